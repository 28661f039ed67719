"""The history: steps by name, clicked to go there, thousands of them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from stepfield_app.document import Document
from stepfield_app.panels.history import HistoryPanel

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")  # which the platform without a screen lacks


@pytest.fixture
def document() -> Iterator[Document]:
    document = Document()
    yield document
    document.close()


@pytest.fixture
def panel(document: Document, qtbot: QtBot) -> HistoryPanel:
    panel = HistoryPanel(document)
    qtbot.addWidget(panel)
    panel.setAttribute(Qt.WidgetAttribute.WA_DontShowOnScreen)
    panel.resize(300, 200)
    panel.show()
    return panel


def test_a_click_goes_back_to_a_step(document: Document, panel: HistoryPanel) -> None:
    """Going back ten steps would take ten undos."""
    for name in ("Ground", "Table", "Shelf"):
        document.set_style(f"Rename to {name}", 0, name=name)
    model = panel.view.model()
    texts = [model.index(row, 0).data() for row in range(model.rowCount())]
    assert texts == ["Nothing is open", "Rename to Ground", "Rename to Table", "Rename to Shelf"]
    place = panel.view.visualRect(model.index(1, 0)).center()
    QTest.mouseClick(panel.view.viewport(), Qt.MouseButton.LeftButton, pos=place)
    assert document.style(0).name == "Ground"


def test_rows_are_measured_once(panel: HistoryPanel) -> None:
    """Every step would measure all before it: after thousands, one took tens of milliseconds."""
    assert panel.view.uniformItemSizes()


def test_it_begins_with_what_was_opened(
    panel: HistoryPanel, document: Document, tmp_path: Path, qtbot: QtBot
) -> None:
    """A list that begins with a scan that is not there would offer to go back to it."""
    np.save(tmp_path / "floor.npy", np.random.default_rng(0).random((500, 3)))
    with qtbot.waitSignal(document.opened):
        document.open([tmp_path / "floor.npy"])
    first = panel.view.model().index(0, 0)
    assert first.data() == "As opened"
    document.close_scan()
    assert panel.view.model().index(0, 0).data() == "Nothing is open"
