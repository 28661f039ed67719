"""Points and pillars of a profile as items of a plot, quick enough to follow a hand."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QRectF

from stepfield_app.views.pictures import Section
from stepfield_app.views.pixels import Boxes, PixelItem, Pixels, Place, packed

#: Side of a point, logical pixels.
POINT = 2
#: Opacity of a pillar and of its edge, 0 to 255.
FILL, EDGE = 56, 112
#: The same of a wall, which is told from ground by it.
WALL_FILL, WALL_EDGE = 140, 220


class Dots(PixelItem):
    """Points as small squares."""

    def __init__(self) -> None:
        super().__init__()
        self._x = self._y = np.zeros(0)
        self._colours = np.zeros(0, np.uint32)

    def set_dots(self, section: Section) -> None:
        """Show the points of another section."""
        x, y = section.distance, section.elevation
        self._x, self._y, self._colours = x, y, packed(section.colours)[section.codes]
        self.changed(QRectF(x.min(), y.min(), np.ptp(x), np.ptp(y)) if len(x) else QRectF())

    def write(self, pixels: Pixels, place: Place) -> None:
        """Write the points, later ones over earlier ones."""
        height, width = pixels.shape
        side = max(1, round(POINT * place.ratio))
        column, row = place.columns(self._x) - (side - 1) / 2, place.rows(self._y) - (side - 1) / 2
        seen = (column > 0) & (column < width - side) & (row > 0) & (row < height - side)
        at = row[seen].astype(np.int64) * width + column[seen].astype(np.int64)
        colours, flat = self._colours[seen], pixels.reshape(-1)
        for shift in (down * width + right for down in range(side) for right in range(side)):
            flat[at + shift] = colours


class Blocks(Boxes):
    """Pillars in section: from the lowest to the highest point, with a line at their height; walls denser."""

    def set_blocks(self, section: Section) -> None:
        """Show the pillars of another section, the lines at their heights over all of them."""
        codes, spans = section.pillar_codes, section.spans
        insides, edges = (packed(section.colours, opacity)[codes] for opacity in (FILL, EDGE))
        walls = np.flatnonzero(section.vertical)
        insides[walls] = packed(section.colours, WALL_FILL)[codes[walls]]
        edges[walls] = packed(section.colours, WALL_EDGE)[codes[walls]]
        self.set_boxes(spans, insides, edges)
        self.set_lines(np.column_stack([spans[:, :2], section.tops]), packed(section.colours)[codes])
