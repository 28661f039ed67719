"""What stands below the list of layers: what can be done with them, and what moved pillars do to others."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QEvent, QObject, QSize, Qt, Signal
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QButtonGroup, QHBoxLayout, QLabel, QToolButton, QVBoxLayout, QWidget

from stepfield_app.controls import named
from stepfield_app.editor import PILLARS_MIME, Conflict
from stepfield_app.icons import ICON_SIZE, icon

#: Name, icon, text, and explanation of the buttons: first those with a text, then those that act at once.
BUTTONS = (
    ("new", "new layer", "New", "Make an empty layer (Ctrl+Shift+N); drop pillars here for a layer of them"),
    ("merge", "merge", "Merge…", "Put the active layer into another one (Ctrl+M)"),
    ("split", "split", "Split…", "Part the active layer at an elevation (Ctrl+Shift+M)"),
    ("up", "up", "", "Exchange the active layer with the one above (Ctrl+Up)"),
    ("down", "down", "", "Exchange the active layer with the one below (Ctrl+Down)"),
    ("lock", "unlocked", "", "Lock the active layer: nothing goes into or out of it (Ctrl+L)"),
)
NAMES = {"up": "Layer up", "down": "Layer down", "lock": "Lock the layer"}
CHOICES: tuple[tuple[Conflict, str, str], ...] = (
    ("swap", "swap", "A pillar in the way of a moved one goes where that one came from"),
    ("leave", "leave", "A pillar in the way stays, and so does the one that was to be moved there"),
)


class LayersBar(QWidget):
    """Buttons, and the switch for places that are taken."""

    pressed = Signal(str)  # name of a button
    lock_wanted = Signal(bool)
    pillars_dropped = Signal()  # on the button that makes a layer
    conflict_chosen = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setProperty("role", "foot")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self._active: tuple[int, int, bool] | None = None
        self.buttons: dict[str, QToolButton] = {}
        self.choices: dict[str, QToolButton] = {}
        layout = QVBoxLayout(self)
        layout.setContentsMargins(2, 4, 2, 4)
        layout.setSpacing(4)
        for button in BUTTONS:
            self._add_button(*button)
        layout.addLayout(_row([self.buttons[name] for name in ("new", "merge", "split")]))
        layout.addLayout(
            _row([self.buttons[name] for name in ("up", "down", "lock")], [self._label(), *self._switch()])
        )
        self.buttons["lock"].setCheckable(True)
        self.buttons["new"].setAcceptDrops(True)
        self.buttons["new"].installEventFilter(self)

    def set_active(self, index: int, count: int, is_locked: bool) -> None:
        """Offer what can be done with a layer; -1 is Unassigned."""
        if (index, count, is_locked) == self._active:  # as at nearly every step of a slider
            return
        self._active = index, count, is_locked
        is_layer = 0 <= index < count
        can = {
            "new": True,
            "merge": is_layer and count > 1,
            "split": is_layer,
            "up": is_layer and index < count - 1,
            "down": is_layer and index > 0,
            "lock": is_layer,
        }
        for name, is_possible in can.items():
            self.buttons[name].setEnabled(is_possible)
        self.buttons["lock"].setChecked(is_layer and is_locked)
        self.buttons["lock"].setIcon(icon("locked" if is_layer and is_locked else "unlocked"))

    def set_conflict(self, conflict: str) -> None:
        """Show what becomes of pillars in the way."""
        self.choices[conflict].setChecked(True)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        """Let pillars be dropped on the button that makes a layer."""
        if isinstance(event, QDragEnterEvent) and event.mimeData().hasFormat(PILLARS_MIME):
            event.acceptProposedAction()
            return True
        if type(event) is QDropEvent:
            event.acceptProposedAction()
            self.pillars_dropped.emit()
            return True
        return False

    def _add_button(self, name: str, glyph: str, text: str, tip: str) -> None:
        button = named(_button(text), NAMES.get(name, text.rstrip("…")), tip)
        button.setIcon(icon(glyph))
        button.setIconSize(QSize(ICON_SIZE, ICON_SIZE))
        style = Qt.ToolButtonStyle
        button.setToolButtonStyle(style.ToolButtonTextBesideIcon if text else style.ToolButtonIconOnly)
        button.clicked.connect(lambda is_on: self._press(name, is_on))
        self.buttons[name] = button

    def _press(self, name: str, is_on: bool) -> None:
        if name == "lock":
            self.lock_wanted.emit(is_on)
        else:
            self.pressed.emit(name)

    def _label(self) -> QLabel:
        label = QLabel("Taken:")
        label.setProperty("role", "muted")
        label.setToolTip("What happens where a moved pillar finds its place taken")
        return label

    def _switch(self) -> list[QToolButton]:
        """Make the switch for places that are taken."""
        group = QButtonGroup(self)
        for conflict, text, tip in CHOICES:
            button = named(_button(text), f"Taken places: {text}", tip)
            button.setCheckable(True)
            button.clicked.connect(lambda _, conflict=conflict: self.conflict_chosen.emit(conflict))
            group.addButton(button)
            self.choices[conflict] = button
        return list(self.choices.values())


def _row(left: Sequence[QWidget], right: Sequence[QWidget] = ()) -> QHBoxLayout:
    """Lay some things out at the left end, some at the right."""
    row = QHBoxLayout()
    row.setSpacing(2)
    for widget in left:
        row.addWidget(widget)
    row.addStretch(1)
    for widget in right:
        row.addWidget(widget)
    return row


def _button(text: str) -> QToolButton:
    button = QToolButton()
    button.setText(text)
    button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    return button
