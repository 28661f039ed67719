"""What the window can be told to do: its actions, menus, toolbar and dialogs."""

from __future__ import annotations

import traceback
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QFileDialog, QMenu

from stepfield_app import docks
from stepfield_app.actions import Actions, Keys
from stepfield_app.opening import ask_for_files
from stepfield_app.render.scene import CLOUD, PILLARS, RECONSTRUCTION, VIEWS

if TYPE_CHECKING:
    from stepfield_app.main_window import MainWindow

#: Texts of the actions that show one view; every letter after an ampersand is alone in its menu.
ONLY = {CLOUD: "Only the &cloud", PILLARS: "Only the p&illars", RECONSTRUCTION: "Only the &reconstruction"}
#: What the mouse does, for the sheet of keys: no action knows it.
GESTURES = {
    "3-D views": [
        ("Orbit", "Left drag"),
        ("Pan", "Right or middle drag"),
        ("Zoom to the cursor", "Wheel"),
        ("Turn around a point", "Double-click it"),
        ("Orbit, pan, zoom", "Arrows, Shift+arrows, + −"),
        ("One view large, or all", "Double-click its title"),
    ],
    "Map and profile": [
        ("Pan", "Drag"),
        ("Zoom to the cursor", "Wheel"),
        ("Move a profile line", "Drag it or its ends"),
    ],
}


def make(window: MainWindow) -> Actions:
    """Make every action and put it where it is looked for."""
    actions = Actions(window)
    _make_file(actions, window)
    _make_edit(actions, window)
    _make_view(actions, window)
    _make_tools(actions, window)
    _make_help(actions, window)
    _fill_menus(actions, window)
    actions.toolbar("Main", ["open", "export", None, "undo", "redo", None, "crop", "profile line", None])
    actions.toolbar("View", ["iso", "top", "front", "side", "fit", "parallel"])
    return actions


def _make_file(actions: Actions, window: MainWindow) -> None:
    make = actions.make
    make(
        "open",
        "&Open…",
        partial(open_dialog, window),
        keys=Keys.Open,
        glyph="open",
        tip="Open the files of one scan",
        needs_scan=False,
    )
    make(
        "demo",
        "Open the &demo",
        window.demo_feed.start,
        glyph="demo",
        tip="Open a collapsed building made for trying things out",
        needs_scan=False,
    )
    make("close", "&Close the scan", partial(_close_scan, window), keys=Keys.Close, glyph="close")
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


def _make_edit(actions: Actions, window: MainWindow) -> None:
    stack = window.document.undo_stack
    undo = actions.make("undo", "&Undo", stack.undo, keys=Keys.Undo, glyph="undo", needs_scan=False)
    redo = actions.make(
        "redo", "&Redo", stack.redo, keys=["Ctrl+Shift+Z", "Ctrl+Y"], glyph="redo", needs_scan=False
    )
    for action, can, text, verb in (
        (undo, stack.canUndoChanged, stack.undoTextChanged, "&Undo"),
        (redo, stack.canRedoChanged, stack.redoTextChanged, "&Redo"),
    ):
        action.setEnabled(False)
        can.connect(action.setEnabled)
        text.connect(partial(_name_step, action, verb))


def _name_step(action: object, verb: str, step: str) -> None:
    escaped = step.replace("&", "&&")  # a layer may be called what it likes
    action.setText(f"{verb} {escaped}".strip())  # type: ignore[attr-defined]


def _make_view(actions: Actions, window: MainWindow) -> None:
    make, trio = actions.make, window.trio
    for preset, text, keys in (
        ("iso", "From above, as&lant", "Ctrl+Alt+0"),
        ("top", "From the &top", "Ctrl+Alt+1"),
        ("front", "From the s&outh", "Ctrl+Alt+2"),
        ("side", "From the &east", "Ctrl+Alt+3"),
    ):
        make(preset, text, partial(trio.look_from, preset), keys=keys, glyph=preset)
    make("fit", "&Fit", trio.fit, keys="F", glyph="fit", tip="Frame everything")
    make(
        "parallel",
        "&Parallel projection",
        trio.set_parallel,
        keys="Ctrl+Alt+P",
        glyph="parallel",
        checkable=True,
        tip="Equal lengths look equal everywhere",
    )
    make("all views", "&All three views", partial(trio.arrange, VIEWS), keys="Ctrl+0")
    for place, (view, text) in enumerate(ONLY.items(), 1):
        make(
            f"only {view}",
            text,
            partial(trio.arrange, (view,)),
            keys=f"Ctrl+{place}",
        )
    for choice, text in (("system", "As the &system"), ("light", "&Light"), ("dark", "&Dark")):
        action = make(
            f"theme {choice}", text, partial(_choose_theme, window, choice), needs_scan=False, checkable=True
        )
        action.setChecked(choice == window.appearance.choice)
    actions.exclusive([f"theme {choice}" for choice in ("system", "light", "dark")])
    make("panels", "Put the panels &back", partial(docks.arrange, window, window.docks), needs_scan=False)


def _make_tools(actions: Actions, window: MainWindow) -> None:
    crop = actions.make(
        "crop",
        "&Crop box",
        window.cleaning.set_crop_tool,
        keys="C",
        glyph="crop",
        checkable=True,
        tip="Crop the scan with a box that has handles",
    )
    window.cleaning.crop_tool_requested.connect(crop.setChecked)
    line = actions.make(
        "profile line",
        "&Profile line",
        window.map.set_drawing,
        keys="P",
        glyph="profile",
        checkable=True,
        tip="Draw a line in the map to cut along",
    )
    window.map.drawing_changed.connect(line.setChecked)
    actions.make("leave", "&Leave the tool", partial(_leave_tools, window), keys="Esc", needs_scan=False)


def _make_help(actions: Actions, window: MainWindow) -> None:
    actions.make("keys", "&Keys", partial(_show_keys, window), keys="F1", glyph="shortcuts", needs_scan=False)
    actions.make("about", "&About Stepfield", partial(_show_about, window), glyph="info", needs_scan=False)


def _fill_menus(actions: Actions, window: MainWindow) -> None:
    file = actions.menu("&File", ["open"])
    recent = file.addMenu("Open &recent")
    recent.aboutToShow.connect(partial(_fill_recent, recent, window))
    actions.fill(file, ["demo", None, "export", "picture", None, "close", "quit"])
    actions.menu("&Edit", ["undo", "redo"])
    view = actions.menu("&View", ["iso", "top", "front", "side", "fit", "parallel", None, "all views"])
    actions.fill(view, [f"only {name}" for name in VIEWS])
    view.addSeparator()
    window.docks.fill(view.addMenu("Panel&s"))
    actions.fill(view, ["panels"])
    actions.fill(view.addMenu("T&heme"), [f"theme {choice}" for choice in ("system", "light", "dark")])
    actions.menu("&Tools", ["crop", "profile line", None, "leave"])
    actions.menu("&Help", ["keys", "about"])


# --- What they do -------------------------------------------------------------------------------------------


def open_dialog(window: MainWindow) -> None:
    """Let the operator choose files and open them."""
    files = ask_for_files(window, window.settings)
    if files:
        window.open_scans(files)


def _close_scan(window: MainWindow) -> None:
    """Close the scan, and the tools that work on it."""
    _put_away(window)
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


def _open_recent(window: MainWindow, files: object) -> None:
    window.open_scans(files)  # type: ignore[arg-type]


def _export(window: MainWindow) -> None:
    from stepfield_app.dialogs.export import ExportDialog

    dialog = ExportDialog(window.document, window.settings, window.appearance.theme, window)
    window.appearance.changed.connect(dialog.set_theme)
    dialog.exec()
    dialog.deleteLater()


def _save_picture(window: MainWindow) -> None:
    picture = window.grab()
    name, _ = QFileDialog.getSaveFileName(
        window, "Save a picture", str(window.settings.folder("picture") / "stepfield.png"), "PNG (*.png)"
    )
    if name and not picture.save(name):
        window.message_bar.tell("error", f"{name}: the picture cannot be written; choose another place")


def _choose_theme(window: MainWindow, choice: str, is_chosen: bool) -> None:
    if is_chosen and choice != window.appearance.choice:
        window.appearance.choose(choice)  # type: ignore[arg-type]
        window.settings.theme = choice  # type: ignore[assignment]


def _leave_tools(window: MainWindow) -> None:
    """Leave the tool in use, else stop what is being made, else dismiss the newest message."""
    if _put_away(window):
        return
    if window.document.busy or window.demo_feed.is_busy:
        window.cancel()
    else:
        window.message_bar.dismiss_newest()


def _put_away(window: MainWindow) -> bool:
    """Leave every tool; False when there was none in use."""
    used = [tool for name in ("crop", "profile line") if (tool := window.actions_[name]).isChecked()]
    for tool in used:
        tool.setChecked(False)
    return bool(used)


def _show_keys(window: MainWindow) -> None:
    from stepfield_app.dialogs.shortcuts import ShortcutSheet

    sheet = ShortcutSheet(window, GESTURES)
    sheet.exec()
    sheet.deleteLater()


def _show_about(window: MainWindow) -> None:
    from stepfield_app.dialogs.about import AboutDialog

    about = AboutDialog(window)
    about.exec()
    about.deleteLater()


def traceback_of(error: BaseException) -> str:
    """Return what helps to mend an unexpected failure."""
    return "".join(traceback.format_exception(error))
