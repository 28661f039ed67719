"""Controls for lengths: metres in the document, the unit that suits their size on the screen."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QMouseEvent, QValidator
from PySide6.QtWidgets import QDoubleSpinBox, QSlider, QStyle, QStyleOptionSlider, QWidget

from stepfield_app.appearance import numbers_font

#: Units to type and to show, in metres.
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
#: Ranges that end below these many metres are shown in a smaller unit.
LEAST_IN_METRES, LEAST_IN_CENTIMETRES = 1.0, 0.05
#: Positions of a slider.
STEPS = 1000
#: Digits of a number that a slider chooses.
DIGITS = 3

_TYPED = re.compile(r"\s*([-+]?[\d.,]*\d[.,]?(?:e[-+]?\d+)?)\s*(m|cm|mm)?\s*", re.IGNORECASE)
_ON_THE_WAY = re.compile(r"\s*[-+]?[\d.,]*(?:e[-+]?\d*)?\s*[cm]{0,2}\s*", re.IGNORECASE)


@dataclass(frozen=True)
class Range:
    """What a length may sensibly be, metres: from ``low``, above zero, to ``high``."""

    low: float
    high: float

    @property
    def unit(self) -> str:
        """The unit that shows such lengths with few digits."""
        if self.high >= LEAST_IN_METRES:
            return "m"
        return "cm" if self.high >= LEAST_IN_CENTIMETRES else "mm"

    def position(self, length: float) -> int:
        """Place of a length among the slider's steps, equal ratios apart; the ends beyond the range."""
        share = math.log(max(length, self.low) / self.low) / math.log(self.high / self.low)
        return min(STEPS, round(STEPS * share))

    def length(self, position: int) -> float:
        """Length at a place of the slider, rounded to a few digits."""
        return rounded(self.low * (self.high / self.low) ** (position / STEPS))


def rounded(length: float) -> float:
    """Round to ``DIGITS`` digits."""
    return float(f"{length:.{DIGITS}g}")


def written(length: float, unit: str = "m") -> str:
    """Write a length with as many digits as its size needs, and its unit: 0.25 m."""
    value = length / UNITS[unit]
    decimals = max(0, 2 - math.floor(math.log10(abs(value)))) if value else 0
    text = f"{value:.{min(decimals, 9)}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return f"{text} {unit}"


class LengthBox(QDoubleSpinBox):
    """A spin box that holds metres exactly and shows them in a unit; takes ``25 cm`` as well as ``0.25``.

    ``chosen`` comes from the operator only.
    """

    chosen = Signal(float)

    def __init__(
        self, parent: QWidget | None = None, *, least: float = 1e-6, decimals: int | None = None
    ) -> None:
        super().__init__(parent)
        self._unit, self._fixed_decimals = "m", decimals
        self.setDecimals(12)
        self.setRange(least, 1e9)
        self.setStepType(QDoubleSpinBox.StepType.AdaptiveDecimalStepType)
        self.setKeyboardTracking(False)
        self.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.setFont(numbers_font(self.font()))
        self.valueChanged.connect(self.chosen)

    def set_unit(self, unit: str) -> None:
        """Show lengths in another unit."""
        self._unit = unit
        self.show_length(self.value())

    def show_length(self, length: float) -> None:
        """Show a length without saying that it was chosen; what is being typed stays."""
        if length == self.value() and self.lineEdit().text() == self.textFromValue(length):
            return
        blocked = self.blockSignals(True)
        self.setValue(length)
        self.lineEdit().setText(self.textFromValue(self.value()))
        self.blockSignals(blocked)

    def textFromValue(self, value: float) -> str:  # noqa: N802
        """Write metres in the unit."""
        if self._fixed_decimals is not None:
            return f"{value / UNITS[self._unit]:.{self._fixed_decimals}f} {self._unit}"
        return written(value, self._unit)

    def valueFromText(self, text: str) -> float:  # noqa: N802
        """Read a length; text that was not edited is the exact value it stands for."""
        if text == self.textFromValue(self.value()):
            return self.value()
        length = read_length(text, self._unit)
        return self.value() if length is None else length

    def validate(self, text: str, place: int) -> tuple[QValidator.State, str, int]:
        """Accept whatever reads as a length or may become one."""
        if read_length(text, self._unit) is not None:
            return QValidator.State.Acceptable, text, place
        on_the_way = _ON_THE_WAY.fullmatch(text) is not None
        return (QValidator.State.Intermediate if on_the_way else QValidator.State.Invalid), text, place


def read_length(text: str, unit: str) -> float | None:
    """Read metres from text as an operator types it, in ``unit`` unless it names one; None if it is none."""
    match = _TYPED.fullmatch(text)
    if match is None:
        return None
    try:
        return float(match[1].replace(",", ".")) * UNITS[(match[2] or unit).lower()]
    except ValueError:
        return None


class LengthSlider(QSlider):
    """A slider over a range of lengths, equal ratios apart; a click on the groove takes the handle there."""

    chosen = Signal(float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self._range = Range(0.001, 1.0)
        super().setRange(0, STEPS)
        self.setSingleStep(STEPS // 200)
        self.setPageStep(STEPS // 20)
        self.valueChanged.connect(lambda position: self.chosen.emit(self._range.length(position)))

    def set_lengths(self, lengths: Range) -> None:
        """Take another range."""
        self._range = lengths

    def show_length(self, length: float) -> None:
        """Move the handle to a length, unless a hand holds it."""
        if not self.isSliderDown() and self._range.length(self.value()) != rounded(length):
            blocked = self.blockSignals(True)
            self.setValue(self._range.position(length))
            self.blockSignals(blocked)

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Bring the handle under the mouse, then let Qt drag it."""
        option = QStyleOptionSlider()
        self.initStyleOption(option)
        style, complex_control = self.style(), QStyle.ComplexControl.CC_Slider
        handle = style.subControlRect(complex_control, option, QStyle.SubControl.SC_SliderHandle, self)
        place = event.position().toPoint()
        if event.button() == Qt.MouseButton.LeftButton and not handle.contains(place):
            groove = style.subControlRect(complex_control, option, QStyle.SubControl.SC_SliderGroove, self)
            reach = groove.width() - handle.width()
            self.sliderPressed.emit()  # so that the jump belongs to the gesture
            self.setValue(
                QStyle.sliderValueFromPosition(0, STEPS, place.x() - groove.x() - handle.width() // 2, reach)
            )
        super().mousePressEvent(event)
