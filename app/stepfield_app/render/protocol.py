"""What the window and the drawing process say to each other: one JSON object a line, arrays by file."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield_app.render.camera import Camera
from stepfield_app.render.outline import Outline
from stepfield_app.render.scene import Lines, Points, Scene, Triangles

Array = NDArray[Any]
Tree = dict[str, Any]


@dataclass(frozen=True)
class SetScene:
    """Show another scene from now on; see :func:`scene_tree`."""

    view: str
    scene: Tree


@dataclass(frozen=True)
class SetOutlines:
    """Paint these outlines over a view from now on, by kind; see :func:`outlines_tree`."""

    view: str
    outlines: Tree


@dataclass(frozen=True)
class SetBackground:
    """Colour of what nothing covers, 0 to 255."""

    colour: tuple[int, int, int]


@dataclass(frozen=True)
class Draw:
    """Draw a view into a file; answered by one Drawn or one Dropped of the same number."""

    view: str
    number: int
    camera: Tree
    size: tuple[int, int]
    moving: bool
    file: str


@dataclass(frozen=True)
class Ready:
    """The drawing process has loaded Open3D and can draw."""


@dataclass(frozen=True)
class Unusable:
    """The drawing process cannot draw, and a new one could not either."""

    reason: str


@dataclass(frozen=True)
class Dropped:
    """A request was overtaken by a newer one."""

    view: str
    number: int


@dataclass(frozen=True)
class Drawn:
    """A picture is in its file: pixels first, then depth if there is one."""

    view: str
    number: int
    size: tuple[int, int]
    depth: bool
    moving: bool
    points: int
    triangles: int
    covered: int
    seconds: float


Message = SetScene | SetOutlines | SetBackground | Draw | Ready | Unusable | Dropped | Drawn
KINDS: dict[str, type[Any]] = {
    kind.__name__: kind
    for kind in (SetScene, SetOutlines, SetBackground, Draw, Ready, Unusable, Dropped, Drawn)
}


def line(message: Message) -> bytes:
    """Write a message as one line."""
    fields = {name: getattr(message, name) for name in message.__dataclass_fields__}
    return json.dumps({"kind": type(message).__name__, **fields}).encode() + b"\n"


def message(line: bytes) -> Message:
    """Read a line back."""
    fields = json.loads(line)
    kind = KINDS[fields.pop("kind")]
    values = {name: tuple(value) if isinstance(value, list) else value for name, value in fields.items()}
    return kind(**values)  # type: ignore[no-any-return]  # one of KINDS


def camera_tree(camera: Camera) -> Tree:
    """Write a camera."""
    return asdict(camera)


def camera_of(tree: Tree) -> Camera:
    """Read a camera."""
    return Camera(**{**tree, "centre": tuple(tree["centre"])})


def frame_bytes(size: tuple[int, int]) -> int:
    """Return how much room a picture with its depth needs."""
    return size[0] * size[1] * 8


def arrays_of(scene: Scene) -> list[Array]:
    """List every large array of a scene."""
    parts: list[Array] = []
    if scene.points:
        parts += [scene.points.places, scene.points.codes]
    for mesh in scene.meshes:
        parts += [mesh.vertices, mesh.triangles, mesh.colours]
    for lines in scene.lines:
        parts += [lines.ends, lines.colours]
    return parts


def scene_tree(scene: Scene, written: Callable[[Array], Tree]) -> Tree:
    """Write a scene; ``written`` says where an array is."""
    points = scene.points
    return {
        "points": points
        and {
            "places": written(points.places),
            "codes": written(points.codes),
            "palette": None if points.palette is None else points.palette.tolist(),
            "size": points.size,
        },
        "meshes": [
            [written(m.vertices), written(m.triangles), written(m.colours), m.solid] for m in scene.meshes
        ],
        "lines": [[written(part.ends), written(part.colours)] for part in scene.lines],
        "low": np.asarray(scene.low).tolist(),
        "high": np.asarray(scene.high).tolist(),
    }


def scene_of(tree: Tree, mapped: Callable[[Tree], Array]) -> Scene:
    """Read a scene; ``mapped`` opens an array."""
    return Scene(
        points=tree["points"] and _points_of(tree["points"], mapped),
        meshes=tuple(_mesh_of(mesh, mapped) for mesh in tree["meshes"]),
        lines=tuple(Lines(*map(mapped, lines)) for lines in tree["lines"]),
        low=np.array(tree["low"]),
        high=np.array(tree["high"]),
    )


def outlines_tree(outlines: Mapping[str, Outline], written: Callable[[Array], Tree]) -> Tree:
    """Write outlines by kind; ``written`` says where an array is."""
    return {
        kind: {"segments": written(outline.segments), "slack": outline.slack}
        for kind, outline in outlines.items()
    }


def outlines_of(tree: Tree, mapped: Callable[[Tree], Array]) -> dict[str, Outline]:
    """Read outlines; ``mapped`` opens an array."""
    return {kind: Outline(mapped(outline["segments"]), outline["slack"]) for kind, outline in tree.items()}


def _mesh_of(parts: list[Any], mapped: Callable[[Tree], Array]) -> Triangles:
    vertices, triangles, colours, is_solid = parts
    return Triangles(mapped(vertices), mapped(triangles), mapped(colours), is_solid)


def _points_of(tree: Tree, mapped: Callable[[Tree], Array]) -> Points:
    palette = None if tree["palette"] is None else np.array(tree["palette"], np.uint8)
    return Points(mapped(tree["places"]), mapped(tree["codes"]), palette, tree["size"])
