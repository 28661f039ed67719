"""A question with a few answers, each of which says what it does; it blocks nothing but its own window."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QAbstractButton, QLabel, QMessageBox, QPushButton, QWidget

from stepfield_app.appearance import icon

Role = QMessageBox.ButtonRole
#: Side of the sign, and least width of the text beside it.
_SIGN, _WIDTH = 32, 360


@dataclass(frozen=True)
class Answer:
    """One of the answers; without something to do it leaves everything as it is."""

    text: str
    tip: str
    role: QMessageBox.ButtonRole = Role.RejectRole
    do: Callable[[], object] | None = None


class Question(QMessageBox):
    """Asks; the first answer is the usual one, Esc stands for the last.

    Parameters
    ----------
    title, sentence : str
        What is asked.
    more : str
        What depends on it.
    answers : sequence of Answer
    parent : QWidget
    """

    def __init__(
        self, title: str, sentence: str, more: str, answers: Sequence[Answer], parent: QWidget
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.setIconPixmap(icon("warning").pixmap(_SIGN, _SIGN))
        self.setStyleSheet(f"QLabel#qt_msgbox_label {{ min-width: {_WIDTH}px; }}")
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setText(sentence)
        self.setInformativeText(more)
        if (label := self.findChild(QLabel, "qt_msgbox_informativelabel")) is not None:
            label.setProperty("role", "muted")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        buttons = [self._button(answer) for answer in answers]
        self._answers: dict[QAbstractButton, Answer] = dict(zip(buttons, answers, strict=True))
        self.setDefaultButton(buttons[0])
        self.setEscapeButton(buttons[-1])
        self.finished.connect(self._do)

    def choose(self, text: str) -> None:
        """Answer as if the button of that text were clicked."""
        next(button for button in self._answers if button.text() == text).click()

    def _button(self, answer: Answer) -> QPushButton:
        button = self.addButton(answer.text, answer.role)
        button.setToolTip(answer.tip)
        return button

    def _do(self) -> None:
        """Do what was answered; a dialog that was closed in another way leaves everything as it is."""
        answer = self._answers.get(self.clickedButton())
        if answer is not None and answer.do is not None:
            answer.do()
