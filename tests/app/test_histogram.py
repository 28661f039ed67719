"""The histogram of elevations."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPointF, QRectF, Qt
from PySide6.QtGui import QMouseEvent, QPaintEvent, QRegion
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from stepfield_app.theme import DARK, LIGHT
from stepfield_app.views.histogram import LABEL, HistogramView, apart
from stepfield_app.views.pictures import Histogram

COLOURS = ("#0072b2", "#e69f00")
LEVELS = (("Floor", "#0072b2", 0.25), ("Table", "#e69f00", 0.75))


def histogram(levels: tuple[tuple[str, str, float], ...] = LEVELS, high: float = 1.0) -> Histogram:
    """Count 12 431 points in the lowest of ten bins, 10 in all others; a third of all in the upper layer."""
    counts = np.array([12431, *[10] * 9])
    upper = counts // 3
    return Histogram(np.linspace(0, high, 11), np.array([counts - upper, upper]), COLOURS, levels)


@pytest.fixture
def view(qtbot: QtBot) -> HistogramView:
    view = HistogramView()
    qtbot.addWidget(view)
    view.setAttribute(Qt.WidgetAttribute.WA_DontShowOnScreen)
    view.resize(260, 220)
    view.show()
    return view


def hover(view: HistogramView, count: float, elevation: float) -> None:
    at, none = view.pixel_of(count, elevation), Qt.MouseButton.NoButton
    place = QPointF(view.viewport().mapToGlobal(at))
    event = QMouseEvent(QEvent.Type.MouseMove, at, place, none, none, Qt.KeyboardModifier.NoModifier)
    QApplication.sendEvent(view.viewport(), event)


def test_the_longest_bar_reaches_across_and_the_others_do_not(view: HistogramView) -> None:
    """The bars would not say where the points are."""
    view.set_histogram(histogram(levels=()))
    image = view.grab().toImage()
    ratio = image.devicePixelRatioF()
    at = [(view.pixel_of(11_000, z) * ratio).toPoint() for z in (0.05, 0.55)]
    assert image.pixelColor(at[0]) != image.pixelColor(at[1])


def test_bars_of_layers_stand_one_after_the_other(view: HistogramView) -> None:
    """The layers' shares of an elevation could not be told apart."""
    view.set_histogram(histogram(levels=()))
    image = view.grab().toImage()
    lower, upper = (
        image.pixelColor((view.pixel_of(count, 0.05) * image.devicePixelRatioF()).toPoint())
        for count in (4_000, 11_000)
    )
    assert lower.blue() > lower.red()
    assert upper.red() > upper.blue()


@pytest.mark.parametrize("theme", [DARK, LIGHT])
def test_each_layer_has_a_line_in_its_colour_at_its_average(view: HistogramView, theme: object) -> None:
    """A layer's average would be read off the wrong place."""
    view.set_theme(theme)  # type: ignore[arg-type]
    view.set_histogram(histogram())
    image = view.grab().toImage()
    for _, colour, elevation in LEVELS:
        at = (view.pixel_of(2000, elevation) * image.devicePixelRatioF()).toPoint()
        assert image.pixelColor(at).name() == colour


def test_hovering_tells_the_count(view: HistogramView) -> None:
    """The number of points at an elevation could only be guessed."""
    view.set_histogram(histogram())
    hover(view, 100, 0.05)
    assert "12\N{NARROW NO-BREAK SPACE}431 points" in view.readout
    assert view.readout.startswith("0.0 m to 0.1 m")
    hover(view, 100, 0.55)
    assert "10 points" in view.readout


def test_axes_stay_as_they_are_while_counts_change(view: HistogramView) -> None:
    """They would be made anew for every result, which takes longer than the bars."""
    view.set_histogram(histogram())
    view.grab()
    axis = view.axes["left"].picture
    view.set_histogram(histogram(levels=()))
    view.grab()
    assert axis is not None
    assert view.axes["left"].picture is axis


def test_another_scan_is_fitted_although_the_operator_had_zoomed(view: HistogramView) -> None:
    """The bars of the next scan could be out of sight."""
    view.set_histogram(histogram())
    view.pane.step(0, 3)
    zoomed = view.visible
    view.set_histogram(histogram(levels=()))
    assert view.visible == zoomed
    view.set_histogram(histogram(high=50.0))
    assert view.visible.top >= 50.0


def test_layers_without_pillars_have_no_line(view: HistogramView) -> None:
    """An unknown average would be drawn somewhere, or painting would fail."""
    view.set_histogram(histogram(levels=(*LEVELS, ("Empty", "#009e73", float("nan")))))
    assert not view.grab().isNull()


@pytest.mark.parametrize("places", [[100, 99, 98, 97], [5, 4, 3], [219, 219, 219], [150, 20], []])
def test_labels_are_apart_and_inside(places: list[float]) -> None:
    """Names of layers close to each other would cover each other."""
    moved = apart(places, QRectF(0, 0, 260, 220))
    assert all(lower - upper >= LABEL for lower, upper in pairwise(moved))
    assert all(LABEL / 2 <= place <= 220 - LABEL / 2 for place in moved)


def test_a_new_histogram_is_painted_whole(qtbot: QtBot) -> None:
    """Where no bar is, old labels would stay and new ones would be cut."""
    painted: list[QRegion] = []

    class Watched(HistogramView):
        def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
            painted.append(event.region())
            super().paintEvent(event)

    view = Watched()
    qtbot.addWidget(view)
    view.show()
    for level in (0.25, 0.35, 0.45):
        view.set_histogram(histogram((("Floor", "#0072b2", level),)))
        painted.clear()
        qtbot.waitUntil(lambda: bool(painted))
    assert QRegion(view.viewport().rect()).subtracted(painted[0]).isEmpty()
