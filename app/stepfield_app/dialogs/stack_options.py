"""How heights become gray levels and pixels: choices that edit the document, with undo."""

from __future__ import annotations

from typing import Any

from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QWidget

from stepfield.parameters import Parameters
from stepfield_app.document import Document

#: Parameter, label, tooltip, and what each value is called.
_CHOICES: dict[str, tuple[str, str, dict[Any, str]]] = {
    "bits": (
        "&Depth",
        "Bits of a pixel: 8 as in the paper, or 16 for finer heights",
        {16: "16 bits, 65 535 levels", 8: "8 bits, 256 levels"},
    ),
    "pad": (
        "&Padding",
        "Whether the images are padded to powers of two, as many engines demand",
        {"pow2": "to powers of two", "none": "none"},
    ),
    "range": (
        "&Range",
        "Whose greatest height is white: one scale for all layers, or each layer its own",
        {"shared": "shared by all layers", "layer": "each layer its own"},
    ),
}


class StackOptions(QWidget):
    """Bit depth, padding and range of the images."""

    def __init__(self, document: Document, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._document = document
        self._boxes: dict[str, QComboBox] = {}
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(8)
        for name, (label, tip, values) in _CHOICES.items():
            box = self._boxes[name] = self._box(name, label, tip, values)
            caption = QLabel(label)
            caption.setBuddy(box)
            layout.addWidget(caption)
            layout.addWidget(box)
            layout.addSpacing(8)
        layout.addStretch()
        self.show_parameters(document.project.parameters)
        document.project_changed.connect(self._follow)

    def show_parameters(self, parameters: Parameters) -> None:
        """Show what is chosen; a new document, an undo or a redo may have changed it."""
        for name, box in self._boxes.items():
            box.setCurrentIndex(box.findData(getattr(parameters, name)))

    def _follow(self) -> None:
        self.show_parameters(self._document.project.parameters)

    def _box(self, name: str, label: str, tip: str, values: dict[Any, str]) -> QComboBox:
        box = QComboBox()
        plain = label.replace("&", "")
        for value, text in values.items():
            box.addItem(text, value)
        box.setToolTip(tip)
        box.setAccessibleName(plain)
        box.activated.connect(
            lambda: self._document.set_parameters(f"{plain} of the images", **{name: box.currentData()})
        )
        return box
