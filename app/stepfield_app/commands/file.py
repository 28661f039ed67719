"""The File menu: opening, exporting, pictures, leaving."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QFileDialog, QMenu

from stepfield_app.actions import Actions, Keys
from stepfield_app.commands import tools
from stepfield_app.settings import Files

if TYPE_CHECKING:
    from stepfield_app.main_window import MainWindow


def make(actions: Actions, window: MainWindow) -> None:
    """Make the actions of the menu."""
    make = actions.make
    make(
        "open",
        "&Open…",
        window.filing.choose_files,
        keys=Keys.Open,
        glyph="open",
        tip="Open the files of one scan, or a project",
        needs_scan=False,
    )
    make(
        "demo",
        "Open the &demo",
        window.feeds.demo.start,
        glyph="demo",
        tip="Open a collapsed building made for trying things out",
        needs_scan=False,
    )
    make(
        "save",
        "&Save",
        window.filing.save,
        keys=Keys.Save,
        glyph="save",
        tip="Save the project with its edits",
    )
    make(
        "save as",
        "Save &as…",
        window.filing.save_as,
        keys="Ctrl+Shift+S",
        glyph="save as",
        tip="Save the project to another file",
    )
    make("close", "&Close the scan", partial(close_scan, window), keys=Keys.Close, glyph="close")
    make(
        "export",
        "&Export…",
        partial(_export, window),
        keys="Ctrl+E",
        glyph="export",
        tip="Write the height-maps",
    )
    make(
        "picture",
        "Save a &picture of the window…",
        partial(_save_picture, window),
        glyph="screenshot",
        needs_scan=False,
    )
    make("quit", "&Quit", window.close, keys=Keys.Quit, needs_scan=False)


def fill(actions: Actions, window: MainWindow) -> None:
    """Fill the menu."""
    file = actions.menu("&File", ["open"])
    recent = file.addMenu("Open &recent")
    recent.aboutToShow.connect(partial(_fill_recent, recent, window))
    actions.fill(file, ["demo", None, "save", "save as", None, "export", "picture", None, "close", "quit"])


def close_scan(window: MainWindow) -> None:
    """Close the scan, and the tools that work on it."""
    window.filing.leave(partial(_close, window))


def _close(window: MainWindow) -> None:
    while tools.put_away(window):
        pass
    window.document.close_scan()


def _fill_recent(menu: QMenu, window: MainWindow) -> None:
    menu.clear()
    for files in window.settings.recent:
        more = f" and {len(files) - 1} more" if len(files) > 1 else ""
        action = menu.addAction(f"{files[0].name}{more}".replace("&", "&&"))
        action.setToolTip(str(files[0]))
        action.triggered.connect(partial(_open_recent, window, files))
    if menu.isEmpty():
        menu.addAction("Nothing yet").setEnabled(False)
    else:
        menu.addSeparator()
        menu.addAction("Forget these", partial(_forget_recent, window))


def _forget_recent(window: MainWindow) -> None:
    window.settings.forget_recent()
    window.welcome.set_recent(())


def _open_recent(window: MainWindow, files: Files, is_checked: bool = False) -> None:
    window.filing.open(files)


def _export(window: MainWindow) -> None:
    from stepfield_app.dialogs.export import ExportDialog

    dialog = ExportDialog(window.document, window.settings, window.appearance.theme, window)
    window.appearance.changed.connect(dialog.set_theme)
    window.feeds.complex.shown.connect(dialog.show_meshed)
    dialog.show_meshed(window.feeds.complex.meshed)
    dialog.exec()
    dialog.deleteLater()


def _save_picture(window: MainWindow) -> None:
    picture = window.grab()
    name, _ = QFileDialog.getSaveFileName(
        window, "Save a picture", str(window.settings.folder("picture") / "stepfield.png"), "PNG (*.png)"
    )
    if name and not picture.save(name):
        window.message_bar.tell("error", f"{name}: the picture cannot be written; choose another place")
