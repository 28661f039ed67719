"""Fewer triangles for a layer's surface, never further from it than a tolerance, its holes and edges exact.

Right triangles that halve at the middle of their longest side (a longest-edge bisection hierarchy, after
Evans, Kirkpatrick and Townsend, *Right-triangulated irregular networks*, 2001) cover the samples. The error
of a triangle is the distance of its middle from the middle of its longest side, plus the greatest error
of its halves: a bound for every place in it, not only for the samples. Both triangles at a longest side
share the greater error, so that they are halved together and no crack opens.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating[Any]]
Flags = NDArray[np.bool_]
Integers = NDArray[np.int64]

#: Side of the largest squares, in quads; a power of two. Larger ones would save next to nothing.
SIDE = 64


def triangles(elevations: Floats, tolerance: float) -> Integers:
    """Triangulate a layer within a tolerance of its whole surface.

    Parameters
    ----------
    elevations : ndarray of shape (rows, columns), float32
        NaN is a hole.
    tolerance : float
        Greatest vertical distance from the surface that has a quad, cut from north-west to south-east,
        wherever four neighbouring samples are there; metres.

    Returns
    -------
    ndarray of shape (T, 3), int64
        Sample numbers (row * columns + column), counter-clockwise seen from above; the triangles cover
        exactly the quads of that surface.
    """
    heights = _padded(elevations)
    there = ~np.isnan(heights)
    whole = there[:-1, :-1] & there[:-1, 1:] & there[1:, :-1] & there[1:, 1:]
    errors = _errors(heights, whole, _twist(heights, whole))
    kept, rest = _refined(errors, whole, tolerance)
    corners = np.concatenate([kept, _smallest(rest, whole, heights.shape[1])])
    return _numbers(corners, heights.shape[1], elevations.shape[1])


def covering(heights: Floats, errors: Floats, tolerance: float) -> tuple[Integers, Flags]:
    """Triangulate squares that have a fan around their middle, within a tolerance of it.

    Parameters
    ----------
    heights : ndarray of shape (rows + 1, columns + 1)
        Of the corners; NaN where no square is.
    errors : ndarray of shape (rows, columns)
        How far the middle of each square is from the middle of the diagonal that :func:`diagonals` gives,
        infinite for one that is to keep its fan; NaN is a hole.
    tolerance : float
        Greatest vertical distance, metres.

    Returns
    -------
    ndarray of shape (T, 3), int64
        Numbers of corners (row * (columns + 1) + column), counter-clockwise seen from above.
    ndarray of shape (rows, columns), bool
        The squares that keep their fan; no triangle covers those.
    """
    padded = _padded(heights)
    inner = _widened(errors, (padded.shape[0] - 1, padded.shape[1] - 1))
    whole = ~np.isnan(inner)
    inner[~whole] = 0
    kept, rest = _refined(_errors(padded, whole, inner), whole, tolerance)
    quad = _quad(rest, padded.shape[1])
    halves = rest[whole.ravel()[quad] & (inner.ravel()[quad] <= tolerance)]
    corners = np.concatenate([kept, _turned(halves, padded.shape[1])])
    is_fan = np.zeros(whole.size, bool)
    is_fan[quad[whole.ravel()[quad] & (inner.ravel()[quad] > tolerance)]] = True
    fans = is_fan.reshape(whole.shape)[: errors.shape[0], : errors.shape[1]]
    return _numbers(corners, padded.shape[1], heights.shape[1]), fans


def _numbers(corners: Integers, width: int, columns: int) -> Integers:
    """Number the corners of triangles in a raster of so many columns instead of the padded one's width."""
    row, column = np.divmod(corners, width)
    numbers: Integers = row * columns + column
    return numbers


def _padded(elevations: Floats) -> Floats:
    """Widen a raster with holes until the squares cover it."""
    rows, columns = (max(1, -(-(side - 1) // SIDE)) * SIDE + 1 for side in elevations.shape)
    return _widened(elevations, (rows, columns))


def _widened(raster: Floats, shape: tuple[int, int]) -> Floats:
    widened = np.full(shape, np.nan, raster.dtype)
    widened[: raster.shape[0], : raster.shape[1]] = raster
    return widened


def _errors(heights: Floats, whole: Flags, inner: Floats) -> Floats:
    """Return the error of the triangles at every sample that is the middle of a longest side.

    ``inner`` has those of the smallest squares, shape (rows - 1, columns - 1).
    """
    errors = np.zeros_like(heights)
    low, high = whole, whole
    for size in (2**power for power in range(1, SIDE.bit_length())):
        half = size // 2
        beside = _at_sides(heights, size, inner, low, high)
        above = _at_sides(heights.T, size, inner.T, low.T, high.T).T
        errors[::size, half::size], errors[half::size, ::size] = beside, above
        inside = np.maximum.reduce([beside[:-1], beside[1:], above[:, :-1], above[:, 1:]])
        low, high = _in_fours(low).all(axis=(1, 3)), _in_fours(high).any(axis=(1, 3))
        inner = _bound(_bend_at_centres(heights, size), inside, high & ~low, high)
        errors[half::size, half::size] = inner
    return errors


def _twist(heights: Floats, whole: Flags) -> Floats:
    """Return how far apart the two ways to cut a quad are, where the hierarchy cuts it the other way."""
    corners = heights[:-1, :-1] + heights[1:, 1:] - heights[:-1, 1:] - heights[1:, :-1]
    return np.where(whole & ~diagonals(whole.shape), np.abs(corners) / 2, np.float32(0))


def diagonals(shape: tuple[int, ...]) -> Flags:
    """Tell the squares that the hierarchy cuts from north-west to south-east from those cut the other way."""
    row, column = np.ogrid[: shape[0], : shape[1]]
    falls: Flags = (row + column) % 2 == 0
    return falls


def _at_sides(heights: Floats, size: int, inner: Floats, low: Flags, high: Flags) -> Floats:
    """Return the errors at the middles of the squares' horizontal sides, where two triangles meet."""
    half = size // 2
    bend = np.abs(heights[::size, half::size] - (heights[::size, :-1:size] + heights[::size, size::size]) / 2)
    around = _in_fours(np.pad(inner, ((1, 1), (0, 0))))
    some = _in_fours(np.pad(high, ((1, 1), (0, 0)))).any(axis=3)
    every = _in_fours(np.pad(low, ((1, 1), (0, 0)))).all(axis=3)
    return _bound(bend, around.max(axis=(1, 3)), (some & ~every).any(axis=1), some.any(axis=1))


def _bend_at_centres(heights: Floats, size: int) -> Floats:
    """Return how far the squares' centres are from the middles of the diagonals that cut them."""
    corner = heights[::size, ::size]
    falling, rising = corner[:-1, :-1] + corner[1:, 1:], corner[:-1, 1:] + corner[1:, :-1]
    cut = np.where(diagonals(falling.shape), falling, rising)
    return np.abs(heights[size // 2 :: size, size // 2 :: size] - cut / 2)


def _bound(bend: Floats, inside: Floats, is_mixed: Flags, has_surface: Flags) -> Floats:
    """Add a triangle's own error to that of its halves; one with surface and hole must be halved."""
    error = np.where(has_surface, bend + inside, np.float32(0))
    error[is_mixed] = np.inf
    return error


def _in_fours(squares: NDArray[Any]) -> Any:
    """View a raster as blocks of two by two, shape (rows / 2, 2, columns / 2, 2)."""
    rows, columns = squares.shape
    return squares.reshape(rows // 2, 2, columns // 2, 2)


def _refined(errors: Floats, whole: Flags, tolerance: float) -> tuple[Integers, Integers]:
    """Halve triangles until all are within the tolerance, or half of a smallest square.

    Return the corners in the padded raster: of those that are within it and not over a hole, ready, and
    of the halves of smallest squares.
    """
    width, flat = errors.shape[1], errors.ravel()
    todo, done = _roots(whole.shape, width), []
    for _ in range(2 * (SIDE.bit_length() - 1)):
        middle = (todo[:, 0] + todo[:, 1]) // 2
        halved = flat[middle] > tolerance
        done.append(todo[~halved])
        a, b, c = todo[halved].T
        m = middle[halved]
        todo = np.concatenate([np.column_stack([c, a, m]), np.column_stack([b, c, m])])
    kept = np.concatenate(done)
    kept = kept[whole.ravel()[_quad(kept, width)]]
    return _turned(kept, width), todo


def _roots(shape: tuple[int, ...], width: int) -> Integers:
    """Cut every largest square in two; the first two corners are the ends of the longest side."""
    row, column = (part.ravel() for part in np.indices((shape[0] // SIDE, shape[1] // SIDE), dtype=np.int64))
    north_west = (row * width + column) * SIDE
    square = [north_west, north_west + SIDE, north_west + SIDE * width, north_west + SIDE * (width + 1)]
    falls = (row + column) % 2 == 0
    nw, ne, sw, se = (np.where(falls, square[i], square[j]) for i, j in ((0, 1), (1, 3), (2, 0), (3, 2)))
    return np.concatenate([np.column_stack([nw, se, sw]), np.column_stack([se, nw, ne])])


def _quad(corners: Integers, width: int) -> Integers:
    """Number a quad (row * quads in a row + column) that each triangle covers or shares in."""
    row, column = (part.sum(axis=1) // 3 for part in np.divmod(corners, width))
    quad: Integers = row * (width - 1) + column
    return quad


def _smallest(corners: Integers, whole: Flags, width: int) -> Integers:
    """Choose among half quads: those with surface, and where both halves are there, cut as the surface is."""
    quad = _quad(corners, width)
    there = whole.ravel()[quad]
    quad, corners = quad[there], corners[there]
    halves = np.bincount(quad, minlength=whole.size)
    row, column = np.divmod(np.flatnonzero(halves == 2), whole.shape[1])
    nw = row * width + column
    sw, se, ne = nw + width, nw + width + 1, nw + 1
    cut = [np.column_stack([nw, sw, se]), np.column_stack([nw, se, ne])]
    return np.concatenate([_turned(corners[halves[quad] == 1], width), *cut])


def _turned(corners: Integers, width: int) -> Integers:
    """Turn triangles counter-clockwise seen from above; rows count southwards."""
    (ra, rb, rc), (ca, cb, cc) = (part.T for part in np.divmod(corners, width))
    is_clockwise = (cb - ca) * (rc - ra) - (rb - ra) * (cc - ca) > 0
    turned = corners.copy()
    turned[is_clockwise] = corners[is_clockwise][:, ::-1]
    return turned
