"""The drawing process: ``python -m stepfield_app.render.server FOLDER...``, told what to draw by its input.

It never waits for the window and ends with it. The folders are those of the window's files, which are removed
if the window was killed.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from threading import Lock
from typing import Any
from weakref import WeakValueDictionary

from stepfield_app.render import picture
from stepfield_app.render.canvas import Canvas, load, rounded_up
from stepfield_app.render.detail import Overtaken
from stepfield_app.render.inbox import Inbox
from stepfield_app.render.outline import Outline
from stepfield_app.render.pace import Pace
from stepfield_app.render.picture import Picture
from stepfield_app.render.plate import Plate
from stepfield_app.render.protocol import (
    Array,
    Draw,
    Drawn,
    Dropped,
    Message,
    Ready,
    SetBackground,
    SetOutlines,
    SetScene,
    Unusable,
    camera_of,
    frame_bytes,
    line,
    outlines_of,
    scene_of,
)
from stepfield_app.render.scene import EMPTY
from stepfield_app.render.store import mapped, mapped_bytes, remove
from stepfield_app.render.subject import Subject
from stepfield_app.spare import give_back, keep
from stepfield_app.urgency import give_way_altogether

Say = Callable[[Message], None]


class Canvases:
    """One canvas a view and scale; if one no longer fits all go, for closing one ends them all."""

    def __init__(self, library: Any) -> None:
        self._library = library
        self._canvases: dict[tuple[str, int], Canvas] = {}

    def fitting(self, view: str, scale: int, size: tuple[int, int]) -> tuple[Canvas, bool]:
        """Return the canvas to draw on, and whether it is new."""
        needed = rounded_up(size)
        canvas = self._canvases.get((view, scale))
        if canvas and canvas.size == needed:
            return canvas, False
        if canvas:
            self._close()
        self._canvases[view, scale] = made = Canvas(self._library, needed)
        return made, True

    def _close(self) -> None:
        for canvas in self._canvases.values():
            canvas.close()
        self._canvases.clear()


class Studio:
    """What is to be drawn, view by view, and the drawing of it."""

    def __init__(self, library: Any, inbox: Inbox, say: Say) -> None:
        self._inbox, self._say = inbox, say
        self._canvases = Canvases(library)
        self._background = (0, 0, 0)
        self._subjects: dict[str, Subject] = {}
        self._outlines: dict[str, dict[str, Outline]] = {}
        self._plates: dict[str, Plate] = {}
        self._paces: dict[str, Pace] = {}
        self._waiting: dict[str, Draw] = {}
        self._drawn_at: dict[str, float] = {}
        self._arrays: WeakValueDictionary[str, Array] = WeakValueDictionary()
        self._pictures: dict[str, Array] = {}

    def work(self) -> None:
        """Draw what is asked for, for ever."""
        while True:
            news = self._inbox.take(wait=not self._waiting)
            self._note(news)
            if self._waiting:
                self._draw(self._next())

    def _note(self, news: Sequence[Message]) -> None:
        newest: dict[tuple[type, str], SetScene | SetOutlines] = {}
        for sent in news:
            if isinstance(sent, SetScene | SetOutlines):
                newest[type(sent), sent.view] = sent
            elif isinstance(sent, SetBackground):
                self._background = sent.colour
            elif isinstance(sent, Draw):
                self._drop(sent.view)
                self._waiting[sent.view] = sent
        for one in newest.values():
            self._stage(one)

    def _stage(self, sent: SetScene | SetOutlines) -> None:
        try:
            if isinstance(sent, SetOutlines):
                self._outlines[sent.view] = outlines_of(sent.outlines, self._mapped)
            else:
                subject = Subject(scene_of(sent.scene, self._mapped))
                self._subjects[sent.view] = subject.inherits(self._subjects.values())
        except OSError:  # its files are gone already: something newer is on its way
            return

    def _mapped(self, where: dict[str, Any]) -> Array:
        array = self._arrays.get(where["file"])
        if array is None:
            self._arrays[where["file"]] = array = mapped(where)
        return array

    def _drop(self, view: str) -> None:
        old = self._waiting.pop(view, None)
        if old:
            self._say(Dropped(view, old.number))

    def _next(self) -> Draw:
        """Moving views before resting ones, then the one drawn longest ago."""
        return min(
            self._waiting.values(), key=lambda draw: (not draw.moving, self._drawn_at.get(draw.view, 0.0))
        )

    def _draw(self, draw: Draw) -> None:
        start = self._drawn_at[draw.view] = time.perf_counter()
        try:
            plate = self._plate(draw)
        except Overtaken:
            return
        has_depth = plate.depth is not None and not draw.moving
        self._write(draw.file, plate, has_depth, self._outlines.get(draw.view, {}))
        del self._waiting[draw.view]
        counts = plate.points, plate.triangles, plate.covered if has_depth else 0
        seconds = time.perf_counter() - start
        self._say(Drawn(draw.view, draw.number, plate.size, has_depth, draw.moving, *counts, seconds))

    def _plate(self, draw: Draw) -> Plate:
        """Return the picture without outlines: the last one if it is of the very same."""
        subject = self._subjects.get(draw.view)
        key = subject and subject.number, self._background, draw.camera, draw.size, draw.moving
        last = self._plates.get(draw.view)
        if last is not None and last.serves(key, self._outlines.get(draw.view, {})):
            return last
        start = time.perf_counter()
        taken, is_telling = self._taken(draw, subject or Subject(EMPTY))
        plate = self._plates[draw.view] = Plate.of(taken, key, camera_of(draw.camera), last)
        if is_telling:
            self._paces[draw.view] = self._pace(draw.view).after(time.perf_counter() - start, taken.limited)
        return plate

    def _taken(self, draw: Draw, subject: Subject) -> tuple[Picture, bool]:
        """Take the picture; also say whether its time tells anything about the next one's."""
        camera, pace = camera_of(draw.camera), self._pace(draw.view)
        scale = pace.scale if draw.moving else 1
        size = max(draw.size[0] // scale, 1), max(draw.size[1] // scale, 1)
        canvas, fresh = self._canvases.fitting(draw.view, scale, size)
        canvas.background(self._background)
        if not draw.moving:
            return picture.at_rest(subject, canvas, camera, size, self._look_up(draw.view)), False
        shown = canvas.key("points"), canvas.key("mesh")
        with_depth = bool(self._outlines.get(draw.view))
        taken = picture.moving(subject, canvas, camera, size, pace, with_depth)
        return taken, not fresh and shown == (canvas.key("points"), canvas.key("mesh"))

    def _pace(self, view: str) -> Pace:
        return self._paces.get(view, Pace())

    def _look_up(self, view: str) -> Callable[[], None]:
        def look_up() -> None:
            if self._inbox.has_news(view):
                raise Overtaken

        return look_up

    def _write(self, file: str, plate: Plate, with_depth: bool, outlines: dict[str, Outline]) -> None:
        if file not in self._pictures:  # and the window may have given up others
            self._pictures = {path: room for path, room in self._pictures.items() if os.path.exists(path)}
            self._pictures[file] = mapped_bytes(file, writable=True)
        room, (width, height) = self._pictures[file], plate.size
        half = frame_bytes(plate.size) // 2
        plate.print(room[:half].reshape(height, width, 4), outlines)
        if with_depth:
            room[half : 2 * half].view("f4").reshape(height, width)[:] = plate.depth


def speaker() -> Say:
    """Take over standard output for messages; what libraries print goes to standard error."""
    pipe = os.fdopen(os.dup(1), "wb", buffering=0)
    os.dup2(2, 1)
    lock = Lock()

    def say(message: Message) -> None:
        with lock:
            pipe.write(line(message))

    return say


def main(folders: Sequence[str]) -> None:
    """Draw until the window is gone."""
    give_way_altogether()
    keep()
    say = speaker()

    def end() -> None:
        remove([Path(folder) for folder in folders])
        os._exit(0)

    inbox = Inbox(sys.stdin.buffer, end, give_back)
    try:
        library = load()
        Canvases(library).fitting("first", 1, (64, 64))
    except Exception as error:  # noqa: BLE001 - whatever Open3D finds amiss, the window has to say it
        say(Unusable(f"Open3D cannot draw here: {error}"))
        os._exit(1)
    try:
        say(Ready())
        Studio(library, inbox, say).work()
    except BrokenPipeError:
        end()


if __name__ == "__main__":
    main(sys.argv[1:])
