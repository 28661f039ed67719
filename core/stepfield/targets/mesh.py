"""Meshes: a surface a layer, whole and decimated, in the four formats that everything reads."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from stepfield.surface import Mesh
from stepfield.targets.boxes import as_boxes
from stepfield.targets.complexmesh import LABEL, TITLE
from stepfield.targets.meshfiles import Titled, save
from stepfield.targets.target import Options, Written, without_surface
from stepfield.targets.terrain import Terrain, TerrainLayer
from stepfield.targets.text import number, readme, write_text
from stepfield.targets.thickening import thickened

SUFFIXES = (".glb", ".obj", ".stl", ".ply")
#: Where the decimated variant stands.
DECIMATED = "decimated"


def write(terrain: Terrain, folder: Path, options: Options) -> Written:
    """Write every layer's surface and its decimated variant."""
    bound = error_bound(terrain, options)
    files: list[str] = []
    counts = []
    for layer in terrain.layers:
        sizes = []
        for place, sheet in (
            ("", _surface(terrain, layer)),
            (f"{DECIMATED}/", _surface(terrain, layer, bound)),
        ):
            closed = sheet if layer.is_obstacles else _closed(sheet, options)
            title = Titled(layer.name, terrain.local_origin)
            files += _save(folder, f"{place}{layer.label}", title, closed)
            sizes.append(len(sheet.triangles))
        counts.append(f"{layer.label}  {sizes[0]} triangles, decimated {sizes[1]}")
    if terrain.complex_mesh is not None:
        files += _save(folder, LABEL, Titled(TITLE, terrain.local_origin), terrain.complex_mesh)
        counts.append(f"{LABEL}  {len(terrain.complex_mesh.triangles)} triangles")
    notes = limits(terrain)
    text = readme(terrain, "Meshes", _steps(terrain, bound, options, counts), notes)
    write_text(folder / "README.txt", text)
    return Written((*files, "README.txt"), tuple(notes))


def limits(terrain: Terrain) -> list[str]:
    """Say which layers have no surface."""
    return without_surface(terrain)


def error_bound(terrain: Terrain, options: Options) -> float:
    """How far the decimated surface may be from the whole one, metres."""
    return terrain.cell_size / 4 if options.decimate is None else options.decimate


def _surface(terrain: Terrain, layer: TerrainLayer, bound: float | None = None) -> Mesh:
    if layer.is_obstacles:
        return as_boxes(terrain, layer, bound or 0.0)
    return terrain.surface(layer, bound)


def _closed(sheet: Mesh, options: Options) -> Mesh:
    return sheet if options.thicken is None else thickened(sheet, options.thicken)


def _save(folder: Path, stem: str, title: Titled, mesh: Mesh) -> Iterator[str]:
    """Write a mesh in every format, unless it is empty, and name the files."""
    if not len(mesh.triangles):
        return
    for suffix in SUFFIXES:
        path = folder / f"{stem}{suffix}"
        path.parent.mkdir(exist_ok=True)
        save(path, mesh, title)
        yield f"{stem}{suffix}"


def _steps(terrain: Terrain, bound: float, options: Options, counts: list[str]) -> str:
    kind = (
        "Open sheets, seen from both sides in GLB; --thicken M closes them."
        if options.thicken is None
        else f"Closed bodies: each layer is {number(options.thicken)} m thick, downwards from its surface."
    )
    return "\n".join(
        [
            "layer_NN.glb (y up, as glTF wants it: x east, y up, z south; Blender, Unity, Godot, Isaac Sim)",
            "layer_NN.obj, .stl, .ply (z up)",
            *_about_surface(terrain),
            "Layers of obstacles are closed boxes from where each wall or column begins to its top.",
            *_about_complex(terrain),
            kind,
            "Tell a physics engine that it is a triangle mesh: a convex hull would fill the holes.",
            "",
            f"{DECIMATED}/ holds the same with fewer triangles: the same holes and edges, nowhere",
            f"further than {number(bound)} m above or below the whole surface (--decimate M sets it).",
            "",
            *counts,
        ]
    )


def _about_complex(terrain: Terrain) -> list[str]:
    if terrain.complex_mesh is None:
        return []
    return [
        f"{LABEL}.glb, .obj, .stl, .ply hold what height-maps cannot, meshed from its points; the layers",
        "have holes there, and the mesh reaches a compartment beyond them.",
    ]


def _about_surface(terrain: Terrain) -> list[str]:
    if terrain.reconstruction == "edges":
        return [
            "The formats hold the same surface: exactly the compartments of the pillars, four triangles each",
            "around the pillar's top, their corners the average of the neighbours that continue each other,",
            "at a rim of where their slopes lead; steps within a layer are closed by upright triangles,",
            "holes are missing ones.",
        ]
    return [
        "The formats hold the same surface: a vertex in the middle of every compartment, two triangles",
        "wherever four neighbouring compartments have a pillar; holes are missing triangles.",
    ]
