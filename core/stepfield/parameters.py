"""The operator's choices: frozen, validated, the same in the project, the manifest and the command."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, field_validator

from stepfield.errors import ParameterError
from stepfield.validation import explain

Unit = Literal["m", "cm", "mm", "ft", "us-ft"]
Up = Literal["x", "y", "z", "-x", "-y", "-z"]
Auto = Literal["auto"]
Way = Literal["edges", "simulator"]

#: Metres in one unit; the US survey foot is 1200/3937 m by definition.
METRES: dict[Unit, float] = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "us-ft": 1200 / 3937}


def _no_truth_values(value: Any) -> Any:
    """Refuse true and false where a number is meant: they would pass as 1 and 0."""
    if isinstance(value, bool):
        raise ValueError("a number is needed")
    return value


#: Beyond a light hour nothing is scanned, and arithmetic with alpha must not overflow.
Length = Annotated[float, BeforeValidator(_no_truth_values), Field(gt=0, le=1e12, allow_inf_nan=False)]
Count = Annotated[int, BeforeValidator(_no_truth_values), Field(ge=1, le=1_000_000)]
Coordinate = Annotated[float, Field(allow_inf_nan=False)]
ClassCode = Annotated[int, Field(ge=0, le=255)]
Box = tuple[Coordinate, Coordinate, Coordinate, Coordinate, Coordinate, Coordinate]


class Frozen(BaseModel):
    """Base of every value that goes into a file: immutable, and no unknown names."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Parameters(Frozen):
    """Everything that decides what a scan becomes. Lengths in metres.

    ``auto`` is replaced by a number picked from the data when the pipeline runs; the manifest
    holds that number.
    """

    cell_size: Length | Auto = Field("auto", description="side of a compartment (5.1)")
    alpha: Length | Auto = Field("auto", description="distance of the base plane below the scan (Eq. 1)")
    layer_tolerance: Length | Auto = Field("auto", description="vertical gap that parts two pillars (5.3.2)")
    layering: Literal["rank", "elevation", "surface"] = Field(
        "surface", description="how pillars get layers (5.3.3)"
    )
    pillar_height: Literal["mean", "max", "median", "p90"] = Field("mean", description="height of a pillar")
    walls: Literal["mean", "top", "layer"] = Field(
        "mean",
        description="vertical pillars: as all others, to their highest point, or in a layer of obstacles",
    )
    min_points: Count = Field(1, description="fewer points than this make no exported pillar")
    max_layers: Count | Literal["auto", "none"] = Field("auto", description="layers at most")
    link_step: Length | Auto = Field("auto", description="height step that still joins two neighbours")
    reconstruction: Way = Field("edges", description="surface that layers become triangles by (6)")
    fill: Literal["none", "nearest", "linear", "inpaint"] = Field("none", description="how holes are filled")
    fill_size: Length | Auto = Field("auto", description="longest side of the holes that are filled")
    bits: Literal[8, 16] = Field(16, description="bits of a pixel (5.2, Eq. 2 is 8)")
    pad: Literal["pow2", "none"] = Field("pow2", description="pad images to powers of two")
    range: Literal["shared", "layer"] = Field("shared", description="whose greatest height is white")
    complex_parts: Literal["off", "mesh"] = Field("off", description="mesh what height-maps cannot hold (7)")
    complex_residual: Length | Auto = Field(
        "auto", description="distance from the scan that makes it complex"
    )
    clearance: bool = Field(False, description="also write the room above each layer")
    unit: Unit | Auto = Field("auto", description="unit of the scan's coordinates")
    up: Up = Field("z", description="the scan's axis that points up")
    crop: Box | None = Field(None, description="keep only x0, y0, z0, x1, y1, z1")
    classes: tuple[ClassCode, ...] | None = Field(None, description="keep only these LAS classes")
    outliers: Literal["off", "radius", "isolated"] = Field("off", description="which stray points to drop")

    @field_validator("crop")
    @classmethod
    def _crop_has_an_inside(cls, crop: Box | None) -> Box | None:
        if crop is not None and any(crop[i] >= crop[i + 3] for i in range(3)):
            raise ValueError("the crop box needs x0 < x1, y0 < y1 and z0 < z1")
        return crop

    @field_validator("classes")
    @classmethod
    def _classes_are_a_set(cls, classes: tuple[int, ...] | None) -> tuple[int, ...] | None:
        return tuple(sorted(set(classes))) if classes else None

    @classmethod
    def checked(cls, **values: Any) -> Self:
        """Make Parameters, or raise ParameterError with one sentence."""
        try:
            return cls(**values)
        except ValidationError as error:
            raise ParameterError(f"impossible parameter, {explain(error)}") from None
