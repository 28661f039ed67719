"""The profile: points and pillars along a line."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPointF, Qt
from PySide6.QtGui import QColor, QMouseEvent
from PySide6.QtWidgets import QApplication, QDoubleSpinBox, QToolButton, QWidget
from pytestqt.qtbot import QtBot

from stepfield_app.theme import LIGHT
from stepfield_app.views.pictures import Section
from stepfield_app.views.profile import ProfileView

Control = TypeVar("Control", bound=QWidget)

RED, BLUE, GRAY = (255, 0, 0), (0, 0, 255), (128, 128, 128)


def section() -> Section:
    """Cut through two surfaces: a red one at 1 m, a blue one at 3 m over its second half; 10 m long."""
    distance = np.concatenate([np.linspace(0, 10, 2000), np.linspace(5, 10, 1000)])
    elevation = np.concatenate([np.full(2000, 1.0), np.full(1000, 3.0)])
    return Section(
        start=(100.0, 200.0),
        end=(106.0, 208.0),
        width=0.5,
        distance=distance,
        elevation=elevation,
        codes=np.repeat([0, 1], [2000, 1000]).astype(np.uint8),
        spans=np.array([[0.0, 5.0, 0.0, 1.0], [5.0, 10.0, 2.5, 3.0]]),
        tops=np.array([0.8, 2.8]),
        pillar_codes=np.array([0, 1], np.uint8),
        colours=np.array([RED, BLUE, GRAY], np.uint8),
        total=3000,
    )


pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")  # which the platform without a screen lacks


@pytest.fixture
def view(qtbot: QtBot) -> ProfileView:
    view = ProfileView()
    qtbot.addWidget(view)
    view.setAttribute(Qt.WidgetAttribute.WA_DontShowOnScreen)
    view.resize(620, 300)
    view.show()
    return view


def colour_at(view: ProfileView, distance: float, elevation: float) -> QColor:
    """Colour on the screen of a place of the profile."""
    image = view.plot.grab().toImage()
    pixel = view.plot.pixel_of(distance, elevation) * image.devicePixelRatioF()
    colour: QColor = image.pixelColor(pixel.toPoint())
    return colour


def hover(view: ProfileView, distance: float, elevation: float) -> None:
    at, none = view.plot.pixel_of(distance, elevation), Qt.MouseButton.NoButton
    place = view.plot.viewport().mapToGlobal(at)
    event = QMouseEvent(QEvent.Type.MouseMove, at, QPointF(place), none, none, Qt.KeyboardModifier.NoModifier)
    QApplication.sendEvent(view.plot.viewport(), event)


def control(view: ProfileView, kind: type[Control], name: str) -> Control:
    """Find a control by the name a screen reader says."""
    return next(found for found in view.findChildren(kind) if name in found.accessibleName())


def test_points_are_where_they_were_measured_in_the_colour_of_their_layer(view: ProfileView) -> None:
    """A profile upside down, or in colours of other layers, would mislead."""
    view.set_section(section())
    assert colour_at(view, 2.5, 1.0) == QColor(*RED)
    assert colour_at(view, 7.5, 3.0) == QColor(*BLUE)


def test_points_and_pillars_can_be_hidden_apart(view: ProfileView) -> None:
    """Dense points would cover the pillars for good."""
    view.set_section(section())
    for name in ("Points", "Pillars"):
        box = control(view, QToolButton, f"{name} in the profile")
        box.setChecked(False)
    assert colour_at(view, 2.5, 1.0) == QColor(view.plot.theme.window)
    assert colour_at(view, 2.5, 0.4) == QColor(view.plot.theme.window)


def test_pillars_reach_from_low_to_high_with_a_line_at_their_height(view: ProfileView) -> None:
    """The height in the height-map could not be told from the highest point."""
    view.set_section(
        replace(section(), distance=np.zeros(0), elevation=np.zeros(0), codes=np.zeros(0, np.uint8))
    )
    inside, line = colour_at(view, 2.5, 0.4), colour_at(view, 2.5, 0.8)
    assert line == QColor(*RED)
    assert inside.red() > inside.blue()
    assert colour_at(view, 7.5, 1.5) == QColor(view.plot.theme.window)


def test_everything_is_in_view_until_the_operator_zooms(view: ProfileView) -> None:
    """A longer line would run out of the plot, or a zoom would be lost while dragging."""
    view.set_section(section())
    longer = replace(section(), end=(112.0, 216.0))
    view.set_section(longer)
    assert view.plot.visible.right > 20
    view.plot.pane.step(1, 0)
    zoomed = view.plot.visible
    view.set_section(section())
    assert view.plot.visible == zoomed


def test_equal_scales_can_be_asked_for(view: ProfileView) -> None:
    """Slopes would always look steeper than they are."""
    view.set_section(section())
    assert view.plot.exaggeration != pytest.approx(1, rel=0.05)
    button = control(view, QToolButton, "Equal scales")
    button.click()
    assert view.plot.exaggeration == pytest.approx(1, rel=0.02)


def test_another_width_is_wanted_and_showing_one_wants_nothing(view: ProfileView, qtbot: QtBot) -> None:
    """Map and profile would chase each other in a circle."""
    with qtbot.assertNotEmitted(view.width_changed):
        view.set_cell_size(0.25)
        view.set_section(section())
    box = control(view, QDoubleSpinBox, "Width")
    assert box.value() == 0.5
    with qtbot.waitSignal(view.width_changed) as changed:
        box.stepUp()
    assert changed.args == [0.75]


def test_the_cursor_tells_the_place_on_the_line(view: ProfileView, qtbot: QtBot) -> None:
    """Nobody could find on the map what is seen in the profile."""
    view.set_section(section())
    with qtbot.waitSignal(view.place_hovered) as hovered:
        hover(view, 5.0, 2.0)
    assert hovered.args == pytest.approx([103.0, 204.0], abs=0.1)


def test_a_line_beside_the_scan_is_shown_empty(view: ProfileView) -> None:
    """Drawing a line over nothing would fail."""
    none = np.zeros(0)
    view.set_section(
        replace(
            section(),
            distance=none,
            elevation=none,
            codes=none.astype(np.uint8),
            spans=np.zeros((0, 4)),
            tops=none,
            pillar_codes=none.astype(np.uint8),
            total=0,
        )
    )
    view.set_theme(LIGHT)
    assert colour_at(view, 5.0, 1.0) == QColor(LIGHT.window)


def test_without_a_line_the_controls_are_off(view: ProfileView) -> None:
    """Controls that do nothing would look broken."""
    view.set_section(section())
    view.set_section(None)
    assert not any(button.isEnabled() for button in view.findChildren(QToolButton))
