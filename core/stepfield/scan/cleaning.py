"""Cleaning before anything else: crop box, classes, outliers. Off by default, always counted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stepfield.errors import ScanError
from stepfield.parameters import Box, Parameters
from stepfield.progress import Progress, silent
from stepfield.scan.cloud import Numbers
from stepfield.scan.scan import Scan

#: Fewest neighbours within the radius that a point needs to stay (``outliers = radius``).
FEWEST_NEIGHBOURS = 4
#: The radius, in typical distances between neighbouring points.
RADIUS_IN_SPACINGS = 4.0
#: Points used to learn the typical distance.
SPACING_SAMPLE = 20_000
#: A group of at most this many points far above or below everything near it is isolated.
LARGEST_ISOLATED_GROUP = 3
#: How far, in multiples of the middle 98 % of the elevations, isolated points stand off.
ISOLATED_GAP = 0.25


def clean(scan: Scan, parameters: Parameters, progress: Progress = silent) -> Scan:
    """Drop what the parameters ask to drop; raise ScanError when nothing is left."""
    if parameters.crop is not None:
        scan = _left(scan.keep(inside(scan, parameters.crop), "crop"), "the crop box")
    if parameters.classes is not None:
        scan = _left(_of_classes(scan, parameters.classes), "the choice of classes")
    if parameters.outliers != "off":
        progress(0.0, "looking for outliers")
        stray = {"radius": sparse_points, "isolated": isolated_points}[parameters.outliers](scan)
        scan = _left(scan.keep(~stray, "outliers"), "the outlier filter")
    return scan


def inside(scan: Scan, box: Box) -> Numbers:
    """Mask of the points within the closed box (x0, y0, z0, x1, y1, z1), metres."""
    mask = np.ones(len(scan), bool)
    for axis, low, high in zip(scan.axes, box[:3], box[3:], strict=True):
        values = axis.values()
        mask &= (values >= low) & (values <= high)
    return mask


def _of_classes(scan: Scan, classes: tuple[int, ...]) -> Scan:
    codes = scan.attributes.get("classification")
    if codes is None:
        warning = "the scan has no classification; the choice of classes was not applied"
        return replace(scan, warnings=(*scan.warnings, warning))
    return scan.keep(np.isin(codes, classes), "classes")


def sparse_points(scan: Scan) -> Numbers:
    """Mask of the points with too few neighbours within a radius learnt from the scan itself."""
    from scipy.spatial import KDTree  # takes longer to load than most runs need

    points = scan.points() - scan.bounds()[0]
    tree = KDTree(points)
    sample = points[:: max(1, len(points) // SPACING_SAMPLE)]
    spacing = float(np.median(tree.query(sample, k=min(2, len(points)), workers=-1)[0][..., -1]))
    neighbours = tree.query_ball_point(
        points, RADIUS_IN_SPACINGS * spacing, return_length=True, workers=-1
    )  # the point itself is one of them
    return np.asarray(neighbours) <= FEWEST_NEIGHBOURS


def isolated_points(scan: Scan) -> Numbers:
    """Mask of small groups of points far above or below all others near them (birds, reflections).

    The plan is cut into coarse squares of about 100 points; within a square, at most
    ``LARGEST_ISOLATED_GROUP`` lowest or highest points are isolated when a gap of
    ``ISOLATED_GAP`` of the usual elevation range parts them from the rest.
    """
    u, v, z = (axis.above_lowest() for axis in scan.axes)
    low, high = np.percentile(z, [1, 99])
    gap = ISOLATED_GAP * max(float(high - low), np.finfo(float).tiny)
    side = np.sqrt(max(u.max(), 1e-9) * max(v.max(), 1e-9) * 100 / len(z))
    square = np.floor(u / side) * (np.floor(v.max() / side) + 1) + np.floor(v / side)
    order = np.lexsort((z, square))
    first = np.flatnonzero(np.diff(square[order], prepend=-1.0))
    last = np.append(first[1:], len(order))
    stray = np.zeros(len(z), bool)
    for reach in range(1, LARGEST_ISOLATED_GROUP + 1):
        roomy = last - first > 2 * LARGEST_ISOLATED_GROUP
        bottom, top = first[roomy] + reach, last[roomy] - reach
        for group, edge in ((range(-reach, 0), bottom), (range(reach), top)):
            apart = edge[z[order[edge]] - z[order[edge - 1]] > gap]
            for step in group:
                stray[order[apart + step]] = True
    return stray


def _left(scan: Scan, what: str) -> Scan:
    if not len(scan):
        raise ScanError(f"{what} leaves no points of the scan; widen it or leave it out")
    return scan
