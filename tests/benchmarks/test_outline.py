"""Outlines and suspicious places of a million pillars: how long until they are known, and until they show."""

from __future__ import annotations

import os
from collections.abc import Iterator

import numpy as np
import pytest
from pytestqt.qtbot import QtBot
from tests.benchmarks.conftest import Table, seconds

from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.reconstruction import Reconstruction
from stepfield.suspects import KINDS, suspects
from stepfield_app.render.camera import Camera
from stepfield_app.render.client import RenderClient
from stepfield_app.render.scene import PILLARS, Scene
from stepfield_app.scenes.blocks import blocks
from stepfield_app.scenes.outline import rim
from stepfield_app.scenes.palette import layer_colours
from stepfield_app.scenes.suspects import cells

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
SIDE, STOREYS, SIZE, LIMIT = 450, 5, (1600, 1000), 120_000
ORIGIN = np.zeros(3)


@pytest.fixture(scope="module")
def million(tmp_path_factory: pytest.TempPathFactory) -> Reconstruction:
    rng = np.random.default_rng(0)
    x, y = (grid.ravel() + 0.5 for grid in np.meshgrid(np.arange(SIDE), np.arange(SIDE)))
    waves = 0.4 * np.sin(x / 17) * np.cos(y / 23)
    storeys = [np.column_stack([x, y, 3.0 * k + waves + rng.normal(0, 0.1, SIDE**2)]) for k in range(STOREYS)]
    path = tmp_path_factory.mktemp("million") / "storeys.npy"
    np.save(path, np.concatenate(storeys))
    return Pipeline().run([path], Parameters.checked(cell_size=1.0, layer_tolerance=1.0))


@pytest.fixture
def client(qtbot: QtBot) -> Iterator[RenderClient]:
    client = RenderClient()
    yield client
    client.close()


def a_hundred_thousand(result: Reconstruction) -> dict[str, np.ndarray]:
    """Return selections of about 100 k pillars: a part of one layer, and pillars scattered over all."""
    grid, rng = result.field.compartments.grid, np.random.default_rng(1)
    from_middle = np.hypot(*(grid.centres(result.field.compartment) - [grid.west, grid.south] - SIDE / 2).T)
    one = (from_middle < 0.4 * SIDE) & (result.layering.layer == STOREYS - 1)
    return {"of one layer": one, "scattered": rng.random(len(result.field)) < 0.1}


def test_outline(qtbot: QtBot, client: RenderClient, million: Reconstruction, table: Table) -> None:
    layers = tuple(range(-1, STOREYS))
    meshes = blocks(million, ORIGIN, layer_colours(STOREYS), layers)
    low, high = (np.array(corner) for corner in million.scan.bounds())
    client.start()
    client.show([PILLARS])
    client.set_scene(PILLARS, Scene(meshes=meshes, low=low, high=high))
    client.set_camera(PILLARS, Camera.fitting(low, high, SIZE, -35, 30), SIZE, False)
    qtbot.waitUntil(client.is_at_rest, timeout=LIMIT)
    for name, mask in a_hundred_thousand(million).items():
        floor = seconds(lambda mask=mask: np.flatnonzero(mask))  # type: ignore[misc]
        made = rim(million, mask, ORIGIN)
        took = seconds(lambda mask=mask: rim(million, mask, ORIGIN))  # type: ignore[misc]
        table.add(f"outline of {mask.sum() // 1000} k pillars, {name}", took, "flatnonzero", floor, "0.04 s")

        def paint(segments: np.ndarray = made.whole) -> None:
            client.set_outline(PILLARS, segments.copy())
            qtbot.waitUntil(client.is_at_rest, timeout=LIMIT)

        copied = seconds(lambda made=made: made.whole.copy())  # type: ignore[misc]
        what = f"painted: {len(made.whole)} segments, {SIZE[0]} x {SIZE[1]}"
        table.add(what, seconds(paint), "copy of them", copied, "0.05 s")


def test_suspects(million: Reconstruction, table: Table) -> None:
    floor = seconds(lambda: million.links, runs=1)
    found = suspects(million)
    table.add("suspicious places", seconds(lambda: suspects(million)), "links, once", floor, "0.5 s")
    marking = seconds(lambda: cells(million, found.masks, KINDS, 0))
    table.add("marks of a layer", marking, "suspicious places", seconds(lambda: suspects(million)))
