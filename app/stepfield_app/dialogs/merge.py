"""Merge: into which layer another one goes, and what that costs, said before it is done."""

from __future__ import annotations

from PySide6.QtWidgets import QComboBox, QDialog, QDialogButtonBox, QFormLayout, QLabel, QVBoxLayout, QWidget

from stepfield.layers import UNASSIGNED
from stepfield.moving import Plan
from stepfield_app.controls import named
from stepfield_app.editor import Editor
from stepfield_app.panels.move_menu import colour_icon
from stepfield_app.wording import counted

COUNTING = "Counting pillars that claim the same place…"


class MergeDialog(QDialog):
    """Asks for the target of a merge and says its numbers.

    Parameters
    ----------
    editor : Editor
    source : int
        The layer that goes into another one.
    target : int
        The one to begin with; -1 leaves the choice to the dialog.
    parent : QWidget, optional
    """

    def __init__(self, editor: Editor, source: int, target: int, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._editor, self._source = editor, source
        self.setWindowTitle(f"Merge {editor.name_of(source)}")
        self.box = named(QComboBox(), "Merge into", "The layer that takes the pillars in")
        for each in editor.targets:
            if each.to not in (source, UNASSIGNED):
                self.box.addItem(colour_icon(each.colour), each.name, each.to)
        wanted = target if target != UNASSIGNED else _nearest(self.box, source)
        self.box.setCurrentIndex(max(self.box.findData(wanted), 0))
        self.sentence = QLabel(COUNTING, wordWrap=True)
        self.sentence.setAccessibleName("What the merge does")
        self.sentence.setMinimumSize(320, 64)
        standard = QDialogButtonBox.StandardButton
        self.buttons = QDialogButtonBox(standard.Ok | standard.Cancel)
        self._merge = self.buttons.button(standard.Ok)
        self._merge.setText("Merge")
        self._arrange()
        self.box.currentIndexChanged.connect(self._weigh)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        editor.merge_weighed.connect(self._say)
        self._weigh()

    @property
    def target(self) -> int:
        """The layer that was chosen."""
        return int(self.box.currentData())

    def _arrange(self) -> None:
        form = QFormLayout()
        form.setHorizontalSpacing(16)
        form.addRow("Merge into", self.box)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(16, 16, 16, 16)
        layout.setSpacing(16)
        layout.addLayout(form)
        layout.addWidget(self.sentence)
        layout.addWidget(self.buttons)

    def _weigh(self) -> None:
        self._merge.setEnabled(False)
        self.sentence.setText(COUNTING)
        self._editor.weigh_merge(self._source, self.target)

    def _say(self, source: int, target: int, plan: Plan) -> None:
        if (source, target) != (self._source, self.target):
            return
        self._merge.setEnabled(bool(plan.moves))
        names = self._editor.name_of(self._source), self._editor.name_of(target)
        self.sentence.setText(_account(plan, *names) if plan.moves else f"{plan.reason}.")


def _account(plan: Plan, source: str, target: str) -> str:
    """Say what a merge does, the losses included."""
    moved = f"{counted(plan.moved, 'pillar')} of {source} go to {target}; {source} is no more."
    if not plan.unassigned:
        return f"{moved} No place is claimed twice."
    lost = counted(plan.unassigned, "pillar")
    verb = "goes" if plan.unassigned == 1 else "go"
    return f"{moved} Where both have a pillar the one with more points stays: {lost} {verb} to Unassigned."


def _nearest(box: QComboBox, source: int) -> int:
    """Return the layer below, else the one above."""
    return source - 1 if box.findData(source - 1) >= 0 else source + 1
