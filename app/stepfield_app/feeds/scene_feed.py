"""Keeps the three 3-D views true to the document: asks for scenes, hands them to the renderer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Qt, QTimer, Signal

from stepfield.pillars import StepField
from stepfield_app.document import Document
from stepfield_app.facts import ScanFacts
from stepfield_app.feeds.drawing import POINT_MODES, SOLID_MODES, WAYS, Drawing, joins_for
from stepfield_app.feeds.hurry import Hurry
from stepfield_app.feeds.wish import Drawn, Picture, Wish
from stepfield_app.newest import NewestWins
from stepfield_app.render.camera import Camera
from stepfield_app.render.client import RenderClient
from stepfield_app.render.scene import CLOUD, EMPTY, PILLARS, RECONSTRUCTION, VIEWS
from stepfield_app.requests import Answer
from stepfield_app.scenes import colouring
from stepfield_app.scenes.cloud import Cloud
from stepfield_app.scenes.complex_parts import Meshed
from stepfield_app.scenes.palette import layer_colours
from stepfield_app.scenes.surfaces import Way
from stepfield_app.theme import DARK, Theme
from stepfield_app.views.trio import Trio

#: Milliseconds by which a result's map, layers and recoloured pictures go before its scenes: all want the
#: same processors.
COURTESY = 120
#: While a hand moves, rest this many times as long as the last scenes took: map and panels come first.
RESTS = 8


@dataclass
class Choices:
    """What the operator chose about the views; nothing of it changes the result."""

    modes: dict[str, str] = field(
        default_factory=lambda: {CLOUD: "height", PILLARS: "layer", RECONSTRUCTION: "layer"}
    )
    visible: tuple[int, ...] = ()
    theme: Theme = DARK
    marks: NDArray[np.float64] | None = None
    meshed: Meshed | None = None
    #: As what the layers are drawn, where that is not what the parameters say.
    way: Way | None = None


class SceneFeed(QObject):
    """Asks for scenes whenever something that shows has changed.

    Parameters
    ----------
    document : Document
    trio : Trio
    client : RenderClient
    """

    failed = Signal(object)  # exception
    cloud_changed = Signal()
    #: Scenes were handed to the renderer: the Wish and some Pictures of it, by view.
    handed_over = Signal(object, object)
    _made = Signal(object, object)  # the same, on the worker's thread

    def __init__(self, document: Document, trio: Trio, client: RenderClient) -> None:
        super().__init__(trio)
        self._document, self._trio, self._client = document, trio, client
        self._choices = Choices()
        self.origin = np.zeros(3)
        self.cloud: Cloud | None = None
        self._fits = self._is_late = self._owes_detail = False
        self._joined = 0
        self._field: StepField | None = None  # what the scenes handed over last show
        self._said: Way | None = None
        self._breath = QTimer(self, singleShot=True)
        self._breath.timeout.connect(self._catch_up)
        self._courtesy = QTimer(self, singleShot=True, interval=COURTESY)
        self._courtesy.timeout.connect(self.ask)
        self._drawing = NewestWins[Wish, Drawn](Drawing(client.share, self._made.emit), "drawing", self)
        self._made.connect(self._show_early, Qt.ConnectionType.QueuedConnection)
        self._drawing.answered.connect(self._show)
        self._drawing.failed.connect(lambda _, error: self.failed.emit(error))
        document.facts_changed.connect(self._place)
        document.answer_changed.connect(self._take)
        document.opened.connect(self._begin)
        self._hurry = Hurry(document, self)
        self._hurry.changed.connect(self._hold)
        document.busy_changed.connect(lambda _: self._pay())
        trio.colour_chosen.connect(self._choose_colour)
        trio.way_chosen.connect(self._choose_way)
        trio.arranged.connect(self.ask)
        trio.viewpoint.changed.connect(self._sharpen)

    @property
    def is_idle(self) -> bool:
        """Whether every scene asked for has been handed over."""
        return not self._drawing.busy and not self._owes_detail and not self._courtesy.isActive()

    def is_drawn(self) -> bool:
        """Whether the views show what there is in full, as far as anything is drawn at all."""
        return self.is_idle and (self._client.state != "running" or self._client.is_at_rest())

    def set_visible(self, layers: tuple[int, ...]) -> None:
        """Show these layers, -1 for Unassigned."""
        if layers != self._choices.visible:
            self._choices.visible = layers
            self.ask()

    def begin_with(self, camera: Camera) -> None:
        """Look at a scan that was just opened as it was left, instead of framing it."""
        self._fits = False
        self._trio.viewpoint.look(camera)

    def set_theme(self, theme: Theme) -> None:
        """Draw for a theme."""
        self._choices.theme = theme
        red, green, blue = (int(theme.window[at : at + 2], 16) for at in (1, 3, 5))
        self._client.set_background((red, green, blue))
        self.ask()

    def set_marks(self, places: NDArray[np.float64] | None) -> None:
        """Mark places in the cloud, shape (n, 3), scan coordinates in metres; or none."""
        self._choices.marks = places
        self.ask()

    def set_meshed(self, meshed: Meshed | None) -> None:
        """Draw a mesh of complex parts in place of their pillars where it belongs to the result; or none."""
        if meshed is not self._choices.meshed:
            self._choices.meshed = meshed
            self.ask()

    def close(self) -> None:
        """End the worker."""
        self._drawing.close()

    def ask(self) -> None:
        """Ask for the scenes of the views that are shown."""
        self._courtesy.stop()
        wish = self.wish
        self._owes_detail = wish is not None and wish.quick
        self._is_late = self._owes_detail and (self._drawing.busy or self._breath.isActive())
        if wish is not None and not self._is_late:
            self._joined = wish.joined
            self._trio.headers[RECONSTRUCTION].set_ways(WAYS, wish.way)
            self._drawing.ask(wish)

    @property
    def wish(self) -> Wish | None:
        """What there is to draw now."""
        answer, choices = self._document.answer, self._choices
        if answer is None:
            return None
        colours = layer_colours(len(answer.result.layers), self._document.project.layers)
        views, modes = self._trio.shown, dict(choices.modes)
        look = choices.visible, choices.theme, choices.marks
        meshed = choices.meshed if choices.meshed and choices.meshed.belongs_to(answer.result) else None
        how = partial(Wish, quick=bool(self._hurry), joined=self._joins(answer), meshed=meshed)
        return how(
            answer,
            self.origin,
            views,
            modes,
            colours,
            *look,
            way=choices.way or answer.result.parameters.reconstruction,
        )

    def _joins(self, answer: Answer) -> int:
        """How often compartments may be joined before anybody sees it, as near as the camera is."""
        facts = self._document.facts
        bounds = np.reshape(facts.bounds, (2, 3)) - self.origin if self._fits and facts else None
        grain = self._trio.grain(None if bounds is None else (bounds[0], bounds[1]))
        return joins_for(answer.result.field.compartments.grid.cell_size, grain)

    def _sharpen(self) -> None:
        """Draw finer blocks once the camera rests nearer."""
        answer = self._document.answer
        if answer is not None and not self._trio.viewpoint.is_moving and self._joins(answer) < self._joined:
            self.ask()

    def _hold(self, hurries: bool) -> None:
        """Draw coarsely and at a calmer pace while a hand moves; then all there is."""
        self._trio.viewpoint.set_held(hurries)
        if not hurries:
            self._pay()

    def _pay(self) -> None:
        """Draw all there is of what a hand left coarse, unless a newer result will be there in a moment."""
        answer = self._document.answer
        is_late = answer is not None and answer.request.quick  # and has been for a while
        if self._owes_detail and not self._hurry and (is_late or not self._document.busy):
            self.ask()

    def _catch_up(self) -> None:
        if self._is_late:
            self.ask()

    def _place(self, facts: ScanFacts | None) -> None:
        """Place the local origin: at the corner of the scan, so that float32 is exact enough."""
        if facts is not None:
            self.origin = np.array(facts.bounds[:3])
            self._choices.marks = None
            self._fits = True

    def _begin(self) -> None:
        """Frame a scan that was just opened as soon as it is drawn."""
        self._fits = True
        self._offer_colours()

    def _take(self, answer: Answer | None) -> None:
        if answer is not None:
            self._follow(answer.result.parameters.reconstruction)
        if answer is None:
            self._courtesy.stop()
            self._drawing.forget()
            self.cloud = self._field = None
            for view in VIEWS:
                self._client.set_scene(view, EMPTY)
        elif self._document.held:
            self.ask()
        else:
            self._owes_detail = False
            self._courtesy.start()

    def _offer_colours(self) -> None:
        answer = self._document.answer
        assert answer is not None
        modes = colouring.modes(answer.result.scan, answer.result)
        if self._choices.modes[CLOUD] not in modes:
            self._choices.modes[CLOUD] = "height"
        offered = {CLOUD: tuple((mode, POINT_MODES[mode]) for mode in modes)}
        for view in VIEWS:
            self._trio.headers[view].set_colours(offered.get(view, SOLID_MODES), self._choices.modes[view])

    def _choose_colour(self, view: str, mode: str) -> None:
        self._choices.modes[view] = mode
        self.ask()

    def _follow(self, said: Way) -> None:
        """Draw the layers as the parameters say once these change, whatever was looked at before."""
        if said != self._said:
            self._said, self._choices.way = said, None

    def _choose_way(self, way: Way) -> None:
        self._choices.way = way
        self.ask()

    def _show(self, wish: Wish, drawn: Drawn) -> None:
        if wish.quick:
            self._breath.start(round(1000 * RESTS * drawn.seconds))
        if wish.origin is not self.origin:
            return  # of a scan that is open no more
        if drawn.cloud is not self.cloud:
            self.cloud = drawn.cloud
            self.cloud_changed.emit()
        self._hand_over(wish, drawn.pictures)
        self._field = wish.result.field
        if self._fits:
            self._fits = False
            self._trio.fit()
        elif wish.quick:
            self._trio.viewpoint.stir()

    def _show_early(self, wish: Wish, pictures: Mapping[str, Picture]) -> None:
        """Hand over what is made of an edit: every view shows it already, recoloured. Others go together."""
        is_newest = wish.answer is self._document.answer and wish.origin is self.origin
        if is_newest and self._is_of_an_edit(wish):
            self._hand_over(wish, pictures)

    def _is_of_an_edit(self, wish: Wish) -> bool:
        """Whether the same pillars are on the screen already, and in the right colours."""
        return wish.result.field is self._field and not wish.quick

    def _hand_over(self, wish: Wish, pictures: Mapping[str, Picture]) -> None:
        for view, picture in pictures.items():
            self._client.set_scene(view, picture.scene, in_full=self._is_of_an_edit(wish))
            self._trio.canvases[view].set_legend(picture.legend)
            self._trio.set_bounds(picture.scene.low, picture.scene.high)
        self.handed_over.emit(wish, pictures)
