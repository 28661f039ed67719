"""Cloud, pillars and reconstruction side by side, or one of them large, seen from one viewpoint."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QSplitter, QVBoxLayout, QWidget

from stepfield_app.render.camera import Camera
from stepfield_app.render.client import RenderClient
from stepfield_app.render.scene import CLOUD, PILLARS, RECONSTRUCTION, VIEWS, Frame
from stepfield_app.theme import Theme
from stepfield_app.views.header import ViewHeader
from stepfield_app.views.view3d import Canvas
from stepfield_app.views.viewpoint import PRESETS, Viewpoint
from stepfield_app.wording import short

TITLES = {CLOUD: "Cloud", PILLARS: "Pillars", RECONSTRUCTION: "Reconstruction"}
Bounds = tuple[NDArray[np.float64], NDArray[np.float64]]


class Trio(QWidget):
    """The three linked views."""

    #: View and the colour mode chosen for it.
    colour_chosen = Signal(str, str)
    #: As what the layers are to be drawn.
    way_chosen = Signal(str)
    #: Local coordinates under the cursor, or None.
    hovered = Signal(object)
    #: Other views are shown than before.
    arranged = Signal()

    def __init__(self, client: RenderClient, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._client = client
        self.viewpoint = Viewpoint(self)
        self._bounds: Bounds = np.zeros(3), np.ones(3)
        self._reached: Bounds | None = None
        self._fitted: Camera | None = None
        self.canvases = {name: Canvas(name, client, self.viewpoint) for name in VIEWS}
        self.headers = {
            name: ViewHeader(TITLES[name], f"Ctrl+{place}") for place, name in enumerate(VIEWS, 1)
        }
        self._frames = {name: self._framed(name) for name in VIEWS}
        self.headers[RECONSTRUCTION].way_chosen.connect(self.way_chosen)
        self._splitter = QSplitter(Qt.Orientation.Horizontal, childrenCollapsible=False, handleWidth=2)
        for name in VIEWS:
            self._splitter.addWidget(self._frames[name])
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._splitter)
        for canvas in self.canvases.values():
            canvas.resized.connect(self._follow_size)
        self.setFocusProxy(self.canvases[CLOUD])
        client.frame_arrived.connect(self._describe)
        client.show(VIEWS)

    def _framed(self, name: str) -> QWidget:
        frame = QFrame()
        layout = QVBoxLayout(frame)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(0)
        layout.addWidget(self.headers[name])
        layout.addWidget(self.canvases[name], 1)
        self.headers[name].enlarge_asked.connect(lambda: self.enlarge(name))
        self.headers[name].colour_chosen.connect(lambda mode: self.colour_chosen.emit(name, mode))
        self.canvases[name].hovered.connect(self.hovered)
        return frame

    # --- Arrangement ----------------------------------------------------------------------------------------

    def enlarge(self, name: str) -> None:
        """Show one view alone, or all again if it is alone already."""
        self.arrange(VIEWS if self.shown == (name,) else (name,))

    def arrange(self, names: tuple[str, ...]) -> None:
        """Show these views."""
        first = self.canvases[next(name for name in VIEWS if name in names)]
        self.setFocusProxy(first)
        if any(canvas.hasFocus() for name, canvas in self.canvases.items() if name not in names):
            first.setFocus()  # else the keyboard goes to whatever comes next
        for name, frame in self._frames.items():
            frame.setVisible(name in names)
        self._client.show(names)
        self.arranged.emit()
        self.viewpoint.stir()

    @property
    def shown(self) -> tuple[str, ...]:
        """The views that are not hidden."""
        return tuple(name for name, frame in self._frames.items() if not frame.isHidden())

    # --- Camera ---------------------------------------------------------------------------------------------

    def set_bounds(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> None:
        """Say what there is to see, in local coordinates."""
        self._bounds = low, high

    def reach_for(self, bounds: Bounds | None) -> None:
        """Frame a box as well, in local coordinates: of a tool that has its handles there; None ends that."""
        self._reached = bounds
        self._fit_again()

    def fit(self) -> None:
        """Frame everything, from the present direction."""
        camera = self.viewpoint.camera
        self._look(camera.azimuth, camera.elevation, camera.parallel)

    def look_from(self, preset: str) -> None:
        """Frame everything from one of the preset directions."""
        self._look(*PRESETS[preset], self.viewpoint.camera.parallel)

    def set_parallel(self, is_parallel: bool) -> None:
        """Switch between perspective and parallel projection, keeping the scale at the centre."""
        self.viewpoint.look(replace(self.viewpoint.camera, parallel=is_parallel))

    def _look(self, azimuth: float, elevation: float, is_parallel: bool) -> None:
        size = self.canvases[self.shown[0]].pixels
        low, high = self._bounds
        if self._reached is not None:
            low, high = np.minimum(low, self._reached[0]), np.maximum(high, self._reached[1])
        self._fitted = Camera.fitting(low, high, size, azimuth, elevation, is_parallel)
        self.viewpoint.look(self._fitted)

    def _follow_size(self, name: str) -> None:
        """Fit again to another size of the views, until the operator has moved the camera."""
        if name == self.shown[0]:
            self._fit_again()

    def _fit_again(self) -> None:
        if self.viewpoint.camera is self._fitted:
            self.fit()

    def grain(self, bounds: Bounds | None = None) -> float:
        """Metres that a pixel spans at the centre, of the present camera or one that frames some bounds."""
        size, camera = self.canvases[self.shown[0]].pixels, self.viewpoint.camera
        if bounds is not None:
            camera = Camera.fitting(*bounds, size, camera.azimuth, camera.elevation, camera.parallel)
        return camera.metres_per_pixel(size)

    # --- What they show -------------------------------------------------------------------------------------

    def set_theme(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        for name in VIEWS:
            self.canvases[name].set_theme(theme)

    def set_pending(self, is_pending: bool) -> None:
        """Mark what depends on the parameters as of older ones."""
        for name in (PILLARS, RECONSTRUCTION):
            self.canvases[name].set_pending(is_pending)

    def set_empty_text(self, text: str) -> None:
        """Say this in place of every picture; an empty text shows the pictures."""
        for name in VIEWS:
            self.canvases[name].set_empty_text(text)
            self.headers[name].set_detail()

    def _describe(self, name: str) -> None:
        frame = self._client.frame(name)
        if frame is not None:
            drawn = _drawn(frame)
            self.headers[name].set_detail(", ".join(drawn), *drawn)


def _drawn(frame: Frame) -> list[str]:
    """Say how much of the scene is drawn, each kind for itself."""
    kinds = ((frame.points, "points"), (frame.triangles, "triangles"))
    return [f"{short(count)} {kind} drawn" for count, kind in kinds if count]
