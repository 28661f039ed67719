"""What all scenes share: read-only results, and work on many points in chunks on all cores."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = TypeVar("Array", bound=NDArray[Any])

#: Points handled at once: small enough for the processor's cache, large enough to hide the calls.
CHUNK = 1 << 16
WORKERS = min(os.cpu_count() or 1, 8)


def frozen(array: Array) -> Array:
    """Make an array read-only, whole, and return it."""
    array.flags.writeable = False
    return array


def in_chunks(length: int, work: Callable[[slice], object]) -> None:
    """Call ``work`` with slices that cover ``length``, on all cores; it writes to places of its own."""
    parts = [slice(at, min(at + CHUNK, length)) for at in range(0, length, CHUNK)]
    if len(parts) <= 1 or WORKERS == 1:
        for part in parts:
            work(part)
        return
    with ThreadPoolExecutor(WORKERS) as pool:
        for _ in pool.map(work, parts):
            pass


def sample(length: int, most: int) -> slice:
    """Return a slice of at most about ``most`` places spread evenly over ``length``."""
    return slice(None, None, max(1, -(-length // most)))


def robust_range(values: NDArray[Any], share: float = 0.005) -> tuple[float, float]:
    """Range of values without the ``share`` at either end that strays would stretch it by.

    Parameters
    ----------
    values : ndarray
        NaN is left out.
    share : float

    Returns
    -------
    tuple of float
        Ascending and never equal; (0, 1) when nothing is known.
    """
    known = values[np.isfinite(values)].astype(np.float64)
    if not known.size:
        return 0.0, 1.0
    low, high = np.quantile(known, [share, 1 - share])
    return (float(low), float(high)) if high > low else (float(low), float(low) + max(abs(low), 1.0) * 1e-6)


def steps(values: NDArray[Any], low: float, high: float, count: int) -> NDArray[np.uint8]:
    """Map ``low`` to ``high`` evenly onto 0 to ``count`` - 1, clipping what lies beyond; NaN becomes 0."""
    scaled = values.astype(np.float32)  # a copy of our own
    if values.dtype.kind == "f":
        np.nan_to_num(scaled, copy=False, nan=low, posinf=high, neginf=low)
    scaled -= np.float32(low)
    scaled *= np.float32((count - 1) / (high - low))
    scaled += np.float32(0.5)
    np.clip(scaled, 0, count - 1, out=scaled)
    return scaled.astype(np.uint8)
