"""The status bar: where the pointer is, what the result holds, what is going on; nothing in it jumps."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QSizePolicy, QStatusBar, QToolButton, QWidget

from stepfield_app.appearance import icon, numbers_font
from stepfield_app.views.strip import Detail
from stepfield_app.wording import counted, duration, grouped, short

_GAP = 24
#: Milliseconds that a sentence stays over the figures.
SAID_FOR = 6000


class Status(QStatusBar):
    """Figures of fixed places, and the progress of what runs with a button to stop it."""

    cancel_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setSizeGripEnabled(False)
        self.setAccessibleName("Status")
        self._position = _Figure("x 888 888.88  y 8 888 888.88  z 888.88 m", "Position")
        self._cell = _Figure("cell 888, 888: 8 surfaces + 1 wall", "Compartment: column, row, surfaces in it")
        self._result = _Figure("8 888 888 pillars, 88 layers", "What the result holds")
        self._points = _Figure("8.88 M points", "Points of the scan")
        self._time = _Figure("made in 888 ms", "Time the last result took")
        self._work = _Work(self)
        self._work.cancel.clicked.connect(self.cancel_wanted)
        for figure in (self._position, self._cell, self._result, self._points, self._time):
            self.addWidget(figure)
        self._selection = Detail()
        self._selection.setProperty("role", "")
        self._selection.setAccessibleName("Selection")
        self.addWidget(self._selection, 1)
        self.addPermanentWidget(self._work)

    def show_position(self, x: float, y: float, z: float | None = None, decimals: int = 2) -> None:
        """Say where the pointer is, metres in the scan's coordinates; no ``z`` where nothing is known."""
        known = "" if z is None else f"  z {_metres(z, decimals)}"
        self._position.setText(f"x {_metres(x, decimals)}  y {_metres(y, decimals)}{known} m")

    def show_cell(self, row: int, column: int, surfaces: int, walls: int = 0, filled: int = 0) -> None:
        """Say which compartment the pointer is in, and how many surfaces, walls and filled places it has."""
        standing = counted(walls, "wall") if walls else ""
        level = counted(surfaces, "surface") if surfaces or not (walls or filled) else ""
        unmeasured = f"{filled} filled" if filled else ""
        parts = " + ".join(filter(None, (level, standing, unmeasured)))
        self._cell.setText(f"cell {column}, {row}: {parts}")

    def show_selection(self, *wordings: str) -> None:
        """Say what is selected, in the longest of these wordings that there is room for."""
        self._selection.say(*wordings)

    def say(self, sentence: str) -> None:
        """Say for a while what was done, or why not."""
        self.showMessage(sentence, SAID_FOR)

    def clear_position(self) -> None:
        """Say nothing of the pointer: it is over no data."""
        self._position.setText("")
        self._cell.setText("")

    def show_result(self, pillars: int, layers: int, points: int, seconds: float) -> None:
        """Say what the result holds and how long it took."""
        self._result.setText(f"{counted(pillars, 'pillar')}, {counted(layers, 'layer')}")
        self._points.setText(f"{short(points)} points")
        self._points.setToolTip(f"Points of the scan: {grouped(points)}")
        self._time.setText(f"made in {duration(seconds)}")

    def clear_result(self) -> None:
        """Say nothing of a result: there is none."""
        for figure in (self._result, self._points, self._time):
            figure.setText("")

    def show_progress(self, share: float, what: str) -> None:
        """Show how much of the work is done, 0 to 1, and what is being done."""
        self._work.show_progress(share, what)

    def clear_progress(self) -> None:
        """Show that nothing is going on; the place stays free for the next time."""
        self._work.clear()


class _Figure(QLabel):
    """A text in tabular figures that asks for the same room whatever it says."""

    def __init__(self, widest: str, tip: str) -> None:
        super().__init__()
        self._widest = widest
        self.setFont(numbers_font())
        self.setToolTip(tip)
        self.setAccessibleName(tip)

    def sizeHint(self) -> QSize:  # noqa: N802
        """Return the room of the widest text there will be."""
        return QSize(self.fontMetrics().horizontalAdvance(self._widest) + _GAP, super().sizeHint().height())

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """Give way where the window is narrow, but never cut a number."""
        least = super().minimumSizeHint()
        return QSize(min(least.width(), self.sizeHint().width()), least.height())


class _Work(QWidget):
    """What is being done, how much of it, and a button to stop it; keeps its room while nothing is."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._what = _Figure("reading a_scan.laz, 88 %", "What is being done")
        self._what.setMinimumWidth(1)
        self._what.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self._bar = QProgressBar()
        self._bar.setRange(0, 1000)
        self._bar.setTextVisible(False)
        self._bar.setFixedWidth(96)
        self._bar.setToolTip("How much of it is done")
        self._bar.setAccessibleName("Progress")
        self.cancel = QToolButton()
        self.cancel.setIcon(icon("cancel"))
        self.cancel.setToolTip("Stop this (Esc)")
        self.cancel.setAccessibleName("Stop")
        # No wider where figures give way to a sentence: that would be cut by what is not there.
        self.setSizePolicy(QSizePolicy.Policy.Maximum, QSizePolicy.Policy.Preferred)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 4, 0)
        layout.setSpacing(4)
        for widget in (self._what, self._bar, self.cancel):
            layout.addWidget(widget)
            policy = widget.sizePolicy()
            policy.setRetainSizeWhenHidden(True)
            widget.setSizePolicy(policy)
        self.clear()

    def show_progress(self, share: float, what: str) -> None:
        self._bar.setValue(round(1000 * share))
        room = self._what.sizeHint().width() - _GAP
        self._what.setText(self.fontMetrics().elidedText(what, Qt.TextElideMode.ElideMiddle, room))
        self._show(True)

    def clear(self) -> None:
        self._show(False)

    def _show(self, working: bool) -> None:
        for widget in (self._what, self._bar, self.cancel):
            widget.setVisible(working)


def _metres(value: float, decimals: int) -> str:
    sign = "\N{MINUS SIGN}" if round(value, decimals) < 0 else ""
    whole, _, rest = f"{abs(value):.{decimals}f}".partition(".")
    return f"{sign}{grouped(int(whole))}" + (f".{rest}" if rest else "")
