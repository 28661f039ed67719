"""A stack as it will be written: its files in a table, and the image of the one that is chosen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import (
    QAbstractItemView,
    QCheckBox,
    QGridLayout,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QTableWidget,
    QTableWidgetItem,
    QWidget,
)

from stepfield.stack import Manifest
from stepfield_app.appearance import numbers_font
from stepfield_app.export import LayerPreview, StackPreview
from stepfield_app.theme import Theme
from stepfield_app.wording import file_size, grouped

_COLUMNS = ("Image", "Layer", "Pillars", "Heights", "White is", "File", "Mask")
_TIPS = (
    "File name of the layer's image",
    "Name of the layer",
    "Pillars of the layer: occupied pixels",
    "Lowest and greatest height above the base plane, metres",
    "Height above the base plane that is white, metres",
    "Size of the image's file",
    "Size of the mask's file, or of both masks",
)
_METRES = "\N{NO-BREAK SPACE}m"
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter


class StackView(QWidget):
    """Shows a StackPreview; until there is one it says what will be here."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._preview: StackPreview | None = None
        self._files = _FileTable(self)
        self._picture = _Picture(theme, self)
        self._mask = QCheckBox("Show the &mask")
        self._mask.setToolTip("Show the mask in place of the image: white where the height is known")
        self._filled = QCheckBox("Show filled &holes")
        self._filled.setToolTip("Show the mask of the holes that were filled: white where nobody measured")
        self._filled.hide()
        self._size = QLabel("The images will be listed here once the result is there.")
        self._size.setProperty("role", "muted")
        self._size.setWordWrap(True)
        self._files.chosen.connect(self._draw)
        for one, other in ((self._mask, self._filled), (self._filled, self._mask)):
            one.toggled.connect(lambda is_on, other=other: other.setChecked(other.isChecked() and not is_on))
            one.toggled.connect(self._draw)
        self._arrange()

    @property
    def shown(self) -> NDArray[np.uint8] | None:
        """The image on the screen, shape (height, width)."""
        return self._picture.pixels

    def show_preview(self, preview: StackPreview) -> None:
        """Show another stack; the chosen layer stays chosen."""
        self._preview = preview
        self._size.setText(_about(preview.manifest))
        self._files.fill(preview.layers)
        self._filled.setVisible(any(layer.filled is not None for layer in preview.layers))
        self._draw()

    def choose(self, index: int) -> None:
        """Show the image of one layer."""
        self._files.selectRow(index)

    def show_mask(self, wanted: bool) -> None:
        """Show masks in place of images."""
        self._mask.setChecked(wanted)

    def show_filled(self, wanted: bool) -> None:
        """Show masks of what was filled in place of images."""
        self._filled.setChecked(wanted)

    def set_theme(self, theme: Theme) -> None:
        """Draw around the image in the colours of another theme."""
        self._picture.set_theme(theme)

    def _draw(self) -> None:
        index = self._files.currentRow()
        if self._preview is None or not 0 <= index < len(self._preview.layers):
            return
        layer, image = self._preview.layers[index], self._preview.manifest.image
        grid = self._preview.manifest.grid
        column, row = image.offset
        inside = QRectF(
            column / image.width, row / image.height, grid.columns / image.width, grid.rows / image.height
        )
        pixels = layer.mask if self._mask.isChecked() else layer.gray
        if self._filled.isChecked() and self._filled.isVisibleTo(self):
            pixels = np.zeros_like(layer.mask) if layer.filled is None else layer.filled
        self._picture.show_pixels(pixels, inside)

    def _arrange(self) -> None:
        layout = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(8)
        layout.addWidget(self._picture, 0, 0, 2, 1)
        masks = QHBoxLayout()
        masks.addWidget(self._mask)
        masks.addWidget(self._filled)
        masks.addStretch(1)
        layout.addLayout(masks, 2, 0)
        layout.addWidget(self._files, 0, 1)
        layout.addWidget(self._size, 1, 1, 2, 1, Qt.AlignmentFlag.AlignTop)
        layout.setColumnStretch(0, 2)
        layout.setColumnStretch(1, 3)
        layout.setRowStretch(0, 1)


class _FileTable(QTableWidget):
    """One row a layer."""

    chosen = Signal()

    def __init__(self, parent: QWidget) -> None:
        super().__init__(0, len(_COLUMNS), parent)
        self.setAccessibleName("Images of the stack")
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setShowGrid(False)
        self.setTabKeyNavigation(False)
        self.setMinimumWidth(560)
        self.verticalHeader().hide()
        self.verticalHeader().setDefaultSectionSize(26)
        header = self.horizontalHeader()
        header.setHighlightSections(False)
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(1, QHeaderView.ResizeMode.Stretch)
        for column, (name, tip) in enumerate(zip(_COLUMNS, _TIPS, strict=True)):
            item = QTableWidgetItem(name)
            item.setToolTip(tip)
            item.setTextAlignment(_alignment(column))
            self.setHorizontalHeaderItem(column, item)
        self.currentCellChanged.connect(self._tell)

    def fill(self, layers: tuple[LayerPreview, ...]) -> None:
        """List the layers; the chosen row stays chosen where it can."""
        row = min(max(0, self.currentRow()), len(layers) - 1)
        self.setRowCount(len(layers))
        for place, layer in enumerate(layers):
            for column, text in enumerate(_cells(layer)):
                item = QTableWidgetItem(text)
                item.setTextAlignment(_alignment(column))
                if column >= 2:
                    item.setFont(numbers_font())
                self.setItem(place, column, item)
        self.selectRow(row)

    def _tell(self, row: int, column: int, row_before: int, column_before: int) -> None:
        if row != row_before:
            self.chosen.emit()


class _Picture(QWidget):
    """An image with its pixels as they are, and the border of the padding."""

    def __init__(self, theme: Theme, parent: QWidget) -> None:
        super().__init__(parent)
        self.pixels: NDArray[np.uint8] | None = None
        self._image = QImage()
        self._inside = QRectF()
        self._theme = theme
        self.setMinimumSize(256, 256)
        self.setAccessibleName("The chosen image")
        self.setToolTip("The image as it will be written; the line is where its padding begins")

    def sizeHint(self) -> QSize:  # noqa: N802
        """Ask for a square large enough to judge by."""
        return QSize(384, 384)

    def show_pixels(self, pixels: NDArray[np.uint8], inside: QRectF) -> None:
        """Show an image; ``inside`` is the part that is no padding, in shares of its sides."""
        self.pixels, self._inside = pixels, inside
        height, width = pixels.shape
        self._image = QImage(pixels.tobytes(), width, height, width, QImage.Format.Format_Grayscale8).copy()
        self.update()

    def set_theme(self, theme: Theme) -> None:
        """Draw in the colours of another theme."""
        self._theme = theme
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Draw the image as large as it fits."""
        painter = QPainter(self)
        painter.setPen(QPen(QColor(self._theme.line), 1))
        if self._image.isNull():
            painter.drawRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5))
            return
        place = self._place()
        painter.drawImage(place, self._image)
        painter.drawRect(place.adjusted(-0.5, -0.5, 0.5, 0.5))
        painter.setPen(QPen(QColor(self._theme.accent), 1, Qt.PenStyle.DashLine))
        painter.drawRect(_part(place, self._inside))

    def _place(self) -> QRectF:
        size = self._image.size().scaled(self.size() - QSize(2, 2), Qt.AspectRatioMode.KeepAspectRatio)
        left, top = (self.width() - size.width()) // 2, 1
        return QRectF(left, top, size.width(), size.height())


def _part(place: QRectF, share: QRectF) -> QRectF:
    return QRectF(
        place.x() + share.x() * place.width(),
        place.y() + share.y() * place.height(),
        share.width() * place.width(),
        share.height() * place.height(),
    )


def _alignment(column: int) -> Qt.AlignmentFlag:
    return _RIGHT if column >= 2 else Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter


def _cells(layer: LayerPreview) -> tuple[str, ...]:
    entry = layer.entry
    heights = "none" if entry.height_min is None else f"{entry.height_min:.2f} to {entry.height_max:.2f} m"
    return (
        entry.image,
        entry.name,
        grouped(entry.pillars),
        heights,
        f"{layer.white:.2f} m",
        file_size(layer.gray_bytes),
        file_size(layer.mask_bytes),
    )


def _about(manifest: Manifest) -> str:
    image, grid = manifest.image, manifest.grid
    column, row = image.offset
    padded = (image.width, image.height) != (grid.columns, grid.rows)
    padding = f", padded from column {column} and row {row}" if padded else ", without padding"
    return (
        f"Images of {image.width} x {image.height} pixels, {image.bits} bits; "
        f"{grid.columns} x {grid.rows} compartments of {grid.cell_size:g}{_METRES}{padding}. "
        f"Gray {'1 to 255' if image.bits == 8 else '1 to 65535'} is height above the base plane at elevation "
        f"{manifest.base_elevation:.2f}{_METRES}; 0 is unknown."
    )
