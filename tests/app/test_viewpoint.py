"""The camera that three views share: it moves at once, and rests once nobody stirs it."""

from __future__ import annotations

from pytestqt.qtbot import QtBot

from stepfield_app.views.viewpoint import PRESETS, Viewpoint


def test_it_moves_at_once_and_rests_later(qtbot: QtBot) -> None:
    """If it failed, the full picture would be drawn under a moving hand, or never."""
    viewpoint, states = Viewpoint(), list[bool]()
    viewpoint.changed.connect(lambda: states.append(viewpoint.is_moving))
    viewpoint.look(viewpoint.camera.orbited(10, 0))
    assert states == [True]
    qtbot.waitUntil(lambda: not viewpoint.is_moving)
    assert states == [True, False]


def test_every_stir_puts_the_rest_off(qtbot: QtBot) -> None:
    """If it failed, a slow hand would see the picture flicker between coarse and fine."""
    viewpoint, states = Viewpoint(), list[bool]()
    viewpoint.changed.connect(lambda: states.append(viewpoint.is_moving))
    for _ in range(30):
        viewpoint.stir()
    assert states == [True] * 30
    assert viewpoint._quiet.remainingTime() > 0
    qtbot.waitUntil(lambda: not viewpoint.is_moving)
    assert states.count(False) == 1


def test_nothing_rests_while_a_hand_holds_a_control(qtbot: QtBot) -> None:
    """If it failed, a slow picture in full would be drawn between two steps of a slider."""
    viewpoint = Viewpoint()
    viewpoint.set_held(True)
    viewpoint.stir()
    qtbot.waitUntil(lambda: not viewpoint._quiet.isActive())
    assert viewpoint.is_moving
    viewpoint.set_held(False)
    qtbot.waitUntil(lambda: not viewpoint.is_moving)


def test_a_stir_keeps_the_camera(qtbot: QtBot) -> None:
    viewpoint = Viewpoint()
    before = viewpoint.camera
    viewpoint.stir()
    assert viewpoint.camera is before


def test_presets_look_where_they_say() -> None:
    """If it failed, *From the south* would show another side."""
    camera = Viewpoint().camera
    directions = {name: camera.looking(*angles).forward.round(6).tolist() for name, angles in PRESETS.items()}
    assert directions["top"] == [0, 0, -1]
    assert directions["front"] == [0, 1, 0], "from the south one looks north"
    assert directions["side"] == [-1, 0, 0], "from the east one looks west"
    assert directions["iso"][2] < 0
