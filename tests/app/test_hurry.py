"""When views draw coarsely: while a hand moves, and while the exact result of its preview is on its way."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from PySide6.QtCore import QObject, Signal
from pytestqt.qtbot import QtBot

from stepfield_app.feeds import hurry as module
from stepfield_app.feeds.hurry import Hurry


class Acted(QObject):
    """What a document says about hands and answers."""

    held_changed = Signal(bool)
    answer_changed = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.held = False
        self.answer: Any = None

    def hold(self, is_held: bool) -> None:
        self.held = is_held
        self.held_changed.emit(is_held)

    def show(self, *, quick: bool) -> None:
        self.answer = SimpleNamespace(request=SimpleNamespace(quick=quick))
        self.answer_changed.emit(self.answer)


@pytest.fixture
def document(qapp: object) -> Acted:
    return Acted()


@pytest.fixture
def hurry(document: Acted) -> Hurry:
    return Hurry(document, document)  # type: ignore[arg-type]  # as much of one as it looks at


def test_a_preview_is_in_a_hurry_until_its_exact_result_is_there(document: Acted, hurry: Hurry) -> None:
    told: list[bool] = []
    hurry.changed.connect(told.append)
    document.show(quick=False)
    document.hold(True)
    document.show(quick=True)
    document.hold(False)
    assert hurry, "the preview would be drawn in full while the exact result is made"
    document.show(quick=True)
    assert hurry
    document.show(quick=False)
    assert not hurry
    assert told == [True, False]


def test_an_exact_result_is_drawn_in_full_as_soon_as_the_hand_rests(document: Acted, hurry: Hurry) -> None:
    document.hold(True)
    document.show(quick=False)
    document.hold(False)
    assert not hurry


def test_nobody_waits_long_for_an_exact_result(
    document: Acted, monkeypatch: pytest.MonkeyPatch, qtbot: QtBot
) -> None:
    monkeypatch.setattr(module, "PATIENCE", 10)
    hurry = Hurry(document, document)  # type: ignore[arg-type]
    document.hold(True)
    document.show(quick=True)
    with qtbot.waitSignal(hurry.changed):
        document.hold(False)
    assert not hurry, "the preview stays coarse for as long as the exact result takes"


def test_the_first_preview_of_a_scan_is_drawn_in_full(document: Acted, hurry: Hurry) -> None:
    document.show(quick=True)
    assert not hurry
