"""How a project is looked at, as it is stored in its file; what is damaged or unknown counts as absent."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, ValidationError

from stepfield.parameters import Coordinate, Length
from stepfield_app.render.camera import Camera
from stepfield_app.render.scene import VIEWS
from stepfield_app.views.line import ProfileLine
from stepfield_app.views.map import MapView
from stepfield_app.views.pictures import MODES
from stepfield_app.views.trio import Trio

Place = tuple[Coordinate, Coordinate]


class _Part(BaseModel):
    """Base of what is remembered; fields of newer versions are passed over."""

    model_config = ConfigDict(frozen=True, extra="ignore")


class CameraPlace(_Part):
    """The camera, its centre in the scan's coordinates."""

    centre: tuple[Coordinate, Coordinate, Coordinate]
    azimuth: Coordinate
    elevation: Coordinate
    distance: Length
    parallel: bool = False


class LinePlace(_Part):
    """The profile line."""

    start: Place
    end: Place
    width: Length


class Remembered(_Part):
    """How a project is looked at.

    Attributes
    ----------
    camera : CameraPlace, optional
    shown : tuple of str
        The 3-D views that are shown.
    layer : int
        The active one, -1 for Unassigned.
    map : str
        How the map is drawn.
    line : LinePlace, optional
    """

    camera: CameraPlace | None = None
    shown: tuple[str, ...] = ()
    layer: int = 0
    map: str = ""
    line: LinePlace | None = None

    @classmethod
    def of(cls, trio: Trio, map_view: MapView, layer: int, origin: NDArray[np.float64]) -> Remembered:
        """Take note of how everything is looked at; ``origin`` is that of local coordinates, metres."""
        camera, line = trio.viewpoint.camera, map_view.line
        x, y, z = (float(value) for value in origin + camera.centre)
        return cls(
            camera=CameraPlace(
                centre=(x, y, z),
                azimuth=camera.azimuth,
                elevation=camera.elevation,
                distance=camera.distance,
                parallel=camera.parallel,
            ),
            shown=trio.shown,
            layer=layer,
            map=map_view.mode,
            line=LinePlace(start=line.start, end=line.end, width=line.width) if line else None,
        )

    @classmethod
    def read(cls, view: Mapping[str, Any]) -> Remembered:
        """Read what a project file says, part by part."""
        parts: dict[str, Any] = {}
        for name in cls.model_fields:
            try:
                parts[name] = getattr(cls.model_validate({name: view[name]}), name)
            except (KeyError, ValidationError):
                continue
        return cls(**parts)

    def content(self) -> dict[str, Any]:
        """Return it as it goes into the file."""
        return self.model_dump(mode="json", exclude_none=True)

    def camera_from(self, origin: NDArray[np.float64]) -> Camera | None:
        """Return the camera in local coordinates."""
        if self.camera is None:
            return None
        x, y, z = (float(value) for value in np.array(self.camera.centre) - origin)
        place = self.camera
        return Camera((x, y, z), place.azimuth, place.elevation, place.distance, place.parallel)

    def show(self, trio: Trio, map_view: MapView) -> None:
        """Show the same views, map and line again."""
        if self.shown and set(self.shown) <= set(VIEWS):
            trio.arrange(tuple(name for name in VIEWS if name in self.shown))
        if self.map in MODES:
            map_view.set_mode(self.map)
        if self.line is not None:
            map_view.set_line(ProfileLine(self.line.start, self.line.end, self.line.width))
