"""Scenes described in a JSON file, checked before anything is drawn.

The file is the paper's section 2 in writing: simple objects, each with a pose, a number of points
and noise. Whatever is wrong with it is said in one sentence naming the object and the field.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, get_args

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from stepfield.errors import SceneError
from stepfield.synth.geometry import Floats, Pose, Shape
from stepfield.synth.primitives import Cylinder, Hole, Plane, Sphere, box
from stepfield.synth.scene import NoiseKind, Scene, Surface, shares

#: More points than this in one cloud are taken for a slip of the pen.
MOST_POINTS = 1_000_000_000
_MOST_BYTES = 16 * 2**20

_NO_KIND = ("union_tag_not_found", "union_tag_invalid")
_PLAIN = {
    "missing": "is missing",
    "extra_forbidden": "no such field",
    "union_tag_not_found": "is missing; it is plane, box, sphere or cylinder",
    "union_tag_invalid": "should be plane, box, sphere or cylinder",
}

Face = Literal["bottom", "top", "south", "north", "west", "east"]
Length = Annotated[float, Field(gt=0, le=1e5, allow_inf_nan=False)]
Number = Annotated[float, Field(ge=-1e9, le=1e9, allow_inf_nan=False)]
Noise = Annotated[float, Field(ge=0, le=1e3, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=1, le=MOST_POINTS)]
Numbers3 = tuple[Number, Number, Number]


class _Described(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class _Object(_Described):
    """What every object has: a name, a pose, a number of points and noise (metres)."""

    name: str | None = None
    position: Numbers3 = (0.0, 0.0, 0.0)
    rotation: Numbers3 = (0.0, 0.0, 0.0)
    points: Count | None = None
    noise: Noise | None = None
    noise_kind: NoiseKind = "normal"

    def pose(self) -> Pose:
        roll, pitch, yaw = self.rotation
        return Pose.at(*self.position, roll=roll, pitch=pitch, yaw=yaw)


class PlaneObject(_Object):
    """A rectangle; ``size`` is width along x and depth along y."""

    kind: Literal["plane"]
    size: tuple[Length, Length]
    holes: tuple[tuple[Number, Number, Number, Number], ...] = ()

    @model_validator(mode="after")
    def _something_left(self) -> PlaneObject:
        _check_holes(self.holes)
        if Plane(*self.size, self.holes).area == 0:
            raise ValueError("the holes leave nothing of the plane")
        return self

    def shape(self) -> Shape:
        """Rectangle with its holes."""
        return Plane(*self.size, self.holes)


class BoxObject(_Object):
    """A box; ``size`` along x, y and z; ``without`` names faces to leave out; ``holes`` are shafts."""

    kind: Literal["box"]
    size: tuple[Length, Length, Length]
    without: tuple[Face, ...] = ()
    holes: tuple[tuple[Number, Number, Number, Number], ...] = ()

    @model_validator(mode="after")
    def _sound(self) -> BoxObject:
        _check_holes(self.holes)
        half_x, half_y = self.size[0] / 2, self.size[1] / 2
        for x0, y0, x1, y1 in self.holes:
            if x0 <= -half_x or x1 >= half_x or y0 <= -half_y or y1 >= half_y:
                raise ValueError("the holes of a box must lie inside its rim")
        if any(_overlap(a, b) for i, a in enumerate(self.holes) for b in self.holes[:i]):
            raise ValueError("the holes of a box must not overlap")
        if len(set(self.without)) == len(get_args(Face)) and not self.holes:
            raise ValueError("a box without any face has no surface")
        return self

    def shape(self) -> Shape:
        """Faces that are not left out."""
        return box(*self.size, without=self.without, holes=self.holes)


class SphereObject(_Object):
    """A sphere."""

    kind: Literal["sphere"]
    radius: Length

    def shape(self) -> Shape:
        """Whole sphere."""
        return Sphere(self.radius)


class CylinderObject(_Object):
    """A cylinder standing on its own z axis; a rotation of [90, 0, 0] lays it along y."""

    kind: Literal["cylinder"]
    radius: Length
    height: Length
    caps: bool = False

    def shape(self) -> Shape:
        """Side, and both ends when it is closed."""
        return Cylinder(self.radius, self.height, self.caps)


AnyObject = Annotated[PlaneObject | BoxObject | SphereObject | CylinderObject, Field(discriminator="kind")]


class Description(_Described):
    """The whole file; ``points`` is what the objects without a number of their own share by area."""

    objects: tuple[AnyObject, ...]
    points: Count = 100_000
    noise: Noise = 0.005
    scan_positions: tuple[Numbers3, ...] = ()

    @model_validator(mode="after")
    def _not_empty(self) -> Description:
        if not self.objects:
            raise ValueError("a scene needs at least one object")
        return self

    def scene(self) -> Scene:
        """Make the scene described."""
        surfaces = tuple(
            Surface(
                thing.name or f"{thing.kind} {number}",
                thing.shape(),
                thing.pose(),
                thing.noise,
                thing.noise_kind,
            )
            for number, thing in enumerate(self.objects, 1)
        )
        counts = self._counts(surfaces)
        return Scene(surfaces, sum(counts), tuple(map(float, counts)), self.noise, self.scan_positions)

    def _counts(self, surfaces: tuple[Surface, ...]) -> list[int]:
        open_ended = [i for i, thing in enumerate(self.objects) if thing.points is None]
        counts = [thing.points or 0 for thing in self.objects]
        if open_ended:
            shared = shares(self.points, _areas([surfaces[i] for i in open_ended]))
            for i, count in zip(open_ended, shared.tolist(), strict=True):
                counts[i] = count
        return counts


def read_description(path: Path) -> Scene:
    """Read a scene from a JSON file.

    Raises
    ------
    SceneError
        When it cannot be read or describes an impossible scene.
    """
    text = _text(path)
    try:
        scene = Description.model_validate_json(text).scene()
    except ValidationError as error:
        raise SceneError(f"{path.name}: {_sentence(error)}") from None
    if scene.points > MOST_POINTS:
        raise SceneError(
            f"{path.name}: the objects ask for {scene.points:,} points in all, more than {MOST_POINTS:,}; "
            "ask for fewer"
        )
    return scene


def _text(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            text = file.read(_MOST_BYTES + 1)
    except OSError as error:
        raise SceneError(
            f"cannot read the scene {path}: {error.strerror or error}; give the path of a JSON file"
        ) from error
    if len(text) > _MOST_BYTES:
        raise SceneError(
            f"{path.name} is larger than {_MOST_BYTES >> 20} MiB; a scene's description is a short JSON file"
        )
    return text


def _sentence(error: ValidationError) -> str:
    """Put the first fault into one sentence: where, what, and what to do."""
    faults = error.errors(include_url=False)
    first = faults[0]
    if first["type"] == "json_invalid":
        return f"not valid JSON ({first['msg'].removeprefix('Invalid JSON: ')}); correct it there"
    place = first["loc"]
    if first["type"] in _NO_KIND:
        # The kind decides what the other fields are, so that pydantic never got as far as a field.
        place = (*place, "", "kind")
    more = f" ({len(faults) - 1} more like it)" if len(faults) > 1 else ""
    return f"{_where(place)}{_what(first['type'], first['msg'], first['input'])}; correct it there{more}"


def _where(place: tuple[int | str, ...]) -> str:
    """("objects", 1, "box", "size", 0) as "object 2 (box), field size[0]: "."""
    named = list(place)
    start = ""
    if len(named) > 1 and named[0] == "objects":
        start = f"object {int(named[1]) + 1}" + (f" ({named[2]})" if len(named) > 2 and named[2] else "")
        named = named[3:]
    if not named:
        return f"{start}: " if start else ""
    fields = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in named).lstrip(".")
    return f"{start}, field {fields}: " if start else f"field {fields}: "


def _what(kind: str, message: str, given: Any) -> str:
    if kind in _PLAIN:
        return _PLAIN[kind]
    what = message.removeprefix("Value error, ").removeprefix("Input ").removeprefix("Tuple ")
    shown = repr(given)
    if kind in ("value_error", "too_long") or len(shown) > 40:
        return what.replace(" after validation", "")
    return f"{what.replace('a valid array', 'a list')}, not {shown}"


def _check_holes(holes: tuple[Hole, ...]) -> None:
    if any(x1 <= x0 or y1 <= y0 for x0, y0, x1, y1 in holes):
        raise ValueError("a hole is [x0, y0, x1, y1] with x0 < x1 and y0 < y1")


def _overlap(a: Hole, b: Hole) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _areas(surfaces: list[Surface]) -> Floats:
    return np.array([surface.shape.area for surface in surfaces])
