"""All feeds of a window: asked whether they rest, and ended in order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from stepfield_app.feeds.complex_feed import ComplexFeed
from stepfield_app.feeds.demo_feed import DemoFeed
from stepfield_app.feeds.fidelity_feed import FidelityFeed
from stepfield_app.feeds.plot_feed import PlotFeed
from stepfield_app.feeds.recolour_feed import RecolourFeed
from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.feeds.selection_feed import SelectionFeed
from stepfield_app.feeds.status_feed import StatusFeed
from stepfield_app.feeds.stray_feed import StrayFeed
from stepfield_app.feeds.suspect_feed import SuspectFeed

#: What asks workers for pictures and figures.
Feed = (
    SceneFeed | RecolourFeed | PlotFeed | FidelityFeed | StrayFeed | SelectionFeed | SuspectFeed | ComplexFeed
)


@dataclass(frozen=True)
class Feeds:
    """What brings results to the views and panels of a window."""

    scene: SceneFeed
    recolour: RecolourFeed
    plot: PlotFeed
    fidelity: FidelityFeed
    status: StatusFeed
    stray: StrayFeed
    demo: DemoFeed
    selection: SelectionFeed
    complex: ComplexFeed
    suspect: SuspectFeed

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
