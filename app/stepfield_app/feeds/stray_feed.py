"""Points that an outlier filter would drop: counted and shown before anything is dropped."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, Signal

from stepfield_app.document import Document
from stepfield_app.feeds.scene_feed import SceneFeed
from stepfield_app.newest import NewestWins
from stepfield_app.panels.cleaning import CleaningPanel
from stepfield_app.stray import Stray, StrayQuestion, find_stray


class StrayFeed(QObject):
    """Connects the outliers of the cleaning panel with the cloud view."""

    failed = Signal(object)  # exception

    def __init__(self, document: Document, panel: CleaningPanel, scene_feed: SceneFeed) -> None:
        super().__init__(document)
        self._document, self._panel, self._scene_feed = document, panel, scene_feed
        self._worker = NewestWins[StrayQuestion, Stray](find_stray, "outliers", self)
        self._worker.answered.connect(self._show)
        self._worker.failed.connect(lambda _, error: self.failed.emit(error))
        panel.preview_requested.connect(self._ask)

    @property
    def is_idle(self) -> bool:
        """Whether nothing is being looked for."""
        return not self._worker.busy

    def close(self) -> None:
        """End the worker."""
        self._worker.close()

    def _ask(self, mode: Any) -> None:
        facts = self._document.facts
        if mode == "off" or facts is None:
            self._worker.cancel()
            self._scene_feed.set_marks(None)
        else:
            self._panel.show_outlier_count(None)
            self._worker.ask(StrayQuestion(facts.scan, self._document.project.parameters, mode))

    def _show(self, question: StrayQuestion, stray: Stray) -> None:
        self._panel.show_outlier_count(len(stray), stray.among)
        self._scene_feed.set_marks(stray.places)
