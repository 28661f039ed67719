"""Suspicious places one after the other: which of how many, what is suspicious there, and on to the next."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QToolButton, QVBoxLayout, QWidget

from stepfield_app.controls import named
from stepfield_app.icons import ICON_SIZE, icon
from stepfield_app.panels.page import GRID
from stepfield_app.wording import counted, grouped

EMPTY = "Open a scan to list the places here where layers are doubtful: close choices, cuts, lone pillars."
FIRST = "Go to the first one with ▶ or the full stop."
CLEAR = "Nothing here is suspicious: no choice of layer was close, no surface is cut, no pillar stands alone."


class SuspectsPanel(QWidget):
    """Shows the suspicious place that the views show, and asks for others."""

    #: By how many places to go on, 1 or -1.
    step_wanted = Signal(int)
    #: The pillars of the place should be selected.
    select_wanted = Signal()
    #: The panel can be seen, and so should what it shows.
    came_to_light = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.number, self.sentence = QLabel(wordWrap=True), QLabel(wordWrap=True)
        self.number.setAccessibleName("Suspicious places")
        self.sentence.setAccessibleName("What is suspicious")
        self.sentence.setAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop)
        self.sentence.setTextFormat(Qt.TextFormat.PlainText)
        self.previous = _button(
            "previous", "Suspicious place before", "Go to the place before (, or Shift+F4)"
        )
        self.next = _button("next", "Next suspicious place", "Go to the next place (. or F4)")
        self.select = _button("target", "Select the place", "Select the pillars of this place")
        row = QHBoxLayout()
        row.setSpacing(GRID // 2)
        row.addWidget(self.number, 1)
        for button in (self.select, self.previous, self.next):
            row.addWidget(button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(GRID, GRID // 2, GRID, GRID)
        layout.setSpacing(GRID // 2)
        layout.addLayout(row)
        layout.addWidget(self.sentence, 1)
        self.previous.clicked.connect(lambda: self.step_wanted.emit(-1))
        self.next.clicked.connect(lambda: self.step_wanted.emit(1))
        self.select.clicked.connect(self.select_wanted)
        self.clear()

    def clear(self) -> None:
        """Say what will be here: no scan is open."""
        self._say("", EMPTY, can_step=False)

    def show_busy(self) -> None:
        """Say that places are being looked for; what was there stays readable meanwhile."""
        if not self.next.isEnabled():
            self._say("Looking…", "", can_step=True)

    def show_count(self, listed: int, found: int) -> None:
        """Say how many places there are, before one is looked at."""
        if found:
            self._say(counted(listed, "place") + _listed(listed, found), FIRST, can_step=True)
        else:
            self._say("No places", CLEAR, can_step=False)

    def show_place(self, number: int, listed: int, found: int, sentence: str) -> None:
        """Show a place by its number, from 1."""
        self._say(
            f"{grouped(number)} of {grouped(listed)}" + _listed(listed, found), f"{sentence}.", can_step=True
        )
        self.select.setEnabled(True)

    def showEvent(self, event: object) -> None:  # noqa: N802
        """Ask for what there is to show."""
        self.came_to_light.emit()

    def _say(self, number: str, sentence: str, *, can_step: bool) -> None:
        self.number.setText(number)
        self.sentence.setText(sentence)
        self.sentence.setProperty("role", "" if number else "muted")
        self.style().polish(self.sentence)
        for button in (self.previous, self.next):
            button.setEnabled(can_step)
        self.select.setEnabled(False)


def _listed(listed: int, found: int) -> str:
    return f" ({grouped(found)} found)" if found > listed else ""


def _button(meaning: str, name: str, tip: str) -> QToolButton:
    button = named(QToolButton(), name, tip)
    button.setAutoRaise(True)
    button.setIconSize(QSize(ICON_SIZE, ICON_SIZE))
    button.setIcon(icon(meaning))
    return button
