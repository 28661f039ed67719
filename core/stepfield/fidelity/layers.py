"""What a layer covers: its pillars' compartments, what of them a simulator draws, its holes."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from stepfield.fidelity.reconstructions import Layers
from stepfield.grid import Grid
from stepfield.holes import holes
from stepfield.surface import losses


@dataclass(frozen=True)
class LayerFigures:
    """One layer in figures; areas in square metres.

    Attributes
    ----------
    occupied_area : float
        Of the compartments of its pillars.
    edges_area, simulator_area : float
        What the two reconstructions cover.
    surfaces, vanished : int
        Connected surfaces, and those of which a simulator draws nothing.
    holes : int
        Regions of empty compartments that it encloses.
    hole_area : float
    """

    occupied_area: float
    edges_area: float
    simulator_area: float
    surfaces: int
    vanished: int
    holes: int
    hole_area: float

    def area(self, way: str) -> float:
        """Return what a reconstruction covers: ``edges``, ``simulator`` or the ``pillars`` themselves."""
        known = {"edges": self.edges_area, "simulator": self.simulator_area, "pillars": self.occupied_area}
        return known[way]

    def as_dict(self) -> dict[str, float]:
        """Return the figures by name."""
        return asdict(self)


def layer_figures(grid: Grid, layers: Layers, link_step: float) -> tuple[LayerFigures, ...]:
    """Tell what layers cover, one a layer.

    Parameters
    ----------
    grid : Grid
    layers : sequence of tuple of ndarray
        Compartments, ascending, and elevations of each layer's pillars, metres.
    link_step : float
        Greatest difference in elevation of two neighbours that continue each other, metres.
    """
    found = (holes(grid, compartment) for compartment, _ in layers)
    return tuple(
        LayerFigures(**asdict(loss), holes=each.count, hole_area=len(each.compartment) * grid.cell_size**2)
        for loss, each in zip(losses(grid, layers, link_step), found, strict=True)
    )
