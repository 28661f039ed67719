"""The views as grounds to select on: what a shape drawn over them picks, and what is selected at a place."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF
from PySide6.QtWidgets import QWidget

from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.scenes.lens import Lens
from stepfield_app.scenes.picking import InSection, InView, OnMap, Pick
from stepfield_app.scenes.readout import pillars_at
from stepfield_app.scenes.shapes import Kind, Shape
from stepfield_app.selection import Selection
from stepfield_app.views.map import MapView
from stepfield_app.views.profile import ProfileView
from stepfield_app.views.view3d import Canvas

#: Numbers of the layers that are shown, -1 for Unassigned.
Visible = Callable[[], Sequence[int]]


class Ground(Protocol):
    """A view, as a hand that selects knows it; pixels are logical ones of its surface."""

    #: The widget under the mouse, and the one that has the keyboard.
    surface: QWidget
    focus: QWidget

    def is_over(self, at: QPointF) -> bool:
        """Whether there is anything to select at a pixel's place."""

    def pick(
        self, kind: Kind, path: Sequence[QPointF], radius: float, lens: Lens | None = None
    ) -> Pick | None:
        """Return what a shape means here; None where nothing is shown. A stroke has one lens for all."""

    def has_selected(self, at: QPointF) -> bool:
        """Whether the pillar at a pixel is selected."""


class CanvasGround:
    """A 3-D view."""

    def __init__(self, canvas: Canvas, selection: Selection, scene_feed: SceneFeed, visible: Visible) -> None:
        self.surface: QWidget = canvas
        self.focus: QWidget = canvas
        self._canvas, self._selection, self._scene_feed = canvas, selection, scene_feed
        self._visible = visible

    def is_over(self, at: QPointF) -> bool:
        """Whether there is a picture."""
        return self._canvas.frame is not None

    def pick(
        self, kind: Kind, path: Sequence[QPointF], radius: float, lens: Lens | None = None
    ) -> Pick | None:
        """Return the shape in device pixels, with what the picture shows at its end."""
        ratio, canvas = self._canvas.devicePixelRatioF(), self._canvas
        return InView(
            camera=canvas.viewpoint.camera,
            size=canvas.pixels,
            origin=self._scene_feed.origin,
            visible=tuple(self._visible()),
            shape=Shape(kind, _array(path) * ratio, radius * ratio),
            place=canvas.place_at(path[-1]),
            lens=lens,
        )

    def has_selected(self, at: QPointF) -> bool:
        """Whether the block that the picture shows at a pixel is selected."""
        local, selection = self._canvas.place_at(at), self._selection
        if local is None or selection.mask is None or selection.result is None or not selection.count:
            return False
        x, y, z = (float(shift + part) for shift, part in zip(self._scene_feed.origin, local, strict=True))
        nearest = min(
            pillars_at(selection.result, x, y),
            key=lambda pillar: max(pillar.low - z, z - max(pillar.high, pillar.elevation), 0.0),
            default=None,
        )
        return nearest is not None and bool(selection.mask[nearest.pillar])


class MapGround:
    """The map."""

    def __init__(self, view: MapView) -> None:
        self.surface: QWidget = view.plot.viewport()
        self.focus: QWidget = view.plot
        self.view = view

    def is_over(self, at: QPointF) -> bool:
        """Whether it is within the axes of a map."""
        return self.view.plot.is_over(at)

    def pick(
        self, kind: Kind, path: Sequence[QPointF], radius: float, lens: Lens | None = None
    ) -> Pick | None:
        """Return the shape in metres."""
        across, _ = self.view.plot.pane.viewPixelSize()
        places = self.view.plot.places_at(_array(path))
        return OnMap(Shape(kind, places, radius * across), self.view.layer)

    def has_selected(self, at: QPointF) -> bool:
        """Whether the compartment at a pixel is outlined."""
        marked, place = self.view.plot.selected.marked, self.view.plot.place_at(at)
        return marked is not None and marked.has(place.x(), place.y())


class ProfileGround:
    """The profile."""

    def __init__(self, view: ProfileView, selection: Selection, visible: Visible) -> None:
        self.surface: QWidget = view.plot.viewport()
        self.focus: QWidget = view.plot
        self._view, self._selection, self._visible = view, selection, visible

    def is_over(self, at: QPointF) -> bool:
        """Whether it is within the axes of a profile."""
        return self._view.section is not None and self._view.plot.is_over(at)

    def pick(
        self, kind: Kind, path: Sequence[QPointF], radius: float, lens: Lens | None = None
    ) -> Pick | None:
        """Return the shape in metres along the line and of elevation."""
        section, plot = self._view.section, self._view.plot
        if section is None:
            return None
        across, _ = plot.pane.viewPixelSize()
        return InSection(
            start=section.start,
            end=section.end,
            width=section.width,
            shape=Shape(kind, plot.places_at(_array(path)), radius * across),
            visible=tuple(self._visible()),
            exaggeration=plot.exaggeration,
        )

    def has_selected(self, at: QPointF) -> bool:
        """Whether the block at a pixel is outlined."""
        place = self._view.plot.place_at(at)
        return self._view.plot.selected.has(place.x(), place.y())


def _array(path: Sequence[QPointF]) -> NDArray[np.float64]:
    return np.array([(at.x(), at.y()) for at in path], np.float64)
