"""Outlines the selection, and a place that is pointed out, in the three 3-D views."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QTimer, Signal

from stepfield.progress import Progress
from stepfield.reconstruction import Reconstruction
from stepfield.selecting import at_places
from stepfield_app.document import Document
from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.newest import NewestWins
from stepfield_app.render.client import RenderClient
from stepfield_app.render.outline import KINDS, PLACE, SELECTION
from stepfield_app.render.scene import PILLARS, VIEWS
from stepfield_app.requests import Answer
from stepfield_app.scenes.outline import Rim, rim
from stepfield_app.selection import Selection

#: How far behind points and surfaces an outline still counts as seen, in sizes of a compartment: both reach
#: above and below the tops of the pillars.
SLACK = 0.5


#: Milliseconds a selection rests before links are found for what may be done with it next.
AHEAD = 600


@dataclass(frozen=True, eq=False)
class Chosen:
    """Pillars of one reconstruction: a mask of shape (P,)."""

    result: Reconstruction
    mask: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class AtPlaces:
    """Pillars of one reconstruction by where they are: boxes of shape (n, 6), metres, scan coordinates."""

    result: Reconstruction
    boxes: NDArray[np.float64]

    @cached_property
    def mask(self) -> NDArray[np.bool_]:
        """Mask of shape (P,); looked for when first asked for, which is a worker's job."""
        return at_places(self.result, self.boxes)


@dataclass(frozen=True, eq=False)
class _Wish:
    """What to outline, by kind."""

    chosen: Mapping[str, Chosen | AtPlaces]
    origin: NDArray[np.float64]
    visible: tuple[int, ...]


class SelectionFeed(QObject):
    """Keeps the outlines in the 3-D views true to the selection.

    Parameters
    ----------
    document : Document
    selection : Selection
    scene_feed : SceneFeed
        Knows the local origin.
    client : RenderClient
    """

    failed = Signal(object)  # exception

    def __init__(
        self, document: Document, selection: Selection, scene_feed: SceneFeed, client: RenderClient
    ) -> None:
        super().__init__(document)
        self._document, self._selection = document, selection
        self._scene_feed, self._client = scene_feed, client
        self._visible: tuple[int, ...] | None = None
        self._place: Chosen | AtPlaces | None = None
        self._shown: dict[str, Rim | None] = dict.fromkeys(KINDS)
        self._rims = NewestWins[_Wish, dict[str, Rim]](_Outlining(), "outlines in 3-D", self)
        self._rims.answered.connect(self._show)
        self._rims.failed.connect(lambda _, error: self.failed.emit(error))
        self._links = NewestWins[Reconstruction, None](_found_links, "links ahead", self)
        self._ahead = QTimer(self, singleShot=True, interval=AHEAD)
        self._ahead.timeout.connect(self._find_links)
        selection.changed.connect(self._ask)
        selection.changed.connect(self._ahead.start)
        document.answer_changed.connect(self._follow)

    @property
    def is_idle(self) -> bool:
        """Whether everything outlined has been handed over."""
        return not self._rims.busy

    def set_visible(self, layers: tuple[int, ...]) -> None:
        """Outline only pillars of these layers, -1 for Unassigned: those that are shown."""
        if layers != self._visible:
            self._visible = layers
            self._ask()

    def point_out(self, chosen: Chosen | AtPlaces | None) -> None:
        """Outline some pillars in the second colour, or none; a mask lasts until another result comes."""
        if chosen is not self._place:
            self._place = chosen
            self._ask()

    def show_places(self, boxes: NDArray[np.float64] | None) -> None:
        """Outline in the second colour what stands at places now: boxes of shape (n, 6), or none."""
        answer = self._document.answer
        self.point_out(None if boxes is None or answer is None else AtPlaces(answer.result, boxes))

    def close(self) -> None:
        """End the workers."""
        self._ahead.stop()
        self._links.close()
        self._rims.close()

    def _follow(self, answer: Answer | None) -> None:
        """Look at the same places in another result; a mask says nothing of it."""
        place = self._place
        if place is not None and (answer is None or answer.result is not place.result):
            self.show_places(place.boxes if isinstance(place, AtPlaces) else None)

    def _find_links(self) -> None:
        """Find the links while the hand rests: the first growing along a surface would wait for them."""
        selection = self._selection
        if selection.count and selection.result is not None and not self._document.held:
            self._links.ask(selection.result)

    def _ask(self) -> None:
        chosen: dict[str, Chosen | AtPlaces] = {}
        selection = self._selection
        if selection.count and selection.mask is not None and selection.result is not None:
            chosen[SELECTION] = Chosen(selection.result, selection.mask)
        if self._place is not None:
            chosen[PLACE] = self._place
        if not chosen:
            self._rims.cancel()
            self._hand_over({})
            return
        layers = max(len(one.result.layers) for one in chosen.values())
        visible = tuple(range(-1, layers)) if self._visible is None else self._visible
        self._rims.ask(_Wish(chosen, self._scene_feed.origin, visible))

    def _show(self, wish: _Wish, rims: dict[str, Rim]) -> None:
        if wish.origin is self._scene_feed.origin:  # else of a scan that is open no more
            self._hand_over(rims)

    def _hand_over(self, rims: dict[str, Rim]) -> None:
        for kind in KINDS:
            made = rims.get(kind)
            if made is self._shown[kind]:
                continue
            self._shown[kind] = made
            for view in VIEWS:
                self._outline(view, kind, made)

    def _outline(self, view: str, kind: str, made: Rim | None) -> None:
        if made is None:
            self._client.set_outline(view, None, kind=kind)
        elif view == PILLARS:
            self._client.set_outline(view, made.whole, kind=kind)
        else:
            self._client.set_outline(view, made.edges, kind=kind, slack=SLACK * made.cell_size)


def _found_links(result: Reconstruction, progress: Progress) -> None:
    assert result.links is not None  # the result keeps them


class _Outlining:
    """Makes outlines, for one thread at a time; keeps those whose pillars have not changed."""

    def __init__(self) -> None:
        self._made: dict[str, tuple[Chosen | AtPlaces, _Wish, Rim]] = {}

    def __call__(self, wish: _Wish, progress: Progress) -> dict[str, Rim]:
        """Make the outlines of a wish."""
        self._made = {kind: (one, wish, self._rim(kind, one, wish)) for kind, one in wish.chosen.items()}
        return {kind: made for kind, (_, _, made) in self._made.items()}

    def _rim(self, kind: str, chosen: Chosen | AtPlaces, wish: _Wish) -> Rim:
        if kind in self._made:
            before, earlier, made = self._made[kind]
            same = before.mask is chosen.mask and _are_alike(before.result, chosen.result, wish.visible)
            if same and earlier.origin is wish.origin and earlier.visible == wish.visible:
                return made
        made = rim(chosen.result, chosen.mask, wish.origin, wish.visible)
        assert made.whole is not None  # put together here rather than on the thread of the window
        return made


def _are_alike(before: Reconstruction, now: Reconstruction, visible: tuple[int, ...]) -> bool:
    """Whether pillars have the same outline in two results: where all layers are shown, any edit will do."""
    if before is now:
        return True
    layers = set(range(-1, max(len(before.layers), len(now.layers))))
    return before.field is now.field and before.parameters == now.parameters and layers <= set(visible)
