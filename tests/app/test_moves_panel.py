"""The list of edits: what became of each, what no longer fits, and taking one out."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QAbstractItemModelTester, QTest
from pytestqt.qtbot import QtBot
from tests.app.editing import Desk

from stepfield.moves import Outcome
from stepfield.project import ExistingLayer, Move
from stepfield_app.panels.moves import MovesPanel
from stepfield_app.panels.moves_model import MoveRole, MoveRow, MovesModel, told
from stepfield_app.theme import LIGHT

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")  # which the platform without a screen lacks

FLOOR_ONLY = (0.0, 0.0, 0.0, 6.0, 4.0, 10.4)


@pytest.fixture
def panel(qtbot: QtBot, desk: Desk) -> MovesPanel:
    panel = MovesPanel(desk.document, desk.editor)
    qtbot.addWidget(panel)
    panel.setAttribute(Qt.WidgetAttribute.WA_DontShowOnScreen)
    panel.resize(300, 260)
    panel.show()
    return panel


def rows(panel: MovesPanel) -> list[MoveRow]:
    """What the list shows, from the top."""
    model = panel.view.model()
    return [model.index(at, 0).data(MoveRole.ROW) for at in range(model.rowCount())]


def move_some(desk: Desk) -> None:
    """Make two edits: one on the upper layers, one on the floor."""
    desk.select(1, 40)
    desk.editor.move_to(2)
    desk.settle()
    desk.select(0, 25)
    desk.editor.move_to(-1)
    desk.settle()


def test_edits_are_listed_with_what_became_of_them(desk: Desk, panel: MovesPanel) -> None:
    """The operator could not tell what an edit did."""
    assert not panel.view.isVisible()
    move_some(desk)
    assert [(row.text, row.account) for row in rows(panel)] == [
        ("Move 40 pillars to Layer 3", "40 pillars moved, 15 swapped"),
        ("Move 25 pillars to Unassigned", "25 pillars moved"),
    ]
    assert panel.summary.text() == "2 edits"
    assert panel.view.isVisible()


def test_an_edit_that_no_longer_fits_is_marked_and_can_be_found(desk: Desk, panel: MovesPanel) -> None:
    """Edits would be lost without a word when parameters change."""
    move_some(desk)
    desk.document.set_parameters("Crop", crop=FLOOR_ONLY)
    desk.settle()
    assert [row.fits for row in rows(panel)] == [False, True]
    assert panel.summary.text() == "2 edits, 1 no longer fit"
    panel.only.click()
    assert [row.text for row in rows(panel)] == ["Move 40 pillars to Layer 3"]
    panel.set_theme(LIGHT)
    assert not panel.grab().isNull()
    desk.undo()
    assert [row.fits for row in rows(panel)] == [True, True]
    assert not panel.only.isChecked()


def test_a_chosen_edit_shows_its_places(desk: Desk, panel: MovesPanel, qtbot: QtBot) -> None:
    """The operator could not find where an edit was made."""
    move_some(desk)
    with qtbot.waitSignal(panel.places_shown) as shown:
        panel.view.setCurrentIndex(panel.view.model().index(1, 0))
    np.testing.assert_array_equal(shown.args[0], desk.document.project.moves[1].boxes())
    QTest.keyClick(panel.view, Qt.Key.Key_Return)
    desk.settle()
    assert desk.selection.by_layer == {-1: 25}


def test_an_edit_taken_out_comes_back_with_undo(desk: Desk, panel: MovesPanel) -> None:
    """One wrong edit among many would cost all that came after it."""
    before = desk.counts
    move_some(desk)
    panel.view.setCurrentIndex(panel.view.model().index(0, 0))
    QTest.keyClick(panel.view, Qt.Key.Key_Delete)
    desk.settle()
    assert desk.steps[-1] == "Remove edit: Move 40 pillars to Layer 3"
    assert desk.counts == [before[0] - 25, *before[1:]]
    assert len(rows(panel)) == 1
    desk.undo()
    assert len(rows(panel)) == 2


def take_out(desk: Desk, panel: MovesPanel, at: int) -> None:
    """Choose an edit of the list and press Del."""
    panel.view.setCurrentIndex(panel.view.model().index(at, 0))
    QTest.keyClick(panel.view, Qt.Key.Key_Delete)
    desk.settle()


def test_an_edit_that_renumbered_layers_can_be_taken_out(desk: Desk, panel: MovesPanel) -> None:
    """One merge too many would cost all that came after it; undone, the file is what it was."""
    before = desk.counts
    desk.document.set_style("Rename", 2, name="shelf")
    desk.editor.merge(1, 0)
    desk.settle()
    desk.select(1, 40)
    desk.editor.move_to(-1)
    desk.settle()
    edited = desk.document.project
    assert [style.index for style in edited.layers] == [1]
    take_out(desk, panel, 0)
    assert desk.steps[-1].startswith("Remove edit: Merge")
    assert desk.counts == [before[0], before[1], before[2] - 40]
    assert desk.document.style(2).name == "shelf"
    assert len(rows(panel)) == 1
    desk.undo()
    assert desk.document.project.content() == edited.content()


def test_an_edit_that_later_ones_need_stays_and_says_why(desk: Desk, panel: MovesPanel) -> None:
    """A layer cannot be merged that nobody has made."""
    desk.select(1, 40)
    desk.editor.new_layer(move_selection=True)
    desk.settle()
    desk.editor.merge(3, 0)
    desk.settle()
    moves = desk.document.project.moves
    take_out(desk, panel, 0)
    assert desk.document.project.moves is moves
    assert desk.told[-1].startswith("“Merge Layer 4 into Layer 1” would no longer fit: ")
    take_out(desk, panel, 1)
    take_out(desk, panel, 0)
    assert not desk.document.project.moves


@pytest.mark.parametrize(
    ("outcome", "sentence"),
    [
        (Outcome(moved=1), "1 pillar moved"),
        (Outcome(moved=212, swapped=14, left=3), "212 pillars moved, 14 swapped, 3 left"),
        (Outcome(moved=2508, swapped=1062), "2\u202f508 pillars moved, 1\u202f062 swapped"),
        (Outcome(unassigned=7), "7 pillars to Unassigned"),
        (Outcome(), "changes no pillar"),
        (Outcome(reason="there is no layer left to move to"), "There is no layer left to move to"),
    ],
)
def test_outcomes_are_told_in_words(outcome: Outcome, sentence: str) -> None:
    """Numbers would stand there without what they count."""
    assert told(outcome) == sentence


def test_the_model_tells_only_of_edits_that_changed(qtbot: QtBot) -> None:
    """Ten thousand rows would be laid out anew at every edit."""
    to = ExistingLayer(layer=0, of=2, elevation=1.0)
    moves = tuple(Move(text=f"{at}", to=to) for at in range(5))
    model = MovesModel()
    QAbstractItemModelTester(model, QAbstractItemModelTester.FailureReportingMode.Warning, model)
    model.set_moves(moves[:3])
    model.set_outcomes(moves[:3], (Outcome(1), Outcome(2), Outcome(3)))
    with qtbot.assertNotEmitted(model.modelReset), qtbot.waitSignal(model.rowsInserted) as inserted:
        model.set_moves(moves)
    assert inserted.args[1:] == [3, 4]
    assert model.outcome(2) == Outcome(3)
    assert model.outcome(3) is None
    changed: list[tuple[int, int]] = []
    model.dataChanged.connect(lambda first, last: changed.append((first.row(), last.row())))
    model.set_outcomes(moves, (Outcome(1), Outcome(2), Outcome(3), Outcome(4), Outcome(5)))
    assert changed == [(3, 4)]
    model.set_moves((moves[0], moves[2]))
    assert model.rowCount() == 2
    assert model.outcome(1) is None
