"""The window's side of the drawing process: says what to draw, shows what came, never waits."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from PySide6.QtCore import QObject, Signal

from stepfield_app.render.camera import Camera, Size
from stepfield_app.render.outline import SELECTION, Outline
from stepfield_app.render.process import DrawingProcess
from stepfield_app.render.protocol import (
    Array,
    Drawn,
    Dropped,
    Message,
    SetBackground,
    SetOutlines,
    SetScene,
    arrays_of,
    outlines_tree,
    scene_tree,
)
from stepfield_app.render.scene import EMPTY, VIEWS, Frame, Scene, Singles
from stepfield_app.render.shelf import Shelf
from stepfield_app.render.slots import Slots
from stepfield_app.render.store import Store
from stepfield_app.render.view import View


class RenderClient(QObject):
    """Scenes and cameras in, frames out.

    Everything set is remembered and sent again when the drawing process had to be started anew. A frame's
    arrays are never written again as long as the frame, or an array made of it, is alive.
    """

    frame_arrived = Signal(str)
    state_changed = Signal(str)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._store = Store()
        self._shelf = Shelf(self._store, self)
        self._process = DrawingProcess(self._store.folders, self)
        self._views = {name: View(name, Slots(self._store)) for name in VIEWS}
        self._background = (0, 0, 0)
        self._shelf.written.connect(self._use_written)
        self._shelf.failed.connect(self._has_no_room)
        self._process.received.connect(self._receive)
        self._process.state_changed.connect(self._process_changed)

    @property
    def state(self) -> str:
        """starting, running, stopped or failed."""
        return self._process.state

    @property
    def reason(self) -> str:
        """Why it failed, one sentence."""
        return self._process.reason

    @property
    def details(self) -> str:
        """What the drawing process last wrote to its standard error."""
        return self._process.details

    @property
    def process_id(self) -> int:
        """Number of the drawing process, 0 if there is none."""
        return self._process.process_id

    def start(self) -> None:
        """Start the drawing process; returns at once. Tries anew after a failure."""
        self._process.start()

    def share(self, array: Array) -> Array:
        """Return a large array as one that needs no copy for the drawing process; on any thread."""
        return self._shelf.share(array)

    def set_scene(self, view: str, scene: Scene, *, in_full: bool = False) -> None:
        """Show another scene in a view; ``in_full`` without a picture of less detail before."""
        self._views[view].set_scene(scene, in_full=in_full)
        self._advance(view)

    def set_outline(
        self, view: str, segments: Singles | None, *, kind: str = SELECTION, slack: float = 0.0
    ) -> None:
        """Paint another outline over a view, or none; the scene under it is not drawn again.

        Parameters
        ----------
        view : str
        segments : ndarray of shape (n, 2, 3), float32, or None
            Ends in local coordinates, metres; not to be written any more.
        kind : str
            One of :data:`~stepfield_app.render.outline.KINDS`; each has a colour.
        slack : float
            How far behind what is drawn a line still counts as seen, metres.
        """
        outline = None if segments is None or not len(segments) else Outline(segments, slack)
        self._views[view].set_outline(kind, outline)
        self._advance(view)

    def set_camera(self, view: str, camera: Camera, size: Size, moving: bool) -> None:
        """Look from somewhere else; ``size`` in device pixels, ``moving`` while a hand moves."""
        self._views[view].set_camera(camera, size, moving)
        self._advance(view)

    def set_background(self, colour: tuple[int, int, int]) -> None:
        """Set the colour of what nothing covers, red, green, blue, 0 to 255."""
        if colour == self._background:
            return
        self._background = colour
        self._process.send(SetBackground(colour))
        for view in self._views.values():
            view.change()
        self._advance_all()

    def show(self, views: Sequence[str]) -> None:
        """Draw these views and no others."""
        for name, view in self._views.items():
            view.shown = name in views
        self._advance_all()

    def frame(self, view: str) -> Frame | None:
        """Return the newest frame of a view.

        Its picture is smaller than asked for where a slow device could not keep up with a moving hand.
        """
        return self._views[view].frame

    def drawn_scene(self, view: str) -> Scene:
        """Return what the newest frame of a view shows."""
        return self._views[view].frame_scene

    def is_at_rest(self) -> bool:
        """Whether every visible view shows its newest scene and camera in full detail."""
        return all(view.is_at_rest for view in self._views.values() if view.shown)

    def close(self) -> None:
        """End the drawing process and remove its files."""
        self._process.close()
        self._shelf.close()
        self._store.close()

    def _process_changed(self, state: str) -> None:
        for view in self._views.values():
            view.forget_sent()
        if state == "running":
            self._process.send(SetBackground(self._background))
            self._advance_all()
        self.state_changed.emit(state)

    def _use_written(self) -> None:
        """Send what waited for an array, and forget those that something newer has replaced meanwhile."""
        self._shelf.keep(self._needed())
        self._advance_all()

    def _advance_all(self) -> None:
        for name in self._views:
            self._advance(name)

    def _advance(self, name: str) -> None:
        """Send what a view needs next, if anything and if it is time."""
        if self._process.state != "running":
            return
        try:
            self._send_next(self._views[name])
        except OSError as error:
            self._has_no_room(str(error.strerror))

    def _has_no_room(self, why: str) -> None:
        self._process.give_up(f"The 3-D views cannot write their data: {why}.")

    def _send_next(self, view: View) -> None:
        if not view.shown:
            self._release_hidden(view)
            return
        self._send_outlines(view)
        if view.may_ask and self._has_sent_scene(view):
            self._process.send(view.ask())

    def _has_sent_scene(self, view: View) -> bool:
        """Send the scene if it is not sent yet; False while its arrays are being written."""
        if view.scene is view.sent:
            return True
        if not self._shelf.has(arrays_of(view.scene)):
            return False
        self._send_scene(view, view.scene)
        return True

    def _send_outlines(self, view: View) -> None:
        """Send the outlines unless they are sent already or still being written."""
        outlines = view.outlines
        if outlines != view.sent_outlines and self._shelf.has(one.segments for one in outlines.values()):
            self._process.send(SetOutlines(view.name, outlines_tree(outlines, self._shelf.where)))
            view.sent_outlines = outlines
            self._shelf.keep(self._needed())

    def _release_hidden(self, view: View) -> None:
        """Let the drawing process forget a scene that was replaced while its view is hidden."""
        if view.sent not in (None, view.scene, EMPTY):
            self._send_scene(view, EMPTY)

    def _send_scene(self, view: View, scene: Scene) -> None:
        self._process.send(SetScene(view.name, scene_tree(scene, self._shelf.where)))
        view.sent = scene
        self._shelf.keep(self._needed())

    def _needed(self) -> Iterable[Array]:
        for view in self._views.values():
            yield from arrays_of(view.scene)
            yield from arrays_of(view.sent or EMPTY)
            for outline in (*view.outlines.values(), *view.sent_outlines.values()):
                yield outline.segments

    def _receive(self, message: Message) -> None:
        if isinstance(message, Drawn):
            if self._views[message.view].take(message):
                self.frame_arrived.emit(message.view)
        elif isinstance(message, Dropped):
            self._views[message.view].drop(message.number)
        else:
            return
        self._advance(message.view)
