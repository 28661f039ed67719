"""Export: the stack as it will be written, where to, and writing it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import Qt, QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QDialog, QHBoxLayout, QLabel, QProgressBar, QPushButton, QVBoxLayout, QWidget

from stepfield.complex_parts import without
from stepfield.errors import StepfieldError
from stepfield.reconstruction import Reconstruction
from stepfield_app.appearance import icon
from stepfield_app.dialogs.folder_choice import FolderChoice
from stepfield_app.dialogs.stack_options import StackOptions
from stepfield_app.dialogs.stack_view import StackView
from stepfield_app.dialogs.target_choice import TargetChoice
from stepfield_app.document import Document
from stepfield_app.export import Export, Exported, StackPreview, export, preview, proposed_folder
from stepfield_app.newest import NewestWins
from stepfield_app.scenes.complex_parts import Meshed
from stepfield_app.settings import Settings
from stepfield_app.theme import Theme
from stepfield_app.wording import counted, file_size

#: Warnings shown in full; the manifest has them all.
_MOST_WARNINGS = 4
#: While the mesh is not there yet.
TO_BE_MESHED = "complex parts are not meshed yet: the images will have holes for them that are not shown here"


class ExportDialog(QDialog):
    """Shows what will be written, and writes the exact result of the document's parameters.

    While only a preview of the result is there, *Export* waits for the exact one.
    """

    def __init__(
        self, document: Document, settings: Settings, theme: Theme, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._document, self._settings = document, settings
        self._written = Path()
        self._wanted = False  # Export was pressed, the exact result is awaited
        self._meshed: Meshed | None = None
        self._previewer = NewestWins[Reconstruction, StackPreview](preview, "stack preview", self)
        self._writer = NewestWins[Export, Exported](export, "export", self)
        self.setWindowTitle("Export")
        self.resize(1040, 600)
        self.folder_choice = FolderChoice(proposed_folder(settings.folder("export"), document.scans), self)
        self.stack_view = StackView(theme, self)
        self._options = StackOptions(document, self)
        self.targets = TargetChoice(settings.targets, self)
        self._warnings = _sentence("warnings of the stack", "warning")
        self._outcome = _sentence("outcome")
        self._bar = _progress_bar()
        self.export_button, self.close_button, self.show_button = self._buttons()
        self._arrange()
        self._connect()
        self._show_answer()

    @property
    def outcome(self) -> str:
        """The sentence that says what is going on, or what came of it."""
        return self._outcome.text()

    @property
    def warnings(self) -> str:
        """What the operator should know about the stack."""
        return self._warnings.text()

    def start(self) -> None:
        """Write the stack, as soon as the exact result is there."""
        self._wanted = True
        self._go_on()

    def show_meshed(self, meshed: Meshed | None) -> None:
        """Show the images with holes where a mesh of complex parts will stand in, once it is known."""
        if meshed is not self._meshed:
            self._meshed = meshed
            self._show_answer()

    def set_theme(self, theme: Theme) -> None:
        """Draw in the colours of another theme."""
        self.stack_view.set_theme(theme)

    def reject(self) -> None:
        """Stop what is being written; a second time, close."""
        if self._wanted or self._writer.busy:
            self._wanted = False
            self._writer.cancel()
            self._say("Stopped; nothing was written.")
            self._update()
        else:
            super().reject()

    def done(self, result: int) -> None:
        """Close, with the workers."""
        self._previewer.close()
        self._writer.close()
        super().done(result)

    def _connect(self) -> None:
        self._document.answer_changed.connect(self._show_answer)
        self._document.pending_changed.connect(self._go_on)
        self._document.failed.connect(self._fail_to_get_a_result)
        self._previewer.answered.connect(self._show_preview)
        self._previewer.failed.connect(lambda _, error: self._fail(error))
        self._writer.progressed.connect(self._show_progress)
        self._writer.answered.connect(self._tell)
        self._writer.failed.connect(lambda _, error: self._fail(error))
        self._writer.busy_changed.connect(self._update)
        self.folder_choice.changed.connect(self._update)

    def _is_exact(self) -> bool:
        answer = self._document.answer
        return answer is not None and not self._document.pending and not answer.request.quick

    def _show_answer(self) -> None:
        if self._document.answer is not None:
            result, meshed = self._document.answer.result, self._meshed
            is_known = meshed is not None and meshed.belongs_to(result)
            self._previewer.ask(without(result, meshed.parts) if meshed is not None and is_known else result)
        self._go_on()

    def _go_on(self) -> None:
        """Take the step that can be taken now."""
        if self._wanted and self._is_exact() and not self._writer.busy:
            self._write()
        elif self._wanted and not self._writer.busy:
            self._say("Waiting for the exact result…")
        self._update()

    def _write(self) -> None:
        assert self._document.answer is not None
        self._wanted = False
        choice = self.folder_choice
        self._say(f"Writing to {choice.folder}…")
        result, targets = self._document.answer.result, self.targets.names
        self._writer.ask(Export(result, choice.folder, choice.overwrite, targets))

    def _show_preview(self, result: Reconstruction, stack: StackPreview) -> None:
        self.stack_view.show_preview(stack)
        is_unknown = result.parameters.complex_parts == "mesh" and not (
            self._meshed is not None and self._meshed.belongs_to(result)
        )
        self._warn((*stack.manifest.warnings, *[TO_BE_MESHED] * is_unknown), "in the manifest")
        files = stack.files
        if not self._wanted and not self._writer.busy and not self.show_button.isVisibleTo(self):
            self._say(f"{counted(files, 'file')}, {file_size(stack.bytes)}, will be written.")

    def _warn(self, found: Sequence[str], place: str) -> None:
        more = [f"and {len(found) - _MOST_WARNINGS} more, {place}"][: len(found) > _MOST_WARNINGS]
        self._warnings.setText("\n".join([*found[:_MOST_WARNINGS], *more]))
        self._warnings.setVisible(bool(found))

    def _show_progress(self, share: float, what: str) -> None:
        self._bar.setValue(round(1000 * share))

    def _tell(self, wanted: Export, made: Exported) -> None:
        self._settings.remember_folder("export", made.folder.parent)
        self._settings.targets = wanted.targets
        if made.notes:
            self._warn(made.notes, "in the folders of the simulators")
        layers = counted(len(made.manifest.layers), "layer")
        self._say(f"Written: {layers} in {counted(made.files, 'file')}, {file_size(made.bytes)}.")
        self._written = made.folder
        self.show_button.show()
        self.close_button.setDefault(True)
        self.close_button.setFocus()
        self.folder_choice.judge_anew()

    def _fail_to_get_a_result(self, error: BaseException) -> None:
        if self._wanted:
            self._fail(error)

    def _fail(self, error: BaseException) -> None:
        self._wanted = False
        known = isinstance(error, StepfieldError)
        self._say(str(error) if known else f"The stack could not be written ({error!r}).", failed=True)
        self._update()

    def _say(self, sentence: str, failed: bool = False) -> None:
        self._outcome.setText(sentence)
        self._outcome.setProperty("role", "error" if failed else "muted")
        self._outcome.style().polish(self._outcome)

    def _update(self) -> None:
        writing = self._wanted or self._writer.busy
        self._bar.setVisible(writing)
        self._bar.setRange(0, 1000 if self._writer.busy else 0)
        self.folder_choice.setEnabled(not writing)
        self._options.setEnabled(not writing)
        self.targets.setEnabled(not writing)
        self.export_button.setEnabled(
            not writing and self.folder_choice.usable and self._document.answer is not None
        )
        self.close_button.setText("Stop" if writing else "Close")

    def _show_folder(self) -> None:
        QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._written)))

    def _buttons(self) -> tuple[QPushButton, QPushButton, QPushButton]:
        write = QPushButton("&Export")
        write.setToolTip("Write the images, the masks and the manifest")
        write.setDefault(True)
        write.clicked.connect(self.start)
        close = QPushButton("Close")
        close.setToolTip("Close this dialog; stop first what is being written (Esc)")
        close.setAutoDefault(False)
        close.clicked.connect(self.reject)
        show = QPushButton(icon("show folder"), "&Show in folder")
        show.setToolTip("Open the folder that was written")
        show.setAutoDefault(False)
        show.clicked.connect(self._show_folder)
        show.hide()
        return write, close, show

    def _arrange(self) -> None:
        buttons = QHBoxLayout()
        buttons.setSpacing(8)
        buttons.addWidget(self._outcome, 1)
        buttons.addWidget(self._bar)
        for button in (self.show_button, self.close_button, self.export_button):
            buttons.addWidget(button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(16, 16, 16, 16)
        layout.setSpacing(16)
        layout.addWidget(self.folder_choice)
        layout.addWidget(self._options)
        layout.addWidget(self.targets)
        layout.addWidget(self.stack_view, 1)
        layout.addWidget(self._warnings)
        layout.addLayout(buttons)


def _sentence(name: str, role: str = "muted") -> QLabel:
    label = QLabel()
    label.setWordWrap(True)
    label.setTextFormat(Qt.TextFormat.PlainText)
    label.setProperty("role", role)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    label.setAccessibleName(name)
    return label


def _progress_bar() -> QProgressBar:
    bar = QProgressBar()
    bar.setRange(0, 1000)
    bar.setTextVisible(False)
    bar.setFixedWidth(160)
    bar.setAccessibleName("Progress of the export")
    bar.setToolTip("How much has been written")
    policy = bar.sizePolicy()
    policy.setRetainSizeWhenHidden(True)
    bar.setSizePolicy(policy)
    return bar
