"""The View menu: cameras, arrangement, theme."""

from __future__ import annotations

from functools import partial

from stepfield_app import docks
from stepfield_app.actions import Actions
from stepfield_app.render.scene import CLOUD, PILLARS, RECONSTRUCTION, VIEWS
from stepfield_app.views.pictures import MODES
from stepfield_app.workbench import Workbench

#: Texts of the actions that show one view; every letter after an ampersand is alone in its menu.
ONLY = {CLOUD: "Only the &cloud", PILLARS: "Only the p&illars", RECONSTRUCTION: "Only the &reconstruction"}


def make(actions: Actions, bench: Workbench) -> None:
    """Make the actions of the menu."""
    make, trio = actions.make, bench.trio
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
            f"theme {choice}", text, partial(_choose_theme, bench, choice), needs_scan=False, checkable=True
        )
        action.setChecked(choice == bench.frame.appearance.choice)
    actions.exclusive([f"theme {choice}" for choice in ("system", "light", "dark")])
    for place, (mode, (text, tip)) in enumerate(MODES.items(), 1):
        name = f"map {mode}"
        make(
            name,
            f"&{place} {text}",
            partial(_show_map, bench, mode),
            keys=f"Alt+{place}",
            tip=tip,
            checkable=True,
        )
    actions.exclusive([f"map {mode}" for mode in MODES])
    actions[f"map {bench.map.mode}"].setChecked(True)
    bench.map.mode_changed.connect(lambda mode: actions[f"map {mode}"].setChecked(True))
    make(
        "panels",
        "Put the panels &back",
        partial(docks.arrange, bench.frame, bench.frame.docks),
        needs_scan=False,
    )


def fill(actions: Actions, bench: Workbench) -> None:
    """Fill the menu."""
    view = actions.menu("&View", ["iso", "top", "front", "side", "fit", "parallel", None, "all views"])
    actions.fill(view, [f"only {name}" for name in VIEWS])
    view.addSeparator()
    actions.fill(view.addMenu("&Map"), [f"map {mode}" for mode in MODES])
    bench.frame.docks.fill(view.addMenu("Panel&s"))
    actions.fill(view, ["panels"])
    actions.fill(view.addMenu("T&heme"), [f"theme {choice}" for choice in ("system", "light", "dark")])


def _show_map(bench: Workbench, mode: str, is_chosen: bool) -> None:
    if is_chosen and mode != bench.map.mode:
        bench.show_map(mode)


def _choose_theme(bench: Workbench, choice: str, is_chosen: bool) -> None:
    if is_chosen and choice != bench.frame.appearance.choice:
        bench.frame.appearance.choose(choice)  # type: ignore[arg-type]
        bench.frame.settings.theme = choice  # type: ignore[assignment]
