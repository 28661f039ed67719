"""Messages from the window, read by a thread so that the drawing one can look up without waiting."""

from __future__ import annotations

from collections.abc import Callable
from threading import Condition, Thread
from typing import BinaryIO

from stepfield_app.render.protocol import Draw, Message, SetScene, message

#: Seconds without a message after which it is quiet.
QUIET = 1.0


class Inbox:
    """Messages not yet taken, in order.

    Parameters
    ----------
    pipe : binary file
        Where they come from.
    at_end : callable
        Called once no more can come, on the thread that reads.
    at_quiet : callable
        Called by who waits for the next one, once none has come for a while.
    """

    def __init__(self, pipe: BinaryIO, at_end: Callable[[], None], at_quiet: Callable[[], None]) -> None:
        self._pipe, self._at_end, self._at_quiet = pipe, at_end, at_quiet
        self._waiting: list[Message] = []
        self._changed = Condition()
        Thread(target=self._read, name="inbox", daemon=True).start()

    def take(self, wait: bool) -> list[Message]:
        """Take all there are; with ``wait`` at least one."""
        with self._changed:
            if wait and not self._waiting and not self._changed.wait(QUIET):
                self._at_quiet()
            while wait and not self._waiting:
                self._changed.wait()
            taken, self._waiting = self._waiting, []
        return taken

    def has_news(self, view: str) -> bool:
        """Whether a full picture of this view should wait: it is out of date, or a hand moves."""
        with self._changed:
            return any(
                (isinstance(sent, Draw) and (sent.moving or sent.view == view))
                or (isinstance(sent, SetScene) and sent.view == view)
                for sent in self._waiting
            )

    def _read(self) -> None:
        try:
            for text in self._pipe:
                received = message(text)
                with self._changed:
                    self._waiting.append(received)
                    self._changed.notify()
        finally:  # whatever went wrong: without messages there is nothing to live for
            self._at_end()
