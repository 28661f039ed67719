"""What the three 3-D views are to show, and the pictures that are made of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield.reconstruction import Reconstruction
from stepfield_app.render.scene import Scene
from stepfield_app.requests import Answer
from stepfield_app.scenes.cloud import Cloud
from stepfield_app.scenes.complex_parts import Meshed
from stepfield_app.scenes.legend import Legend
from stepfield_app.scenes.surfaces import Way
from stepfield_app.theme import Theme

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Wish:
    """What to draw.

    Attributes
    ----------
    answer : Answer
    origin : ndarray of shape (3,), float64
        Scan coordinates of the local origin, metres; one for as long as a scan is open.
    views : tuple of str
        Those that are shown.
    modes : mapping of str to str
        Colour mode of each view.
    colours : ndarray of shape (layers + 1, 3), uint8
        Unassigned last.
    visible : tuple of int
        Layers that are shown, -1 for Unassigned.
    theme : Theme
    marks : ndarray of shape (n, 3), float64, or None
        Places to mark in the cloud, scan coordinates, metres.
    joined : int
        How often compartments are joined two by two before they are drawn: from afar nobody sees it.
    quick : bool
        Whether pillars and layers may be coarse: a hand moves, and the next picture comes soon.
    meshed : Meshed or None
        Complex parts of this result, drawn as a mesh in the reconstruction.
    way : str
        As what the layers are drawn.
    """

    answer: Answer
    origin: Floats
    views: tuple[str, ...]
    modes: Mapping[str, Any]
    colours: NDArray[np.uint8]
    visible: tuple[int, ...]
    theme: Theme
    marks: Floats | None = None
    joined: int = 0
    quick: bool = False
    meshed: Meshed | None = None
    way: Way = "edges"

    @property
    def result(self) -> Reconstruction:
        """The reconstruction to draw."""
        return self.answer.result


@dataclass(frozen=True, eq=False)
class Picture:
    """A scene and what its colours mean."""

    scene: Scene
    legend: Legend | None


@dataclass(frozen=True, eq=False)
class Drawn:
    """The pictures of the views that are shown, and the cloud in local coordinates for whoever cuts it."""

    pictures: Mapping[str, Picture]
    cloud: Cloud
    seconds: float
