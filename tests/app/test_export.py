"""The window exports what the command builds, to the byte, and shows beforehand what that will be."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from PySide6.QtCore import QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QCheckBox, QComboBox
from pytestqt.qtbot import QtBot

from stepfield.complex_parts import ComplexParts
from stepfield.parameters import Parameters
from stepfield.pipeline import Pipeline
from stepfield.progress import Progress
from stepfield.scan.write import write
from stepfield.surface import Mesh
from stepfield.synth import synthesise
from stepfield_app import export as exporting
from stepfield_app.dialogs.export import TO_BE_MESHED, ExportDialog
from stepfield_app.document import Document
from stepfield_app.runner import Runner
from stepfield_app.scenes.complex_parts import Meshed
from stepfield_app.settings import Settings
from stepfield_app.theme import DARK, LIGHT

#: Qt's platform for tests without a screen says so at every window.
pytestmark = pytest.mark.qt_log_ignore("This plugin does not support", extend=True)

EXPLICIT = {
    "cell_size": 0.1,
    "layer_tolerance": 0.3,
    "alpha": 0.5,
    "bits": 8,
    "pad": "none",
    "range": "layer",
    "layering": "rank",
}
OPTIONS = [
    "--cell=0.1",
    "--tolerance=0.3",
    "--alpha=0.5",
    "--bits=8",
    "--pad=none",
    "--range=layer",
    "--layering=rank",
]


@pytest.fixture(scope="session")
def scan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make a small scan with two surfaces above each other."""
    made, file = synthesise("table", 20_000), tmp_path_factory.mktemp("scan") / "table.ply"
    write(file, made.points, {"surface": made.surface})
    return file


@pytest.fixture
def document(scan: Path) -> Iterator[Document]:
    """Open the scan in a document that works on a thread of its own."""
    opened = Document(Runner())
    opened.open([scan])
    yield opened
    opened.close()
    opened.deleteLater()


@pytest.fixture
def dialog(document: Document, tmp_path: Path, qtbot: QtBot) -> Iterator[ExportDialog]:
    """Show the dialog on the exact result of the scan."""
    settings = Settings()
    settings.remember_folder("export", tmp_path)
    qtbot.waitUntil(lambda: document.answer is not None and not document.pending)
    shown = ExportDialog(document, settings, DARK)
    qtbot.addWidget(shown)
    shown.show()
    qtbot.waitUntil(lambda: shown.stack_view.shown is not None)
    yield shown
    shown.done(0)


def built(scan: Path, folder: Path, *options: str) -> dict[str, bytes]:
    """Build a stack with the command and return its files."""
    command = [sys.executable, "-m", "stepfield", "build", str(scan), "-o", str(folder), *options]
    subprocess.run(command, check=True, capture_output=True)
    return files_of(folder)


def files_of(folder: Path) -> dict[str, bytes]:
    """Return the files of a folder by name."""
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def written(dialog: ExportDialog, qtbot: QtBot) -> dict[str, bytes]:
    """Export, and return the files."""
    dialog.export_button.click()
    qtbot.waitUntil(lambda: dialog.outcome.startswith("Written"))
    return files_of(dialog.folder_choice.folder)


@pytest.mark.parametrize(
    ("values", "options"),
    [({}, []), (EXPLICIT, OPTIONS), ({"complex_parts": "mesh"}, ["--complex=mesh"])],
    ids=["auto", "explicit", "complex"],
)
def test_same_bytes_as_the_command(
    values: dict[str, Any],
    options: list[str],
    scan: Path,
    document: Document,
    dialog: ExportDialog,
    tmp_path: Path,
    qtbot: QtBot,
) -> None:
    """If it failed, what was tuned in the window could not be built again on a server."""
    if values:
        document.set_parameters("All at once", **values)
    assert written(dialog, qtbot) == built(scan, tmp_path / "by command", *options)
    assert dialog.folder_choice.folder == tmp_path / "table"


def test_targets_are_those_of_the_command_and_chosen_again_next_time(
    scan: Path, document: Document, dialog: ExportDialog, tmp_path: Path, qtbot: QtBot
) -> None:
    """If it failed, a world would have to be made again on the command line, and might differ."""
    for name in ("geotiff", "gazebo"):
        dialog.targets.boxes[name].setChecked(True)
    targets = ["--target", "geotiff", "--target", "gazebo"]
    assert written(dialog, qtbot) == built(scan, tmp_path / "by command", *targets)
    assert "geotiff: the scan has no coordinate reference system" in dialog.warnings
    assert Settings().targets == ("geotiff", "gazebo")


def test_the_exact_result_is_waited_for(
    scan: Path, document: Document, dialog: ExportDialog, tmp_path: Path, qtbot: QtBot
) -> None:
    """If it failed, a quick click would export what was on screen before the last change."""
    document.set_parameters("Cell size", cell_size=0.07)
    assert document.pending
    dialog.start()
    assert "Waiting" in dialog.outcome
    qtbot.waitUntil(lambda: dialog.outcome.startswith("Written"))
    assert files_of(tmp_path / "table") == built(scan, tmp_path / "by command", "--cell=0.07")


@pytest.mark.parametrize("bits", [8, 16])
def test_preview_is_what_gets_written(bits: int, scan: Path, tmp_path: Path) -> None:
    """If it failed, the dialog would promise other images, sizes or warnings than it writes."""
    parameters = Parameters.checked(cell_size=0.05, bits=bits)
    result = Pipeline().run([scan], parameters)
    shown = exporting.preview(result)
    made = exporting.export(exporting.Export(result, tmp_path / "stack"))
    assert shown.manifest == made.manifest
    assert shown.bytes == made.bytes
    assert made.files == 2 * len(shown.layers) + 1
    for layer in shown.layers:
        image = np.asarray(Image.open(made.folder / layer.entry.image))
        mask = np.asarray(Image.open(made.folder / layer.entry.mask))
        assert np.array_equal(layer.gray, image >> (bits - 8))
        assert np.array_equal(layer.mask, mask)
        assert layer.gray_bytes == (made.folder / layer.entry.image).stat().st_size


def test_preview_shows_what_is_filled_in_a_mask_of_its_own(scan: Path, tmp_path: Path) -> None:
    """If it failed, nobody could see before an export which heights nobody measured."""
    parameters = Parameters.checked(cell_size=0.05, fill="linear", min_points=2)
    result = Pipeline().run([scan], parameters)
    shown = exporting.preview(result)
    made = exporting.export(exporting.Export(result, tmp_path / "stack"))
    assert (shown.manifest, shown.bytes) == (made.manifest, made.bytes)
    assert made.files == shown.files == 3 * len(shown.layers) + 1
    for layer in shown.layers:
        filled = np.asarray(Image.open(made.folder / str(layer.entry.filled_mask)))
        assert layer.filled is not None
        assert np.array_equal(layer.filled, filled)
        assert np.count_nonzero(filled) == layer.entry.filled
        assert not (filled & layer.mask).any()
    assert sum(layer.entry.filled for layer in shown.layers) > 0


def test_a_large_image_is_thinned_for_the_screen() -> None:
    """If it failed, a large grid would fill the memory of the window, or be squeezed out of shape."""
    pixels = np.arange(3 * exporting.SIDE * 100, dtype=np.uint16).reshape(100, -1)
    shown = exporting._on_screen(pixels)
    assert shown.shape == (34, exporting.SIDE)
    assert np.array_equal(shown, (pixels >> 8)[::3, ::3])


def test_options_edit_the_document_and_undo(document: Document, dialog: ExportDialog, qtbot: QtBot) -> None:
    """If it failed, the dialog would export other parameters than the project holds."""
    padded = dialog.stack_view.shown
    assert padded is not None
    padding = next(box for box in dialog.findChildren(QComboBox) if box.accessibleName() == "Padding")
    padding.setCurrentIndex(padding.findData("none"))
    padding.activated.emit(padding.currentIndex())
    assert document.project.parameters.pad == "none"
    qtbot.waitUntil(lambda: _shape(dialog) != padded.shape)
    document.undo_stack.undo()
    assert padding.currentData() == "pow2"
    qtbot.waitUntil(lambda: _shape(dialog) == padded.shape)


def test_layers_and_masks_can_be_looked_at(dialog: ExportDialog) -> None:
    """If it failed, only the lowest layer could be judged before it is written."""
    images = []
    for index, mask in ((0, False), (0, True), (1, True)):
        dialog.stack_view.choose(index)
        dialog.stack_view.show_mask(mask)
        assert dialog.stack_view.shown is not None
        images.append(dialog.stack_view.shown)
    assert set(np.unique(images[1])) == {0, 255}
    assert not np.array_equal(images[0], images[1])
    assert not np.array_equal(images[1], images[2])
    dialog.set_theme(LIGHT)
    assert not dialog.grab().isNull()


def test_the_mask_of_what_was_filled_can_be_looked_at(
    document: Document, dialog: ExportDialog, qtbot: QtBot
) -> None:
    """If it failed, what nobody measured would look like what somebody did."""
    box = next(box for box in dialog.findChildren(QCheckBox) if "filled" in box.text())
    assert box.isHidden()
    document.set_parameters("Fill", fill="nearest")
    qtbot.waitUntil(lambda: not box.isHidden())
    dialog.stack_view.show_mask(True)
    mask = dialog.stack_view.shown
    dialog.stack_view.show_filled(True)
    filled = dialog.stack_view.shown
    assert mask is not None
    assert filled is not None
    assert not (mask & filled).any()
    document.set_parameters("Fill", fill="none")
    qtbot.waitUntil(box.isHidden)
    shown = dialog.stack_view.shown
    assert shown is not None
    assert shown.max() > 0, "the mask or the image, not a mask that is no more"


def test_a_stack_is_replaced_only_when_ticked(dialog: ExportDialog, document: Document, qtbot: QtBot) -> None:
    """If it failed, a stack could be lost by pressing Enter twice."""
    before = written(dialog, qtbot)
    assert not dialog.export_button.isEnabled()
    document.set_parameters("Depth", bits=8)
    tick = next(box for box in dialog.findChildren(QCheckBox) if "Replace" in box.text())
    tick.click()
    assert dialog.export_button.isEnabled()
    after = written(dialog, qtbot)
    assert after != before
    assert not tick.isChecked(), "leave to replace one stack must not hold for the next"


def test_a_folder_with_other_things_is_refused(dialog: ExportDialog, tmp_path: Path) -> None:
    """If it failed, an export could mix with the operator's own files."""
    (tmp_path / "notes.txt").touch()
    dialog.folder_choice.choose(tmp_path)
    assert not dialog.export_button.isEnabled()
    dialog.folder_choice.choose(tmp_path / "notes.txt")
    assert not dialog.export_button.isEnabled()
    dialog.folder_choice.choose(tmp_path / "new")
    assert dialog.export_button.isEnabled()


def test_a_disk_that_refuses_is_one_sentence(dialog: ExportDialog, tmp_path: Path, qtbot: QtBot) -> None:
    """If it failed, the operator would see a traceback, or believe the stack was written."""
    (tmp_path / "file").touch()
    dialog.folder_choice.choose(tmp_path / "file" / "stack")
    dialog.start()
    qtbot.waitUntil(lambda: "cannot write the stack" in dialog.outcome)
    assert "\n" not in dialog.outcome
    assert dialog.export_button.isEnabled()


def test_an_export_can_be_stopped(
    dialog: ExportDialog, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """If it failed, Esc would close the dialog on half a stack, or wait for all of it."""

    def endless(*_: Any, progress: Progress, **__: Any) -> None:
        while True:
            progress(0.5, "writing")

    monkeypatch.setattr(exporting, "write_stack_and_targets", endless)
    dialog.start()
    qtbot.waitUntil(lambda: dialog.outcome.startswith("Writing"))
    dialog.reject()
    assert dialog.isVisible()
    assert dialog.outcome == "Stopped; nothing was written."
    qtbot.waitUntil(dialog.export_button.isEnabled)
    dialog.reject()
    assert not dialog.isVisible()


def test_the_folder_can_be_shown(dialog: ExportDialog, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch) -> None:
    """If it failed, the operator would have to look for what was just written."""
    opened: list[QUrl] = []
    monkeypatch.setattr(QDesktopServices, "openUrl", opened.append)
    written(dialog, qtbot)
    dialog.show_button.click()
    assert [Path(url.toLocalFile()) for url in opened] == [dialog.folder_choice.folder]


def test_warnings_of_the_manifest_are_shown(document: Document, dialog: ExportDialog, qtbot: QtBot) -> None:
    """If it failed, pillars would be missing from the stack without a word."""
    document.set_parameters("Layers at most", max_layers=1)
    qtbot.waitUntil(lambda: "in no layer" in dialog.warnings)


def _shape(dialog: ExportDialog) -> tuple[int, ...]:
    return () if dialog.stack_view.shown is None else dialog.stack_view.shown.shape


def test_the_images_show_holes_where_a_mesh_will_stand_in(
    dialog: ExportDialog, document: Document, qtbot: QtBot
) -> None:
    """They are said to be as they will be written."""
    document.set_parameters("Mesh complex parts", complex_parts="mesh")
    qtbot.waitUntil(lambda: not document.pending and TO_BE_MESHED in dialog.warnings)
    dialog.stack_view.choose(0)
    before = dialog.stack_view.shown
    assert before is not None
    assert document.answer is not None
    result = document.answer.result
    replaced = np.zeros(len(result.field), bool)
    replaced[result.layers[0].pillars[:5]] = True
    none = Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64))
    dialog.show_meshed(Meshed(result, ComplexParts(replaced, replaced, none)))
    qtbot.waitUntil(lambda: TO_BE_MESHED not in dialog.warnings)
    after = dialog.stack_view.shown
    assert after is not None
    assert np.count_nonzero(before) - np.count_nonzero(after) == 5
