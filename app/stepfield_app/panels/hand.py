"""The hand on a control: from when to when its edits are one gesture, and so one undo step."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt, QTimer
from PySide6.QtWidgets import QWidget

from stepfield_app.document import Document
from stepfield_app.edit import Gesture

#: Milliseconds of quiet after which keys and wheel, which know no release, have ended a gesture.
QUIET = 1000


class Hand(QObject):
    """Begins and ends the gestures of one control.

    Parameters
    ----------
    document : Document
    parent : QObject
    """

    def __init__(self, document: Document, parent: QObject) -> None:
        super().__init__(parent)
        self._document = document
        self._gesture: Gesture | None = None
        self._quiet = QTimer(self, singleShot=True, interval=QUIET)
        self._quiet.timeout.connect(self.release)

    def press(self) -> None:
        """Begin a gesture that lasts until the release."""
        self.release()
        self._gesture = self._document.begin_gesture()

    def release(self) -> None:
        """End the gesture."""
        self._quiet.stop()
        if self._gesture is not None:
            gesture, self._gesture = self._gesture, None
            self._document.end_gesture(gesture)

    def touch(self) -> Gesture:
        """Return the gesture of an edit: the one of the press, or one that ends after some quiet."""
        if self._gesture is None:
            self._gesture = self._document.begin_gesture()
            self._quiet.start()
        elif self._quiet.isActive():
            self._quiet.start()
        return self._gesture


class WheelGuard(QObject):
    """Lets the wheel scroll the panel, and not change the value below it, until a control has the focus."""

    def guard(self, *controls: QWidget) -> None:
        """Guard controls."""
        for control in controls:
            control.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            control.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        """Pass the wheel on to what is around a control without focus."""
        if event.type() == QEvent.Type.Wheel and isinstance(watched, QWidget) and not watched.hasFocus():
            event.ignore()
            return True
        return False
