"""Messages stay until dismissed, can be unfolded and copied, and leave room when there are none."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFrame, QPlainTextEdit, QPushButton, QToolButton, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from stepfield_app.theme import DARK, LIGHT
from stepfield_app.views.message_bar import SHOWN, Choice, MessageBar

#: Qt's platform for tests without a screen says so at every window.
pytestmark = pytest.mark.qt_log_ignore("This plugin does not support", extend=True)


@pytest.fixture
def bar(qtbot: QtBot) -> Iterator[MessageBar]:
    """Return a bar in a window."""
    window = QWidget()
    made = MessageBar(DARK)
    layout = QVBoxLayout(window)
    layout.addWidget(made)
    layout.addStretch()
    window.resize(600, 400)
    qtbot.addWidget(window)
    window.show()
    yield made
    window.close()


def rows(bar: MessageBar) -> list[QFrame]:
    """Return the messages that can be seen, from top to bottom."""
    found = [row for row in bar.findChildren(QFrame) if row.property("level") and row.isVisibleTo(bar)]
    return sorted(found, key=lambda row: row.y())


def test_nothing_to_say_takes_no_room(bar: MessageBar) -> None:
    """If it failed, an empty stripe would stand above the views."""
    assert bar.isHidden()
    bar.tell("info", "Something is so.")
    assert not bar.isHidden()
    assert bar.dismiss_newest()
    assert bar.isHidden()


def test_newest_is_on_top_and_a_repeated_one_stands_there_once(bar: MessageBar) -> None:
    """If it failed, a message that comes with every slider step would bury all others."""
    bar.tell("error", "First.")
    bar.tell("warning", "Second.")
    bar.tell("error", "First.")
    assert [message.sentence for message in bar.messages] == ["First.", "Second."]


def test_many_messages_leave_the_views_their_room(bar: MessageBar, qtbot: QtBot) -> None:
    """If it failed, messages would push the data off the screen, or be lost."""
    for number in range(SHOWN + 2):
        bar.tell("warning", f"Number {number}.")
    assert len(rows(bar)) == SHOWN
    for _ in range(SHOWN + 1):
        bar.dismiss_newest()
    assert [message.sentence for message in bar.messages] == ["Number 0."]
    assert len(rows(bar)) == 1


def test_details_unfold_and_can_be_copied(bar: MessageBar, qtbot: QtBot) -> None:
    """If it failed, nobody could report what lies behind a message."""
    bar.tell("error", "It failed.", "line 1\nline 2")
    details = bar.findChild(QPlainTextEdit)
    assert details is not None
    assert not details.isVisible()
    unfold = next(button for button in bar.findChildren(QToolButton) if button.text() == "Details")
    QTest.mouseClick(unfold, Qt.MouseButton.LeftButton)
    assert details.isVisible()
    copy = bar.findChild(QPushButton)
    assert copy is not None
    QTest.mouseClick(copy, Qt.MouseButton.LeftButton)
    assert QGuiApplication.clipboard().text() == "It failed.\n\nline 1\nline 2"


def test_escape_dismisses_from_within_the_bar(bar: MessageBar, qtbot: QtBot) -> None:
    """If it failed, the bar could not be cleared without a mouse."""
    bar.tell("error", "One.")
    bar.tell("error", "Two.")
    bar.window().activateWindow()
    close = [button for button in bar.findChildren(QToolButton) if button.isVisible()][-1]
    close.setFocus()
    qtbot.waitUntil(close.hasFocus)
    QTest.keyClick(close, Qt.Key.Key_Escape)
    assert [message.sentence for message in bar.messages] == ["One."]
    focused = bar.focusWidget()
    assert focused is not None
    QTest.keyClick(focused, Qt.Key.Key_Escape)
    assert bar.messages == ()
    assert not bar.dismiss_newest(), "Esc must be free for tools once nothing is left to dismiss"


def test_another_theme_keeps_the_messages(bar: MessageBar) -> None:
    """If it failed, a desktop turning light at sunrise would clear what the operator has not read."""
    bar.tell("info", "Still here.", "details")
    bar.set_theme(LIGHT)
    assert [message.sentence for message in bar.messages] == ["Still here."]


def test_a_message_can_be_answered_and_dismissing_it_is_the_last_answer(bar: MessageBar) -> None:
    """If it failed, edits offered back would be neither opened nor left for later."""
    done: list[str] = []
    choices = [Choice(text, f"Do {text}", lambda text=text: done.append(text)) for text in ("Open", "Later")]  # type: ignore[misc]
    bar.tell("info", "Recover?", choices=choices)
    buttons = {button.text(): button for button in bar.findChildren(QPushButton)}
    assert buttons["Open"].toolTip() == "Do Open"
    buttons["Open"].click()
    assert (done, bar.messages) == (["Open"], ())
    bar.tell("info", "Recover?", choices=choices)
    bar.dismiss_newest()
    assert (done, bar.messages) == (["Open", "Later"], ())


def test_a_question_stays_when_other_messages_are_cleared_away(bar: MessageBar) -> None:
    """Opening a scan clears the messages: an offer to recover must outlive it."""
    bar.tell("info", "Recover?", choices=[Choice("Later", "Not now", lambda: None)])
    bar.tell("error", "Something is wrong.")
    bar.dismiss_all()
    assert [message.sentence for message in bar.messages] == ["Recover?"]
