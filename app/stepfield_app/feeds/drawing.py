"""From an answer to what the three 3-D views draw; runs on a worker, remembers what has not changed."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepfield.layers import UNASSIGNED
from stepfield.progress import Progress
from stepfield.scan import Scan
from stepfield_app.feeds.wish import Drawn, Picture, Wish
from stepfield_app.ramps import ramp
from stepfield_app.render.scene import CLOUD, PILLARS, RECONSTRUCTION, Lines, Points, Scene, Triangles
from stepfield_app.scenes import blocks, colouring, surfaces
from stepfield_app.scenes.cloud import Cloud, cloud, points
from stepfield_app.scenes.complex_parts import complex_mesh
from stepfield_app.scenes.ground import crosses, ground
from stepfield_app.scenes.legend import Legend
from stepfield_app.scenes.thinned import stride_for
from stepfield_app.theme import COMPLEX_COLOUR, FILLED_COLOUR, rgb
from stepfield_app.wording import counted

Array = NDArray[Any]
Floats = NDArray[np.float64]
#: What the blocks and surfaces can show, with the names offered to the operator.
SOLID_MODES = (("layer", "Layer"), ("height", "Height"))
#: As what the layers are drawn, with the names offered to the operator and what each is.
WAYS = (
    ("edges", "Edges", "exactly the ground of the pillars"),
    ("simulator", "Simulator", "a vertex a pixel: sides cut, thin surfaces gone"),
    ("pillars", "Pillars", "blocks from the base plane up"),
)
#: Blocks, or pixels of the layers, while a hand moves: about what a moving picture shows of them.
QUICK_BLOCKS = 40_000
#: Blocks narrower than so many pixels are joined.
FINE = 2.0
#: Size of a mark as a share of the scan's diagonal.
MARK_SHARE = 0.004
POINT_MODES = {
    "height": "Height",
    "layer": "Layer",
    "rgb": "RGB",
    "intensity": "Intensity",
    "class": "Class",
    "single": "Plain",
}


class Drawing:
    """Turns wishes into scenes, for one thread at a time.

    The cloud is kept while its scan is the same: it is by far the largest part. A preview, which has only
    some of the points, leaves it as it is.

    Parameters
    ----------
    share : callable
        Puts a large array where the drawing process can read it; see :class:`RenderClient`.
    tell : callable
        Takes a wish and each picture of it, by view, as soon as it is made: on the worker's thread.
    """

    def __init__(
        self, share: Callable[[Array], Array], tell: Callable[[Wish, dict[str, Picture]], None] | None = None
    ) -> None:
        self._share, self._tell = share, tell
        self._cloud: Cloud | None = None
        self._parts: dict[str, tuple[tuple[Any, ...], Any]] = {}

    def forget(self) -> None:
        """Give the memory of the last scan back."""
        self._cloud = None
        self._parts.clear()

    def __call__(self, wish: Wish, progress: Progress) -> Drawn:
        """Draw the views that are shown."""
        start, shown = time.perf_counter(), self._shown(wish)
        draw = {CLOUD: self._of_cloud, PILLARS: self._of_pillars, RECONSTRUCTION: self._of_layers}
        pictures = {}
        for done, name in enumerate(wish.views):
            progress(done / len(wish.views), f"drawing {name}")
            pictures[name] = draw[name](wish)
            if self._tell is not None:
                self._tell(wish, {name: pictures[name]})
        return Drawn(pictures, shown, time.perf_counter() - start)

    def _shown(self, wish: Wish) -> Cloud:
        """Return the cloud of an exact answer, or the one before while there is but a preview."""
        if (
            not wish.answer.request.quick
            or self._cloud is None
            or not np.array_equal(self._cloud.origin, wish.origin)
        ):
            self._cloud = self._placed(wish.result.scan, wish.origin)
        return self._cloud

    def _of_cloud(self, wish: Wish) -> Picture:
        shown = self._shown(wish)
        colours = self._coloured(shown.scan, wish)
        key = (shown, colours, wish.theme, wish.marks)
        # The very same scene need not be drawn again: of many points that takes seconds.
        picture: Picture = self._once(CLOUD, key, lambda: _cloud_picture(wish, shown, colours))
        return picture

    def _placed(self, scan: Scan, origin: Floats) -> Cloud:
        def make() -> Cloud:
            self._cloud = None  # the old places go before the new ones take their memory
            made = cloud(scan, origin)
            return replace(made, places=self._share(made.places))

        placed: Cloud = self._once("places", (scan, origin), make)
        return placed

    def _coloured(self, scan: Scan, wish: Wish) -> colouring.Colouring:
        mode = wish.modes[CLOUD]
        of_layers = (wish.result, wish.colours) if mode == "layer" else ()
        plain = wish.theme.muted

        def make() -> colouring.Colouring:
            made = colouring.coloured(scan, mode, result=wish.result, colours=wish.colours, plain=plain)
            return replace(made, codes=self._share(made.codes))

        made: colouring.Colouring = self._once("colours", (scan, mode, plain, *of_layers), make)
        return made

    def _of_pillars(self, wish: Wish) -> Picture:
        mode = wish.modes[PILLARS]
        stride = stride_for(len(wish.result.field), QUICK_BLOCKS) if wish.quick else 1
        joined = 0 if wish.quick else wish.joined
        return self._solid(
            wish,
            PILLARS,
            lambda: blocks.blocks(
                wish.result, wish.origin, wish.colours, wish.visible, mode=mode, stride=stride, joined=joined
            ),
        )

    def _of_layers(self, wish: Wish) -> Picture:
        mode = wish.modes[RECONSTRUCTION]
        most, least = QUICK_BLOCKS if wish.quick else None, 1 << wish.joined
        meshed = wish.meshed
        result = wish.result if meshed is None else meshed.rest_of(wish.result)

        def make() -> tuple[Triangles, ...]:
            drawn = surfaces.surfaces(
                *(result, wish.origin, wish.colours, wish.visible, wish.way, mode, most, least),
                sampled=wish.quick,
            )
            if meshed is None:
                return drawn
            span = blocks.local_span(wish.result, wish.origin) if mode == "height" else None
            mesh = complex_mesh(meshed, wish.origin, span)
            return tuple(surfaces.merged([level, mesh]) for level in drawn)

        return self._solid(wish, RECONSTRUCTION, make)

    def _solid(self, wish: Wish, view: str, make: Callable[[], tuple[Triangles, ...]]) -> Picture:
        mode, is_layers = wish.modes[view], view == RECONSTRUCTION
        detail = f"{wish.quick} {wish.joined} {wish.way if is_layers else None}"
        meshed = wish.meshed if is_layers else None
        key = wish.result, mode, wish.colours, wish.visible, detail, meshed
        meshes = self._once(view, key, lambda: tuple(self._shared(mesh) for mesh in make()))
        legend = _heights(wish, view) if mode == "height" else _layers(wish, view)
        return Picture(_scene(wish, self._shown(wish), meshes=meshes), legend)

    def _shared(self, mesh: Triangles) -> Triangles:
        share = self._share
        return Triangles(share(mesh.vertices), share(mesh.triangles), share(mesh.colours), mesh.solid)

    def _once(self, name: str, key: tuple[Any, ...], make: Callable[[], Any]) -> Any:
        """Make a part unless it was made from these very values last time; keeping them keeps them apart."""
        before = self._parts.pop(name, None)
        if (
            before is not None
            and len(before[0]) == len(key)
            and all(_same(*pair) for pair in zip(before[0], key, strict=True))
        ):
            self._parts[name] = before
            return before[1]
        del before  # the old part goes before the new one takes its memory
        made = make()
        self._parts[name] = (key, made)
        return made


def joins_for(cell_size: float, grain: float) -> int:
    """How often compartments can be joined until they are ``FINE`` pixels wide, of ``grain`` metres each."""
    return max(0, math.floor(math.log2(FINE * grain / cell_size)))


def _same(one: Any, other: Any) -> bool:
    """Whether two values are one and the same, or short and equal."""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return one is other or (one.size < 10_000 and np.array_equal(one, other))
    return one is other or (isinstance(one, str | tuple) and bool(one == other))


def _cloud_picture(wish: Wish, shown: Cloud, colours: colouring.Colouring) -> Picture:
    scene = _scene(wish, shown, points=points(shown, colours))
    if wish.marks is not None:
        low, high = shown.box
        marks = crosses(
            wish.marks - wish.origin, MARK_SHARE * float(np.linalg.norm(high - low)), wish.theme.error
        )
        scene = replace(scene, lines=(*scene.lines, marks))
    return Picture(scene, colours.legend)


def _scene(
    wish: Wish, shown: Cloud, *, points: Points | None = None, meshes: tuple[Triangles, ...] = ()
) -> Scene:
    """Frame nearly all points, over a grid that lies below every one."""
    low, high = shown.core
    lowest = np.array([low[0], low[1], shown.box[0][2]])
    lines: tuple[Lines, ...] = (ground(lowest, high, wish.theme, wish.origin),)
    return Scene(points, meshes, lines, low, high)


def _heights(wish: Wish, view: str) -> Legend:
    low, high = blocks.height_range(wish.result)
    note = "cyan: filled" if _shows_filled(wish, view) else ""
    return Legend("Elevation", "m", ramp("height"), low=low, high=high, note=note)


def _layers(wish: Wish, view: str) -> Legend:
    """Name the layers that are drawn; what is in no layer stands among the pillars only."""
    result, colours = wish.result, wish.colours
    names = {layer.index: layer.name for layer in result.layers}
    if result.layering.unassigned and view == PILLARS:
        names[UNASSIGNED] = "Unassigned"
    entries = []
    for index in sorted((index for index in wish.visible if index in names), reverse=True):
        red, green, blue = (int(part) for part in colours[index])
        entries.append(((red, green, blue), names[index]))
    if wish.meshed is not None and view == RECONSTRUCTION:
        entries.insert(0, (rgb(COMPLEX_COLOUR), f"Complex: {counted(wish.meshed.parts.count, 'pillar')}"))
    if _shows_filled(wish, view):
        entries.append((rgb(FILLED_COLOUR), "Filled"))
    return Legend("Layer", entries=tuple(entries))


def _shows_filled(wish: Wish, view: str) -> bool:
    """Whether anything that was filled is drawn."""
    if view != RECONSTRUCTION or wish.way == "pillars":
        return False
    return any(len(layer.filled.compartment) for layer in wish.result.layers if layer.index in wish.visible)
