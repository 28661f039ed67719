"""MuJoCo: complex parts are seen as their mesh and touched as boxes: it collides convex bodies only."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from stepfield.errors import TargetError
from stepfield.surface import Mesh
from stepfield.targets.boxes import Box
from stepfield.targets.complexmesh import LABEL, TITLE
from stepfield.targets.meshfiles import Titled, save
from stepfield.targets.terrain import Terrain
from stepfield.targets.text import number, numbers
from stepfield.targets.voxels import solids

#: Triangles in a file; MuJoCo takes no more than 200 000.
MOST_TRIANGLES = 100_000
#: More boxes than this, and MuJoCo takes minutes and gigabytes to load them.
MOST_BOXES = 200_000
#: Cubes along a compartment's side.
FINE = 2
COLOUR = (0.62, 0.72, 0.35)


@dataclass(frozen=True)
class ComplexPart:
    """What a scene says of the complex parts, and their files; nothing where there are none."""

    defaults: tuple[str, ...] = ()
    assets: tuple[str, ...] = ()
    geometries: tuple[str, ...] = ()
    files: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, terrain: Terrain, folder: Path) -> ComplexPart:
        """Write the meshes; raise TargetError where the parts would be too many boxes."""
        mesh = terrain.complex_mesh
        if mesh is None:
            return cls()
        side = terrain.cell_size / FINE
        made = _boxes(mesh, side)
        files = tuple(_saved(terrain, mesh, folder))
        names = [Path(file).stem for file in files]
        return cls(
            defaults=(
                f'<default class="{LABEL}"><geom type="box" material="{LABEL}" group="3"/></default>',
                f'<default class="{LABEL}_seen">'
                f'<geom type="mesh" material="{LABEL}" contype="0" conaffinity="0"/></default>',
            ),
            assets=(
                f'<material name="{LABEL}" rgba="{numbers(COLOUR)} 1" specular="0.1"/>',
                *(f'<mesh name="{name}" file="{name}.stl" inertia="shell"/>' for name in names),
            ),
            geometries=(
                *(f'<geom class="{LABEL}_seen" name="{name}" mesh="{name}"/>' for name in names),
                *(_geometry(count, box) for count, box in enumerate(made)),
            ),
            files=files,
            notes=(
                f"complex parts are seen as a mesh and touched as {len(made):,} boxes {number(side)} m thick "
                f"in group 3: MuJoCo has no contacts with meshes but their convex hulls",
            ),
        )


def _boxes(mesh: Mesh, side: float) -> list[Box]:
    made = list(solids(mesh, side))
    if len(made) > MOST_BOXES:
        raise TargetError(
            f"mujoco: the complex parts are {len(made):,} boxes, more than {MOST_BOXES:,}; build the stack "
            f"with a larger cell size"
        )
    return made


def _saved(terrain: Terrain, mesh: Mesh, folder: Path) -> Iterator[str]:
    """Write the mesh in files of so many triangles; name them."""
    for count, start in enumerate(range(0, len(mesh.triangles), MOST_TRIANGLES)):
        name = f"{LABEL}_seen_{count:02d}.stl"
        part = Mesh(mesh.vertices, mesh.triangles[start : start + MOST_TRIANGLES])
        save(folder / name, part, Titled(TITLE, terrain.local_origin))
        yield name


def _geometry(count: int, box: Box) -> str:
    place, size = (" ".join(repr(round(value, 9)) for value in of) for of in (box.middle, box.half))
    return f'<geom class="{LABEL}" name="{LABEL}_{count:05d}" pos="{place}" size="{size}"/>'
