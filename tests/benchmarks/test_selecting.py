"""Selecting among a million pillars in five layers: how soon a shape has become a mask."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.benchmarks.conftest import Table, seconds

from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.reconstruction import Reconstruction
from stepfield.selecting import Reach, carried, connected, grown, inverted, of_layer, shrunk
from stepfield_app.render.camera import Camera
from stepfield_app.scenes.lens import Lens
from stepfield_app.scenes.picking import InSection, InView, OnMap, Pick, Shape, picked
from stepfield_app.scenes.selected import Selected

METHOD = Parameters(cell_size=0.1, layer_tolerance=0.3, alpha=0.5)
SIDE, LAYERS = 450, 5
SIZE = (1600, 1000)
EVERYTHING, LAYER = Reach(), Reach(layer=2)
#: What is to be seen within 200 ms must be known well before that.
TARGET = 0.2


@pytest.fixture(scope="module")
def scan(folder: Path) -> Path:
    """Two points in each compartment of five undulating storeys."""
    rng, middles = np.random.default_rng(0), (np.arange(SIDE) + 0.5) * 0.1
    x, y = (each.ravel() for each in np.meshgrid(middles, middles))
    storey = 0.3 * np.sin(x / 4) + 0.2 * np.cos(y / 3)
    points = [
        np.c_[x + shift, y - shift, 1.2 * k + storey + rng.normal(0, 0.02, len(x))]
        for k in range(LAYERS)
        for shift in (-0.02, 0.02)
    ]
    path = folder / "storeys.npy"
    np.save(path, np.vstack([*points, [[0, 0, 0], [SIDE * 0.1, SIDE * 0.1, 0]]]))
    return path


@pytest.fixture(scope="module")
def result(scan: Path) -> Reconstruction:
    made = Pipeline().run([scan], METHOD)
    assert len(made.field) > 1_000_000
    return made


def blob(middle: tuple[float, float], across: float, up: float) -> NDArray[np.float64]:
    """A lasso of 400 places with bays."""
    angle = np.linspace(0, 2 * np.pi, 400)
    radius = 1 + 0.15 * np.sin(5 * angle) + np.random.default_rng(1).normal(0, 0.01, 400)
    path: NDArray[np.float64] = np.c_[across * radius * np.cos(angle), up * radius * np.sin(angle)] + middle
    return path


def wave(left: float, right: float, middle: float, height: float) -> NDArray[np.float64]:
    """A stroke of 300 places."""
    path: NDArray[np.float64] = np.c_[
        np.linspace(left, right, 300), middle + height * np.sin(np.linspace(0, 20, 300))
    ]
    return path


def picks(result: Reconstruction) -> dict[str, Pick]:
    """One of each kind, in each of the views."""
    low, high = (np.array(ends) for ends in zip(*(axis.bounds() for axis in result.scan.axes), strict=True))
    camera = Camera.fitting(np.zeros(3), high - low, SIZE, 30, 35)
    visible = tuple(range(LAYERS))

    def view(kind: Any, path: NDArray[np.float64], radius: float = 0.0) -> InView:
        return InView(camera, SIZE, low, visible, Shape(kind, path, radius))

    stroke, line = wave(300, 1300, 500, 200), ((3.0, 3.0), (40.0, 40.0))
    band = blob((20, 1.2), 10, 0.5)
    return {
        "3-D, lasso around most": view("lasso", blob((800, 500), 560, 350)),
        "3-D, rectangle": view("rectangle", np.array([[300.0, 200.0], [1300.0, 800.0]])),
        "3-D, brush of 20 px": view("brush", stroke, 20),
        "3-D, brush of 100 px": view("brush", stroke, 100),
        "map, lasso": OnMap(Shape("lasso", blob((22, 22), 15, 15)), 2),
        "map, brush of 1 m": OnMap(Shape("brush", wave(3, 40, 22, 10), 1.0), 2),
        "profile, lasso": InSection(*line, 0.2, Shape("lasso", band), visible),
        "profile, brush": InSection(*line, 0.2, Shape("brush", band, 0.2), visible),
    }


def test_picking(result: Reconstruction, table: Table) -> None:
    for name, pick in picks(result).items():
        for reach, how in ((EVERYTHING, "everything"), (LAYER, "a layer")):
            taken = int(picked(result, pick, reach).sum())
            took = seconds(lambda pick=pick, reach=reach: picked(result, pick, reach))  # type: ignore[misc]
            table.add(f"{name}, {how}: {taken}", took, "200 ms to the screen", TARGET, "<= 0.5")


def test_a_stroke_in_a_view(result: Reconstruction, table: Table) -> None:
    """Every dab of a brush picks anew all that the stroke has taken so far."""
    whole = picks(result)["3-D, brush of 20 px"]
    assert isinstance(whole, InView)
    lens, length = Lens(), iter(range(2, 300))

    def dab() -> None:
        shape = replace(whole.shape, path=whole.shape.path[: next(length)])
        picked(result, replace(whole, shape=shape, lens=lens), EVERYTHING)

    table.add("3-D, brush of 20 px, the first dab", seconds(dab, 1), "200 ms to the screen", TARGET, "<= 0.5")
    table.add("  each of those that follow", seconds(dab, 50), "200 ms to the screen", TARGET, "<= 0.25")


def test_along_surfaces(result: Reconstruction, table: Table) -> None:
    mask, seed = of_layer(result, 2), np.zeros(len(result.field), bool)
    seed[np.flatnonzero(mask)[1000]] = True
    table.add("links, found once", seconds(lambda: result.links, 1), "200 ms to the screen", TARGET)
    for name, work in {
        "grow": lambda: grown(result, mask, EVERYTHING),
        "shrink": lambda: shrunk(result, mask),
        "invert": lambda: inverted(result, mask, EVERYTHING),
        "connected surface": lambda: connected(result, seed, EVERYTHING),
        "count by layer": lambda: Selected.of(result, mask),
    }.items():
        table.add(f"{name}, of {int(mask.sum())}", seconds(work), "200 ms to the screen", TARGET, "<= 0.5")


def test_carrying(result: Reconstruction, scan: Path, table: Table) -> None:
    after = Pipeline().run([scan], METHOD)
    mask = of_layer(result, 2)
    assert np.array_equal(carried(result, after, mask), mask)
    took = seconds(lambda: carried(result, after, mask))
    table.add(f"carry {int(mask.sum())} over to another step-field", took, "200 ms to the screen", TARGET)
