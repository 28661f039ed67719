"""The cleaning panel: nothing is dropped until it is asked for, and every step has a name and a way back."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import laspy
import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QComboBox
from pytestqt.qtbot import QtBot

from stepfield.parameters import Parameters
from stepfield_app.document import Document
from stepfield_app.panels.cleaning import CleaningPanel
from stepfield_app.panels.history import HistoryPanel
from stepfield_app.panels.lengths import LengthBox
from stepfield_app.panels.slab import SlabSlider
from stepfield_app.runner import Runner

pytestmark = pytest.mark.qt_log_ignore("This plugin does not support", extend=True)

BASE = Parameters(cell_size=0.5, layer_tolerance=0.3, alpha=0.1)


@pytest.fixture
def building(tmp_path: Path) -> Path:
    """Three floors, three metres apart; ground, buildings and a user's own class."""
    rng = np.random.default_rng(5)
    las = laspy.LasData(laspy.LasHeader(point_format=6, version="1.4"))
    las.header.scales = np.array([0.001] * 3)
    x, y = rng.random((2, 3000)) * 10
    floor = np.arange(3000) % 3
    las.x, las.y, las.z = x, y, floor * 3.0
    las.classification = np.array([2, 6, 70], np.uint8)[floor]
    path = tmp_path / "building.las"
    las.write(path)
    return path


@pytest.fixture
def document(qtbot: QtBot, building: Path) -> Iterator[Document]:
    document = Document(Runner(threaded=False))
    document.open([building], BASE)
    yield document
    document.close()


@pytest.fixture
def panel(qtbot: QtBot, document: Document) -> CleaningPanel:
    panel = CleaningPanel(document)
    qtbot.addWidget(panel)
    panel.resize(320, 800)
    panel.show()
    return panel


def steps(document: Document) -> list[str]:
    return [document.undo_stack.text(i) for i in range(document.undo_stack.count())]


def used(document: Document) -> int:
    assert document.answer is not None
    return len(document.answer.result.scan)


def drag(slab: SlabSlider, start: float, stop: float) -> None:
    """Drag whatever is at a share of the slab to another."""

    def at(share: float) -> QPoint:
        return QPoint(round(slab._place(share)), slab.height() // 2)

    QTest.mousePress(slab, Qt.MouseButton.LeftButton, pos=at(start))
    for share in np.linspace(start, stop, 5):
        QTest.mouseMove(slab, at(float(share)))
    QTest.mouseRelease(slab, Qt.MouseButton.LeftButton, pos=at(stop))


def test_opening_the_panel_changes_nothing(panel: CleaningPanel, document: Document) -> None:
    assert document.project.parameters == BASE
    assert document.undo_stack.count() == 0
    assert not panel.crop.switch.isChecked()
    assert "3 000" in panel.removed.text().replace("\N{NARROW NO-BREAK SPACE}", " ")


def test_one_drag_of_the_slab_takes_a_floor_off(panel: CleaningPanel, document: Document) -> None:
    drag(panel.crop.slab, 1.0, 0.7)
    crop = document.project.parameters.crop
    assert crop is not None
    assert document.facts is not None
    assert crop[:5] == document.facts.bounds[:5], "the other sides stay where the scan ends"
    assert crop[5] == pytest.approx(4.2, abs=0.1)
    assert used(document) == 2000
    assert len(steps(document)) == 1
    assert steps(document)[0].startswith("Crop z 0.00 to 4.")
    assert panel.crop.switch.isChecked()
    assert "outside the crop box" in panel.removed.text()
    document.undo_stack.undo()
    assert used(document) == 3000
    assert panel.crop.slab.ends[1] == pytest.approx(1.0)


def test_the_part_between_is_dragged_from_floor_to_floor(panel: CleaningPanel, document: Document) -> None:
    drag(panel.crop.slab, 0.0, 0.35)
    drag(panel.crop.slab, 1.0, 0.65)
    assert used(document) == 1000
    before = panel.crop.slab.ends
    drag(panel.crop.slab, 0.5, 0.3)
    after = panel.crop.slab.ends
    assert after[1] - after[0] == pytest.approx(before[1] - before[0])
    assert after[0] == pytest.approx(before[0] - 0.2, abs=0.02)


def test_the_slab_moves_by_keys_too(panel: CleaningPanel, document: Document) -> None:
    slab = panel.crop.slab
    QTest.keyClick(slab, Qt.Key.Key_PageDown)
    assert slab.ends == pytest.approx((0.0, 0.95))
    QTest.keyClick(slab, Qt.Key.Key_Space)
    QTest.keyClick(slab, Qt.Key.Key_Right)
    assert slab.ends == pytest.approx((0.005, 0.95))
    assert len(steps(document)) == 1
    panel.crop._hand.release()


def test_ends_of_the_slab_never_pass_each_other(qtbot: QtBot) -> None:
    slab = SlabSlider()
    qtbot.addWidget(slab)
    slab.resize(300, 24)
    drag(slab, 1.0, -0.5)
    assert 0 <= slab.ends[0] < slab.ends[1] <= 1


def test_numbers_of_the_box_are_typed_in_scan_coordinates(panel: CleaningPanel, document: Document) -> None:
    box = panel.crop.boxes[3]
    box.selectAll()
    QTest.keyClicks(box, "5")
    QTest.keyClick(box, Qt.Key.Key_Return)
    crop = document.project.parameters.crop
    assert crop is not None
    assert crop[3] == 5.0
    assert steps(document) == ["Crop"]
    panel.crop._hand.release()


def test_a_box_without_an_inside_is_refused_and_the_old_number_shown(
    panel: CleaningPanel, document: Document
) -> None:
    errors: list[Exception] = []
    document.failed.connect(errors.append)
    before = panel.crop.boxes[0].value()
    panel.crop.boxes[0].setValue(99.0)
    assert "x0 < x1" in str(errors[0])
    assert panel.crop.boxes[0].value() == before
    assert document.undo_stack.count() == 0
    panel.crop._hand.release()


def test_switching_off_keeps_the_box_for_switching_on(panel: CleaningPanel, document: Document) -> None:
    box = (1.0, 1.0, -1.0, 9.0, 9.0, 7.0)
    document.set_parameters("Crop", crop=box)
    panel.crop.switch.click()
    assert document.project.parameters.crop is None
    panel.crop.switch.click()
    assert document.project.parameters.crop == box
    panel.crop.clear.click()
    assert document.project.parameters.crop is None
    assert steps(document) == ["Crop", "Crop off", "Crop on", "Clear the crop box"]
    assert document.facts is not None
    assert panel.crop.box == document.facts.bounds


def test_classes_have_names_counts_and_checkboxes(panel: CleaningPanel, document: Document) -> None:
    checks = panel.classes.checks
    assert [check.text() for check in checks.values()] == ["2  Ground", "6  Building", "70  User defined"]
    checks[2].click()
    assert document.project.parameters.classes == (6, 70)
    assert used(document) == 2000
    checks[2].click()
    assert document.project.parameters.classes is None, "all classes are no filter"
    assert steps(document) == ["Drop class 2 Ground", "Keep class 2 Ground"]


def test_the_last_class_cannot_be_dropped(panel: CleaningPanel, document: Document) -> None:
    for check in panel.classes.checks.values():
        check.click()
    assert document.project.parameters.classes == (70,)
    assert panel.classes.checks[70].isChecked()


def test_counts_stay_those_of_the_whole_scan(panel: CleaningPanel, document: Document) -> None:
    facts = document.facts
    panel.classes.checks[2].click()
    assert document.facts is facts
    assert facts is not None
    assert dict(facts.classes) == {2: 1000, 6: 1000, 70: 1000}


def test_outliers_are_counted_before_they_are_dropped(panel: CleaningPanel, document: Document) -> None:
    asked: list[str] = []
    panel.preview_requested.connect(asked.append)
    group = panel.outliers
    assert not group.preview.isEnabled()
    group.mode.setFocus()
    QTest.keyClick(group.mode, Qt.Key.Key_Down)
    assert str(document.project.parameters.outliers) == "off"
    group.preview.click()
    assert group.count.text() == "Counting…"
    panel.show_outlier_count(12, 3000)
    assert group.count.text().startswith("12 points of 3")
    group.apply.click()
    assert document.project.parameters.outliers == "radius"
    assert asked == ["radius", "off"], "the preview ends when the filter is applied"
    assert not group.apply.isEnabled()
    assert steps(document) == ["Drop radius outliers"]


def test_unit_and_up_axis_show_what_the_file_declares_and_can_be_changed(
    panel: CleaningPanel, document: Document
) -> None:
    assert panel.unit.currentText() == "auto: metres"
    document.set_parameters("Crop", crop=(1.0, 1.0, -1.0, 9.0, 9.0, 7.0))
    panel.unit.setFocus()
    QTest.keyClick(panel.unit, Qt.Key.Key_Down, delay=0)
    QTest.keyClick(panel.unit, Qt.Key.Key_Down, delay=0)
    assert document.project.parameters.unit == "cm"
    assert document.project.parameters.crop is None, "a box in metres means another place now"
    assert document.facts is not None
    assert document.facts.bounds[5] == pytest.approx(0.06)
    panel.up.setFocus()
    QTest.keyClick(panel.up, Qt.Key.Key_Up)
    assert document.project.parameters.up == "y"
    assert steps(document) == ["Crop", "Unit metres", "Unit centimetres", "y is up"]


def test_the_crop_tool_is_asked_for_and_can_be_left_elsewhere(panel: CleaningPanel) -> None:
    asked: list[bool] = []
    panel.crop_tool_requested.connect(asked.append)
    panel.crop.tool.click()
    panel.set_crop_tool(False)
    assert asked == [True, False]
    assert not panel.crop.tool.isChecked()


def test_every_control_has_a_name_and_a_tooltip(panel: CleaningPanel) -> None:
    kinds = (QAbstractButton, QComboBox, LengthBox, SlabSlider)
    for kind in kinds:
        for control in panel.findChildren(kind):
            assert control.accessibleName(), control
            assert control.toolTip(), control


def test_history_lists_steps_and_goes_back_to_one(qtbot: QtBot, document: Document) -> None:
    history = HistoryPanel(document)
    qtbot.addWidget(history)
    document.set_parameters("Alpha 0.5 m", alpha=0.5)
    document.set_parameters("Alpha 0.6 m", alpha=0.6)
    model = history.view.model()
    assert [model.index(i, 0).data() for i in range(3)] == ["As opened", "Alpha 0.5 m", "Alpha 0.6 m"]
    history.view.setCurrentIndex(model.index(1, 0))
    assert document.project.parameters.alpha == 0.5
