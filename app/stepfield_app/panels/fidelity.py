"""How true the layers are, in numbers; each of them shows in the map where it comes from."""

from __future__ import annotations

from functools import partial
from typing import Protocol

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from stepfield.fidelity import Distances, Hidden
from stepfield_app.appearance import numbers_font
from stepfield_app.controls import named
from stepfield_app.panels.page import GRID, Page
from stepfield_app.scenes.fidelity import FidelityFacts
from stepfield_app.wording import UNKNOWN, area, counted, distance, grouped, share, short

EMPTY = "Open a scan to see here how true its layers are: distances of its points, seams, holes."
#: Rows of distances: name, text, explanation.
DISTANCES = (
    ("rmse", "RMSE", "Root of the mean square of the distances of the scan's points from the layers"),
    ("p95", "95 % within", "The distance that 95 of 100 points of the scan are within"),
    ("explained", "Explained", "Share of all points of the scan that are within the tolerance of a layer"),
)
#: Columns of distances: attribute, text, explanation.
WAYS = (
    ("vertical", "up, down", "Straight up or down to the nearest layer"),
    ("nearest", "nearest", "To the nearest place of any layer, in whatever direction"),
)
#: Rows of counts: name, mode of the map, text, explanation.
COUNTS = (
    ("seams", "seams", "Seams", "Neighbours that continue each other but lie in two layers, of all that do"),
    ("holes", "holes", "Holes", "Regions of empty compartments that a layer encloses, and their area"),
    ("filled", "holes", "Filled", "Holes that were filled, and the area that has heights nobody measured"),
    (
        "off",
        "holes",
        "    RMSE, 95 %",
        "How far filled heights are likely to be off, straight up or down: root of the mean square, and what "
        "95 of 100 are within",
    ),
    (
        "gaps",
        "gaps",
        "Close gaps",
        "Compartments with a vertical gap within a quarter of the tolerance of it",
    ),
    ("lost", "lost", "Not drawn", "Share of the area that a simulator with a vertex a pixel does not draw"),
    ("clearance", "clearance", "Least room", "The smallest clearance between a layer and what is above it"),
)
#: Those that are there only when holes are filled.
FILLED = ("filled", "off")


class Headline(Protocol):
    """What stands above the panel and can remark on it."""

    def set_detail(self, *wordings: str) -> None:
        """Say the longest of these that fits."""


class FidelityPanel(QWidget):
    """Shows figures, and asks the map to show where one comes from.

    Parameters
    ----------
    strip : Headline
        Says the most telling figures beside the panel's name.
    parent : QWidget, optional
    """

    #: A mode of the map.
    map_wanted = Signal(str)

    def __init__(self, strip: Headline, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.strip = strip
        self.values: dict[str, QPushButton] = {}
        self._filled: list[QWidget] = []
        self._page = Page(self._content(), EMPTY)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._page)
        self.set_facts(None)

    def _content(self) -> QWidget:
        content, grid = QWidget(), QGridLayout()
        grid.setContentsMargins(GRID, GRID // 2, GRID // 2, GRID // 2)
        grid.setHorizontalSpacing(GRID // 2)
        grid.setVerticalSpacing(0)
        for column, (_, text, tip) in enumerate(WAYS, 1):
            grid.addWidget(_label(text, tip, Qt.AlignmentFlag.AlignRight), 0, column)
        for row, (name, text, tip) in enumerate(DISTANCES, 1):
            grid.addWidget(_label(text, tip), row, 0)
            for column, (way, way_text, way_tip) in enumerate(WAYS, 1):
                where = self._value(f"{way} {name}", "error", f"{text}, {way_text}", f"{tip}. {way_tip}")
                grid.addWidget(where, row, column)
        for row, (name, mode, text, tip) in enumerate(COUNTS, len(DISTANCES) + 1):
            label, value = _label(text, tip), self._value(name, mode, text, tip)
            grid.addWidget(label, row, 0)
            grid.addWidget(value, row, 1, 1, 2)
            if name in FILLED:
                self._filled += [label, value]
        grid.setColumnStretch(1, 1)
        grid.setColumnStretch(2, 1)
        grid.setRowStretch(grid.rowCount(), 1)
        content.setLayout(grid)
        return content

    def _value(self, name: str, mode: str, text: str, tip: str) -> QPushButton:
        """Make a number that can be pressed."""
        button = named(QPushButton(), text.strip(), f"{tip}. Press to see in the map where.")
        button.setProperty("role", "figure")
        button.setFlat(True)
        button.setFont(numbers_font())
        button.setSizePolicy(button.sizePolicy().Policy.Expanding, button.sizePolicy().Policy.Fixed)
        button.clicked.connect(partial(self.map_wanted.emit, mode))
        button.setWhatsThis(tip)
        self.values[name] = button
        return button

    def set_facts(self, facts: FidelityFacts | None) -> None:
        """Show the figures of a result; None shows how to get any."""
        self._page.set_filled(facts is not None)
        if facts is None:
            self.strip.set_detail("")
            return
        found = facts.comparison.fidelity
        about = "≈ " if found.is_drawn else ""
        rmse, explained = distance(found.vertical.rmse), share(found.explained)
        self.strip.set_detail(f"{about}RMSE {rmse}, {explained}", f"{about}{rmse}, {explained}", explained)
        for way, distances in (("vertical", found.vertical), ("nearest", found.nearest)):
            more = _more(distances, found.points, found.of)
            self._say(f"{way} rmse", distance(distances.rmse), more)
            self._say(f"{way} p95", distance(distances.p95), more)
            self._say(f"{way} explained", share(distances.explained), more)
        self._show_counts(facts)
        for widget in self._filled:
            widget.setVisible(bool(facts.filled))
        if facts.filled:
            self._show_filled(facts)

    def _show_counts(self, facts: FidelityFacts) -> None:
        holes, hole_area = facts.holes
        vanished, surfaces = facts.vanished
        gone = f"{grouped(vanished)} of {counted(surfaces, 'surface')} vanish"
        self._say("seams", f"{grouped(facts.seams)} of {grouped(facts.links)}")
        self._say("holes", f"{grouped(holes)}, {area(hole_area)}" if holes else "none")
        self._say("gaps", grouped(facts.gaps) if facts.gaps else "none")
        self._say("lost", share(facts.lost), gone)
        self._say("clearance", distance(facts.least_room))

    def _show_filled(self, facts: FidelityFacts) -> None:
        count, filled_area = facts.filled_holes
        pixels, still = (sum(each) for each in zip(*((f.pixels, f.open) for f in facts.filled), strict=True))
        more = f"{counted(pixels, 'pixel')}; {counted(still, 'hole')} left open, at least in part"
        self._say("filled", f"{grouped(count)}, {area(filled_area)}" if pixels else "none", more)
        self._say("off", _off(facts.hidden), _estimated(facts) if pixels else "")

    def set_pending(self, is_pending: bool) -> None:
        """Mark the figures as of older parameters."""
        for button in self.values.values():
            if button.property("pending") != is_pending:
                button.setProperty("pending", is_pending)
                button.style().polish(button)

    def _say(self, name: str, text: str, more: str = "") -> None:
        button = self.values[name]
        button.setText(text)
        button.setToolTip(
            f"{button.whatsThis()}.{f' {more}.' if more else ''} Press to see in the map where."
        )
        button.setAccessibleDescription(text)


def _off(hidden: Hidden | None) -> str:
    return UNKNOWN if hidden is None else f"≈ {distance(hidden.rmse)}, {distance(hidden.p95)}"


def _estimated(facts: FidelityFacts) -> str:
    """Say what the error of filled heights is known from, and what it is in each layer."""
    names = [
        (layer.name, each)
        for layer, each in zip(facts.result.layers, facts.filled, strict=True)
        if each.pixels
    ]
    layers = "; ".join(f"{name} {_off(each.hidden)}" for name, each in names)
    patches = sum(each.hidden.patches for _, each in names if each.hidden is not None)
    return (
        f"Estimated from {grouped(patches)} patches of measured ground, shaped like the holes, that were "
        f"hidden and filled by the same method: {layers}. Where nothing is at all, it may be more"
    )


def _more(distances: Distances, points: int, of: int) -> str:
    drawn = f"{short(points)} of {short(of)} points, an even draw" if points < of else f"{grouped(of)} points"
    missing = f", {grouped(distances.missing)} without a layer there" if distances.missing else ""
    return f"Median {distance(distances.median)}, greatest {distance(distances.max)}, of {drawn}{missing}"


def _label(text: str, tip: str, side: Qt.AlignmentFlag = Qt.AlignmentFlag.AlignLeft) -> QLabel:
    label = QLabel(text)
    label.setProperty("role", "muted")
    label.setToolTip(tip)
    label.setAlignment(side | Qt.AlignmentFlag.AlignVCenter)
    return label
