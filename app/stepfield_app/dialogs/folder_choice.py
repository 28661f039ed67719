"""Choosing the folder a stack goes to, with a word on what stands there."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QCheckBox, QFileDialog, QGridLayout, QLabel, QLineEdit, QPushButton, QWidget

from stepfield_app.appearance import icon
from stepfield_app.export import Target, target


class FolderChoice(QWidget):
    """A folder, typed or picked; one that holds a stack has to be given up by a tick."""

    changed = Signal()

    def __init__(self, folder: Path, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._name = QLineEdit(str(folder))
        self._name.setToolTip("Folder of the stack; it is made if it does not exist")
        self._name.setAccessibleName("Folder")
        self._browse = QPushButton(icon("folder"), "Browse…")
        self._browse.setToolTip("Choose the folder the stack goes to")
        self._browse.setAutoDefault(False)
        self._verdict = QLabel()
        self._replace = QCheckBox("Replace the stack that is there")
        self._replace.setToolTip("The stack in this folder is given up for the new one")
        self._name.textChanged.connect(self.judge_anew)
        self._browse.clicked.connect(self._pick)
        self._replace.toggled.connect(self.changed)
        self._arrange()
        self._judge()

    @property
    def folder(self) -> Path:
        """The folder as it stands there, ``~`` understood."""
        return Path(self._name.text().strip()).expanduser().absolute()

    @property
    def overwrite(self) -> bool:
        """Whether a stack that is there may be replaced."""
        return self._target.state == "stack" and self._replace.isChecked()

    @property
    def usable(self) -> bool:
        """Whether a stack may be written there."""
        return bool(self._name.text().strip()) and (self._target.state == "free" or self.overwrite)

    def choose(self, folder: Path) -> None:
        """Put another folder there."""
        self._name.setText(str(folder))

    def _judge(self) -> None:
        named = bool(self._name.text().strip())
        self._target: Target = target(self.folder) if named else Target("taken", "Name a folder.")
        self._verdict.setText(self._target.sentence)
        self._verdict.setProperty("role", "error" if self._target.state == "taken" else "muted")
        self._verdict.style().polish(self._verdict)
        self._replace.setEnabled(self._target.state == "stack")
        self.changed.emit()

    def judge_anew(self) -> None:
        """Look again at what stands there; leave that was given to replace it was for what stood there."""
        self._replace.setChecked(False)
        self._judge()

    def _pick(self) -> None:
        start = self.folder if self.folder.is_dir() else self.folder.parent
        if picked := QFileDialog.getExistingDirectory(self, "Folder of the stack", str(start)):
            self.choose(Path(picked))

    def _arrange(self) -> None:
        layout = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(8)
        label = QLabel("&Folder")
        label.setBuddy(self._name)
        layout.addWidget(label, 0, 0)
        layout.addWidget(self._name, 0, 1, 1, 2)
        layout.addWidget(self._browse, 0, 3)
        layout.addWidget(self._verdict, 1, 1)
        layout.addWidget(self._replace, 1, 2, 1, 2)
        layout.setColumnStretch(1, 1)
