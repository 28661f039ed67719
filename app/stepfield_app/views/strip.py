"""The strip above a view or a panel: its name, what it shows, and its controls."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import QDoubleSpinBox, QHBoxLayout, QLabel, QSizePolicy, QToolButton, QWidget

from stepfield_app.appearance import ICON_SIZE, icon
from stepfield_app.controls import named
from stepfield_app.wording import digits_for, round_step

HEIGHT = 32
SPACING, SWATCH = 6, 12


class Strip(QWidget):
    """Name, subject with the colour of a layer, a remark, and controls at the right end."""

    def __init__(self, title: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFixedHeight(HEIGHT)
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self.setProperty("role", "strip")
        self.title = QLabel(title, textFormat=Qt.TextFormat.PlainText)
        self.title.setProperty("role", "name")
        self._swatch = Swatch()
        self._detail = Detail()
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(8, 0, 4, 0)
        self._row.setSpacing(SPACING)
        self._row.addWidget(self.title)
        self._row.addWidget(self._swatch)
        self._row.addWidget(self._detail, 1)

    def sizeHint(self) -> QSize:  # noqa: N802
        """As high as every strip: a dock asks for this and for nothing else."""
        return QSize(super().sizeHint().width(), HEIGHT)

    def add(self, *controls: QWidget) -> None:
        """Put controls at the right end."""
        for control in controls:
            self._row.addWidget(control)

    def set_subject(self, text: str, colour: str) -> None:
        """Say what is shown, and in which colour it is elsewhere."""
        self._detail.say(text)
        self._swatch.set_colour(colour)

    def set_detail(self, *wordings: str) -> None:
        """Remark on what is shown: the longest of these that fits, see :class:`Detail`."""
        self._detail.say(*wordings)

    @property
    def detail(self) -> str:
        """All that it says of what is shown, also where there is no room for it."""
        return self._detail.toolTip()


class Detail(QLabel):
    """A muted remark in the longest of its wordings that fits, or not at all; never cut."""

    def __init__(self) -> None:
        super().__init__(textFormat=Qt.TextFormat.PlainText)
        self._wordings: tuple[str, ...] = ()
        self.setProperty("role", "muted")
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)

    def say(self, *wordings: str) -> None:
        """Take other wordings, the longest first; the tip always says the longest."""
        if wordings == self._wordings:
            return
        self._wordings = wordings
        self.setToolTip(wordings[0] if wordings else "")
        self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Choose anew."""
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        advance, room = self.fontMetrics().horizontalAdvance, self.contentsRect().width()
        self.setText(next((text for text in self._wordings if advance(text) <= room), ""))


class Swatch(QWidget):
    """A small square of a colour; takes no room without one."""

    def __init__(self) -> None:
        super().__init__()
        self._colour = ""
        self.setFixedSize(SWATCH, SWATCH)
        self.hide()

    def set_colour(self, colour: str) -> None:
        """Show another colour."""
        if colour != self._colour:
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
        self.setFixedWidth(80)

    def set_cell_size(self, cell_size: float) -> None:
        """Step by compartments, with digits enough to tell a tenth of one."""
        self.setDecimals(min(4, digits_for(round_step(cell_size / 10))))
        self.setSingleStep(cell_size)
        self.setMinimum(10.0 ** -self.decimals())
