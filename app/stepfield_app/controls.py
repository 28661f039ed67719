"""What every control needs: a name for screen readers, an explanation, a size that gives way."""

from __future__ import annotations

from typing import TypeVar

from PySide6.QtWidgets import QComboBox, QSizePolicy, QWidget

#: Edges, padding and arrow of a box beside its text, logical pixels.
BESIDE_TEXT = 34

Control = TypeVar("Control", bound=QWidget)


def named(control: Control, name: str, explanation: str) -> Control:
    """Give a control its tooltip and the name that screen readers say."""
    control.setAccessibleName(name)
    control.setToolTip(explanation)
    return control


def shrinkable(box: QComboBox) -> QComboBox:
    """Let a box be narrower than its longest entry."""
    box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
    box.setMinimumContentsLength(8)
    box.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
    return box


def snug(box: QComboBox) -> QComboBox:
    """Make a box just wide enough for its longest entry."""
    advance = box.fontMetrics().horizontalAdvance
    box.setFixedWidth(max((advance(box.itemText(at)) for at in range(box.count())), default=0) + BESIDE_TEXT)
    return box
