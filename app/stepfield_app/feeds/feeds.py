"""All feeds of a window: made, tied to each other, and ended in order."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from stepfield_app.feeds.complex_feed import ComplexFeed
from stepfield_app.feeds.demo_feed import DemoFeed
from stepfield_app.feeds.fidelity_feed import FidelityFeed
from stepfield_app.feeds.lead import Lead
from stepfield_app.feeds.plot_feed import PlotFeed
from stepfield_app.feeds.recolour_feed import RecolourFeed
from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.feeds.selection_feed import SelectionFeed
from stepfield_app.feeds.status_feed import StatusFeed
from stepfield_app.feeds.stray_feed import StrayFeed
from stepfield_app.feeds.suspect_feed import SuspectFeed

if TYPE_CHECKING:
    from stepfield_app.main_window import MainWindow

#: What asks workers for pictures and figures.
Feed = (
    SceneFeed | RecolourFeed | PlotFeed | FidelityFeed | StrayFeed | SelectionFeed | SuspectFeed | ComplexFeed
)


class Feeds:
    """What brings results to the views and panels of a window.

    Parameters
    ----------
    window : MainWindow
        With its views and panels made.
    """

    def __init__(self, window: MainWindow) -> None:
        document, trio, client = window.document, window.trio, window.client
        self.scene = SceneFeed(document, trio, client)
        self.recolour = RecolourFeed(document, trio, client, self.scene)
        self.plot = PlotFeed(
            document, self.scene, window.map, window.profile, window.histogram, window.layers
        )
        self.fidelity = FidelityFeed(document, window.fidelity, self.scene.is_drawn)
        self.status = StatusFeed(document, window.status, trio, window.map, self.scene)
        self.stray = StrayFeed(document, window.cleaning, self.scene)
        self.demo = DemoFeed(window)
        self.selection = SelectionFeed(document, window.selection, self.scene, client)
        self.complex = ComplexFeed(document, self.scene, window.map, window.complex_marks)
        self.suspect = SuspectFeed(
            document,
            window.selection,
            window.map,
            window.marks,
            window.mark_box,
            window.suspects,
            Lead(document, window.map, trio, self.scene, self.selection),
            self.scene.is_drawn,
        )
        self.fidelity.changed.connect(self.plot.set_facts)
        self.complex.shown.connect(self.fidelity.set_meshed)

    def __iter__(self) -> Iterator[Feed]:
        """Give those that ask workers, in the order in which they have to end."""
        yield from (self.suspect, self.selection, self.fidelity, self.plot)
        yield from (self.stray, self.complex, self.recolour, self.scene)

    @property
    def is_idle(self) -> bool:
        """Whether all that was asked for is there."""
        return not self.demo.is_busy and all(feed.is_idle for feed in self)

    def cancel(self) -> None:
        """Stop what takes long."""
        self.demo.cancel()
        self.complex.cancel()

    def close(self) -> None:
        """End them all; no thread is left."""
        self.demo.close()
        for feed in self:
            feed.close()
