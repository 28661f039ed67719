"""The frame of the window: all that its first picture shows, before there is anything to work on."""

from __future__ import annotations

import traceback

from PySide6.QtCore import QSize
from PySide6.QtWidgets import QMainWindow

from stepfield.errors import StepfieldError
from stepfield_app import docks, toolbars
from stepfield_app.appearance import Appearance
from stepfield_app.first_paint import FirstPaint
from stepfield_app.settings import Settings
from stepfield_app.views.centre import Centre
from stepfield_app.views.message_bar import MessageBar
from stepfield_app.views.status import Status
from stepfield_app.views.welcome import WelcomePage

#: Size of the window when nothing else is said and the screen is large enough.
USUAL_SIZE = QSize(1440, 900)


class Frame(QMainWindow):
    """Menus, toolbars, docks that are still blank, the status bar, a page that says what can be opened.

    Nothing here may import what fills it, which takes longer to load than all of this.

    Parameters
    ----------
    appearance : Appearance
    settings : Settings
    size : tuple of int, optional
        Width and height in pixels; as the operator left it by default.
    remembers : bool
        False leaves the operator's arrangement and recent files alone.

    Attributes
    ----------
    status : Status
    message_bar : MessageBar
    welcome : WelcomePage
    centre : Centre
    docks : Docks
    first_paint : FirstPaint
    trouble : StepfieldError or None
        What went wrong last, since a scan was opened.
    """

    def __init__(
        self,
        appearance: Appearance,
        settings: Settings,
        *,
        size: tuple[int, int] | None = None,
        remembers: bool = True,
    ) -> None:
        super().__init__()
        self.setWindowTitle("Stepfield")
        self.resize(QSize(*size) if size else USUAL_SIZE.boundedTo(self.screen().availableSize()))
        self.setDockOptions(QMainWindow.DockOption.AllowTabbedDocks | QMainWindow.DockOption.AllowNestedDocks)
        self.appearance, self.settings, self.remembers = appearance, settings, remembers
        self.trouble: StepfieldError | None = None
        self.first_paint = FirstPaint(self)
        self.welcome = WelcomePage(settings.recent)
        self.message_bar = MessageBar(appearance.theme)
        self.centre = Centre(self.message_bar, self.welcome)
        self.setCentralWidget(self.centre)
        self.status = Status(self)
        self.setStatusBar(self.status)
        toolbars.sketch(self, self.welcome.open_wanted.emit)
        self.docks = docks.make(self)
        if remembers:
            docks.restore(self, settings, with_size=size is None)

    def tell(self, error: BaseException) -> None:
        """Show a failure, in the one place that shows any."""
        if isinstance(error, StepfieldError):
            self.trouble = error
            self.message_bar.tell("error", str(error))
        else:
            self.tell_unexpected("".join(traceback.format_exception(error)))

    def tell_unexpected(self, details: str) -> None:
        """Show a fault of the program's own, with what helps to mend it."""
        self.trouble = StepfieldError("something unexpected went wrong in the window; the details say what")
        self.message_bar.tell(
            "error", f"{self.trouble}. Your scan and its parameters are as they were.", details
        )
