"""Fixed-size binary records, split into columns block by block.

The readers of binary PLY, PCD and STL share it: a block stays in the processor's cache while it is split,
and a file costs the memory of the columns that are used, not of all that it holds.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from stepfield.scan.cloud import Numbers

Record = np.dtype[np.void]

_BLOCK = 1 << 20


def packed(formats: list[tuple[str, int]]) -> Record:
    """Return the dtype of a record without gaps; its fields are ``f0``, ``f1``… as names may repeat."""
    return np.dtype([(f"f{i}", kind, (count,)) for i, (kind, count) in enumerate(formats)])


def read_columns(
    path: Path, offset: int, record: Record, count: int, wanted: Mapping[str, str]
) -> dict[str, Numbers]:
    """Read records into contiguous columns of this machine's byte order.

    Parameters
    ----------
    path : Path
    offset : int
        Byte where the first record starts.
    record : dtype
        Of :func:`packed`; of a field of several values the first is taken.
    count : int
        Records to read; the caller has checked that the file holds them.
    wanted : mapping of str to str
        Column name to field of the record.
    """
    columns = {name: np.empty(count, record[field].base.newbyteorder("=")) for name, field in wanted.items()}
    size = max(1, _BLOCK // max(1, record.itemsize))
    block = np.empty(min(size, count), record)
    with path.open("rb") as file:
        file.seek(offset)
        for start in range(0, count, size):
            part = block[: count - start]
            if file.readinto(part.view(np.uint8).data) < part.nbytes:
                raise OSError("it became shorter while it was read")
            for name, field in wanted.items():
                columns[name][start : start + len(part)] = part[field][:, 0]
    return columns
