"""The selecting tools, and what can be done to a selection: for the menus Edit and Tools, and the toolbar."""

from __future__ import annotations

from functools import partial

from stepfield_app.actions import Actions
from stepfield_app.selection import ReachKind
from stepfield_app.toolbars import TOOLS
from stepfield_app.tools.choice import ToolName
from stepfield_app.workbench import Workbench

#: Names of the other actions: of the Edit menu and every view's, of its submenu, of the Tools menu.
EDIT = ["select all", "invert", "grow", "shrink", "clear selection"]
REACHES = ["reach layer", "reach range", "reach everything"]
BRUSH = ["narrower brush", "wider brush"]
KEYBOARD = "keys to the map"
#: What the mouse and the keys do while a tool is in use, for the sheet of keys.
GESTURES = {
    "Selecting": [
        ("Select anew", "Drag or click"),
        ("Add", "Shift"),
        ("Subtract", "Alt or Ctrl"),
        ("Size of the brush", "Ctrl+wheel"),
        ("Move pillars to a layer", "Drag the selection"),
        ("Navigate meanwhile", "Hold Space"),
        ("Select in the map by keys", "M, arrows, Enter"),
        ("A rectangle by keys", "Shift+arrows, Enter"),
    ],
}

_TOOLS: tuple[tuple[ToolName, str, str, str], ...] = (
    ("navigate", "&Navigate", "N", "Orbit, pan and zoom"),
    ("click", "Clic&k", "V", "Select single pillars"),
    ("rectangle", "&Rectangle", "R", "Select pillars in a rectangle"),
    ("lasso", "La&sso", "L", "Select pillars by drawing around them"),
    ("brush", "&Brush", "B", "Select pillars by brushing over them"),
    ("surface", "Connected s&urface", "U", "Select all pillars of a surface"),
)
_REACHES: tuple[tuple[ReachKind, str, str], ...] = (
    ("layer", "The active &layer", "Ctrl+Alt+L"),
    ("range", "A range of &elevations", "Ctrl+Alt+R"),
    ("everything", "E&verything", "Ctrl+Alt+E"),
)


def make(actions: Actions, bench: Workbench) -> None:
    """Make the actions; those of the other tools must be there already."""
    _make_tools(actions, bench)
    _make_commands(actions, bench)
    _make_reaches(actions, bench)
    bench.select_tools.set_commands([actions[name] for name in EDIT])


def _make_tools(actions: Actions, bench: Workbench) -> None:
    """Let one of all tools be in use: these are exclusive with the crop box and the profile line."""
    for name, text, key, tip in _TOOLS:
        choose = partial(_choose, actions, bench, name)
        actions.make(name, text, choose, keys=key, glyph=name, checkable=True, tip=tip)
    actions.exclusive(TOOLS)
    actions["navigate"].setChecked(True)
    bench.select_tools.tool_changed.connect(lambda name: actions[name].setChecked(True))
    for other in ("crop", "profile line"):
        actions[other].toggled.connect(partial(_give_way, actions))
    make = actions.make
    make("narrower brush", "Narro&wer brush", partial(bench.select_tools.widen, -1), keys="[")
    make("wider brush", "Wid&er brush", partial(bench.select_tools.widen, 1), keys="]")
    make(
        KEYBOARD,
        "Select in the &map by keys",
        partial(_go_to_map, actions, bench),
        keys="M",
        tip="Bring the map to the front and give it the keyboard: arrows, Shift+arrows, Enter",
    )


def _go_to_map(actions: Actions, bench: Workbench) -> None:
    """Show the map, and its cursor if there is no tool yet."""
    bench.raise_map()
    bench.map.plot.setFocus()
    if bench.select_tools.tool == "navigate":
        actions["rectangle"].setChecked(True)


def _give_way(actions: Actions, other_is_used: bool) -> None:
    if other_is_used:
        actions["navigate"].setChecked(True)


def _choose(actions: Actions, bench: Workbench, name: ToolName, is_chosen: bool) -> None:
    if not is_chosen:
        return
    if name != "navigate":
        for other in ("crop", "profile line"):
            actions[other].setChecked(False)
    bench.select_tools.choose(name)


def _make_commands(actions: Actions, bench: Workbench) -> None:
    selection, document, make = bench.selection, bench.document, actions.make
    make(
        "select all",
        "Select &all of the layer",
        lambda: selection.all_of(document.active_layer),
        keys="Ctrl+A",
        glyph="select all",
        tip="Select every pillar of the active layer",
    )
    make("invert", "&Invert the selection", selection.invert, keys="Ctrl+I", glyph="invert")
    make("grow", "&Grow the selection", selection.grow, keys=["Ctrl++", "Ctrl+="], glyph="grow")
    make("shrink", "&Shrink the selection", selection.shrink, keys="Ctrl+-", glyph="shrink")
    make(
        "clear selection",
        "&Clear the selection",
        selection.clear,
        keys="Ctrl+Shift+A",
        glyph="clear selection",
    )


def _make_reaches(actions: Actions, bench: Workbench) -> None:
    selection = bench.selection
    for kind, text, keys in _REACHES:
        choose = partial(_reach, bench, kind)
        action = actions.make(f"reach {kind}", text, choose, keys=keys, checkable=True)
        action.setData(f"Reach: {_uncapitalised(text.replace('&', ''))}")  # in the sheet of keys
    actions.exclusive(REACHES)

    def show() -> None:
        actions[f"reach {selection.reach_kind}"].setChecked(True)

    show()
    selection.reach_changed.connect(show)


def _uncapitalised(text: str) -> str:
    return text[:1].lower() + text[1:]


def _reach(bench: Workbench, kind: ReachKind, is_chosen: bool) -> None:
    if is_chosen and bench.selection.reach_kind != kind:
        bench.selection.set_reach(kind)
