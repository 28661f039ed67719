"""Cleaning before anything else: crop box, classes, outliers. Off by default, always counted."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np

from stepfield.errors import ScanError
from stepfield.parameters import Box, Parameters
from stepfield.progress import Progress, silent
from stepfield.scan.cloud import CHUNK, Numbers
from stepfield.scan.scan import Scan

#: Neighbours that a point needs within the radius (``outliers = radius``) ...
FEWEST_NEIGHBOURS = 4
#: ... which is this many times as far as nearly all points (``USUAL_SHARE``) have to go for them.
RADIUS_FACTOR, USUAL_SHARE = 2.0, 0.95
#: Points used to learn the radius.
SAMPLE = 20_000
#: Points of a neighbourhood up to which it is isolated (``outliers = isolated``) ...
LARGEST_ISOLATED_GROUP = 3
#: ... in boxes of this share of the usual elevation range, and at least so many times the usual spacing.
BOX_SHARE, BOX_SPACINGS = 1 / 30, 2.0
#: Boxes along a side at most: their numbers must fit 63 bits.
MOST_BOXES = 1_000_000


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
        least, greatest = axis.bounds()
        if low <= least and greatest <= high:
            continue  # a slab of heights need not look at places
        for at in range(0, len(scan), CHUNK):
            values = axis.values(slice(at, at + CHUNK))
            mask[at : at + CHUNK] &= (values >= low) & (values <= high)
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
    if len(points) <= FEWEST_NEIGHBOURS:
        return np.zeros(len(points), bool)
    tree = KDTree(points, balanced_tree=False, compact_nodes=False)
    place = FEWEST_NEIGHBOURS + 1  # the point itself is its own nearest
    sample = points[:: max(1, len(points) // SAMPLE)]
    usual = np.quantile(tree.query(sample, [place], workers=-1)[0], USUAL_SHARE)
    radius = max(RADIUS_FACTOR * float(usual), np.finfo(float).tiny)
    distance, _ = tree.query(points, [place], distance_upper_bound=radius, workers=-1)
    sparse: Numbers = np.isinf(distance[:, 0])
    return sparse


def isolated_points(scan: Scan) -> Numbers:
    """Mask of the points that stand alone: birds, reflections below the ground, dust.

    Space is cut into boxes; a point is isolated when its own and the 26 boxes around hold no more than
    ``LARGEST_ISOLATED_GROUP`` points.
    """
    distances = [axis.above_lowest() for axis in scan.axes]
    low, high = np.quantile(distances[2], [0.005, 0.995])
    plan = max(float(distances[0].max() * distances[1].max()), 1e-12)
    side = max(BOX_SHARE * float(high - low), BOX_SPACINGS * (plan / len(scan)) ** 0.5)
    # A free box on every side keeps neighbours from wrapping round, and as few boxes as int64 can number.
    side = max(side, max(float(d.max()) for d in distances) / MOST_BOXES)
    x, y, z = ((distance / side).astype(np.int64) + 1 for distance in distances)
    wide, high_boxes = int(y.max()) + 2, int(z.max()) + 2
    box, at, held = np.unique((x * wide + y) * high_boxes + z, return_inverse=True, return_counts=True)
    around = np.zeros(len(box), np.int64)
    for dx, dy, dz in product((-1, 0, 1), repeat=3):
        neighbour = box + (dx * wide + dy) * high_boxes + dz
        place = np.minimum(np.searchsorted(box, neighbour), len(box) - 1)
        around += np.where(box[place] == neighbour, held[place], 0)
    isolated: Numbers = (around <= LARGEST_ISOLATED_GROUP)[at]
    return isolated


def _left(scan: Scan, what: str) -> Scan:
    if not len(scan):
        raise ScanError(f"{what} leaves no points of the scan; widen it or leave it out")
    return scan
