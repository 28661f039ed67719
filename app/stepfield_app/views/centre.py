"""The middle of the window: messages, the strip of the tool in use, and the views or what can be opened."""

from __future__ import annotations

from PySide6.QtWidgets import QStackedWidget, QVBoxLayout, QWidget


class Centre(QWidget):
    """Stacks messages above a page that greets, until there are views to be shown instead of it.

    Parameters
    ----------
    messages, greeting : QWidget
    """

    def __init__(self, messages: QWidget, greeting: QWidget) -> None:
        super().__init__()
        self._greeting = greeting
        self._views: QWidget | None = None
        self._stack = QStackedWidget()
        self._stack.addWidget(greeting)
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(0)
        self._column.addWidget(messages)
        self._column.addWidget(self._stack, 1)

    def add(self, views: QWidget, strip: QWidget) -> None:
        """Add what stands here while a scan is open, and what stands above it while a tool is in use."""
        self._views = views
        self._stack.addWidget(views)
        self._column.insertWidget(1, strip)

    @property
    def shows_views(self) -> bool:
        """Whether the views are shown, and not the greeting."""
        return self._views is not None and self._stack.currentWidget() is self._views

    def show_views(self, are_wanted: bool) -> None:
        """Show the views, or the greeting."""
        shown = self._views if are_wanted else self._greeting
        if shown is not None:
            self._stack.setCurrentWidget(shown)
