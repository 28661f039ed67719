"""One view as the window knows it: what is wanted, what was asked for, what came."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import count

from stepfield_app.render.camera import Camera, Size
from stepfield_app.render.outline import KINDS, Outline
from stepfield_app.render.protocol import Draw, Drawn, camera_tree, frame_bytes
from stepfield_app.render.scene import EMPTY, Frame, Scene
from stepfield_app.render.slots import Slot, Slots

#: Scenes with more points or triangles than this are shown in less detail first.
MANY = 300_000
#: Room for pictures is reserved in steps of so many bytes, so that a window being resized keeps its files.
ROOM = 1 << 20


@dataclass(frozen=True)
class Asked:
    """A picture on its way."""

    slot: Slot
    camera: Camera
    moving: bool
    wish: int
    scene: Scene
    outlines: dict[str, Outline]


@dataclass
class View:
    """Wishes are numbered; a frame of the newest wish, in full and with the newest outlines, means rest."""

    name: str
    slots: Slots
    shown: bool = False
    scene: Scene = EMPTY
    sent: Scene | None = None
    outlines: dict[str, Outline] = field(default_factory=dict)
    sent_outlines: dict[str, Outline] = field(default_factory=dict)
    camera: Camera | None = None
    size: Size = (1, 1)
    moving: bool = False
    frame: Frame | None = None
    frame_scene: Scene = EMPTY
    _wish: int = 0
    _asked_quick: int = -1
    _asked_full: int = -1
    _finished: int = -1
    _painted: dict[str, Outline] = field(default_factory=dict)
    _asked: dict[int, Asked] = field(default_factory=dict)
    _numbers: count[int] = field(default_factory=count)

    def set_scene(self, scene: Scene, *, in_full: bool = False) -> None:
        """Want another scene; ``in_full`` without a picture of less detail first."""
        if scene is not self.scene:
            self.scene = scene
            self.change()
            if in_full and not self.moving:
                self._asked_quick = self._wish

    def set_outline(self, kind: str, outline: Outline | None) -> None:
        """Want another outline of a kind, or none: the picture stays, and is painted over anew."""
        wanted = {**self.outlines, kind: outline}
        self.outlines = {name: known for name in KINDS if (known := wanted.get(name)) is not None}

    def set_camera(self, camera: Camera, size: Size, moving: bool) -> None:
        """Want another camera, size or detail."""
        size = max(size[0], 1), max(size[1], 1)
        if (camera, size, moving) != (self.camera, self.size, self.moving):
            self.camera, self.size, self.moving = camera, size, moving
            self.change()
            if not moving:  # the last moving picture is on the screen already
                self._asked_quick = self._wish

    def change(self) -> None:
        """Want a new picture."""
        self._wish += 1

    @property
    def is_at_rest(self) -> bool:
        """Whether the frame is the newest wish in full."""
        return self._finished == self._wish and self._painted == self.outlines

    @property
    def may_ask(self) -> bool:
        """Whether a picture is wanted and not too many are on their way.

        Quick ones are asked for one at a time; a full one may be overtaken by one more, but not by the same
        with other outlines.
        """
        asked = self._asked.values()
        if self.camera is None or any(one.moving for one in asked) or len(asked) > 1:
            return False
        return self._wants_quick or self._wants_full or (self._wants_paint and not asked)

    def ask(self) -> Draw:
        """Ask for the next picture."""
        assert self.camera is not None
        quick = self._wants_quick or (self.moving and not self._wants_full)
        if quick:
            self._asked_quick = self._wish
        else:
            self._asked_full = self._wish
        slot = self.slots.free(-(-frame_bytes(self.size) // ROOM) * ROOM)
        slot.asked = True
        number = next(self._numbers)
        self._asked[number] = Asked(slot, self.camera, quick, self._wish, self.scene, self.sent_outlines)
        return Draw(self.name, number, camera_tree(self.camera), self.size, quick, str(slot.path))

    def take(self, drawn: Drawn) -> bool:
        """Take a picture that came; False if nobody asked for it."""
        asked = self._asked.pop(drawn.number, None)
        if asked is None:
            return False
        asked.slot.asked = False
        pixels, depth = asked.slot.picture(drawn.size, drawn.depth)
        counts = drawn.points, drawn.triangles, drawn.covered
        self.frame = Frame(pixels, depth, asked.camera, drawn.moving, *counts, drawn.seconds)
        self.frame_scene, self._painted = asked.scene, asked.outlines
        if not drawn.moving:
            self._finished = asked.wish
        return True

    def drop(self, number: int) -> None:
        """Note that a picture will not come."""
        asked = self._asked.pop(number, None)
        if asked:
            asked.slot.asked = False

    def forget_sent(self) -> None:
        """Begin again: the drawing process is a new one and knows nothing."""
        for number in list(self._asked):
            self.drop(number)
        self.sent, self.sent_outlines = None, {}
        self._finished = self._asked_quick = self._asked_full = -1

    @property
    def _wants_quick(self) -> bool:
        """Whether a picture with less detail comes next: while a hand moves, and first of a large scene."""
        return self._asked_quick != self._wish and (self.moving or self._is_large)

    @property
    def _wants_full(self) -> bool:
        return not self.moving and self._asked_full != self._wish

    @property
    def _wants_paint(self) -> bool:
        """Whether the newest picture lacks the outlines that the drawing process knows by now."""
        return self.frame is not None and self._painted != self.sent_outlines

    @property
    def _is_large(self) -> bool:
        points = len(self.scene.points.places) if self.scene.points else 0
        return points > MANY or any(len(mesh.triangles) > MANY for mesh in self.scene.meshes[:1])
