"""Places where an operator should look: a choice of layer was close, a surface is cut, a pillar stands alone.

Nothing here is wrong by itself. *Close*: another layer that the pillar could be in has an average elevation
nearly as near (5.3.3). *Seams*: two pillars that continue each other lie in two layers. *Isolated*: the
pillar continues no other of its layer. Pillars that touch make one place.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepfield.layers import UNASSIGNED
from stepfield.progress import Progress, silent
from stepfield.reconstruction import Reconstruction
from stepfield.touching import Groups

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

CLOSE, SEAMS, ISOLATED = KINDS = ("close", "seams", "isolated")
#: How much a pillar weighs: a cut surface is a hole in the simulator, a lone pillar often only noise.
WEIGHT = {CLOSE: 2, SEAMS: 3, ISOLATED: 1}
#: Close means in the middle so much of the way from one layer's average to the other's.
MIDDLE = 0.2
#: More places of a kind than this are counted, not listed.
MOST_PLACES = 500


@dataclass(frozen=True, eq=False)
class Place:
    """Suspicious pillars that touch.

    Attributes
    ----------
    kind : str
        One of :data:`KINDS`.
    pillars : ndarray of shape (n,), int64
        Indices into the step-field, ascending.
    centre : tuple of 3 floats
        Top of the pillar nearest to their middle, scan coordinates, metres.
    box : tuple of 6 floats
        x0, y0, x1, y1, z_low, z_high of all of them.
    layer : int
        That most of them are in.
    sentence : str
        What is suspicious, without a full stop.
    """

    kind: str
    pillars: Integers
    centre: tuple[float, float, float]
    box: tuple[float, ...]
    layer: int
    sentence: str


@dataclass(frozen=True, eq=False)
class Suspects:
    """What is suspicious in a reconstruction.

    Attributes
    ----------
    masks : mapping of str to ndarray of shape (P,), bool
        By kind; read-only.
    places : tuple of Place
        The most serious first.
    found : mapping of str to int
        How many places there are of each kind, listed or not.
    """

    masks: Mapping[str, Mask]
    places: tuple[Place, ...]
    found: Mapping[str, int]


def suspects(result: Reconstruction, progress: Progress = silent, most: int = MOST_PLACES) -> Suspects:
    """Find what is suspicious.

    Parameters
    ----------
    result : Reconstruction
    progress : Progress
    most : int
        Places of each kind at most.
    """
    progress(0.0, "looking for suspicious places")
    other = nearly_in(result)
    progress(0.2, "looking for suspicious places")
    masks = {CLOSE: other != UNASSIGNED, SEAMS: at_seams(result), ISOLATED: isolated(result)}
    progress(0.7, "looking for suspicious places")
    reach = max(float(result.parameters.link_step), result.field.compartments.grid.cell_size)
    groups = {kind: Groups.of(result.field, np.flatnonzero(mask), reach) for kind, mask in masks.items()}
    telling = {
        CLOSE: _close_sentence(result, other),
        SEAMS: _seam_sentence(result),
        ISOLATED: _lone_sentence(result),
    }
    places = [
        _place(result, kind, pillars, telling[kind])
        for kind in KINDS
        for pillars in groups[kind].largest(most)
    ]
    places.sort(key=lambda place: -WEIGHT[place.kind] * len(place.pillars))
    for mask in masks.values():
        mask.flags.writeable = False
    return Suspects(masks, tuple(places), {kind: len(of) for kind, of in groups.items()})


# --- The three kinds ----------------------------------------------------------------------------------------


def nearly_in(result: Reconstruction) -> Integers:
    """Find the layer that each pillar is nearly in: another one whose average is about as near.

    Only layers count that are free in the pillar's compartment and keep the order of heights there. A pillar
    that was put elsewhere by hand is where it should be.

    Returns
    -------
    ndarray of shape (P,), int64
        ``UNASSIGNED`` for pillars whose layer is clear.
    """
    averages, order = _ascending_averages(result)
    nearly = np.full(len(result.field), UNASSIGNED)
    layer = result.layering.layer
    chosen = np.flatnonzero((layer != UNASSIGNED) & ~result.layering.in_obstacles())
    if not len(chosen):
        return nearly
    place = np.argsort(order)[layer[chosen]]  # of its layer among the averages, from the lowest
    elevation = result.field.elevation[chosen]
    free_below, free_above = _free_places(result.field.compartment[chosen], place, len(averages))
    share = np.full(len(chosen), (1 - MIDDLE) / 2)
    for step, is_free in ((-1, free_below), (1, free_above)):
        beside = np.clip(place + step, 0, len(averages) - 1)
        apart = averages[beside] - averages[place]
        with np.errstate(divide="ignore", invalid="ignore"):
            along = (elevation - averages[place]) / apart
        better = is_free & (along > share) & (apart != 0)
        share[better] = along[better]
        nearly[chosen[better]] = order[beside[better]]
    nearly[_moved_by_hand(result)] = UNASSIGNED
    return nearly


def _ascending_averages(result: Reconstruction) -> tuple[Floats, Integers]:
    """Average elevations in ascending order, and their layers; empty ones and obstacles last, as NaN."""
    averages = result.layering.averages(result.field.elevation)
    averages[list(result.layering.obstacles)] = np.nan
    order = np.argsort(averages, kind="stable")
    return averages[order], order


def _free_places(compartment: Integers, place: Integers, count: int) -> tuple[Mask, Mask]:
    """Tell whether the place below and the one above are free in the compartment, shape (n,) each."""
    same = compartment[1:] == compartment[:-1]
    is_free_below, is_free_above = place > 0, place < count - 1
    is_free_below[1:] &= ~same | (place[:-1] < place[1:] - 1)
    is_free_above[:-1] &= ~same | (place[1:] > place[:-1] + 1)
    return is_free_below, is_free_above


def _moved_by_hand(result: Reconstruction) -> Mask:
    """Mask of pillars that are elsewhere than most of the layer they were put in at first."""
    first, now = result.automatic.layer, result.layering.layer
    if first is now:
        return np.zeros(len(now), bool)
    wide = int(now.max(initial=0)) + 2
    held = np.bincount((first + 1) * wide + now + 1, minlength=(int(first.max(initial=0)) + 2) * wide)
    became: Integers = held.reshape(-1, wide).argmax(axis=1) - 1
    moved: Mask = np.not_equal(became[first + 1], now)
    return moved


def at_seams(result: Reconstruction) -> Mask:
    """Mask of the pillars at both sides of seams."""
    mask = np.zeros(len(result.field), bool)
    mask[result.seams.reshape(-1)] = True
    return mask


def isolated(result: Reconstruction) -> Mask:
    """Mask of the pillars in a layer that are linked to no other of it."""
    layer = result.layering.layer
    one, other = result.links.T
    within = layer[one] == layer[other]
    mask: Mask = (layer != UNASSIGNED) & ~result.layering.in_obstacles()
    mask[one[within]] = False
    mask[other[within]] = False
    return mask


# --- Places -------------------------------------------------------------------------------------------------


def _place(result: Reconstruction, kind: str, pillars: Integers, told: Callable[[Integers], str]) -> Place:
    field = result.field
    boxes = field.boxes(pillars)
    tops = field.elevation[pillars] + field.compartments.lowest
    middles = np.column_stack([(boxes[:, :2] + boxes[:, 2:4]) / 2, tops])
    x, y, z = middles[np.square(middles - middles.mean(axis=0)).sum(axis=1).argmin()].tolist()
    low, high = boxes.min(axis=0), boxes.max(axis=0)
    box = (*low[:2].tolist(), *high[2:4].tolist(), float(low[4]), float(high[5]))
    layer = int(np.bincount(result.layering.layer[pillars]).argmax())
    return Place(kind, pillars, (x, y, z), box, layer, told(pillars))


# --- Sentences ----------------------------------------------------------------------------------------------


def _close_sentence(result: Reconstruction, other: Integers) -> Callable[[Integers], str]:
    def told(pillars: Integers) -> str:
        own, nearly = (_common(result, of[pillars]) for of in (result.layering.layer, other))
        verb = "fits" if len(pillars) == 1 else "fit"
        return f"{_pillars(pillars)} of {own} {verb} {nearly} nearly as well"

    return told


def _seam_sentence(result: Reconstruction) -> Callable[[Integers], str]:
    def told(pillars: Integers) -> str:
        held = np.bincount(result.layering.layer[pillars])
        one, other = sorted(np.argsort(-held, kind="stable")[:2].tolist())
        names = result.layers[one].name, result.layers[other].name
        return (
            f"{_pillars(pillars)} of {names[0]} and {names[1]} continue each other: the surface is cut here"
        )

    return told


def _lone_sentence(result: Reconstruction) -> Callable[[Integers], str]:
    def told(pillars: Integers) -> str:
        own = _common(result, result.layering.layer[pillars])
        rest = "s no other of its layer" if len(pillars) == 1 else " no others of their layer"
        return f"{_pillars(pillars)} of {own} continue{rest}"

    return told


def _pillars(pillars: Integers) -> str:
    return "1 pillar" if len(pillars) == 1 else f"{len(pillars)} pillars"


def _common(result: Reconstruction, layer: Integers) -> str:
    """Name of the layer that is there most often."""
    return result.layers[int(np.bincount(layer).argmax())].name
