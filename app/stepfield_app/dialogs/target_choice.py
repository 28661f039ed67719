"""For which simulators files are written beside the images."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QCheckBox, QHBoxLayout, QLabel, QWidget

from stepfield.targets import WHAT

#: What the targets are called, where their names are not words.
TITLES = {
    "mesh": "&Meshes",
    "geotiff": "&GeoTIFF",
    "mujoco": "M&uJoCo",
    "pybullet": "Py&Bullet",
    "gazebo": "Ga&zebo",
    "usarsim": "USARS&im",
}


class TargetChoice(QWidget):
    """A box a target."""

    changed = Signal()

    def __init__(self, chosen: Sequence[str], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(16)
        layout.addWidget(QLabel("Also write"))
        self.boxes = {name: _box(name, what, name in chosen) for name, what in WHAT.items()}
        for box in self.boxes.values():
            box.toggled.connect(lambda _: self.changed.emit())
            layout.addWidget(box)
        layout.addStretch()

    @property
    def names(self) -> tuple[str, ...]:
        """Targets that are chosen, in their order."""
        return tuple(name for name, box in self.boxes.items() if box.isChecked())


def _box(name: str, what: str, is_chosen: bool) -> QCheckBox:
    box = QCheckBox(TITLES[name])
    box.setChecked(is_chosen)
    box.setToolTip(f"{what[:1].upper()}{what[1:]}, in a folder {name} within the stack")
    box.setAccessibleName(f"Also write {name}: {what}")
    return box
