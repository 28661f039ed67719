"""MuJoCo's files, loaded by MuJoCo: its rays, its balls, its memory of names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.core.targets.stacks import CELL, asymmetric, height_at, large, places_in, stack_of

from stepfield.errors import TargetError
from stepfield.targets import mujoco as target
from stepfield.targets.target import Options, Written
from stepfield.targets.terrain import Terrain, TerrainLayer

mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed: its files are not loaded")

Raster = NDArray[np.float64]

BALL = 0.05
#: A pillar is as high as the mean of its points, and the table top is 4 cm thick: 0.71 to 0.75 m.
TOP = 0.73


def exported(stack: Path, folder: Path) -> tuple[Terrain, Written]:
    terrain = Terrain.of_stack(stack)
    return terrain, target.write(terrain, folder, Options())


def corner(terrain: Terrain) -> tuple[float, float]:
    return terrain.west - terrain.cell_size / 2, terrain.south - terrain.cell_size / 2


def only(scene: Path, layer: TerrainLayer) -> Any:
    """Load the scene with a single layer left in it."""
    tree = ElementTree.parse(scene)
    world = tree.getroot().find("worldbody")
    assert world is not None
    for geometry in world.findall("geom"):
        if not geometry.attrib["name"].startswith(layer.label):
            world.remove(geometry)
    tree.write(scene.with_name("only.xml"))
    return mujoco.MjModel.from_xml_path(str(scene.with_name("only.xml")))


def looked_down(model: Any, places: Raster) -> Raster:
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    met, down = np.zeros(1, np.int32), np.array([0.0, 0, -1])
    distance = [
        mujoco.mj_ray(model, data, np.array([x, y, 500.0]), down, None, 1, -1, met) for x, y in places
    ]
    return np.array([500 - d if d >= 0 else np.nan for d in distance])


def test_rays_meet_the_reconstruction_and_nothing_else(stack: Path, tmp_path: Path) -> None:
    # Half a level and a millimetre, over all of the map and beyond it; a flip, a transposition, a shift by
    # half a compartment, the other diagonal or a hole that is closed would each miss by far more.
    terrain, _ = exported(stack, tmp_path)
    places = places_in(corner(terrain), terrain.cell_size, (terrain.rows, terrain.columns))
    for layer in terrain.layers:
        if not layer.quads.any():
            continue
        wanted = height_at(layer.elevations.astype(float), corner(terrain), terrain.cell_size, places)
        seen = looked_down(only(tmp_path / target.SCENE, layer), places)
        np.testing.assert_array_equal(np.isnan(seen), np.isnan(wanted))
        np.testing.assert_allclose(seen, wanted, atol=layer.half_level + 1e-3)


def test_rays_meet_the_pillars_themselves_at_their_middles(asymmetric_stack: Path, tmp_path: Path) -> None:
    terrain, _ = exported(asymmetric_stack, tmp_path)
    for layer, made in zip(terrain.layers, asymmetric(), strict=True):
        row, column = (steps[:300] for steps in np.nonzero(layer.quads))
        x, y = terrain.west + column * CELL, terrain.north - row * CELL
        places = np.column_stack([x + 1e-6, y - 1e-6])  # just within the quad to its south-east
        seen = looked_down(only(tmp_path / target.SCENE, layer), places)
        np.testing.assert_allclose(seen, made[row, column], atol=layer.half_level + 1e-3)


def dropped(scene: Path, place: tuple[float, float, float], speed: tuple[float, float, float]) -> Raster:
    """Let a ball go; return its path over four seconds."""
    path = scene.with_name("ball.xml")
    path.write_text(
        f"""<mujoco><include file="{scene.name}"/><option timestep="0.001"/><worldbody>
        <body pos="{place[0]} {place[1]} {place[2]}"><freejoint/>
        <geom size="{BALL}" mass="0.3"/></body></worldbody></mujoco>"""
    )
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    data.qvel[:3] = speed
    gone = np.empty((400, 3))
    for moment in gone:
        mujoco.mj_step(model, data, 10)
        moment[:] = data.qpos[:3]
    return gone


@pytest.mark.parametrize(
    ("place", "rest"), [((0.1, 0.05, 1.2), TOP), ((1.4, 1.1, 1.2), 0.0)], ids=["on the table", "beside it"]
)
def test_balls_rest_where_they_fall(
    find_stack: Callable[[str], Path], tmp_path: Path, place: tuple[float, float, float], rest: float
) -> None:
    exported(find_stack("table"), tmp_path)
    assert dropped(tmp_path / target.SCENE, place, (0, 0, 0))[-1, 2] == pytest.approx(rest + BALL, abs=0.015)


def test_a_ball_rolls_under_the_table(find_stack: Callable[[str], Path], tmp_path: Path) -> None:
    exported(find_stack("table"), tmp_path)
    gone = dropped(tmp_path / target.SCENE, (0.05, -1.2, BALL + 0.01), (0, 2.0, 0))
    assert gone[:, 1].max() > 0.9
    beneath = gone[np.abs(gone[:, 1]) < 0.4]
    assert len(beneath)
    assert np.abs(beneath[:, 2] - BALL).max() < 0.03


def test_names_cannot_break_the_scene(tmp_path: Path) -> None:
    evil = "\"><geom/><!-- ]]> & ' \x07 \n über"
    stack = stack_of(tmp_path / "made", [np.zeros((4, 5))], names=[evil], name=evil + ".ply")
    exported(stack, tmp_path)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / target.SCENE))
    assert model.ngeom == 1
    text = model.text_data.decode("utf-8", "replace")
    assert "\"><geom/><!-- ]]> & '" in text


def test_equal_stacks_give_equal_bytes(asymmetric_stack: Path, tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        exported(asymmetric_stack, tmp_path / name)
    files = sorted(path.name for path in (tmp_path / "a").iterdir())
    assert files == sorted(path.name for path in (tmp_path / "b").iterdir())
    for file in files:
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_what_is_written_is_what_is_said(asymmetric_stack: Path, tmp_path: Path) -> None:
    _, written = exported(asymmetric_stack, tmp_path)
    assert sorted(written.files) == sorted(path.name for path in tmp_path.iterdir())


def test_a_layer_without_a_quad_is_left_out_and_said(tmp_path: Path) -> None:
    checkered = np.where(np.indices((5, 5)).sum(axis=0) % 2, np.nan, 1.0)
    (tmp_path / "out").mkdir()
    _, written = exported(stack_of(tmp_path / "made", [np.zeros((5, 5)), checkered]), tmp_path / "out")
    assert any("Layer 2" in note and "no surface" in note for note in written.notes)
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "out" / target.SCENE)).ngeom == 1


def test_too_many_holes_are_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(target, "MOST_TILES", 20)
    (tmp_path / "out").mkdir()
    with pytest.raises(TargetError, match="larger cell size"):
        exported(stack_of(tmp_path / "made", large(64, 2)), tmp_path / "out")


def test_a_hilly_large_map_loads_and_runs(tmp_path: Path) -> None:
    # A quarter of the size that the figures are taken of, so that the test stays quick.
    (tmp_path / "out").mkdir()
    terrain, _ = exported(stack_of(tmp_path / "made", large(256, 4)), tmp_path / "out")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / target.SCENE))
    assert model.nhfield > 100
    assert model.nhfielddata >= sum(int(layer.quads.sum()) for layer in terrain.layers)
