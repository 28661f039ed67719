"""Figures and searches wait for the views, but not for ever."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QObject
from pytestqt.qtbot import QtBot

from stepfield_app.feeds import courtesy as module
from stepfield_app.feeds.courtesy import Courtesy


class Views(QObject):
    """Whether they are drawn, and how often somebody asked."""

    drawn, asked = False, 0

    def is_drawn(self) -> bool:
        self.asked += 1
        return self.drawn


@pytest.fixture
def views(qapp: object) -> Views:
    return Views()


def test_it_waits_until_the_views_are_drawn(qtbot: QtBot, views: Views) -> None:
    courtesy = Courtesy(1, views.is_drawn, views)
    told: list[bool] = []
    courtesy.passed.connect(lambda: told.append(views.drawn))
    courtesy.start()
    qtbot.waitUntil(lambda: views.asked >= 2)
    assert courtesy.is_active
    views.drawn = True
    qtbot.waitUntil(lambda: told == [True])
    assert not courtesy.is_active, "figures would be made twice"


def test_a_view_that_never_rests_does_not_stop_it(
    qtbot: QtBot, views: Views, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "PATIENCE", 1)
    courtesy = Courtesy(1, views.is_drawn, views)
    with qtbot.waitSignal(courtesy.passed):
        courtesy.start()
    assert not views.drawn


def test_what_is_stopped_says_nothing(qtbot: QtBot, views: Views) -> None:
    courtesy, other = Courtesy(1, views.is_drawn, views), Courtesy(2, lambda: True, views)
    courtesy.passed.connect(lambda: pytest.fail("it was stopped"))
    views.drawn = True
    courtesy.start()
    with qtbot.waitSignal(other.passed):
        other.start()
        courtesy.stop()
