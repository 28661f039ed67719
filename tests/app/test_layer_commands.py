"""The Layers menu: every edit of layers by key."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtGui import QShortcut
from PySide6.QtWidgets import QApplication, QDialog, QMainWindow
from pytestqt.qtbot import QtBot
from tests.app.editing import Desk

from stepfield_app.actions import Actions
from stepfield_app.commands import layers
from stepfield_app.dialogs.merge import MergeDialog
from stepfield_app.dialogs.split import SplitDialog
from stepfield_app.panels.layers import LayersPanel
from stepfield_app.panels.layers_editing import LayersEditing
from stepfield_app.theme import DARK


class Dressed:
    """Stands in for the window's appearance."""

    theme = DARK


class Frame(QMainWindow):
    """What of the window's frame the menu needs."""

    appearance = Dressed()


class Bench:
    """What of all there is to work with the menu needs."""

    def __init__(self, desk: Desk) -> None:
        self.frame = Frame()
        self.document, self.editor, self.selection = desk.document, desk.editor, desk.selection
        self.layers = LayersPanel(desk.document)
        self.layer_editing = LayersEditing(desk.document, self.layers, desk.editor)
        self.frame.setCentralWidget(self.layers)


@pytest.fixture
def desk(qtbot: QtBot) -> Iterator[Desk]:
    desk = Desk(qtbot)
    yield desk
    desk.close()


@pytest.fixture
def actions(qtbot: QtBot, desk: Desk, tmp_path: Path) -> Actions:
    bench: Any = Bench(desk)
    qtbot.addWidget(bench.frame)
    made = Actions(bench.frame)
    layers.make(made, bench)
    layers.fill(made)
    desk.open(tmp_path)
    made.enable(True)
    return made


def test_a_digit_takes_the_selection_to_its_layer(desk: Desk, actions: Actions) -> None:
    """The keyboard would have no way to put pillars right."""
    desk.select(1, 40)
    assert actions["to layer 1"].shortcut().toString() == "1"
    actions["to layer 1"].trigger()
    desk.settle()
    actions["to unassigned"].trigger()
    desk.settle()
    actions["to new layer"].trigger()
    desk.settle()
    assert desk.steps == [
        "Move 40 pillars to Layer 1",
        "Move 40 pillars to Unassigned",
        "Move 40 pillars to Layer 4",
    ]


def test_the_menu_names_the_layers_there_are(desk: Desk, actions: Actions) -> None:
    """Digits would be offered for layers that are not there, or under other names than the panel's."""
    visible = [number for number in range(1, 10) if actions[f"to layer {number}"].isVisible()]
    assert visible == [1, 2, 3]
    desk.document.set_style("Rename", 1, name="Tables & chairs")
    assert actions["to layer 2"].text() == "&2  Tables && chairs"


def test_the_digit_of_a_layer_that_is_not_there_says_so(desk: Desk, actions: Actions) -> None:
    """A key that does nothing looks broken."""
    told: list[str] = []
    desk.editor.told.connect(told.append)
    (window,) = (each for each in QApplication.topLevelWidgets() if isinstance(each, Frame))
    keys = {shortcut.key().toString(): shortcut for shortcut in window.findChildren(QShortcut)}
    assert [key for key in sorted(keys) if keys[key].isEnabled()] == ["4", "5", "6", "7", "8", "9"]
    keys["7"].activated.emit()
    assert told == ["There is no layer 7"]
    desk.editor.new_layer()
    desk.settle()
    assert not keys["4"].isEnabled(), "two things for one key do nothing"
    desk.document.close_scan()
    assert not any(shortcut.isEnabled() for shortcut in keys.values())


def test_keys_act_on_the_active_layer(desk: Desk, actions: Actions) -> None:
    """Layers could be edited with the mouse only."""
    desk.document.set_active_layer(1)
    for name in ("layer up", "layer down", "layer toggle_locked", "layer toggle_locked", "new layer"):
        actions[name].trigger()
        desk.settle()
    desk.document.set_active_layer(0)
    actions["layer remove"].trigger()
    desk.settle()
    assert desk.steps == [
        "Exchange Layer 2 and Layer 3",
        "Exchange Layer 3 and Layer 2",
        "Lock Layer 2",
        "Unlock Layer 2",
        "Add Layer 4",
        "Remove Layer 1",
    ]


def test_keys_go_from_layer_to_layer(desk: Desk, actions: Actions) -> None:
    """The active layer could be chosen with the mouse only, or by many presses of Tab."""
    desk.document.set_active_layer(1)
    actions["layer above"].trigger()
    actions["layer above"].trigger()
    assert desk.document.active_layer == 2, "the highest one"
    for _ in range(5):
        actions["layer below"].trigger()
    assert desk.document.active_layer == -1, "Unassigned"


def test_an_empty_layer_is_not_split(desk: Desk, actions: Actions, monkeypatch: pytest.MonkeyPatch) -> None:
    """A dialog would ask where to part nothing."""
    monkeypatch.setattr(SplitDialog, "exec", lambda self: pytest.fail("the dialog has opened"))
    actions["new layer"].trigger()
    desk.settle()
    said: list[str] = []
    desk.editor.told.connect(said.append)
    desk.document.set_active_layer(3)
    actions["layer split"].trigger()
    assert said == ["Layer 4 is empty: there is nothing to split"]


@pytest.mark.parametrize("is_wanted", [True, False])
def test_merge_and_split_are_done_when_confirmed(
    desk: Desk, actions: Actions, monkeypatch: pytest.MonkeyPatch, is_wanted: bool
) -> None:
    """A dialog's Cancel would edit, or its OK would not."""
    answer = QDialog.DialogCode.Accepted if is_wanted else QDialog.DialogCode.Rejected
    monkeypatch.setattr(SplitDialog, "exec", lambda self: answer)
    monkeypatch.setattr(MergeDialog, "exec", lambda self: answer)
    desk.document.set_active_layer(1)
    actions["layer split"].trigger()
    desk.settle()
    actions["layer merge"].trigger()
    desk.settle()
    wanted = ["Split Layer 2 at 11.200 m", "Merge Layer 2 into Layer 1"]
    assert desk.steps == (wanted if is_wanted else [])


def test_every_letter_of_the_menu_is_alone(actions: Actions) -> None:
    """Alt and a letter would stop at the first of two entries."""
    names = ["new layer", *(f"layer {wish}" for wish, *_ in layers.OF_LAYER), "show all layers"]
    texts = [actions[name].text() for name in names] + ["Move the &selection to"]
    letters = [text[text.index("&") + 1].lower() for text in texts]
    assert len(letters) == len(set(letters))
