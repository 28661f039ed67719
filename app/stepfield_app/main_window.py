"""The window: its frame, then what fills it, and what can be done with all of it; holds no data."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QDialog

from stepfield.parameters import Parameters
from stepfield_app import docks
from stepfield_app.afterwards import Afterwards
from stepfield_app.appearance import Appearance
from stepfield_app.dropping import DropTarget
from stepfield_app.frame import Frame
from stepfield_app.settings import Settings
from stepfield_app.theme import Theme

if TYPE_CHECKING:
    from stepfield_app.actions import Actions
    from stepfield_app.commands.filing import Filing
    from stepfield_app.workbench import Workbench


class MainWindow(Frame):
    """Stepfield's window.

    Parameters
    ----------
    appearance, settings, size, remembers
        As of a :class:`Frame`.
    in_pieces : bool
        Whether it is filled after its first paint, and not at once.

    Attributes
    ----------
    bench : Workbench
        Everything to work with; like ``filing`` and ``commands`` not there before the window is ready.
    filing : Filing
    commands : Actions
    ready : Signal
        All is there.
    """

    bench: Workbench
    filing: Filing
    commands: Actions

    def __init__(
        self,
        appearance: Appearance,
        settings: Settings,
        *,
        size: tuple[int, int] | None = None,
        remembers: bool = True,
        in_pieces: bool = False,
    ) -> None:
        super().__init__(appearance, settings, size=size, remembers=remembers)
        self._afterwards = Afterwards(_load, self._fill, self)
        self.ready = self._afterwards.done
        self.welcome.open_wanted.connect(partial(self.when_ready, lambda: self.filing.choose_files()))
        self.welcome.demo_wanted.connect(partial(self.when_ready, lambda: self.bench.feeds.demo.start()))
        self.welcome.files_chosen.connect(self.open_scans)
        DropTarget(self).dropped.connect(self.open_scans)
        if in_pieces:
            self.first_paint.then(self._afterwards.begin)
        else:
            self._afterwards.finish()

    # --- Making ---------------------------------------------------------------------------------------------

    def _fill(self) -> Iterator[None]:
        """Make all that the frame lacks; each piece takes less than an eye notices."""
        commands, filing, workbench = _load()
        with self._as_painted():
            self.bench = workbench.Workbench(self)
            yield from self.bench.fill()
            self.filing = filing.Filing(self.bench)
            self.commands = commands.make(self.bench, self.filing)
            yield
            self._connect()

    @contextmanager
    def _as_painted(self) -> Iterator[None]:
        """Leave what is on the screen as it is: all that is new comes into sight at once."""
        self.setUpdatesEnabled(False)
        try:
            yield
        finally:
            self.setUpdatesEnabled(True)

    def _connect(self) -> None:
        self.bench.document.answer_changed.connect(lambda _: self._show_whether_open())
        self.bench.feeds.demo.made.connect(self.open_scans)
        self.status.cancel_wanted.connect(self._cancel)
        self.appearance.changed.connect(self._dress)  # which outlives the window, and lets go of its methods
        self._dress(self.appearance.theme)
        self._show_whether_open()

    @property
    def is_ready(self) -> bool:
        """Whether everything is there."""
        return self._afterwards.is_done

    def when_ready(self, call: Callable[[], object]) -> None:
        """Call when everything is there."""
        if self.is_ready:
            call()
        else:
            self.ready.connect(call)

    # --- Doing ----------------------------------------------------------------------------------------------

    def open_scans(self, files: Sequence[Path], parameters: Parameters | None = None) -> None:
        """Open the files of one scan, or a project; the present one stays until the new one has been read."""
        self.when_ready(lambda: self.filing.open(files, parameters))

    def close_at_once(self) -> None:
        """Close, and ask nothing: edits are kept for the next time."""
        if self.is_ready:
            self.filing.close_at_once()
        else:
            self.close()

    def _cancel(self) -> None:
        """Stop what is being made."""
        self.filing.cancel()
        self.bench.cancel()

    def is_settled(self) -> bool:
        """Whether everything that was asked for is on the screen."""
        return self.is_ready and self.filing.is_idle and self.bench.is_settled()

    # --- Following ------------------------------------------------------------------------------------------

    def _show_whether_open(self) -> None:
        """Show the views while a scan is open, and what can be opened while there is none."""
        is_open = self.bench.document.answer is not None
        if self.is_ready and is_open == self.centre.shows_views:
            return
        self.centre.show_views(is_open)
        self.commands.enable(is_open)
        self.bench.mark_box.setEnabled(is_open)
        if is_open:
            self.bench.trio.setFocus()

    def _dress(self, theme: Theme) -> None:
        """Put on the colours of a theme."""
        self.message_bar.set_theme(theme)
        self.bench.dress(theme)

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        """Stop everything; no process and no thread is left."""
        self._afterwards.stop()
        if not self.is_ready:
            return
        if not self.filing.may_close():
            event.ignore()
            return
        if self.remembers:
            docks.remember(self, self.settings)
        for dialog in self.findChildren(QDialog):
            dialog.done(QDialog.DialogCode.Rejected)  # a signal closes the window under an open dialog
        self.filing.close()
        self.bench.close()
        super().closeEvent(event)


def _load() -> tuple[ModuleType, ModuleType, ModuleType]:
    """Import what fills the window: it takes longer than all before the first paint."""
    from stepfield_app import commands, workbench
    from stepfield_app.commands import filing

    return commands, filing, workbench
