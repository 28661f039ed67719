"""The icons of the window: Material Design glyphs, by what they mean, in the colours of the theme.

The glyphs are those QtAwesome ships as a font. Its own Python code is left alone: importing it takes longer
than all the rest of the window's start, and its icons keep the colours of the theme they were made under.
"""

from __future__ import annotations

import importlib.util
import json
from functools import cache
from pathlib import Path

from PySide6.QtCore import QPoint, QPointF, QRect, QSize, Qt
from PySide6.QtGui import (
    QColor,
    QFont,
    QFontDatabase,
    QGuiApplication,
    QIcon,
    QIconEngine,
    QPainter,
    QPalette,
    QPixmap,
)

#: Side of an icon in a toolbar or a button, in logical pixels.
ICON_SIZE = 18

#: What an icon means, and the Material Design glyph that says so.
GLYPHS = {
    # scans, projects, stacks
    "open": "folder-open-outline",
    "demo": "cube-scan",
    "recent": "history",
    "scan": "blur",
    "project": "file-document-outline",
    "save": "content-save-outline",
    "save as": "content-save-edit-outline",
    "export": "export",
    "folder": "folder-outline",
    "show folder": "folder-search-outline",
    "image": "image-outline",
    "images": "image-multiple-outline",
    "screenshot": "camera-outline",
    # editing
    "undo": "undo",
    "redo": "redo",
    "copy": "content-copy",
    "rename": "pencil-outline",
    "reset": "restore",
    "refresh": "refresh",
    "settings": "cog-outline",
    # tools
    "navigate": "cursor-move",
    "click": "cursor-default-click-outline",
    "rectangle": "selection-drag",
    "lasso": "lasso",
    "brush": "brush",
    "surface": "format-color-fill",
    "measure": "ruler",
    "crop": "crop",
    "slab": "arrow-split-horizontal",
    "outliers": "broom",
    "classes": "filter-outline",
    "pick": "eyedropper",
    # selection
    "grow": "arrow-expand-all",
    "shrink": "arrow-collapse-all",
    "invert": "select-inverse",
    "select all": "select-all",
    "clear selection": "selection-off",
    # views
    "iso": "cube-outline",
    "fit": "fit-to-screen-outline",
    "cloud": "blur",
    "pillars": "chart-histogram",
    "reconstruction": "terrain",
    "map": "map-outline",
    "profile": "chart-line",
    "histogram": "chart-bell-curve",
    "overlay": "layers-search-outline",
    "mask": "checkerboard",
    "parallel": "perspective-less",
    "full screen": "fullscreen",
    "search": "magnify",
    "target": "target",
    # layers
    "layers": "layers-outline",
    "new layer": "plus",
    "merge": "call-merge",
    "split": "source-branch",
    "up": "arrow-up",
    "down": "arrow-down",
    "swap": "swap-vertical",
    "locked": "lock",
    "unlocked": "lock-open-variant-outline",
    "visible": "eye-outline",
    "hidden": "eye-off-outline",
    "colour": "palette-outline",
    "remove": "trash-can-outline",
    # saying something
    "error": "close-circle-outline",
    "warning": "alert-outline",
    "info": "information-outline",
    "done": "check",
    "close": "close",
    "cancel": "close",
    "unfold": "chevron-right",
    "fold": "chevron-down",
    "previous": "chevron-left",
    "next": "chevron-right",
    "more": "dots-horizontal",
    "help": "help-circle-outline",
    "shortcuts": "keyboard-outline",
    "theme": "theme-light-dark",
}

#: Corners of a cube seen aslant, shares of an icon's side, clockwise from the top; the last is the nearest.
_CUBE = ((0.5, 0.1), (0.87, 0.3), (0.87, 0.7), (0.5, 0.9), (0.13, 0.7), (0.13, 0.3), (0.5, 0.5))
#: What stands for looking at one face of a cube, and the corners of that face.
FACES = {"top": (0, 1, 6, 5), "front": (5, 6, 3, 4), "side": (1, 2, 3, 6)}
#: Width of the edges of a cube as a share of the icon's side: that of the glyphs' strokes.
_EDGE = 1 / 12

_PREFIX = "materialdesignicons6-webfont"


def icon(meaning: str, colour: str | None = None) -> QIcon:
    """Return the icon for what is meant, sharp at every size and scaling.

    Parameters
    ----------
    meaning : str
        One of :data:`GLYPHS` or :data:`FACES`.
    colour : str, optional
        As #rrggbb; without one the icon takes the text's colour of the theme, also when that changes.

    Raises
    ------
    KeyError
        When no glyph says that.
    """
    if meaning in FACES:
        return QIcon(_CubeEngine(meaning, colour))
    return QIcon(_GlyphEngine(GLYPHS[meaning], colour))


class _Engine(QIconEngine):
    """Draws an icon when asked, in the colour of that moment."""

    def __init__(self, what: str, colour: str | None) -> None:
        super().__init__()
        self._what, self._colour = what, colour

    def paint(self, painter: QPainter, rect: QRect, mode: QIcon.Mode, state: QIcon.State) -> None:
        painter.save()
        painter.setRenderHints(QPainter.RenderHint.TextAntialiasing | QPainter.RenderHint.Antialiasing)
        painter.setPen(self._pen(mode))
        self._draw(painter, rect)
        painter.restore()

    def _draw(self, painter: QPainter, rect: QRect) -> None:
        raise NotImplementedError

    def pixmap(self, size: QSize, mode: QIcon.Mode, state: QIcon.State) -> QPixmap:
        pixmap = QPixmap(size)
        pixmap.fill(Qt.GlobalColor.transparent)
        painter = QPainter(pixmap)
        self.paint(painter, QRect(QPoint(0, 0), size), mode, state)
        painter.end()
        return pixmap

    def clone(self) -> QIconEngine:
        return type(self)(self._what, self._colour)

    def _pen(self, mode: QIcon.Mode) -> QColor:
        palette, text = QGuiApplication.palette(), QPalette.ColorRole.ButtonText
        if mode == QIcon.Mode.Disabled:
            return palette.color(QPalette.ColorGroup.Disabled, text)
        return QColor(self._colour) if self._colour else palette.color(QPalette.ColorGroup.Active, text)


class _GlyphEngine(_Engine):
    """Draws one character of the icon font."""

    def _draw(self, painter: QPainter, rect: QRect) -> None:
        font = QFont(_family())
        font.setPixelSize(max(1, min(rect.width(), rect.height())))
        painter.setFont(font)
        painter.drawText(rect, Qt.AlignmentFlag.AlignCenter, chr(_code_points()[self._what]))


class _CubeEngine(_Engine):
    """Draws a cube with the face one looks at filled: no glyph of the font says that."""

    def _draw(self, painter: QPainter, rect: QRect) -> None:
        side = min(rect.width(), rect.height())
        corner = QPointF(rect.center()) + QPointF(0.5 - side / 2, 0.5 - side / 2)
        places = [corner + QPointF(x, y) * side for x, y in _CUBE]
        pen = painter.pen()
        painter.setBrush(pen.color())
        painter.setPen(Qt.PenStyle.NoPen)
        painter.drawPolygon([places[at] for at in FACES[self._what]])
        pen.setWidthF(_EDGE * side)
        pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
        painter.setPen(pen)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPolygon(places[:6])
        for end in (1, 3, 5):
            painter.drawLine(places[6], places[end])


@cache
def _family() -> str:
    """Load the icon font into the program and return its family."""
    number = QFontDatabase.addApplicationFont(str(_font_file(".ttf")))
    return QFontDatabase.applicationFontFamilies(number)[0]


@cache
def _code_points() -> dict[str, int]:
    named: dict[str, str] = json.loads(_font_file(".json").read_text(encoding="ascii"))
    return {name: int(code, 16) for name, code in named.items() if name in GLYPHS.values()}


def _font_file(suffix: str) -> Path:
    """Find a file of the icon font without importing the package it comes in."""
    package = importlib.util.find_spec("qtawesome")
    if package is None or package.origin is None:
        raise ModuleNotFoundError("QtAwesome, which brings the icons, is not installed")
    return next((Path(package.origin).parent / "fonts").glob(f"{_PREFIX}*{suffix}"))
