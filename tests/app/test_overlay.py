"""What is painted over the pictures is true: ticks are round numbers, the bar is as long as it says."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QRectF
from PySide6.QtGui import QColor, QImage, QPainter
from pytestqt.qtbot import QtBot

from stepfield_app.ramps import ramp
from stepfield_app.render.camera import Camera
from stepfield_app.scenes.legend import Legend
from stepfield_app.scenes.units import scale_bar
from stepfield_app.theme import DARK, LIGHT, Theme, rgb
from stepfield_app.views import overlay
from stepfield_app.views.overlay import Overlay, _ticks, small_font
from stepfield_app.views.plot import LEAST_BESIDE

SIZE = (480, 420)


class Painted:
    """An overlay on a picture, and what it wrote."""

    def __init__(self, size: tuple[int, int] = SIZE, theme: Theme = DARK) -> None:
        self.image = QImage(*size, QImage.Format.Format_RGB32)
        self.image.fill(QColor(theme.window))
        self.painter = QPainter(self.image)
        self.painter.setFont(small_font(self.painter.font()))
        self.overlay = Overlay(self.painter, QRectF(0, 0, *size), theme)

    def colours(self) -> set[tuple[int, int, int]]:
        array = np.frombuffer(self.image.constBits(), np.uint8).reshape(self.image.height(), -1, 4)
        return {tuple(colour) for colour in np.unique(array[..., 2::-1].reshape(-1, 3), axis=0).tolist()}

    def is_blank(self) -> bool:
        return len(self.colours()) == 1


@pytest.fixture
def painted(qtbot: QtBot) -> Iterator[Painted]:
    painted = Painted()
    yield painted
    painted.painter.end()


@pytest.fixture
def texts(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, QRectF]]:
    """Everything an overlay writes."""
    found: list[tuple[str, QRectF]] = []
    write = Overlay._text

    def noted(self: Overlay, room: QRectF, text: str, *more: Any, **named: Any) -> None:
        found.append((text, room))
        write(self, room, text, *more, **named)

    monkeypatch.setattr(Overlay, "_text", noted)
    return found


@pytest.mark.parametrize(
    ("low", "high"),
    [
        (0, 1),
        (-3.2, 17.9),
        (212.0, 212.004),
        (0, 4000),
        (-1e-3, 1e-3),
        (5_411_300.2, 5_411_318.7),
        (0.5, 0.5),
    ],
)
def test_ticks_are_round_and_inside_the_range(low: float, high: float) -> None:
    """If it failed, a legend would show 13.3333 m, or a height that no colour stands for."""
    ticks, digits = _ticks(low, high)
    span = max(high - low, 1e-9)
    assert 1 <= len(ticks) <= overlay.TICKS + 2
    assert (ticks >= low - 1e-6 * span).all()
    assert (ticks <= high + 1e-6 * span).all()
    if len(ticks) > 1:
        step = float(np.diff(ticks).mean())
        leading = step / 10 ** math.floor(math.log10(step) + 1e-6)
        assert min(abs(leading - whole) for whole in (1, 2, 5)) < 1e-3
        texts = [f"{tick:.{digits}f}" for tick in ticks]
        assert len(set(texts)) == len(texts), "two ticks read the same"


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("distance", [0.05, 1.0, 37.0, 4200.0])
@pytest.mark.parametrize("ratio", [1.0, 2.0])
def test_the_scale_bar_is_as_long_as_it_says(distance: float, parallel: bool, ratio: float) -> None:
    """If it failed, a length read off the picture would be wrong."""
    camera = Camera((3.0, 4.0, 5.0), 20.0, 35.0, distance, parallel)
    device = (round(SIZE[0] * ratio), round(SIZE[1] * ratio))
    metres, pixels, label = scale_bar(camera.metres_per_pixel(device) * ratio)
    ends = np.array([camera.centre, np.asarray(camera.centre) + metres * camera.right])
    drawn, _ = camera.project(ends, device)
    assert np.hypot(*(drawn[1] - drawn[0])) / ratio == pytest.approx(pixels)
    amount, unit = label.split()
    assert float(amount) * {"km": 1000, "m": 1, "cm": 0.01, "mm": 0.001}[unit] == pytest.approx(metres)
    assert 60 < pixels <= 160.5


def test_the_bar_is_drawn_as_long_as_it_was_measured(painted: Painted) -> None:
    camera = Camera((0.0, 0.0, 0.0), 0.0, 90.0, 10.0)
    _, pixels, _ = scale_bar(camera.metres_per_pixel(SIZE))
    painted.overlay.scale(camera, SIZE, 1.0)
    row = SIZE[1] - overlay.MARGIN
    ground = QColor(DARK.window).rgb()
    lit = [x for x in range(SIZE[0]) if any(painted.image.pixel(x, y) != ground for y in (row - 1, row))]
    assert max(lit) - min(lit) == pytest.approx(pixels, abs=2.5)
    assert min(lit) == pytest.approx(overlay.MARGIN, abs=2)


def test_labels_of_a_ramp_stand_beside_their_colours(
    painted: Painted, texts: list[tuple[str, QRectF]]
) -> None:
    """If it failed, a height would be read off at the wrong colour."""
    painted.overlay.legend(Legend("Elevation", "m", ramp("height"), low=0.0, high=4.0))
    assert texts[0][0] == "Elevation (m)"
    heights = {float(text): room.center().y() for text, room in texts[1:]}
    long = heights[0.0] - heights[4.0]
    assert 80 < long <= overlay.RAMP_HEIGHT
    assert heights[2.0] - heights[4.0] == pytest.approx(long / 2)
    for height, colour in ((4.0, ramp("height")[-1]), (0.0, ramp("height")[0])):
        inside = round(heights[height] + (2 if height else -2))
        seen = QColor(painted.image.pixel(SIZE[0] - overlay.MARGIN - 5, inside))
        assert np.abs(np.array([seen.red(), seen.green(), seen.blue()]) - colour).max() < 12


def test_a_legend_of_layers_says_when_it_has_no_room(
    painted: Painted, texts: list[tuple[str, QRectF]]
) -> None:
    """If it failed, layers would be missing without a word."""
    entries = tuple(((10 * i % 256, 80, 90), f"Layer {i + 1}") for i in range(60))
    painted.overlay.legend(Legend("Layer", entries=entries))
    names = [text for text, _ in texts[1:]]
    shown = len(names) - 1
    assert names[-1] == f"{60 - shown} more"
    assert all(room.bottom() <= SIZE[1] for _, room in texts)


def test_a_small_view_shows_no_legend(qtbot: QtBot) -> None:
    """If it failed, the legend would cover the data."""
    small = Painted((150, 120))
    small.overlay.legend(Legend("Elevation", "m", ramp("height")))
    assert small.is_blank()
    small.painter.end()


def test_a_legend_that_covers_nothing_needs_less_height(
    qtbot: QtBot, texts: list[tuple[str, QRectF]]
) -> None:
    """If it failed, the map of a small window would not say what its colours mean."""
    low = Painted((300, LEAST_BESIDE))
    low.overlay.legend(Legend("Elevation", "m", ramp("height"), note="red: wall, cyan: filled"), LEAST_BESIDE)
    assert [text for text, _ in texts[:2]] == ["red: wall", "cyan: filled"]
    assert all(room.bottom() <= LEAST_BESIDE for _, room in texts)
    low.painter.end()


def test_a_flat_scan_has_one_height_in_its_legend(painted: Painted, texts: list[tuple[str, QRectF]]) -> None:
    """If it failed, a level floor would end in a division by nothing."""
    painted.overlay.legend(Legend("Elevation", "m", ramp("height"), low=2.0, high=2.0))
    assert [text for text, _ in texts] == ["Elevation (m)", "2.00"]


def test_a_legend_of_no_layers_does_no_harm(painted: Painted, texts: list[tuple[str, QRectF]]) -> None:
    painted.overlay.legend(Legend("Layer"))
    assert [text for text, _ in texts] == ["Layer"]


def test_text_of_a_legend_stays_on_its_plate(
    painted: Painted, monkeypatch: pytest.MonkeyPatch, texts: list[tuple[str, QRectF]]
) -> None:
    """If it failed, the title would be lost in bright data."""
    plates: list[QRectF] = []
    monkeypatch.setattr(Overlay, "_plate", lambda self, room: plates.append(room))
    painted.overlay.legend(Legend("Elevation", "m", ramp("height"), low=0.0, high=4.0))
    for text, room in texts:
        left = room.right() - painted.overlay._metrics.horizontalAdvance(text)
        assert plates[0].left() <= left, f"{text} spills over the plate"
        assert room.right() <= plates[0].right()


@pytest.mark.parametrize("elevation", [-90.0, -20.0, 0.0, 45.0, 90.0])
def test_axes_point_where_the_camera_sees_them(
    painted: Painted, texts: list[tuple[str, QRectF]], elevation: float
) -> None:
    """If it failed, north would be taken for east."""
    camera = Camera((0.0, 0.0, 0.0), 30.0, elevation, 5.0)
    painted.overlay.axes(camera)
    corner = np.array([SIZE[0], SIZE[1]]) - overlay.MARGIN - overlay.AXIS_LENGTH
    for name, direction, _ in overlay.AXES:
        seen = np.array([np.dot(direction, camera.right), -np.dot(direction, camera.up)])
        written = [room.center() for text, room in texts if text == name]
        if np.hypot(*seen) * overlay.AXIS_LENGTH <= 6:
            assert not written, f"{name} points at the eye and has no room for a name"
            continue
        away = np.array([written[0].x(), written[0].y()]) - corner
        assert np.allclose(away, 1.3 * overlay.AXIS_LENGTH * seen)


@pytest.mark.parametrize("theme", [DARK, LIGHT])
def test_a_note_can_be_read_on_any_data(qtbot: QtBot, theme: Theme) -> None:
    """If it failed, *updating…* would vanish on bright points."""
    painted = Painted(theme=theme)
    painted.image.fill(QColor(128, 128, 128))
    painted.overlay.note("updating…", theme.text)
    plate = QColor(painted.image.pixel(overlay.MARGIN + 5, overlay.MARGIN + 4))
    assert abs(plate.lightness() - QColor(*rgb(theme.text)).lightness()) > 90
    painted.painter.end()
