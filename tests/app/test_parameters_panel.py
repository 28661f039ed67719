"""The parameters panel: what the hand does becomes edits, and what the document says is shown."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QScrollArea, QWidget
from pytestqt.qtbot import QtBot

from stepfield.parameters import Parameters
from stepfield_app.document import Document
from stepfield_app.panels import hand, page
from stepfield_app.panels.lengths import STEPS, LengthBox, Range, read_length, written
from stepfield_app.panels.parameters import ParametersPanel
from stepfield_app.runner import Runner

#: The offscreen plugin says that it cannot tell the desktop how large a window may be.
pytestmark = pytest.mark.qt_log_ignore("This plugin does not support", extend=True)

BASE = Parameters(cell_size=0.25, layer_tolerance=0.3)


@pytest.fixture
def room(tmp_path: Path) -> Path:
    """Five metres by four, three high."""
    rng = np.random.default_rng(3)
    path = tmp_path / "room.npy"
    points = np.vstack(
        [rng.random((2000, 3)) * [5, 4, 0.02], rng.random((2000, 3)) * [5, 4, 0.02] + [0, 0, 3]]
    )
    np.save(path, np.vstack([points, [[0, 0, 0], [5, 4, 0]]]))
    return path


@pytest.fixture
def document(qtbot: QtBot, room: Path) -> Iterator[Document]:
    document = Document(Runner(threaded=False))
    document.open([room], BASE)
    yield document
    document.close()


@pytest.fixture
def panel(qtbot: QtBot, document: Document) -> ParametersPanel:
    panel = ParametersPanel(document)
    qtbot.addWidget(panel)
    panel.resize(340, 300)
    panel.show()
    return panel


def steps(document: Document) -> list[str]:
    return [document.undo_stack.text(i) for i in range(document.undo_stack.count())]


def turn_wheel(control: QWidget) -> None:
    """Turn the wheel over a control, as the desktop would say it."""
    window = control.window()
    place = control.mapTo(window, control.rect().center())
    QTest.wheelEvent(window.windowHandle(), QPointF(place), QPoint(0, -120))
    QApplication.processEvents()


def test_a_drag_follows_the_hand_and_is_one_named_step(
    panel: ParametersPanel, document: Document, qtbot: QtBot
) -> None:
    slider = panel.cell_size.slider
    handle = QPoint(round(slider.width() * slider.value() / STEPS), slider.height() // 2)
    QTest.mousePress(slider, Qt.MouseButton.LeftButton, pos=handle)
    seen = []
    for x in range(0, 30, 5):
        QTest.mouseMove(slider, handle + QPoint(x, 0))
        seen.append(document.project.parameters.cell_size)
    QTest.mouseRelease(slider, Qt.MouseButton.LeftButton, pos=handle + QPoint(25, 0))
    assert len(set(seen)) > 4
    assert document.answer is not None
    assert document.answer.request.parameters == document.project.parameters
    assert steps(document) == [f"Cell size {written(document.project.parameters.cell_size)}"]  # type: ignore[arg-type]
    assert panel.cell_size.box.value() == document.project.parameters.cell_size


def test_a_click_on_the_groove_takes_the_handle_there_in_one_step(
    panel: ParametersPanel, document: Document, qtbot: QtBot
) -> None:
    slider = panel.alpha.slider
    QTest.mouseClick(slider, Qt.MouseButton.LeftButton, pos=QPoint(slider.width() - 8, slider.height() // 2))
    assert len(steps(document)) == 1
    alpha = document.project.parameters.alpha
    assert isinstance(alpha, float)
    assert alpha > 1


def test_keys_in_a_row_are_one_step_and_after_some_quiet_another(
    panel: ParametersPanel, document: Document, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    slider = panel.tolerance.slider
    panel.tolerance._hand._quiet.setInterval(30)
    for _ in range(5):
        QTest.keyClick(slider, Qt.Key.Key_Right)
    assert len(steps(document)) == 1
    qtbot.waitUntil(lambda: not document._gestures)
    QTest.keyClick(slider, Qt.Key.Key_Right)
    assert len(steps(document)) == 2
    qtbot.waitUntil(lambda: not document._gestures)
    assert hand.QUIET == 1000


@pytest.mark.parametrize(("typed", "metres"), [("0.4", 0.4), ("40 cm", 0.4), ("400mm", 0.4), ("0,4 m", 0.4)])
def test_a_typed_number_may_have_a_unit_of_its_own(
    panel: ParametersPanel, document: Document, qtbot: QtBot, typed: str, metres: float
) -> None:
    box = panel.cell_size.box
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, typed)
    assert document.undo_stack.count() == 0, "half a number is not yet a wish"
    QTest.keyClick(box, Qt.Key.Key_Return)
    assert document.project.parameters.cell_size == pytest.approx(metres)
    assert steps(document) == ["Cell size 0.4 m"]


def test_return_in_a_box_that_was_not_edited_changes_nothing(
    panel: ParametersPanel, document: Document, qtbot: QtBot
) -> None:
    """The box shows three digits of a number that has more."""
    document.set_parameters("Alpha", alpha=0.123456)
    panel.alpha.box.setFocus()
    QTest.keyClick(panel.alpha.box, Qt.Key.Key_Return)
    assert document.project.parameters.alpha == 0.123456
    assert panel.alpha.box.text() == "0.123 m"


def test_auto_shows_the_picked_number_and_can_be_returned_to(
    panel: ParametersPanel, document: Document
) -> None:
    assert panel.alpha.auto.isChecked()
    assert document.answer is not None
    assert panel.alpha.box.value() == pytest.approx(float(document.answer.result.parameters.alpha))
    panel.alpha.auto.click()
    assert document.project.parameters.alpha == panel.alpha.box.value()
    assert not panel.alpha.auto.isChecked()
    panel.alpha.auto.click()
    assert str(document.project.parameters.alpha) == "auto"
    assert steps(document) == ["Alpha 0.125 m", "Alpha auto"]


def test_undo_is_shown(panel: ParametersPanel, document: Document) -> None:
    before = panel.cell_size.slider.value()
    document.set_parameters("Cell", cell_size=1.0)
    assert panel.cell_size.slider.value() > before
    document.undo_stack.undo()
    assert panel.cell_size.slider.value() == before
    assert panel.cell_size.box.text() == "0.25 m"


def test_the_wheel_scrolls_the_panel_unless_a_control_has_the_focus(
    panel: ParametersPanel, document: Document
) -> None:
    """Scrolling past a slider must not change the result."""
    panel.resize(340, 190)
    QApplication.processEvents()
    bar = panel.findChildren(QScrollArea)[0].verticalScrollBar()
    for control in (panel.cell_size.slider, panel.cell_size.box, panel.alpha.box):
        bar.setValue(0)
        control.clearFocus()
        turn_wheel(control)
        assert bar.value() > 0, f"the panel did not scroll over {control.accessibleName()}"
        assert document.undo_stack.count() == 0
    bar.setValue(0)
    panel.cell_size.box.setFocus()
    turn_wheel(panel.cell_size.box)
    assert document.undo_stack.count() == 1
    panel.cell_size._hand.release()


def test_choices_and_counts_are_steps(panel: ParametersPanel, document: Document, qtbot: QtBot) -> None:
    layering = panel.choices["layering"].box
    layering.setFocus()
    QTest.keyClick(layering, Qt.Key.Key_Down)
    assert document.project.parameters.layering == "elevation"
    panel.min_points.box.stepUp()
    assert document.project.parameters.min_points == 2
    assert steps(document) == ["Layering by elevation", "Least points 2"]
    document.set_parameters("Layers", max_layers=40)
    assert panel.choices["max_layers"].box.currentText() == "40", "a value that was not offered is shown"


def test_ranges_suit_the_scan(panel: ParametersPanel, document: Document, tmp_path: Path) -> None:
    assert panel.cell_size.slider._range.high == pytest.approx(1.25)
    small = tmp_path / "pump.npy"
    np.save(small, np.random.default_rng(0).random((500, 3)) * 0.04)
    document.open([small])
    assert panel.cell_size.slider._range.high == pytest.approx(0.01, rel=0.02)
    assert panel.cell_size.box.text().endswith(" mm")


@pytest.mark.parametrize("points", [np.zeros((1, 3)), np.array([[0, 0, 5], [3, 0, 5.0]])])
def test_scans_without_any_extent_still_have_ranges(
    panel: ParametersPanel, document: Document, tmp_path: Path, points: np.ndarray
) -> None:
    path = tmp_path / "flat.npy"
    np.save(path, points)
    document.open([path])
    for row in (panel.cell_size, panel.tolerance):
        assert 0 < row.slider._range.low < row.slider._range.high


def test_a_step_of_a_slider_leaves_other_rows_alone(panel: ParametersPanel, document: Document) -> None:
    """Every row would be written anew sixty times a second, over what is being typed in it."""
    panel.alpha.box.lineEdit().setText("0.7")
    panel.tolerance.slider.setSliderDown(True)
    panel.tolerance.slider.setValue(panel.tolerance.slider.value() + 20)
    assert panel.alpha.box.lineEdit().text() == "0.7"
    panel.tolerance.slider.setSliderDown(False)


def test_nothing_is_laid_out_anew_while_a_slider_moves(panel: ParametersPanel, document: Document) -> None:
    def places() -> list[object]:
        return [child.geometry() for child in panel.findChildren(QWidget)]

    gesture = document.begin_gesture()
    QApplication.processEvents()
    before = places()
    for cell in (0.1234, 1.0, 0.05, 1.25):
        document.set_parameters("Cell", gesture, cell_size=cell)
        QApplication.processEvents()
        assert places() == before
    document.end_gesture(gesture)


def test_every_control_has_a_name_and_a_tooltip(panel: ParametersPanel) -> None:
    for row in panel._rows:
        for control in (getattr(row, name, None) for name in ("slider", "box", "auto")):
            if control is not None:
                assert control.accessibleName()
                assert control.toolTip()


def test_an_empty_panel_says_how_to_fill_it(qtbot: QtBot) -> None:
    document = Document(Runner(threaded=False))
    panel = ParametersPanel(document)
    qtbot.addWidget(panel)
    panel.show()
    assert not panel.findChildren(QScrollArea)[0].isVisible()
    assert any("Open a scan" in label.text() for label in panel.findChildren(QLabel) if label.isVisible())
    document.close()


def test_the_mark_shows_what_lasts_and_does_not_flicker(
    panel: ParametersPanel, document: Document, qtbot: QtBot
) -> None:
    mark = panel.findChildren(page.PendingMark)[0]
    document.set_parameters("Cell", cell_size=1e-7)
    assert mark.text() == ""
    qtbot.waitUntil(lambda: mark.text() == "● updating")
    document.undo_stack.undo()
    qtbot.waitUntil(lambda: mark.text() == "")


@pytest.mark.parametrize(
    ("metres", "unit", "text"),
    [
        (0.25, "m", "0.25 m"),
        (12.0, "m", "12 m"),
        (0.0375, "m", "0.0375 m"),
        (0.0375, "cm", "3.75 cm"),
        (0.0004, "mm", "0.4 mm"),
        (1234.5, "m", "1234 m"),
    ],
)
def test_lengths_are_written_in_the_digits_that_matter(metres: float, unit: str, text: str) -> None:
    assert written(metres, unit) == text


@pytest.mark.parametrize("text", ["", "m", "a", "1 km", "--1", "1..2", "1 2"])
def test_what_is_no_length_is_refused(text: str) -> None:
    assert read_length(text, "m") is None


def test_places_of_a_slider_are_lengths_in_equal_ratios() -> None:
    lengths = Range(0.001, 10.0)
    assert [lengths.length(step) for step in (0, STEPS // 4, STEPS // 2, STEPS)] == [0.001, 0.01, 0.1, 10.0]
    assert lengths.position(1e-9) == 0
    assert lengths.position(1e9) == STEPS


def test_a_box_for_coordinates_takes_any_number(qtbot: QtBot) -> None:
    box = LengthBox(least=-1e9, decimals=3)
    qtbot.addWidget(box)
    box.show_length(-637177.98765)
    assert box.text() == "-637177.988 m"
    assert box.value() == pytest.approx(-637177.98765, abs=1e-9)
