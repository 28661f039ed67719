"""Places of pillars in the world: many boxes as one frozen value that goes into a file."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema, to_json

#: x0, y0, x1, y1, z_low, z_high.
SIDES = 6
#: Boxes written at once: some milliseconds of work.
PIECE = 1000


class Boxes:
    """A read-only array of boxes, equal and hashed by value; a list of lists of six numbers in JSON.

    A hundred thousand of them are one array, not as many objects: a project holds them in every step of its
    history.

    Parameters
    ----------
    rows : array_like of shape (N, 6), optional
        x0, y0, x1, y1 of a compartment and the lowest and highest elevation of the pillar in it, in scan
        coordinates, metres. Copied unless it is read-only.

    Raises
    ------
    ValueError
        When that is not what it is given.
    """

    def __init__(self, rows: ArrayLike = ()) -> None:
        self.array = _checked(rows)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array, (N, 6)."""
        return self.array.shape

    def __len__(self) -> int:
        return len(self.array)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.array, dtype, copy=copy)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Boxes):
            return NotImplemented
        return self.array is other.array or np.array_equal(self._bits, other._bits)

    def __hash__(self) -> int:
        return self._hash

    def __repr__(self) -> str:
        return f"Boxes({len(self)})"

    def listed(self) -> bytes:
        """Return the boxes as JSON, some on a line; in pieces, so that other threads get their turn."""
        pieces = (self.array[at : at + PIECE] for at in range(0, len(self), PIECE))
        return b"[" + b",\n".join(to_json(piece.tolist())[1:-1] for piece in pieces) + b"]"

    @property
    def _bits(self) -> NDArray[np.int64]:
        return self.array.view(np.int64)

    @cached_property
    def _hash(self) -> int:
        return hash(self.array.tobytes())

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(
            lambda value: value if isinstance(value, cls) else cls(value),
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda boxes: boxes.array.tolist(), when_used="json"
            ),
        )

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        box = {"type": "array", "items": {"type": "number"}, "minItems": SIDES, "maxItems": SIDES}
        return {"type": "array", "items": box}


def _checked(rows: Any) -> NDArray[np.float64]:
    """Return rows as an array that nobody can write to."""
    is_frozen = isinstance(rows, np.ndarray) and rows.flags.owndata and not rows.flags.writeable
    try:
        array = np.array(rows, np.float64, order="C", copy=None if is_frozen else True)
    except (ValueError, TypeError, OverflowError):
        raise ValueError("each pillar needs six numbers") from None
    if array.shape == (0,):
        array = array.reshape(0, SIDES)
    if array.ndim != 2 or array.shape[1] != SIDES or not np.isfinite(array).all():
        raise ValueError("each pillar needs six numbers, none of them infinite")
    array.flags.writeable = False
    return array
