"""How true a reconstruction is: to its scan, and to the truth where it is known."""

from stepfield.fidelity.against import Comparison, compare, compare_result
from stepfield.fidelity.figures import Distances, Fidelity
from stepfield.fidelity.filled import FilledFigures, filled_figures, result_filled_figures, with_truth
from stepfield.fidelity.gaps import Gaps, near_gaps
from stepfield.fidelity.hidden import Hidden
from stepfield.fidelity.layers import LayerFigures, layer_figures
from stepfield.fidelity.measure import Measured, measure
from stepfield.fidelity.reconstructions import Way, layers_of, surface_of
from stepfield.fidelity.surface import Surface
from stepfield.fidelity.true_mesh import true_mesh
from stepfield.fidelity.truth import TruthFidelity, against_truth, result_against_truth
from stepfield.holes import Holes, holes

__all__ = [
    "Comparison",
    "Distances",
    "Fidelity",
    "FilledFigures",
    "Gaps",
    "Hidden",
    "Holes",
    "LayerFigures",
    "Measured",
    "Surface",
    "TruthFidelity",
    "Way",
    "against_truth",
    "compare",
    "compare_result",
    "filled_figures",
    "holes",
    "layer_figures",
    "layers_of",
    "measure",
    "near_gaps",
    "result_against_truth",
    "result_filled_figures",
    "surface_of",
    "true_mesh",
    "with_truth",
]
