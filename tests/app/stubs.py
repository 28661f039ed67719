"""A renderer that draws nothing: the tests say which frames it shows and what state it is in."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Signal
from pytestqt.qtbot import QtBot

from stepfield.parameters import Parameters
from stepfield_app.document import Document
from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.render.camera import Camera, Size
from stepfield_app.render.outline import SELECTION
from stepfield_app.render.scene import EMPTY, VIEWS, Frame, Scene, Singles
from stepfield_app.requests import Answer
from stepfield_app.views.trio import Trio


class StubClient(QObject):
    """Stands in for ``RenderClient``: remembers what it is told, shows what it is given."""

    frame_arrived = Signal(str)
    state_changed = Signal(str)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._state, self._reason, self._rests = "stopped", "", True
        self.scenes: dict[str, Scene] = dict.fromkeys(VIEWS, EMPTY)
        self.cameras: dict[str, tuple[Camera, Size, bool]] = {}
        self.frames: dict[str, Frame] = {}
        self._drawn: dict[str, Scene] = {}
        self.outlines: dict[tuple[str, str], tuple[Singles | None, float]] = {}
        self.shown: tuple[str, ...] = ()
        self.background = (0, 0, 0)

    @property
    def state(self) -> str:
        return self._state

    @property
    def reason(self) -> str:
        return self._reason

    @property
    def details(self) -> str:
        return ""

    @property
    def process_id(self) -> int:
        return 0

    def share(self, array: NDArray[Any]) -> NDArray[Any]:
        return array

    def start(self) -> None:
        self.enter("running")

    def set_scene(self, view: str, scene: Scene, *, in_full: bool = False) -> None:
        self.scenes[view] = scene

    def drawn_scene(self, view: str) -> Scene:
        return self._drawn.get(view, EMPTY)

    def set_outline(
        self, view: str, segments: Singles | None, *, kind: str = SELECTION, slack: float = 0.0
    ) -> None:
        self.outlines[view, kind] = segments, slack

    def set_camera(self, view: str, camera: Camera, size: Size, moving: bool) -> None:
        self.cameras[view] = camera, size, moving

    def set_background(self, colour: tuple[int, int, int]) -> None:
        self.background = colour

    def show(self, views: Sequence[str]) -> None:
        self.shown = tuple(views)

    def frame(self, view: str) -> Frame | None:
        return self.frames.get(view)

    def is_at_rest(self) -> bool:
        return self._rests

    def close(self) -> None:
        self._state = "stopped"

    # --- What a test does -----------------------------------------------------------------------------------

    def enter(self, state: str, reason: str = "") -> None:
        """Be in another state, and say so."""
        self._state, self._reason = state, reason
        self.state_changed.emit(state)

    def deliver(self, view: str, frame: Frame) -> None:
        """Let a frame arrive."""
        self.frames[view], self._drawn[view] = frame, self.scenes[view]
        self.frame_arrived.emit(view)

    def say_it_rests(self, rests: bool) -> None:
        """Say whether everything wanted is drawn."""
        self._rests = rests


def floor_frame(camera: Camera, size: Size, colour: tuple[int, int, int] = (0, 158, 115)) -> Frame:
    """Return the resting picture of an endless floor at height zero, with its true depths."""
    width, height = size
    pixels = np.zeros((height, width, 4), np.uint8)
    pixels[:] = (*reversed(colour), 255)
    rows, columns = np.mgrid[0:height, 0:width] + 0.5
    along = 2 * Camera.SLOPE / height
    right, up, forward = camera.right, camera.up, camera.forward
    across = along * (
        (columns - width / 2)[..., np.newaxis] * right + (height / 2 - rows)[..., np.newaxis] * up
    )
    if camera.parallel:
        depth = -(camera.eye[2] + across[..., 2] * camera.distance) / forward[2]
    else:
        slope = forward[2] + across[..., 2]
        depth = -camera.eye[2] / np.where(slope < 0, slope, np.nan)
    depth = np.where(np.isfinite(depth) & (depth > 0), depth, 0).astype(np.float32)
    return Frame(pixels, depth, camera, False, 12_000, 0, int((depth > 0).sum()), 0.01)


def moving_frame(camera: Camera, size: Size, colour: tuple[int, int, int]) -> Frame:
    """Return a picture as drawn while a hand moves: without depth."""
    width, height = size
    pixels = np.zeros((height, width, 4), np.uint8)
    pixels[:] = (*reversed(colour), 255)
    return Frame(pixels, None, camera, True, 500, 0, 0, 0.01)


class Bench:
    """A document, the three views and what keeps them true to it, around a renderer that draws nothing."""

    def __init__(self, qtbot: QtBot) -> None:
        self.qtbot = qtbot
        self.client = StubClient()
        self.document = Document()
        self.trio = Trio(self.client)  # type: ignore[arg-type]
        qtbot.addWidget(self.trio)
        self.trio.resize(1200, 400)
        with qtbot.waitExposed(self.trio):
            self.trio.show()
        self.scene_feed = SceneFeed(self.document, self.trio, self.client)  # type: ignore[arg-type]

    def open(self, *files: Path, **parameters: object) -> Answer:
        """Open a scan and wait until it is drawn."""
        with self.qtbot.waitSignal(self.document.opened):
            self.document.open(files, Parameters.checked(**parameters))
        return self.settle()

    def settle(self) -> Answer:
        """Wait until everything asked for is there."""
        self.qtbot.waitUntil(self.is_settled)
        assert self.document.answer is not None
        return self.document.answer

    def is_settled(self) -> bool:
        """Whether nothing is being made."""
        return not self.document.busy and not self.document.pending and self.scene_feed.is_idle

    def close(self) -> None:
        """End every worker."""
        self.scene_feed.close()
        self.document.close()
