"""Evened-out points -> triangles, by ball pivoting in tiles that overlap. Open3D is loaded here only.

Ball pivoting was chosen by measurement (tests/benchmarks/test_complex.py prints it): on rubble and on pipes
it follows the points most closely, with a third of the triangles and half the time of Poisson reconstruction,
which gives the same triangles every time on one thread only; alpha shapes fill what is hollow, a tenth of
their surface is far from any point. What no ball reaches, single points far from all others, it leaves out:
pillars stay there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from stepfield.progress import Progress, part, silent

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: Radii of the balls, in the distance of neighbouring points; the widest bridges gaps of twice its size.
RADII = (1.0, 2.0, 4.0)
#: Neighbours that tell which way the surface looks at a point, and how far they may be, in that distance.
NEIGHBOURS, AROUND = 30, 4.0
#: Points that pass the direction on to each other, so that all look to the same side.
ORIENTING = 12
#: Share of the work that is left after each round.
REST = 0.3
#: Side of a tile, and what it sees beyond its edge, in that distance.
TILE, OVERLAP = 256.0, 8.0
#: Fewer points make no surface.
FEWEST = 4


def pivoted(
    points: Floats, spacing: float, progress: Progress = silent, *, radii: Sequence[float] = RADII
) -> Integers:
    """Join points to triangles.

    Open3D begins no new piece with a wider ball while that one still widens an old piece, so what is sparse
    would be missed wherever something dense is: points that are left are joined again, by the next wider
    balls. Each time those are two, one to begin and one to close gaps: the widest at the rims of dense pieces
    would bridge what is open.

    Every tile is meshed with what lies around it and keeps the triangles that touch its own points, so that
    neighbouring tiles overlap and no crack opens; a triangle that both have is kept once.

    Parameters
    ----------
    points : ndarray of shape (V, 3)
        About ``spacing`` apart; metres.
    spacing : float
    progress : Progress
    radii : sequence of float
        Of the balls, in spacings.

    Returns
    -------
    ndarray of shape (T, 3), int64
    """
    found = np.zeros((0, 3), np.int64)
    for number in range(len(radii)):
        is_left = np.ones(len(points), bool)
        is_left[found] = False
        left = np.flatnonzero(is_left)
        again = part(progress, 1 - REST**number, 1 - REST ** (number + 1))
        balls = radii[number : number + 2]
        found = np.concatenate([found, left[_joined(points[left], spacing, balls, again)]])
    return found


def _joined(points: Floats, spacing: float, radii: Sequence[float], progress: Progress) -> Integers:
    """Join points tile by tile."""
    tiles = list(_tiles(points, TILE * spacing, OVERLAP * spacing))
    found = [np.zeros((0, 3), np.int64)]
    for number, (near, own) in enumerate(tiles):
        progress(number / len(tiles), "meshing complex parts")
        if len(near) >= FEWEST:
            corners = near[_ball_pivoting(points[near], spacing, radii)]
            found.append(corners[own[corners].any(axis=1)])
    return _once_each(np.concatenate(found))


def _tiles(points: Floats, side: float, overlap: float) -> Iterator[tuple[Integers, Flags]]:
    """Yield for every tile of the plan the points in and around it, and which of all are its own."""
    if not len(points):
        return
    place = points[:, :2] - points[:, :2].min(axis=0)
    tile = (place // side).astype(np.int64)
    for east, north in np.unique(tile, axis=0):
        low = np.array([east, north]) * side
        near = ((place >= low - overlap) & (place <= low + side + overlap)).all(axis=1)
        yield np.flatnonzero(near), (tile == (east, north)).all(axis=1)


def _ball_pivoting(points: Floats, spacing: float, radii: Sequence[float]) -> Integers:
    import open3d as o3d

    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points - points.mean(axis=0)))
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamHybrid(AROUND * spacing, NEIGHBOURS))
    try:
        cloud.orient_normals_consistent_tangent_plane(min(ORIENTING, len(points) - 1))
    except RuntimeError:  # points in one plane or on one line have no tetrahedra to pass it along
        cloud.orient_normals_to_align_with_direction([0.0, 0.0, 1.0])
    balls = o3d.utility.DoubleVector([radius * spacing for radius in radii])
    mesh = o3d.geometry.TriangleMesh.create_from_point_cloud_ball_pivoting(cloud, balls)
    return np.asarray(mesh.triangles).astype(np.int64).reshape(-1, 3)


def _once_each(triangles: Integers) -> Integers:
    """Remove triangles that were found before; the order stays."""
    _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    kept: Integers = triangles[np.sort(first)]
    return kept
