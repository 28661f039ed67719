"""Gazebo: the worlds as libsdformat takes them, shapes by the formulas of gz-sim's sources."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from tests.core.targets.stacks import asymmetric, height_at, places_in, rays, stack_of

from stepfield.targets import gazebo as target
from stepfield.targets.target import Options
from stepfield.targets.terrain import Terrain

trimesh = pytest.importorskip("trimesh", reason="trimesh reads the meshes; pip install trimesh")


def write(stack: Path, folder: Path, options: Options | None = None) -> Terrain:
    folder.mkdir()
    terrain = Terrain.of_stack(stack)
    made = target.write(terrain, folder, options or Options())
    found = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert found == set(made.files)
    return terrain


def models(world: Path) -> list[ElementTree.Element]:
    """Return the models a world includes, checking that each stands at the origin."""
    found = []
    for include in ElementTree.parse(world).getroot().iter("include"):
        assert include.findtext("pose") == "0 0 0 0 0 0"
        name = (include.findtext("uri") or "").removeprefix("model://")
        model = ElementTree.parse(world.parent / "models" / name / "model.sdf").getroot().find("model")
        assert model is not None
        assert model.get("name") == name
        found.append(model)
    return found


def numbers(element: ElementTree.Element | None, path: str) -> list[float]:
    assert element is not None
    return [float(word) for word in (element.findtext(path) or "").split()]


def file_of(world: Path, element: ElementTree.Element | None, path: str) -> Path:
    """Find the file that a uri names."""
    assert element is not None
    file = world.parent / "models" / (element.findtext(path) or "").removeprefix("model://")
    assert file.is_file()
    return file


def check_with_libsdformat(world: Path) -> None:
    program = shutil.which("gz") or shutil.which("ign")
    if program is None:
        pytest.skip("neither gz nor ign is installed; Debian: libsdformat-dev ignition-tools")
    for path in [world, *world.parent.glob("models/*/model.sdf")]:
        done = subprocess.run(
            [program, "sdf", "-k", str(path)],
            env=os.environ | {"SDF_PATH": str(world.parent / "models")},
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
        )
        if "not found" in done.stdout + done.stderr and "Valid" not in done.stdout and done.returncode == 255:
            pytest.skip(f"{program} knows no sdf: {done.stderr.strip()}")
        assert "Valid." in done.stdout, f"{path.name}: {done.stdout}{done.stderr}"
        assert "Error" not in done.stdout + done.stderr


@pytest.mark.parametrize("world", ["world.sdf", "world_meshes.sdf"])
def test_libsdformat_takes_the_worlds(asymmetric_stack: Path, tmp_path: Path, world: str) -> None:
    write(asymmetric_stack, tmp_path / "out")
    check_with_libsdformat(tmp_path / "out" / world)


def test_libsdformat_takes_any_name(tmp_path: Path) -> None:
    bad = "<a & \"b' -- \x00\x0b日本\n]]>"
    write(stack_of(tmp_path / "s", asymmetric(), names=[bad, bad], name=f"{bad}.ply"), tmp_path / "out")
    check_with_libsdformat(tmp_path / "out" / "world.sdf")
    (config,) = tmp_path.glob("out/models/*_layer_01/model.config")
    assert "<a & \"b' -- " in (ElementTree.parse(config).findtext("description") or "")


def test_meshes_hold_the_reconstruction(stack: Path, tmp_path: Path) -> None:
    terrain = write(stack, tmp_path / "out")
    half = terrain.cell_size / 2
    corner = (terrain.west - half, terrain.south - half)
    places = places_in(corner, terrain.cell_size, (terrain.rows, terrain.columns))
    only = tmp_path / "out" / "world_meshes.sdf"
    world = only if only.exists() else tmp_path / "out" / "world.sdf"
    layers = [layer for layer in terrain.layers if layer.quads.any()]
    for layer, model in zip(layers, models(world), strict=True):
        files = {file_of(world, model, f"link/{what}/geometry/mesh/uri") for what in ("collision", "visual")}
        found = trimesh.load_mesh(files.pop())
        assert not files
        heights = rays(np.asarray(found.vertices), np.asarray(found.faces), places)
        expected = height_at(layer.elevations.astype(np.float64), corner, terrain.cell_size, places)
        np.testing.assert_array_equal(np.isfinite(heights), np.isfinite(expected))
        assert np.abs(heights - expected)[np.isfinite(expected)].max(initial=0) <= layer.half_level + 1e-3


def drawn(image: NDArray[np.uint16], height: float) -> NDArray[np.float64]:
    """Return the heights gz-sim gives an image: the brightest pixel is as high as the size says."""
    share: NDArray[np.float64] = image / 65535
    heights: NDArray[np.float64] = share * (height / share.max())
    return heights


def test_the_height_map_is_the_lowest_layer(asymmetric_stack: Path, tmp_path: Path) -> None:
    """By the formulas of gz-sim: what is seen and what is touched have each sample at its place."""
    terrain = write(asymmetric_stack, tmp_path / "out")
    world = tmp_path / "out" / "world.sdf"
    ground = models(world)[0]
    image = np.asarray(Image.open(file_of(world, ground, "link/visual/geometry/heightmap/uri")))
    assert image.dtype == np.uint16
    assert image.shape == (65, 65), "a power of two and one"
    pose = numbers(ground, "link/collision/pose")
    for what, spaces in (("visual", 64), ("collision", 65)):
        shape = ground.find(f"link/{what}/geometry/heightmap")
        width, depth, height = numbers(shape, "size")
        assert numbers(shape, "pos") == pose[:3], "said twice, and the same"
        assert (width / spaces, depth / spaces) == pytest.approx((0.25, 0.25))
        x = pose[0] + (np.arange(65) - 32) * width / spaces
        y = pose[1] - (np.arange(65) - 32) * depth / spaces
        np.testing.assert_allclose(x[:37], terrain.west + 0.25 * np.arange(37), atol=1e-5)
        np.testing.assert_allclose(y[:24], terrain.north - 0.25 * np.arange(24), atol=1e-5)
        heights = pose[2] + drawn(image, height)
        assert np.abs(heights[:24, :37] - asymmetric()[0]).max() < terrain.layers[0].half_level + 1e-4
    assert pose[3:] == [0, 0, 0]


def test_a_height_map_that_goes_on_beyond_the_scan_says_so(asymmetric_stack: Path) -> None:
    (said,) = target.limits(Terrain.of_stack(asymmetric_stack))
    assert "7 m to the east" in said
    assert "10.25 m to the south" in said


@pytest.mark.parametrize(
    ("why", "lowest"),
    [
        ("a hole", np.where(np.arange(37) == 5, np.nan, asymmetric()[0])),
        ("level", np.ones((24, 37))),
        ("narrow", asymmetric()[0][:3]),
    ],
)
def test_what_is_no_height_map_is_a_mesh(tmp_path: Path, why: str, lowest: NDArray[np.float64]) -> None:
    write(stack_of(tmp_path / "s", [lowest]), tmp_path / "out")
    assert not list(tmp_path.glob("out/**/*.png")), why
    assert not (tmp_path / "out" / "world_meshes.sdf").exists()
    (model,) = models(tmp_path / "out" / "world.sdf")
    assert file_of(tmp_path / "out" / "world.sdf", model, "link/collision/geometry/mesh/uri").suffix == ".stl"


def test_thickened_meshes_are_closed(asymmetric_stack: Path, tmp_path: Path) -> None:
    write(asymmetric_stack, tmp_path / "out", Options(thicken=0.1))
    (mesh,) = tmp_path.glob("out/models/*_layer_01/meshes/layer_01.stl")
    assert trimesh.load_mesh(mesh).is_watertight


def test_the_same_stack_makes_the_same_bytes(asymmetric_stack: Path, tmp_path: Path) -> None:
    write(asymmetric_stack, tmp_path / "a")
    write(asymmetric_stack, tmp_path / "b")
    for path in filter(Path.is_file, (tmp_path / "a").rglob("*")):
        assert (tmp_path / "b" / path.relative_to(tmp_path / "a")).read_bytes() == path.read_bytes()
