"""The strip above a plot: what it shows, and its controls."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QDoubleSpinBox, QHBoxLayout, QLabel, QSizePolicy, QToolButton, QWidget

from stepfield_app.appearance import ICON_SIZE, icon
from stepfield_app.controls import named
from stepfield_app.wording import digits_for, round_step

HEIGHT = 32
SWATCH = 12


class Strip(QWidget):
    """Title with the colour of a layer on the left, controls on the right."""

    def __init__(self, title: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFixedHeight(HEIGHT)
        self._swatch = Swatch()
        self._title = QLabel(title, textFormat=Qt.TextFormat.PlainText)
        self._title.setStyleSheet("font-weight: 600")
        self._detail = QLabel()
        self._detail.setProperty("muted", True)
        self._detail.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(8, 0, 4, 0)
        self._row.setSpacing(8)
        self._row.addWidget(self._swatch)
        self._row.addWidget(self._title)
        self._row.addWidget(self._detail, 1)

    def add(self, *controls: QWidget) -> None:
        """Put controls at the right end."""
        for control in controls:
            self._row.addWidget(control)

    def set_title(self, title: str, colour: str = "") -> None:
        """Say what is shown, and in which colour it is elsewhere."""
        self._title.setText(title)
        self._swatch.set_colour(colour)

    def set_detail(self, text: str) -> None:
        """Say more about it; what does not fit is cut."""
        self._detail.setText(text)
        self._detail.setToolTip(text)

    @property
    def title(self) -> str:
        """What it says is shown."""
        return self._title.text()


class Swatch(QWidget):
    """A small square of a colour; takes no room without one."""

    def __init__(self) -> None:
        super().__init__()
        self._colour = ""
        self.setFixedSize(SWATCH, SWATCH)
        self.hide()

    def set_colour(self, colour: str) -> None:
        """Show another colour."""
        self._colour = colour
        self.setVisible(bool(colour))
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Paint the square."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(self._colour))
        painter.drawRoundedRect(self.rect(), 3, 3)


def tool_button(meaning: str, name: str, tip: str, *, checkable: bool = False) -> QToolButton:
    """Make a flat button with an icon of the window's set."""
    button = named(QToolButton(), name, tip)
    button.setAutoRaise(True)
    button.setCheckable(checkable)
    button.setIcon(icon(meaning))
    button.setIconSize(QSize(ICON_SIZE, ICON_SIZE))
    button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    return button


class WidthBox(QDoubleSpinBox):
    """The width of a profile's band in metres."""

    def __init__(self) -> None:
        super().__init__(suffix=" m", decimals=2, minimum=0.01, maximum=1e6, value=1.0)
        tip = "Width of the band: points in it are in the profile"
        named(self, "Width of the profile band in metres", tip)
        self.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.setKeyboardTracking(False)
        self.setFixedWidth(88)

    def set_cell_size(self, cell_size: float) -> None:
        """Step by compartments, with digits enough to tell a tenth of one."""
        self.setDecimals(min(4, digits_for(round_step(cell_size / 10))))
        self.setSingleStep(cell_size)
        self.setMinimum(10.0 ** -self.decimals())
