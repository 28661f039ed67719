"""What every control needs: a name for screen readers, an explanation, a size that gives way."""

from __future__ import annotations

from typing import TypeVar

from PySide6.QtWidgets import QComboBox, QSizePolicy, QWidget

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
