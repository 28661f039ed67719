"""Shows an edit in the 3-D views at once, in the pictures that are there, until its own are drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from weakref import WeakKeyDictionary

from PySide6.QtCore import QObject, Signal

from stepfield.progress import Progress
from stepfield_app.document import Document
from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.feeds.wish import Picture, Wish
from stepfield_app.newest import NewestWins
from stepfield_app.render.client import RenderClient
from stepfield_app.render.scene import VIEWS, Bytes, Frame, Scene
from stepfield_app.scenes.recolour import Coloured, Recolouring, recoloured
from stepfield_app.views.trio import Trio


@dataclass(frozen=True, eq=False)
class _Task:
    """A picture of one wish, to be shown as of another."""

    frame: Frame
    drawn: Wish
    now: Wish


class RecolourFeed(QObject):
    """Gives what an edit has moved the colour of its new layer, in the pictures that show it as it was.

    Parameters
    ----------
    document : Document
    trio : Trio
    client : RenderClient
    scene_feed : SceneFeed
    """

    failed = Signal(object)  # exception

    def __init__(self, document: Document, trio: Trio, client: RenderClient, scene_feed: SceneFeed) -> None:
        super().__init__(trio)
        self._document, self._trio, self._client, self._scene_feed = document, trio, client, scene_feed
        self._wishes: WeakKeyDictionary[Scene, Wish] = WeakKeyDictionary()
        self._now: Wish | None = None
        self._done: dict[str, tuple[Frame, Wish]] = {}
        self._worker = NewestWins[dict[str, _Task], dict[str, Bytes]](_Recolouring(), "recolouring", self)
        self._worker.answered.connect(self._show)
        self._worker.failed.connect(lambda _, error: self.failed.emit(error))
        scene_feed.handed_over.connect(self._note)
        document.answer_changed.connect(lambda _: self._follow())
        client.frame_arrived.connect(lambda _: self._ask())

    @property
    def is_idle(self) -> bool:
        """Whether nothing is being recoloured."""
        return not self._worker.busy

    @property
    def is_current(self) -> bool:
        """Whether every picture shows the newest result, be it recoloured or drawn."""
        now = self._document.answer
        for view in self._trio.shown:
            drawn = self._wishes.get(self._client.drawn_scene(view))
            done = self._done.get(view)
            is_drawn = drawn is not None and (drawn.answer is now or drawn.modes[view] != "layer")
            is_done = done is not None and done[0] is self._client.frame(view) and done[1].answer is now
            if not (is_drawn or is_done):
                return False
        return True

    def close(self) -> None:
        """End the worker."""
        self._worker.close()

    def _note(self, wish: Wish, pictures: Mapping[str, Picture]) -> None:
        """Remember what a scene shows for as long as there is a picture of it."""
        for picture in pictures.values():
            if wish.quick:
                self._wishes.pop(picture.scene, None)
            else:
                self._wishes[picture.scene] = wish

    def _follow(self) -> None:
        """Recolour what is there, unless a hand moves: then the next result comes in a moment."""
        answer = self._document.answer
        is_edit = answer is not None and not self._document.held and not answer.request.quick
        self._now = self._scene_feed.wish if is_edit else None
        self._ask()

    def _ask(self) -> None:
        """Ask for what is not shown as it should be; show the rest as it was drawn."""
        tasks = {view: task for view in VIEWS if (task := self._task(view)) is not None}
        for view in VIEWS:
            if view not in tasks:
                self._done.pop(view, None)
                self._trio.canvases[view].recoloured.clear()
        due = {view: task for view, task in tasks.items() if self._done.get(view) != (task.frame, task.now)}
        if due:
            self._worker.ask(due)

    def _task(self, view: str) -> _Task | None:
        now, frame = self._now, self._client.frame(view)
        drawn = self._wishes.get(self._client.drawn_scene(view))
        if now is None or drawn is None or frame is None or frame.depth is None:
            return None
        if drawn.answer is now.answer or not drawn.modes[view] == now.modes[view] == "layer":
            return None
        return _Task(frame, drawn, now)

    def _show(self, tasks: Mapping[str, _Task], made: Mapping[str, Bytes]) -> None:
        for view, task in tasks.items():
            if self._client.frame(view) is not task.frame or self._now is not task.now:
                continue
            self._done[view] = task.frame, task.now
            if view in made:
                self._trio.canvases[view].recoloured.set(task.frame, made[view])
            else:
                self._trio.canvases[view].recoloured.clear()
        if not self._worker.busy:
            self._ask()


class _Recolouring:
    """Recolours pictures, for one thread at a time; remembers the last edit, which all views show."""

    def __init__(self) -> None:
        self._last: tuple[Wish, Wish, Recolouring | None] | None = None

    def forget(self) -> None:
        """Give the memory of the last scan back."""
        self._last = None

    def __call__(self, tasks: Mapping[str, _Task], progress: Progress) -> dict[str, Bytes]:
        """Return the pictures in which something changes."""
        made = {}
        for view, task in tasks.items():
            progress(0.0, "recolouring")
            change = self._change(task.drawn, task.now)
            if change is not None and task.frame.depth is not None:
                made[view] = recoloured(task.frame.pixels, task.frame.depth, task.frame.camera, change)
        return made

    def _change(self, drawn: Wish, now: Wish) -> Recolouring | None:
        if self._last is None or self._last[0] is not drawn or self._last[1] is not now:
            change = Recolouring.between(_coloured(drawn), _coloured(now), now.origin, drawn.joined)
            self._last = drawn, now, change
        return self._last[2]


def _coloured(wish: Wish) -> Coloured:
    return Coloured(wish.result, wish.colours, wish.visible)
