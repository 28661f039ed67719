"""The layers panel as an editor: drops, dragged rows, buttons, lock, menus."""

from __future__ import annotations

from itertools import pairwise

import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt
from PySide6.QtGui import QDragEnterEvent, QDragLeaveEvent, QDragMoveEvent, QDropEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QWidget
from pytestqt.qtbot import QtBot
from tests.app.editing import Desk

from stepfield_app.editor import PILLARS_MIME
from stepfield_app.panels.layers import LayersPanel
from stepfield_app.panels.layers_drops import COUNTING
from stepfield_app.panels.layers_editing import TO_BE_CHOSEN, LayersEditing
from stepfield_app.panels.layers_model import LAYER_MIME, Notice
from stepfield_app.panels.move_menu import fill_move_menu
from stepfield_app.panels.row_layout import ROW_HEIGHT, RowLayout
from stepfield_app.scenes.summary import summaries
from stepfield_app.theme import LIGHT

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")  # which the platform without a screen lacks


@pytest.fixture
def panel(qtbot: QtBot, desk: Desk) -> LayersPanel:
    panel = LayersPanel(desk.document)
    qtbot.addWidget(panel)
    panel.setAttribute(Qt.WidgetAttribute.WA_DontShowOnScreen)
    panel.resize(300, 420)
    panel.show()
    panel.set_layers(summaries(desk.result))
    return panel


@pytest.fixture
def editing(desk: Desk, panel: LayersPanel) -> LayersEditing:
    editing = LayersEditing(desk.document, panel, desk.editor)
    QApplication.processEvents()  # so that the list has its place above the buttons
    return editing


class Drag:
    """A hand that drags something over a widget."""

    def __init__(self, target: QWidget, mime: str, content: str) -> None:
        self._target, self._data = target, QMimeData()
        self._data.setData(mime, content.encode())
        self._rest = (
            Qt.DropAction.MoveAction,
            self._data,
            Qt.MouseButton.LeftButton,
            Qt.KeyboardModifier.NoModifier,
        )

    def enter(self, place: QPoint) -> bool:
        event = QDragEnterEvent(place, *self._rest)
        QApplication.sendEvent(self._target, event)
        return event.isAccepted()

    def move(self, place: QPoint) -> bool:
        event = QDragMoveEvent(place, *self._rest)
        QApplication.sendEvent(self._target, event)
        return event.isAccepted()

    def leave(self) -> None:
        QApplication.sendEvent(self._target, QDragLeaveEvent())

    def drop(self, place: QPoint) -> None:
        QApplication.sendEvent(self._target, QDropEvent(QPointF(place), *self._rest))


def row_of(panel: LayersPanel, layer: int) -> QPoint:
    """Middle of a layer's row."""
    return panel.view.visualRect(panel.model.index(panel.model.row_of(layer))).center()


def notice(panel: LayersPanel, layer: int) -> Notice | None:
    return panel.model.rows[panel.model.row_of(layer)].notice


def entries(menu: QMenu) -> dict[str, bool]:
    """Texts of a menu and whether they can be chosen."""
    return {action.text().split("\t")[0]: action.isEnabled() for action in menu.actions() if action.text()}


def test_a_row_says_what_a_drop_would_do_and_the_drop_does_it(
    desk: Desk, panel: LayersPanel, editing: LayersEditing, qtbot: QtBot
) -> None:
    """Pillars would be dropped blindly, or not at all."""
    desk.select(1, 40)
    drag = Drag(panel.view.viewport(), PILLARS_MIME, "40")
    assert drag.enter(row_of(panel, 0))
    drag.move(row_of(panel, 0))
    qtbot.waitUntil(lambda: notice(panel, 0) == Notice("move 40, swap 40"))
    assert drag.move(row_of(panel, 2))
    assert notice(panel, 0) is None
    drag.drop(row_of(panel, 0))
    assert notice(panel, 0) is None
    desk.settle()
    assert desk.steps == ["Move 40 pillars to Layer 1"]


def test_a_locked_row_refuses_in_words(
    desk: Desk, panel: LayersPanel, editing: LayersEditing, qtbot: QtBot
) -> None:
    """A drop would silently do nothing."""
    desk.editor.set_locked(0, True)
    desk.select(1, 40)
    drag = Drag(panel.view.viewport(), PILLARS_MIME, "40")
    drag.enter(row_of(panel, 0))
    drag.move(row_of(panel, 0))
    qtbot.waitUntil(lambda: notice(panel, 0) == Notice("Layer 1 is locked", is_refusal=True))
    assert not drag.move(row_of(panel, 0))
    drag.leave()
    assert notice(panel, 0) is None
    panel.set_theme(LIGHT)
    assert not panel.grab().isNull()


def test_while_plans_are_made_the_row_says_so(
    desk: Desk, panel: LayersPanel, editing: LayersEditing, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A row would stay mute under a large selection."""
    monkeypatch.setattr(desk.editor, "preview", lambda target: None)
    desk.select(1, 40)
    drag = Drag(panel.view.viewport(), PILLARS_MIME, "40")
    drag.enter(row_of(panel, 2))
    assert drag.move(row_of(panel, 2))
    assert notice(panel, 2) == COUNTING


def test_a_drop_below_the_rows_makes_a_layer(
    desk: Desk, panel: LayersPanel, editing: LayersEditing, qtbot: QtBot
) -> None:
    """A surface of its own would take a detour over an empty layer."""
    desk.select(1, 40)
    below = QPoint(100, panel.view.below_rows() + 20)
    drag = Drag(panel.view.viewport(), PILLARS_MIME, "40")
    drag.enter(below)
    drag.move(below)
    qtbot.waitUntil(lambda: panel.view.foot == Notice("New layer: move 40"))
    assert not panel.grab().isNull()
    drag.drop(below)
    assert panel.view.foot is None
    desk.settle()
    assert desk.counts[3] == 40


def test_pillars_dropped_on_the_button_make_a_layer(
    desk: Desk, panel: LayersPanel, editing: LayersEditing
) -> None:
    """A full list would have no place to drop them for a layer of their own."""
    desk.select(1, 40)
    drag = Drag(editing.bar.buttons["new"], PILLARS_MIME, "40")
    assert drag.enter(QPoint(5, 5))
    drag.drop(QPoint(5, 5))
    desk.settle()
    assert desk.counts[3] == 40


def test_what_is_no_pillar_is_not_taken(panel: LayersPanel, editing: LayersEditing) -> None:
    """A file dropped on the panel would look as if it were taken."""
    assert not Drag(panel.view.viewport(), "text/uri-list", "file:///x").enter(QPoint(50, 20))


@pytest.mark.parametrize(
    ("layer", "over", "half", "place"),
    [
        (2, 0, "lower", 0),
        (0, 2, "upper", 2),
        (2, 1, "lower", 1),
        (0, -1, "lower", None),
        (1, 1, "upper", None),
    ],
)
def test_a_dragged_row_goes_where_the_line_is(
    desk: Desk,
    panel: LayersPanel,
    editing: LayersEditing,
    monkeypatch: pytest.MonkeyPatch,
    layer: int,
    over: int,
    half: str,
    place: int | None,
) -> None:
    """A layer would land beside the place that was shown, or below Unassigned."""
    wishes: list[tuple[int, int]] = []
    monkeypatch.setattr(desk.editor, "reorder", lambda *wish: wishes.append(wish))
    offset = QPoint(0, ROW_HEIGHT // 4 if half == "lower" else -ROW_HEIGHT // 4)
    drag = Drag(panel.view.viewport(), LAYER_MIME, str(layer))
    drag.enter(row_of(panel, layer))
    assert drag.move(row_of(panel, over) + offset) == (place is not None)
    assert panel.view.gap is not None
    assert not panel.grab().isNull()
    if place is not None:
        drag.drop(row_of(panel, over) + offset)
        assert wishes == [(layer, place)]
        assert panel.view.gap is None


def test_a_row_carries_its_layer(panel: LayersPanel, editing: LayersEditing) -> None:
    """Another layer would be dragged along."""
    data = panel.model.mimeData([panel.model.index(0)])
    assert panel.model.mimeTypes() == [LAYER_MIME]
    assert data.data(LAYER_MIME).data() == b"2"
    assert not panel.model.flags(panel.model.index(3)) & Qt.ItemFlag.ItemIsDragEnabled


def test_the_list_scrolls_under_a_drag_at_its_end(
    desk: Desk, panel: LayersPanel, editing: LayersEditing, qtbot: QtBot
) -> None:
    """Rows out of sight could not be dropped on."""
    panel.resize(300, 220)
    QApplication.processEvents()
    desk.select(1, 40)
    bar, height = panel.view.verticalScrollBar(), panel.view.viewport().height()
    panel.view.scrollToTop()
    drag = Drag(panel.view.viewport(), PILLARS_MIME, "40")
    drag.enter(QPoint(50, height - 5))
    drag.move(QPoint(50, height - 5))
    qtbot.waitUntil(lambda: bar.value() == bar.maximum() > 0)
    drag.leave()


@pytest.mark.parametrize("height", [700, 240])
def test_in_a_low_panel_rows_are_lower_and_whole(
    desk: Desk, panel: LayersPanel, editing: LayersEditing, height: int
) -> None:
    """On a small screen hardly a layer was seen; lowered, parts could leave their row or overlap."""
    panel.resize(300, height)
    QApplication.processEvents()
    room = panel.view.visualRect(panel.model.index(0))
    layout = RowLayout(room)
    assert (room.height() < ROW_HEIGHT) == (height < 300)
    parts = layout.eye(), layout.swatch(), layout.name(), layout.solo(), layout.thumbnail()
    assert all(room.contains(part) for part in (*parts, layout.lock(), layout.figures()))
    assert not any(one.intersects(other) for one, other in pairwise(parts))
    assert not layout.solo().intersects(layout.lock())
    assert layout.name().bottom() < layout.figures().top()


def test_the_lock_in_a_row_locks(
    desk: Desk, panel: LayersPanel, editing: LayersEditing, qtbot: QtBot
) -> None:
    """A finished layer could not be kept from harm."""
    room = panel.view.visualRect(panel.model.index(panel.model.row_of(1)))
    lock = RowLayout(room).lock().center()
    QTest.mouseClick(panel.view.viewport(), Qt.MouseButton.LeftButton, pos=lock)
    assert desk.editor.locked == {1}
    assert panel.model.rows[1].is_locked
    assert panel.model.rows[1].sentence.endswith("locked")
    QTest.mouseClick(panel.view.viewport(), Qt.MouseButton.LeftButton, pos=lock)
    assert desk.steps == ["Lock Layer 2", "Unlock Layer 2"]


def test_rows_count_what_is_selected(desk: Desk, panel: LayersPanel, editing: LayersEditing) -> None:
    """The operator could not see how much of a layer is selected."""
    desk.select(1, 40)
    assert [row.selected for row in panel.model.rows] == [0, 40, 0, 0]
    assert "40 selected" in panel.model.rows[1].sentence
    panel.resize(256, 420)
    assert not panel.grab().isNull()


def test_buttons_act_on_the_active_layer(desk: Desk, panel: LayersPanel, editing: LayersEditing) -> None:
    """Buttons would act on nothing, or on another layer."""
    desk.document.set_active_layer(1)
    buttons, before = editing.bar.buttons, desk.counts
    buttons["up"].click()
    desk.settle()
    assert desk.counts == [before[0], before[2], before[1]]
    assert desk.document.active_layer == 2
    assert not buttons["up"].isEnabled()
    buttons["down"].click()
    desk.settle()
    buttons["new"].click()
    desk.settle()
    assert desk.counts == [*before, 0]
    buttons["lock"].click()
    assert desk.editor.locked == {1}


def test_merge_and_split_ask_first(
    desk: Desk, panel: LayersPanel, editing: LayersEditing, qtbot: QtBot
) -> None:
    """Layers would be joined or parted without numbers."""
    desk.document.set_active_layer(1)
    with qtbot.waitSignal(editing.merge_wanted) as merge:
        editing.bar.buttons["merge"].click()
    assert merge.args == [1, TO_BE_CHOSEN]
    with qtbot.waitSignal(editing.split_wanted) as split:
        editing.bar.buttons["split"].click()
    assert split.args == [1]
    assert desk.steps == []


def test_unassigned_offers_no_layer_buttons(desk: Desk, panel: LayersPanel, editing: LayersEditing) -> None:
    """A button would fail on what is no layer."""
    desk.document.set_active_layer(-1)
    enabled = [name for name, button in editing.bar.buttons.items() if button.isEnabled()]
    assert enabled == ["new"]
    editing.remove()
    editing.merge()
    desk.settle()
    assert desk.steps == []


def test_the_switch_chooses_what_becomes_of_taken_places(
    desk: Desk, panel: LayersPanel, editing: LayersEditing
) -> None:
    """The switch would be for show."""
    assert editing.bar.choices["swap"].isChecked()
    editing.bar.choices["leave"].click()
    assert desk.editor.conflict == "leave"
    desk.editor.set_conflict("swap")
    assert editing.bar.choices["swap"].isChecked()


def test_the_menu_of_a_layer_offers_what_can_be_done(
    desk: Desk, panel: LayersPanel, editing: LayersEditing
) -> None:
    """Edits would be offered that fail, or could not be found."""
    offered = entries(panel.menu_for(panel.model.rows[0]))
    assert list(offered) == [
        "Move the selection here",
        "Select all of it",
        "Rename",
        "Colour…",
        "Usual colour",
        "Lock",
        "Merge into",
        "Split at an elevation…",
        "Move up",
        "Move down",
        f"Remove ({desk.counts[2]} pillars to Unassigned)",
        "Show only this layer",
        "Show all layers",
    ]
    assert [text for text, is_enabled in offered.items() if not is_enabled] == [
        "Move the selection here",
        "Move up",
    ]


def test_the_menu_of_unassigned_can_take_pillars_but_is_no_layer(
    desk: Desk, panel: LayersPanel, editing: LayersEditing
) -> None:
    """Merging or locking it would fail."""
    assert list(entries(panel.menu_for(panel.model.rows[-1])))[:2] == [
        "Move the selection here",
        "Select all of it",
    ]
    assert "Lock" not in entries(panel.menu_for(panel.model.rows[-1]))


def test_the_menu_says_what_a_move_would_do(
    desk: Desk, panel: LayersPanel, editing: LayersEditing, qtbot: QtBot
) -> None:
    """The keyboard's way to a layer would be a blind one."""
    desk.select(1, 40)
    qtbot.waitUntil(lambda: desk.editor.preview(0) is not None)
    assert "Move the selection here (move 40, swap 40)" in entries(panel.menu_for(panel.model.rows[2]))


def test_entries_of_the_menu_act(desk: Desk, panel: LayersPanel, editing: LayersEditing) -> None:
    """A menu would be for show."""
    menu = panel.menu_for(panel.model.rows[1])
    by_text = {action.text(): action for action in menu.actions()}
    by_text["Select all of it"].trigger()
    desk.settle()
    assert desk.selection.by_layer == {1: desk.counts[1]}
    by_text["Move down"].trigger()
    desk.settle()
    by_text["Lock"].trigger()
    assert desk.steps == ["Exchange Layer 2 and Layer 1", "Lock Layer 2"]


def test_the_move_menu_lists_every_target(desk: Desk, qtbot: QtBot) -> None:
    """A layer could not be reached from the views."""
    desk.editor.set_locked(0, True)
    desk.select(1, 40)
    qtbot.waitUntil(lambda: desk.editor.preview(2) is not None)
    menu = QMenu()
    qtbot.addWidget(menu)
    fill_move_menu(menu, desk.editor)
    assert entries(menu) == {
        "Layer 3": True,
        "Layer 2": True,
        "Layer 1 (locked)": False,
        "Unassigned": True,
        "New layer": True,
    }
    assert menu.actions()[0].toolTip() == "move 40, swap 15"
    menu.actions()[0].trigger()
    desk.settle()
    assert desk.steps[-1] == "Move 40 pillars to Layer 3"
