"""The parameters as options of a command; one definition for every command that takes them."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Annotated, Any, get_type_hints

import typer

from stepfield.errors import ParameterError


def _option(flag: str, metavar: str, text: str) -> Any:
    return Annotated[str | None, typer.Option(flag, metavar=metavar, help=text, show_default=False)]


#: Name in JSON, and the option that sets it.
OPTIONS: dict[str, Any] = {
    "cell_size": _option("--cell", "M|auto", "Side of a compartment in metres. (default: auto)"),
    "alpha": _option("--alpha", "M|auto", "Distance of the base plane below the scan. (default: auto)"),
    "layer_tolerance": _option(
        "--tolerance", "M|auto", "Vertical gap that parts two pillars. (default: auto)"
    ),
    "layering": _option("--layering", "rank|elevation|surface", "How pillars get layers. (default: surface)"),
    "pillar_height": _option("--pillar-height", "mean|max|median|p90", "Height of a pillar. (default: mean)"),
    "walls": _option(
        "--walls",
        "mean|top|layer",
        "Walls and columns: like all pillars, to their top, or as obstacles. (default: mean)",
    ),
    "min_points": _option("--min-points", "N", "Pillars of fewer points are left out. (default: 1)"),
    "max_layers": _option("--max-layers", "auto|none|N", "At most this many layers. (default: auto)"),
    "link_step": _option(
        "--link-step", "M|auto", "Step that still joins neighbours. (default: the tolerance)"
    ),
    "reconstruction": _option(
        "--reconstruction", "edges|simulator", "Surface of the targets' meshes. (default: edges)"
    ),
    "fill": _option(
        "--fill",
        "none|nearest|linear|inpaint",
        "How to fill holes of layers; linear is seldom far from the best. (default: none)",
    ),
    "fill_size": _option(
        "--fill-size", "M|auto", "Longest side of the holes that are filled. (default: 5 cells)"
    ),
    "bits": _option("--bits", "8|16", "Bits of a pixel. (default: 16)"),
    "pad": _option("--pad", "pow2|none", "Pad images to powers of two. (default: pow2)"),
    "range": _option("--range", "shared|layer", "Whose greatest height is white. (default: shared)"),
    "complex_parts": _option(
        "--complex", "off|mesh", "Mesh the parts that height-maps cannot hold. (default: off)"
    ),
    "complex_residual": _option(
        "--complex-residual",
        "M|auto",
        "Distance from the scan that makes it complex. (default: cell / 4)",
    ),
    "clearance": Annotated[
        bool | None,
        typer.Option(
            "--clearance/--no-clearance", help="Also write the room above each layer.", show_default=False
        ),
    ],
    "unit": _option(
        "--unit", "auto|m|cm|mm|ft|us-ft", "Unit of the scan. (default: what the file says, or m)"
    ),
    "up": _option("--up", "x|y|z|-x|-y|-z", "Axis of the scan that points up. (default: z)"),
    "crop": _option("--crop", "x0,y0,z0,x1,y1,z1", "Keep only this box, in metres."),
    "classes": _option("--classes", "2,6", "Keep only these LAS classes."),
    "outliers": _option("--outliers", "off|radius|isolated", "Which stray points to drop. (default: off)"),
}
_LISTS = {"crop", "classes"}
_WHOLE = {"bits"}


def with_parameters(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give ``command(..., given)`` the parameter options; ``given`` holds those that were used."""

    @wraps(command)
    def run(**values: Any) -> Any:
        given = {name: _parsed(name, values.pop(name)) for name in OPTIONS if values.get(name) is not None}
        own = {name: value for name, value in values.items() if name not in OPTIONS}
        return command(**own, given=given)

    hints = get_type_hints(command, include_extras=True)
    own = [
        parameter.replace(annotation=hints[name])
        for name, parameter in inspect.signature(command).parameters.items()
        if name != "given"
    ]
    extra = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=option)
        for name, option in OPTIONS.items()
    ]
    own = [parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY) for parameter in own]
    run.__signature__ = inspect.Signature(own + extra)  # type: ignore[attr-defined]
    run.__annotations__ = {parameter.name: parameter.annotation for parameter in own + extra}
    return run


def _parsed(name: str, text: str | bool) -> Any:
    """Turn an option's text into what the parameter takes; the values are checked by Parameters."""
    if isinstance(text, bool):
        return text
    try:
        if name in _LISTS:
            return tuple(float(item) if name == "crop" else int(item) for item in text.split(","))
        return int(text) if name in _WHOLE else text
    except ValueError:
        raise ParameterError(f"impossible parameter, {name}: numbers are needed (found {text!r})") from None
