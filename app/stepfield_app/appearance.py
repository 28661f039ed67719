"""How the window looks: Fusion, one palette and one style sheet, following the system's light or dark."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Literal

from PySide6.QtCore import QObject, Qt, QTemporaryDir, Signal
from PySide6.QtGui import QColor, QFont, QPalette
from PySide6.QtWidgets import QApplication

from stepfield_app.icons import GLYPHS, ICON_SIZE, icon
from stepfield_app.style_sheet import mixed, on_accent, style_sheet
from stepfield_app.theme import DARK, LIGHT, Theme

__all__ = ["GLYPHS", "ICON_SIZE", "Appearance", "Choice", "icon", "numbers_font", "palette", "text_font"]

#: Height of text, in logical pixels.
TEXT_SIZE = 13

Choice = Literal["system", "light", "dark"]

_SCHEMES = {"light": Qt.ColorScheme.Light, "dark": Qt.ColorScheme.Dark, "system": Qt.ColorScheme.Unknown}


class Appearance(QObject):
    """Dresses the application, and says when the theme has changed.

    Parameters
    ----------
    application : QApplication
    choice : str
        ``system`` follows the desktop, also when that changes; dark where the desktop says nothing.
    """

    changed = Signal(object)  # Theme

    def __init__(self, application: QApplication, choice: Choice = "system") -> None:
        super().__init__(application)
        self._application = application
        self._choice: Choice = choice
        self._theme: Theme | None = None
        self._marks = QTemporaryDir()
        application.setStyle("Fusion")
        application.setFont(text_font())
        application.styleHints().colorSchemeChanged.connect(self._dress)
        self.choose(choice)

    @property
    def theme(self) -> Theme:
        """The theme in use."""
        return self._theme or DARK

    @property
    def choice(self) -> Choice:
        """What was asked for."""
        return self._choice

    def choose(self, choice: Choice) -> None:
        """Use one theme, or follow the system."""
        self._choice = choice
        hints = self._application.styleHints()
        hints.setColorScheme(_SCHEMES[choice])  # for what the desktop itself draws
        self._dress(hints.colorScheme())

    @contextmanager
    def undressed(self) -> Iterator[None]:
        """Take the style sheet off while a window is made: widgets put it on anew with every parent."""
        sheet = self._application.styleSheet()
        self._application.setStyleSheet("")
        try:
            yield
        finally:
            self._application.setStyleSheet(sheet)

    def _dress(self, system: Qt.ColorScheme) -> None:
        """Put the colours on that go with the system's scheme and the operator's choice."""
        theme = self._wanted(system)
        if theme is self._theme:
            return
        self._theme = theme
        self._application.setPalette(palette(theme))
        self._application.setStyleSheet(style_sheet(theme, Path(self._marks.path())))
        self.changed.emit(theme)

    def _wanted(self, system: Qt.ColorScheme) -> Theme:
        if self._choice == "system":
            return LIGHT if system == Qt.ColorScheme.Light else DARK
        return LIGHT if self._choice == "light" else DARK


def text_font() -> QFont:
    """Return the font of the window: the system's family at 13 logical pixels."""
    font = QFont(QApplication.font().families())
    font.setPixelSize(TEXT_SIZE)
    return font


def numbers_font(font: QFont | None = None) -> QFont:
    """Return a font whose digits are all of one width, so that changing numbers do not jump."""
    numbers = QFont(font) if font else text_font()
    numbers.setFeature(QFont.Tag("tnum"), 1)
    return numbers


def palette(theme: Theme) -> QPalette:
    """Return the colours of a theme by the roles Qt knows."""
    role = QPalette.ColorRole
    made = QPalette()
    for each, colour in {
        role.Window: theme.window,
        role.WindowText: theme.text,
        role.Base: theme.field,
        role.AlternateBase: theme.panel,
        role.Text: theme.text,
        role.Button: theme.panel,
        role.ButtonText: theme.text,
        role.BrightText: theme.error,
        role.PlaceholderText: theme.muted,
        role.ToolTipBase: theme.field,
        role.ToolTipText: theme.text,
        role.Highlight: theme.accent,
        role.Accent: theme.accent,
        role.HighlightedText: on_accent(theme),
        role.Link: theme.accent,
        role.LinkVisited: theme.accent,
        role.Light: mixed(theme.panel, theme.text, 0.08),
        role.Midlight: theme.panel,
        role.Mid: theme.line,
        role.Dark: theme.line,
        role.Shadow: theme.window,
    }.items():
        made.setColor(each, QColor(colour))
    faded = QColor(mixed(theme.muted, theme.panel, 0.45))
    for each in (role.WindowText, role.Text, role.ButtonText, role.HighlightedText):
        made.setColor(QPalette.ColorGroup.Disabled, each, faded)
    made.setColor(QPalette.ColorGroup.Disabled, role.Highlight, QColor(theme.line))
    return made
