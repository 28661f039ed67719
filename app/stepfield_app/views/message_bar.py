"""The bar that says what went wrong or has to be decided: one sentence a message, there until dismissed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAccessible, QAccessibleEvent, QGuiApplication, QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QPlainTextEdit,
    QPushButton,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from stepfield_app.appearance import icon, numbers_font
from stepfield_app.theme import Theme

Level = Literal["error", "warning", "info"]

#: More messages than this wait below until the newer ones are dismissed.
SHOWN = 3


@dataclass(frozen=True)
class Choice:
    """What can be done about a message."""

    text: str
    tip: str
    do: Callable[[], object]


@dataclass(frozen=True)
class Message:
    """What the operator should know, what would help whoever mends it, and what can be done.

    Dismissing a message that has choices is the last of them.
    """

    level: Level
    sentence: str
    details: str = ""
    choices: tuple[Choice, ...] = ()


class MessageBar(QWidget):
    """Messages, the newest on top; takes no room while there are none."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._rows: list[_Row] = []
        self._waiting = QLabel(self)
        self._waiting.setProperty("role", "muted")
        self._waiting.setContentsMargins(8, 0, 8, 0)
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(8, 4, 8, 4)
        self._layout.setSpacing(4)
        self._layout.addWidget(self._waiting)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self.setAccessibleName("Messages")
        escape = QShortcut(QKeySequence(Qt.Key.Key_Escape), self)
        escape.setContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        escape.activated.connect(self.dismiss_newest)
        self._arrange()

    @property
    def messages(self) -> tuple[Message, ...]:
        """All that has not been dismissed, the newest first."""
        return tuple(row.message for row in self._rows)

    def tell(self, level: Level, sentence: str, details: str = "", choices: Sequence[Choice] = ()) -> None:
        """Show a message; one that is there already moves to the top instead of standing there twice."""
        message = Message(level, sentence, details, tuple(choices))
        for row in [row for row in self._rows if row.message == message]:
            self._remove(row)
        row = _Row(message, self._theme, self)
        row.dismissed.connect(self._leave)
        row.chosen.connect(self._choose)
        self._rows.insert(0, row)
        self._layout.insertWidget(0, row)
        self._arrange()
        QAccessible.updateAccessibility(QAccessibleEvent(row, QAccessible.Event.Alert))

    def dismiss_newest(self) -> bool:
        """Take the newest message away; False when there was none, so that Esc can mean something else."""
        if not self._rows:
            return False
        self._leave(self._rows[0])
        return True

    def dismiss_all(self) -> None:
        """Take every message away that asks nothing."""
        for row in [row for row in self._rows if not row.message.choices]:
            self._dismiss(row)

    def set_theme(self, theme: Theme) -> None:
        """Draw the icons in the colours of another theme."""
        self._theme = theme
        for row in self._rows:
            row.set_theme(theme)

    def _leave(self, row: _Row) -> None:
        """Dismiss a message; of one that asks something, that is the last answer."""
        self._choose(row, row.message.choices[-1] if row.message.choices else None)

    def _choose(self, row: _Row, choice: Choice | None) -> None:
        self._dismiss(row)
        if choice is not None:
            choice.do()

    def _dismiss(self, row: _Row) -> None:
        had_focus = row.isAncestorOf(self.focusWidget()) if self.focusWidget() else False
        self._remove(row)
        self._arrange()
        if had_focus and self._rows:
            self._rows[0].close_button.setFocus()

    def _remove(self, row: _Row) -> None:
        self._rows.remove(row)
        self._layout.removeWidget(row)
        row.hide()
        row.deleteLater()

    def _arrange(self) -> None:
        for place, row in enumerate(self._rows):
            row.setVisible(place < SHOWN)
        waiting = max(0, len(self._rows) - SHOWN)
        self._waiting.setText(f"{waiting} earlier below; dismiss these to see them")
        self._waiting.setVisible(waiting > 0)
        self.setVisible(bool(self._rows))


class _Row(QFrame):
    """One message."""

    dismissed = Signal(object)  # this row
    chosen = Signal(object, object)  # this row, Choice

    def __init__(self, message: Message, theme: Theme, parent: QWidget) -> None:
        super().__init__(parent)
        self.message = message
        self.setProperty("level", message.level)
        self.setAccessibleName(f"{message.level}: {message.sentence}")
        self._sign = QLabel(self)
        self._details = _Details(message, self)
        self.close_button = _button("close", "Dismiss this message (Esc)", self)
        self.close_button.clicked.connect(lambda: self.dismissed.emit(self))
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 4, 4, 4)
        layout.setSpacing(4)
        layout.addLayout(self._line())
        layout.addWidget(self._details)
        self.set_theme(theme)

    def set_theme(self, theme: Theme) -> None:
        colours = {"error": theme.error, "warning": theme.warning, "info": theme.accent}
        self._sign.setPixmap(icon(self.message.level, colours[self.message.level]).pixmap(18, 18))

    def _line(self) -> QHBoxLayout:
        sentence = QLabel(self.message.sentence, self)
        sentence.setTextFormat(Qt.TextFormat.PlainText)
        sentence.setWordWrap(True)
        sentence.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        line = QHBoxLayout()
        line.setSpacing(8)
        line.addWidget(self._sign)
        line.addWidget(sentence, 1)
        if self.message.details:
            line.addWidget(self._unfold_button())
        for choice in self.message.choices:
            line.addWidget(self._choice_button(choice))
        line.addWidget(self.close_button)
        return line

    def _choice_button(self, choice: Choice) -> QPushButton:
        button = QPushButton(choice.text, self)
        button.setToolTip(choice.tip)
        button.setAutoDefault(False)
        button.clicked.connect(lambda: self.chosen.emit(self, choice))
        return button

    def _unfold_button(self) -> QToolButton:
        button = _button("unfold", "Show or hide what lies behind this message", self)
        button.setText("Details")
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        button.setCheckable(True)
        button.toggled.connect(self._details.setVisible)
        button.toggled.connect(lambda open_: button.setIcon(icon("fold" if open_ else "unfold")))
        return button


class _Details(QWidget):
    """What lies behind a message, to read and to copy."""

    def __init__(self, message: Message, parent: QWidget) -> None:
        super().__init__(parent)
        self._text = f"{message.sentence}\n\n{message.details}"
        text = QPlainTextEdit(message.details, self)
        text.setReadOnly(True)
        text.setFont(numbers_font())
        text.setFixedHeight(120)
        text.setTabChangesFocus(True)
        text.setAccessibleName("Details")
        text.setToolTip("What lies behind this message")
        copy = QPushButton(icon("copy"), "Copy", self)
        copy.setToolTip("Copy the message and its details")
        copy.clicked.connect(lambda: QGuiApplication.clipboard().setText(self._text))
        layout = QHBoxLayout(self)
        layout.setContentsMargins(26, 0, 4, 4)
        layout.addWidget(text, 1)
        layout.addWidget(copy, 0, Qt.AlignmentFlag.AlignTop)
        self.hide()


def _button(meaning: str, tip: str, parent: QWidget) -> QToolButton:
    button = QToolButton(parent)
    button.setIcon(icon(meaning))
    button.setToolTip(tip)
    button.setAccessibleName(tip)
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    return button
