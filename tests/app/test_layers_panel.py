"""The layers panel: what it shows, and what becomes of clicks and keys."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QAbstractItemModelTester, QTest
from PySide6.QtWidgets import QLineEdit
from pytestqt.qtbot import QtBot

from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.reconstruction import Reconstruction
from stepfield_app.document import Document
from stepfield_app.panels.layers import LayersPanel
from stepfield_app.panels.layers_model import Role
from stepfield_app.panels.row_layout import RowLayout
from stepfield_app.scenes.summary import LayerSummary, summaries
from stepfield_app.theme import LIGHT, UNASSIGNED_COLOUR, layer_colour

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")  # which the platform without a screen lacks

LAYERS = (
    LayerSummary(0, "Layer 1", 12431, 0.12),
    LayerSummary(1, "Layer 2", 812, 1.63),
    LayerSummary(2, "Layer 3", 37, 3.14),
    LayerSummary(-1, "Unassigned", 5, float("nan")),
)


@pytest.fixture
def document() -> Iterator[Document]:
    document = Document()
    yield document
    document.close()


@pytest.fixture
def panel(qtbot: QtBot, document: Document) -> LayersPanel:
    panel = LayersPanel(document)
    qtbot.addWidget(panel)
    panel.setAttribute(Qt.WidgetAttribute.WA_DontShowOnScreen)
    panel.resize(300, 360)
    panel.show()
    panel.set_layers(LAYERS)
    return panel


def click(
    panel: LayersPanel,
    qtbot: QtBot,
    layer: int,
    part: str,
    key: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier,
) -> None:
    """Click the middle of a part of a layer's row."""
    view = panel.view
    layout = RowLayout(view.visualRect(panel.model.index(panel.model.row_of(layer))))
    place: QPoint = getattr(layout, part)().center()
    QTest.mouseClick(view.viewport(), Qt.MouseButton.LeftButton, key, place)


def names(panel: LayersPanel) -> list[str]:
    return [panel.model.index(row).data() for row in range(panel.model.rowCount())]


def test_the_highest_layer_is_at_the_top_and_unassigned_at_the_foot(panel: LayersPanel) -> None:
    """The list would stand on its head against the building."""
    assert names(panel) == ["Layer 3", "Layer 2", "Layer 1", "Unassigned"]


def test_the_model_keeps_the_rules_of_models(panel: LayersPanel, qtbot: QtBot) -> None:
    """The list could show rows that are no more."""
    QAbstractItemModelTester(panel.model, QAbstractItemModelTester.FailureReportingMode.Warning, panel)
    panel.set_layers(LAYERS[:2])
    panel.set_layers(())
    panel.set_layers(LAYERS)


def test_while_a_slider_moves_only_rows_that_changed_are_told(panel: LayersPanel, qtbot: QtBot) -> None:
    """The list would lose its place and flicker with every tick of a slider."""
    changed: list[int] = []
    panel.model.dataChanged.connect(lambda first, last: changed.extend(range(first.row(), last.row() + 1)))
    with qtbot.assertNotEmitted(panel.model.modelReset):
        panel.set_layers((LAYERS[0], replace(LAYERS[1], pillars=813), *LAYERS[2:]))
    assert changed == [1]


def test_a_row_tells_itself_in_words(panel: LayersPanel) -> None:
    """The list would be mute to a screen reader."""
    sentence = panel.model.index(2).data(Qt.ItemDataRole.AccessibleTextRole)
    assert sentence == "Layer 1, 12\N{NARROW NO-BREAK SPACE}431 pillars, average elevation 0.12 m, shown"


def test_a_click_makes_a_layer_active(panel: LayersPanel, document: Document, qtbot: QtBot) -> None:
    """The map would go on showing another layer."""
    click(panel, qtbot, 2, "name")
    assert document.active_layer == 2
    click(panel, qtbot, -1, "name")
    assert document.active_layer == -1


def test_arrow_keys_move_the_active_layer(panel: LayersPanel, document: Document, qtbot: QtBot) -> None:
    """Layers would be out of reach without a mouse."""
    QTest.keyClick(panel.view, Qt.Key.Key_Up)
    assert document.active_layer == 1


def test_a_layer_made_active_elsewhere_is_highlighted(panel: LayersPanel, document: Document) -> None:
    """Panel and map would disagree."""
    document.set_active_layer(2)
    assert [row.index for row in panel.model.rows if row.is_active] == [2]
    assert panel.view.currentIndex().row() == 0


def test_the_eye_hides_a_layer_and_undo_shows_it(
    panel: LayersPanel, document: Document, qtbot: QtBot
) -> None:
    """A click by mistake could not be taken back."""
    with qtbot.waitSignal(panel.visibility_changed):
        click(panel, qtbot, 1, "eye")
    assert panel.visible_layers() == (-1, 0, 2)
    document.undo_stack.undo()
    assert panel.visible_layers() == (-1, 0, 1, 2)


def test_space_hides_the_layer_under_the_keyboard(panel: LayersPanel, qtbot: QtBot) -> None:
    """The eye would need a mouse."""
    QTest.keyClick(panel.view, Qt.Key.Key_Space)
    assert panel.visible_layers() == (-1, 1, 2)


def test_the_unassigned_are_hidden_for_a_while_only(
    panel: LayersPanel, document: Document, qtbot: QtBot
) -> None:
    """A project would be changed by what is no layer of it."""
    click(panel, qtbot, -1, "eye")
    assert panel.visible_layers() == (0, 1, 2)
    assert document.undo_stack.count() == 0


@pytest.mark.parametrize("how", ["alt", "button", "key"])
def test_one_layer_alone_and_back_changes_no_project(
    panel: LayersPanel, document: Document, qtbot: QtBot, how: str
) -> None:
    """Looking at one layer would leave steps to undo."""

    def toggle() -> None:
        if how == "alt":
            click(panel, qtbot, 0, "eye", Qt.KeyboardModifier.AltModifier)
        elif how == "button":
            click(panel, qtbot, 0, "solo")
        else:
            QTest.keyClick(panel.view, Qt.Key.Key_S)

    toggle()
    assert panel.visible_layers() == (0,)
    toggle()
    assert panel.visible_layers() == (-1, 0, 1, 2)
    assert document.undo_stack.count() == 0


def test_a_lone_layer_that_is_no_more_gives_way_to_all(panel: LayersPanel, qtbot: QtBot) -> None:
    """Nothing at all would be shown."""
    click(panel, qtbot, 2, "solo")
    panel.set_layers((*LAYERS[:2], LAYERS[3]))
    assert panel.visible_layers() == (-1, 0, 1)


def test_f2_renames_undoably_and_an_empty_name_is_none(
    panel: LayersPanel, document: Document, qtbot: QtBot
) -> None:
    """A layer could lose its name, or a name could not be taken back."""
    for typed, shown in (("Ground", "Ground"), ("   ", "Ground")):
        QTest.keyClick(panel.view, Qt.Key.Key_F2)
        editor = panel.view.findChild(QLineEdit)
        assert editor is not None
        editor.setText(typed)
        QTest.keyClick(editor, Qt.Key.Key_Return)
        qtbot.waitUntil(lambda: panel.view.findChild(QLineEdit) is None)
        assert names(panel)[2] == shown
    document.undo_stack.undo()
    assert names(panel)[2] == "Layer 1"


def test_unassigned_cannot_be_named(panel: LayersPanel) -> None:
    """It is no layer of the project, so the name would be lost."""
    assert not panel.model.flags(panel.model.index(3)) & Qt.ItemFlag.ItemIsEditable


def test_a_chosen_colour_is_shown_and_the_usual_one_can_be_had_again(panel: LayersPanel) -> None:
    """Colours by hand would have no effect, or no way back."""
    row = panel.model.rows[2]
    assert row.colour == layer_colour(0)
    panel.set_colour(row, "#123456")
    assert panel.model.rows[2].colour == "#123456"
    panel.set_colour(row, None)
    assert panel.model.rows[2].colour == layer_colour(0)
    assert panel.model.rows[3].colour == UNASSIGNED_COLOUR


def test_show_all_is_one_step(panel: LayersPanel, document: Document, qtbot: QtBot) -> None:
    """Showing everything again would take an undo a layer."""
    for layer in (0, 1, -1):
        click(panel, qtbot, layer, "eye")
    steps = document.undo_stack.count()
    panel.show_all()
    assert panel.visible_layers() == (-1, 0, 1, 2)
    assert document.undo_stack.count() == steps + 1


def test_the_menu_of_unassigned_offers_only_what_it_can_do(panel: LayersPanel) -> None:
    """Naming or colouring it would fail."""
    menu = panel.menu_for(panel.model.rows[-1])
    enabled = [
        action.text().split("\t")[0] for action in menu.actions() if action.isEnabled() and action.text()
    ]
    assert enabled == ["Show only this layer", "Show all layers"]


def test_thumbnails_are_shown_on_their_rows(panel: LayersPanel) -> None:
    """A layer would carry the picture of another one."""
    pixels = np.zeros((10, 20, 4), np.uint8)
    pixels[:] = 10, 20, 30, 255
    panel.set_thumbnails({1: pixels})
    image = panel.model.index(1).data(Role.THUMBNAIL)
    assert (image.width(), image.height()) == (20, 10)
    assert image.pixelColor(3, 3).getRgb() == (10, 20, 30, 255)
    assert panel.model.index(0).data(Role.THUMBNAIL) is None
    panel.set_theme(LIGHT)
    assert not panel.grab().isNull()


def test_an_empty_panel_says_what_comes(panel: LayersPanel) -> None:
    """An operator without a scan would face a blank."""
    panel.set_layers(())
    assert not panel.view.isVisible()


def test_summaries_count_every_pillar_once(result: Reconstruction) -> None:
    """The counts of the panel would not add up to those of the result."""
    rows = summaries(result)
    assert [row.index for row in rows] == [*range(len(result.layers)), -1]
    assert sum(row.pillars for row in rows) == len(result.field)
    averages = result.layering.averages(result.field.elevation) + result.field.compartments.lowest
    np.testing.assert_allclose([row.elevation for row in rows[:-1]], averages)


@pytest.fixture
def result(tmp_path: Path) -> Reconstruction:
    """Reconstruct a floor with a table on it."""
    rng = np.random.default_rng(7)
    floor = np.column_stack([rng.uniform(0, 4, (8000, 2)), np.full(8000, 10.0)])
    table = np.column_stack([rng.uniform(1, 2, (1500, 2)), np.full(1500, 10.8)])
    path = tmp_path / "table.npy"
    np.save(path, np.vstack([floor, table]))
    return Pipeline().run((path,), Parameters(cell_size=0.2, layer_tolerance=0.3, alpha=0.5))
