"""Splitting and merging layers: the numbers come first."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QCoreApplication, QEvent, QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QDialogButtonBox
from pytestqt.qtbot import QtBot
from tests.app.editing import Desk

from stepfield_app.dialogs.merge import COUNTING, MergeDialog
from stepfield_app.dialogs.split import SplitDialog
from stepfield_app.scenes.parting import BINS, Parting, parting
from stepfield_app.theme import DARK

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")  # which the platform without a screen lacks

OK = QDialogButtonBox.StandardButton.Ok


@pytest.fixture
def split(desk: Desk, qtbot: QtBot) -> SplitDialog:
    dialog = SplitDialog(desk.result, 1, "Layer 2", "#e69f00", DARK)
    qtbot.addWidget(dialog)
    dialog.setAttribute(Qt.WidgetAttribute.WA_DontShowOnScreen)
    dialog.show()
    return dialog


def spread(*elevations: float) -> Parting:
    """Look at pillars at these elevations."""
    counts, edges = np.histogram(elevations, BINS)
    return Parting(np.array(elevations), edges, counts)


def test_a_split_begins_between_the_surfaces(desk: Desk, split: SplitDialog) -> None:
    """The operator would have to search for the gap."""
    elevation = desk.result.layers[1].elevation + desk.result.field.compartments.lowest
    assert sorted(np.unique(elevation.round(2))) == [10.8, 11.6]
    assert split.elevation == pytest.approx(11.2, abs=0.01)
    assert split.above.text() == f"{np.count_nonzero(elevation > 11.2)} pillars"
    assert split.below.text() == f"{np.count_nonzero(elevation < 11.2)} pillars"
    assert not split.grab().isNull()


def test_the_suggestion_lies_in_the_widest_gap() -> None:
    """A few strays would draw the line to themselves, or a flat layer have none."""
    assert spread(*[1.0] * 50, *[1.1] * 50, *[3.0] * 80).suggested() == pytest.approx(2.05, abs=0.05)
    flat = spread(2.0, 2.0)
    assert flat.low <= flat.suggested() <= flat.high


def test_the_counts_follow_the_number_and_the_line(desk: Desk, split: SplitDialog) -> None:
    """The numbers would belong to another elevation than the one shown."""
    total = desk.counts[1]
    split.box.setValue(20.0)
    assert split.above.text() == "0 pillars"
    assert not split.buttons.button(OK).isEnabled()
    QTest.mouseClick(split.plot, Qt.MouseButton.LeftButton, pos=QPoint(150, split.plot.height() // 2))
    assert split.elevation == pytest.approx(11.2, abs=0.05)
    assert split.buttons.button(OK).isEnabled()
    before = split.elevation
    QTest.keyClick(split.plot, Qt.Key.Key_Up)
    assert split.elevation > before
    QTest.mouseClick(split.plot, Qt.MouseButton.LeftButton, pos=QPoint(150, split.plot.height() - 1))
    assert split.below.text() != f"{total} pillars"


def test_counts_are_what_the_split_then_does(desk: Desk, split: SplitDialog) -> None:
    """The dialog would promise something else than happens."""
    desk.editor.split(1, split.elevation)
    desk.settle()
    assert split.above.text() == f"{desk.counts[3]} pillars"


def test_an_empty_layer_cannot_be_parted(desk: Desk, qtbot: QtBot) -> None:
    """The dialog would fail on a layer that was just made."""
    desk.editor.new_layer()
    desk.settle()
    assert parting(desk.result, 3).above(0.0) == 0
    dialog = SplitDialog(desk.result, 3, "Layer 4", "#cc79a7", DARK)
    qtbot.addWidget(dialog)
    assert not dialog.buttons.button(OK).isEnabled()
    assert not dialog.grab().isNull()


def test_a_merge_says_its_losses_first(desk: Desk, qtbot: QtBot) -> None:
    """Pillars would go to Unassigned without a warning."""
    dialog = MergeDialog(desk.editor, 2, -1)
    qtbot.addWidget(dialog)
    assert dialog.sentence.text() == COUNTING
    assert not dialog.buttons.button(OK).isEnabled()
    qtbot.waitUntil(lambda: dialog.sentence.text() != COUNTING)
    assert dialog.target == 1
    lost = desk.counts[1] + desk.counts[2]
    desk.editor.merge(2, dialog.target)
    desk.settle()
    lost -= desk.counts[1]
    assert f"{lost} pillars go to Unassigned" in dialog.sentence.text()


def test_a_merge_into_a_locked_layer_says_why_not(desk: Desk, qtbot: QtBot) -> None:
    """The button would do nothing."""
    desk.editor.set_locked(0, True)
    dialog = MergeDialog(desk.editor, 2, 0)
    qtbot.addWidget(dialog)
    qtbot.waitUntil(lambda: dialog.sentence.text() == "Layer 1 is locked.")
    assert not dialog.buttons.button(OK).isEnabled()
    dialog.box.setCurrentIndex(dialog.box.findData(1))
    qtbot.waitUntil(dialog.buttons.button(OK).isEnabled)


def test_numbers_that_come_late_find_nobody(desk: Desk, qtbot: QtBot) -> None:
    """A dialog that was closed would crash when its numbers come."""
    dialog = MergeDialog(desk.editor, 2, 1)
    dialog.reject()
    dialog.deleteLater()
    QCoreApplication.sendPostedEvents(dialog, QEvent.Type.DeferredDelete)
    with qtbot.waitSignal(desk.editor.merge_weighed):
        pass
    assert desk.steps == []
