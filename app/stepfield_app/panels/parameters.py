"""The parameters of the method: every control is one edit of the document, and shows what that says."""

from __future__ import annotations

from typing import Any

from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from stepfield.project import Project
from stepfield_app.document import Document
from stepfield_app.facts import ScanFacts
from stepfield_app.panels.hand import WheelGuard
from stepfield_app.panels.lengths import Range
from stepfield_app.panels.page import GRID, Fold, Page, PendingMark, column, heading
from stepfield_app.panels.rows import ChoiceRow, CountRow, Described, LengthRow

CELL_SIZE = Described(
    "cell_size",
    "Cell size",
    "Side of a compartment of the grid (5.1): smaller shows more, and needs more points",
    "C",
)
ALPHA = Described(
    "alpha", "Alpha", "Distance of the base plane below the lowest point of the scan (Eq. 1)", "A"
)
TOLERANCE = Described(
    "layer_tolerance",
    "Tolerance",
    "Layer tolerance: a vertical gap wider than this parts two pillars of a compartment (5.3.2)",
    "o",
)
LAYERING = Described(
    "layering",
    "Layering",
    "How pillars get layers (5.3.3): so that a continuous surface stays in one layer, by average elevation, "
    "or in order from the lowest of each compartment",
    "y",
)
PILLAR_HEIGHT = Described(
    "pillar_height", "Pillar height", "Which elevation of its points a pillar is given (5.1)", "g"
)
WALLS = Described(
    "walls",
    "Walls",
    "Pillars whose points run upwards, walls and columns: like all others, up to their highest point, "
    "or taken out of the surfaces into a layer of obstacles, solid from foot to top",
    "W",
)
MIN_POINTS = Described("min_points", "Least points", "A pillar of fewer points is left out of every layer")
MAX_LAYERS = Described(
    "max_layers", "Most layers", "Pillars beyond this many in a compartment are left unassigned"
)
LINK_STEP = Described(
    "link_step", "Link step", "Greatest height step at which two neighbouring pillars still belong together"
)
COMPLEX = Described(
    "complex_parts",
    "Complex",
    "What becomes of what height-maps cannot hold, walls and rubble: a mesh of just that may stand in (7)",
    "x",
)
COMPLEX_RESIDUAL = Described(
    "complex_residual",
    "Mesh from",
    "A pillar whose points are further from the surface than this is complex",
)
RECONSTRUCTION = Described(
    "reconstruction",
    "Surface",
    "What layers become triangles by, here and for simulators (6): exactly the ground of their pillars, or a "
    "vertex a pixel, which cuts the sides and loses what is thin",
)
FILL = Described(
    "fill",
    "Fill holes",
    "Give holes of a layer a height that nobody measured; a mask of its own says where. Linear is seldom far "
    "from the best; Fidelity says how far off the heights are likely to be",
)
FILL_SIZE = Described("fill_size", "Holes up to", "Longest side of the holes that are filled")
BITS = Described("bits", "Bits", "Bits of a pixel of the height-maps (Eq. 2 is 8)")
PAD = Described("pad", "Padding", "Widen the images to powers of two, as most simulators ask")
WHITE = Described(
    "range", "White", "Whose greatest height is white: that of all layers, or of each layer its own"
)
CLEARANCE = Described(
    "clearance",
    "Clearance",
    "Write beside each layer how much room is above it: does a robot fit under the table?",
)

OPTIONS: dict[str, tuple[tuple[str, Any], ...]] = {
    "layering": (("by surface", "surface"), ("by elevation", "elevation"), ("by rank", "rank")),
    "pillar_height": (
        ("mean", "mean"),
        ("highest point", "max"),
        ("median", "median"),
        ("90th percentile", "p90"),
    ),
    "walls": (("like all pillars", "mean"), ("to their tops", "top"), ("as obstacles", "layer")),
    "complex_parts": (("as height-maps", "off"), ("as a mesh", "mesh")),
    "reconstruction": (("edges", "edges"), ("as a simulator", "simulator")),
    "fill": (
        ("no", "none"),
        ("nearest pillar", "nearest"),
        ("linear", "linear"),
        ("inpaint", "inpaint"),
    ),
    "max_layers": (("auto", "auto"), ("no limit", "none"), *((str(n), n) for n in range(1, 13))),
    "bits": (("16 bits", 16), ("8 bits", 8)),
    "pad": (("powers of two", "pow2"), ("none", "none")),
    "clearance": (("not written", False), ("written", True)),
    "range": (("shared by all layers", "shared"), ("of each layer", "layer")),
}
MOST_POINTS = 1_000_000
EMPTY = "Cell size, alpha and layer tolerance are tuned here. Open a scan to begin (Ctrl+O)."
#: Shares of the scan's extent that lengths are offered between.
FINEST, COARSEST_CELL = 1 / 2000, 1 / 4


class ParametersPanel(QWidget):
    """Sliders, boxes and choices for the parameters of the method.

    Parameters
    ----------
    document : Document
    parent : QWidget, optional
    """

    def __init__(self, document: Document, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._document = document
        self._shown: list[Any] = []  # what the rows show
        self._project = document.project
        self._make_rows()
        self._page = Page(self._content(), EMPTY)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._page)
        document.project_changed.connect(self._follow)
        document.answer_changed.connect(lambda _: self._show_changes())
        document.facts_changed.connect(self._adapt)
        self._adapt(document.facts)

    def _make_rows(self) -> None:
        document = self._document
        self.cell_size = LengthRow(CELL_SIZE, document, self)
        self.alpha = LengthRow(ALPHA, document, self)
        self.tolerance = LengthRow(TOLERANCE, document, self)
        self.link_step = LengthRow(LINK_STEP, document, self)
        self.complex_residual = LengthRow(COMPLEX_RESIDUAL, document, self)
        self.fill_size = LengthRow(FILL_SIZE, document, self)
        self.min_points = CountRow(MIN_POINTS, MOST_POINTS, document, self)
        described = (
            LAYERING,
            PILLAR_HEIGHT,
            WALLS,
            RECONSTRUCTION,
            FILL,
            MAX_LAYERS,
            COMPLEX,
            BITS,
            PAD,
            WHITE,
            CLEARANCE,
        )
        self.choices = {each.name: ChoiceRow(each, OPTIONS[each.name], document, self) for each in described}
        self._rows: tuple[LengthRow | CountRow | ChoiceRow, ...] = (
            *(self.cell_size, self.alpha, self.tolerance, self.link_step, self.min_points),
            self.complex_residual,
            self.fill_size,
            *self.choices.values(),
        )
        guard = WheelGuard(self)
        for row in self._rows:
            row.guard(guard)

    def _content(self) -> QWidget:
        content = QWidget()
        title = QHBoxLayout()
        title.addWidget(heading("Method"))
        title.addWidget(PendingMark(self._document), 1)
        layout = column()
        layout.addLayout(title)
        first = [self.cell_size, self.alpha, self.tolerance]
        second = [self.choices[name] for name in ("layering", "pillar_height", "walls", "reconstruction")]
        layout.addLayout(_grid([*first, *second]))
        more = QWidget()
        images = [self.choices[name] for name in ("bits", "pad", "range", "clearance")]
        meshed = [self.choices["complex_parts"], self.complex_residual]
        holes = [self.choices["fill"], self.fill_size]
        layers = [self.link_step, self.min_points, self.choices["max_layers"]]
        more.setLayout(_grid([*layers, *holes, *meshed, *images]))
        layout.addWidget(Fold("More", more))
        layout.addStretch(1)
        content.setLayout(layout)
        return content

    def _follow(self, project: Project) -> None:
        """Show what has changed; all of a project that has not, for a row may show what was refused."""
        if project is self._project:
            self._show()
        else:
            self._show_changes()
        self._project = project

    def _show(self) -> None:
        """Show what the document says, row by row."""
        self._shown = [None] * len(self._rows)
        self._show_changes()

    def _show_changes(self) -> None:
        """Show the values that are others: a hand moves one of them many times a second."""
        answer, chosen = self._document.answer, self._document.project.parameters
        picked = answer.result.parameters if answer else None
        for place, row in enumerate(self._rows):
            value = row.value_of(chosen, picked)
            if value != self._shown[place]:
                self._shown[place] = value
                row.show_value(chosen, picked)

    def _adapt(self, facts: ScanFacts | None) -> None:
        """Offer the lengths that suit the scan."""
        self._page.set_filled(facts is not None)
        if facts is not None:
            cells, heights = cell_range(facts), height_range(facts)
            for row in (self.cell_size, self.fill_size):
                row.set_range(cells)
            for row in (self.alpha, self.tolerance, self.link_step, self.complex_residual):
                row.set_range(heights)
        self._show()


def cell_range(facts: ScanFacts) -> Range:
    """Cell sizes from a fine grid to a few compartments."""
    side = _side(facts)
    return Range(side * FINEST, side * COARSEST_CELL)


def height_range(facts: ScanFacts) -> Range:
    """Heights up to that of the scan; a flat one has none, so its side must do."""
    height = facts.bounds[5] - facts.bounds[2]
    most = max(height, _side(facts) / 100)
    return Range(most * FINEST, most)


def _side(facts: ScanFacts) -> float:
    """Longer side of the scan in plan, metres; of a single point, one."""
    bounds = facts.bounds
    return max(bounds[3] - bounds[0], bounds[4] - bounds[1]) or 1.0


def _grid(rows: list[Any]) -> QGridLayout:
    """Lay rows of controls out in common columns."""
    grid = QGridLayout()
    grid.setContentsMargins(0, 0, 0, 0)
    grid.setHorizontalSpacing(GRID)
    grid.setVerticalSpacing(GRID)
    grid.setColumnStretch(1, 1)
    for place, row in enumerate(rows):
        row.place(grid, 2 * place)  # a length takes two
    return grid
