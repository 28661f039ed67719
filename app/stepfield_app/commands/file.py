"""The File menu: opening, exporting, pictures, leaving."""

from __future__ import annotations

from functools import partial

from PySide6.QtWidgets import QFileDialog, QMenu

from stepfield_app.actions import Actions, Keys
from stepfield_app.commands import tools
from stepfield_app.commands.filing import Filing
from stepfield_app.frame import Frame
from stepfield_app.settings import Files
from stepfield_app.workbench import Workbench


def make(actions: Actions, bench: Workbench, filing: Filing) -> None:
    """Make the actions of the menu."""
    make = actions.make
    make(
        "open",
        "&Open…",
        filing.choose_files,
        keys=Keys.Open,
        glyph="open",
        tip="Open the files of one scan, or a project",
        needs_scan=False,
    )
    make(
        "demo",
        "Open the &demo",
        bench.feeds.demo.start,
        glyph="demo",
        tip="Open a collapsed building made for trying things out",
        needs_scan=False,
    )
    make(
        "save",
        "&Save",
        filing.save,
        keys=Keys.Save,
        glyph="save",
        tip="Save the project with its edits",
    )
    make(
        "save as",
        "Save &as…",
        filing.save_as,
        keys="Ctrl+Shift+S",
        glyph="save as",
        tip="Save the project to another file",
    )
    make(
        "close",
        "&Close the scan",
        partial(_close_scan, actions, bench, filing),
        keys=Keys.Close,
        glyph="close",
    )
    make(
        "export",
        "&Export…",
        partial(_export, bench),
        keys="Ctrl+E",
        glyph="export",
        tip="Write the height-maps",
    )
    make(
        "picture",
        "Save a &picture of the window…",
        partial(_save_picture, bench.frame),
        glyph="screenshot",
        needs_scan=False,
    )
    make("quit", "&Quit", bench.frame.close, keys=Keys.Quit, needs_scan=False)


def fill(actions: Actions, frame: Frame, filing: Filing) -> None:
    """Fill the menu."""
    file = actions.menu("&File", ["open"])
    recent = file.addMenu("Open &recent")
    recent.aboutToShow.connect(partial(_fill_recent, recent, frame, filing))
    actions.fill(file, ["demo", None, "save", "save as", None, "export", "picture", None, "close", "quit"])


def _close_scan(actions: Actions, bench: Workbench, filing: Filing) -> None:
    """Close the scan, and the tools that work on it."""
    filing.leave(partial(_close, actions, bench))


def _close(actions: Actions, bench: Workbench) -> None:
    while tools.put_away(actions, bench):
        pass
    bench.document.close_scan()


def _fill_recent(menu: QMenu, frame: Frame, filing: Filing) -> None:
    menu.clear()
    for files in frame.settings.recent:
        more = f" and {len(files) - 1} more" if len(files) > 1 else ""
        action = menu.addAction(f"{files[0].name}{more}".replace("&", "&&"))
        action.setToolTip(str(files[0]))
        action.triggered.connect(partial(_open_recent, filing, files))
    if menu.isEmpty():
        menu.addAction("Nothing yet").setEnabled(False)
    else:
        menu.addSeparator()
        menu.addAction("Forget these", partial(_forget_recent, frame))


def _forget_recent(frame: Frame) -> None:
    frame.settings.forget_recent()
    frame.welcome.set_recent(())


def _open_recent(filing: Filing, files: Files, is_checked: bool = False) -> None:
    filing.open(files)


def _export(bench: Workbench) -> None:
    from stepfield_app.dialogs.export import ExportDialog

    frame = bench.frame
    dialog = ExportDialog(bench.document, frame.settings, frame.appearance.theme, frame)
    frame.appearance.changed.connect(dialog.set_theme)
    bench.feeds.complex.shown.connect(dialog.show_meshed)
    dialog.show_meshed(bench.feeds.complex.meshed)
    dialog.exec()
    dialog.deleteLater()


def _save_picture(frame: Frame) -> None:
    picture = frame.grab()
    name, _ = QFileDialog.getSaveFileName(
        frame, "Save a picture", str(frame.settings.folder("picture") / "stepfield.png"), "PNG (*.png)"
    )
    if name and not picture.save(name):
        frame.message_bar.tell("error", f"{name}: the picture cannot be written; choose another place")
