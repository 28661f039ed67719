"""The document: a project, its undo stack and the newest result. Everything that changes them comes here.

Widgets call ``edit`` (or ``set_parameters``, ``set_style``) and listen; they never hold the truth themselves.
What is on screen always belongs to one Answer; ``pending`` says that a newer one is on its way.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QUndoStack

from stepfield.errors import ParameterError, StepfieldError
from stepfield.parameters import Parameters
from stepfield.project import LayerStyle, Project, ScanFile
from stepfield_app.edit import Change, Edit, Gesture, recalled
from stepfield_app.facts import ScanFacts
from stepfield_app.filed import ProjectFile, Work
from stepfield_app.requests import Answer, Request, paths_of, request_for
from stepfield_app.runner import Runner

#: What is active when no layer is: the pillars in no layer.
UNASSIGNED = -1


class Document(QObject):
    """One open scan, what the operator chose for it, and what came of that.

    Parameters
    ----------
    runner : Runner, optional
        Owned by the document from now on.
    parent : QObject, optional

    Attributes
    ----------
    file : ProjectFile
        Where it is stored, and whether there is anything to save.
    """

    project_changed = Signal(object)  # Project
    answer_changed = Signal(object)  # Answer, or None when the scan was closed
    facts_changed = Signal(object)  # ScanFacts, or None
    pending_changed = Signal(bool)
    busy_changed = Signal(bool)
    progressed = Signal(float, str)
    failed = Signal(object)  # exception; the text of a StepfieldError is one sentence
    opened = Signal()  # another scan: the last of all signals about it
    opening_changed = Signal(bool)
    active_layer_changed = Signal(int)
    held_changed = Signal(bool)  # whether a gesture goes on
    edit_wished = Signal()  # it is being worked out and will come in a moment

    def __init__(self, runner: Runner | None = None, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._project = Project()
        self.file = ProjectFile(self)
        self._answer: Answer | None = None
        self._facts: ScanFacts | None = None
        self._opening: Work | None = None
        self._active_layer = 0
        self._pending = False
        self._gestures: list[Gesture] = []
        self._undo_stack = QUndoStack(self)
        self._runner = runner or Runner()
        self._runner.setParent(self)
        self._runner.answered.connect(self._receive)
        self._runner.failed.connect(self._fail)
        self._runner.progressed.connect(self.progressed)
        self._runner.busy_changed.connect(self.busy_changed)

    @property
    def project(self) -> Project:
        """What the operator chose."""
        return self._project

    @property
    def scans(self) -> tuple[Path, ...]:
        """Files of the open scan."""
        return paths_of(self._project)

    @property
    def answer(self) -> Answer | None:
        """What is on screen."""
        return self._answer

    @property
    def facts(self) -> ScanFacts | None:
        """The open scan before cleaning."""
        return self._facts

    @property
    def undo_stack(self) -> QUndoStack:
        """The edits, to be undone and redone."""
        return self._undo_stack

    @property
    def pending(self) -> bool:
        """Whether what is on screen is not yet of the newest parameters."""
        return self._pending

    @property
    def busy(self) -> bool:
        """Whether anything is being made."""
        return self._runner.busy

    @property
    def held(self) -> bool:
        """Whether a hand holds a control: more edits will follow soon."""
        return bool(self._gestures)

    @property
    def opening(self) -> bool:
        """Whether another scan is being opened."""
        return self._opening is not None

    @property
    def active_layer(self) -> int:
        """Number of the layer that the map shows and moves start from; -1 for Unassigned."""
        return self._active_layer

    def open(self, scans: Sequence[Path], parameters: Parameters | None = None) -> None:
        """Open a scan; the present one stays until the first result of the new one has arrived."""
        files = tuple(ScanFile(path=str(path.absolute())) for path in scans)
        self.open_project(Project(scans=files, parameters=parameters or Parameters()))

    def open_project(self, project: Project) -> None:
        """Open a project whose scans are given by their full paths."""
        self.open_work(Work(project))

    def open_work(self, work: Work) -> None:
        """Open a project with what is known of its file."""
        self._runner.cancel()
        self._opening = work
        self.opening_changed.emit(True)
        self._runner.ask(request_for(work.project))

    def close_scan(self) -> None:
        """Close the scan: an empty document."""
        self._runner.forget()
        self._stop_opening()
        self._undo_stack.clear()
        self._project, self._answer, self._facts = Project(), None, None
        self.file.begin(Work(self._project))
        self.project_changed.emit(self._project)
        self.facts_changed.emit(None)
        self.answer_changed.emit(None)
        self._note_pending()

    def cancel(self) -> None:
        """Stop what is being made: forget the scan that was being opened, or go back to what is shown.

        An exact result that follows its preview goes on: there is nothing to go back to.
        """
        if self._opening is not None:
            self._runner.cancel()
            self._stop_opening()
            self._ask()
        elif self._answer is not None and self._pending:
            shown = self._answer.request
            before = self._project.model_copy(update={"parameters": shown.parameters, "moves": shown.moves})
            self.edit("Back to what is shown", before)

    def close(self) -> None:
        """End the document and its worker thread."""
        self._runner.close()

    def begin_gesture(self) -> Gesture:
        """Begin a gesture; give it to every edit that belongs to it."""
        self._gestures.append(gesture := Gesture())
        if len(self._gestures) == 1:
            self.held_changed.emit(True)
        return gesture

    def end_gesture(self, gesture: Gesture) -> None:
        """Say that the hand has stopped, so that an exact result follows a preview."""
        self._gestures.remove(gesture)
        if not self._gestures and self._opening is None:
            self._runner.settle()
        if not self._gestures:
            self.held_changed.emit(False)

    def edit(self, text: str, project: Project, gesture: object | None = None) -> None:
        """Take the project a step further.

        Parameters
        ----------
        text : str
            Name of the undo step.
        project : Project
            What the project becomes.
        gesture : object, optional
            Edits in a row with the same one are a single step.
        """
        if project != self._project:
            change = Change.between(self._project, project)
            self._undo_stack.push(Edit(text, change, self._present, self._place, gesture))

    def set_parameters(self, text: str, gesture: object | None = None, **values: Any) -> None:
        """Change some parameters; impossible ones change nothing and are reported through ``failed``."""
        try:
            parameters = Parameters.checked(**{**self._project.parameters.model_dump(), **values})
        except ParameterError as error:
            self.failed.emit(error)
            self.project_changed.emit(self._project)  # for the widget that shows the refused value
            return
        self.edit(text, self._project.model_copy(update={"parameters": parameters}), gesture)

    def style(self, index: int) -> LayerStyle:
        """What the operator chose for a layer."""
        chosen = (style for style in self._project.layers if style.index == index)
        return next(chosen, LayerStyle(index=index))

    def set_style(self, text: str, index: int, gesture: object | None = None, **values: Any) -> None:
        """Change how a layer is named or shown."""
        style = LayerStyle.model_validate({**self.style(index).model_dump(), **values})
        others = [other for other in self._project.layers if other.index != index]
        layers = tuple(sorted([*others, style], key=lambda style: style.index))
        self.edit(text, self._project.model_copy(update={"layers": layers}), gesture)

    def set_active_layer(self, index: int) -> None:
        """Choose the layer to look at and to work on; -1 is Unassigned."""
        if index != self._active_layer:
            self._active_layer = index
            self.active_layer_changed.emit(index)

    def _present(self) -> Project:
        return self._project

    def _place(self, project: Project) -> None:
        """Put another project in place of the present one."""
        self._project = project
        self._ask()
        self.project_changed.emit(project)
        self.file.follow(project)

    def _ask(self) -> None:
        """Ask for the newest result, unless another scan is on its way."""
        is_pending = self._note_pending()
        if self._opening is not None:
            return
        if is_pending:
            self._runner.ask(request_for(self._project), settled=not self._gestures)
        else:
            self._runner.cancel()  # back to what is on screen: no other result may take its place

    def _note_pending(self) -> bool:
        wanted = request_for(self._project) if self._project.scans else None
        pending = wanted != (self._answer and self._answer.request)
        if pending != self._pending:
            self._pending = pending
            self.pending_changed.emit(pending)
        return pending

    def _stop_opening(self) -> None:
        if self._opening is not None:
            self._opening = None
            self.opening_changed.emit(False)

    def _receive(self, answer: Answer, facts: ScanFacts) -> None:
        opened, has_new_facts = self._opening, facts is not self._facts
        self._answer, self._facts = answer, facts
        if opened is not None:
            self._project = opened.project
            self._undo_stack.clear()
            self._recall(opened)
            self._stop_opening()
            self.file.begin(opened)
            self.project_changed.emit(self._project)
        if has_new_facts:
            self.facts_changed.emit(facts)
        self._keep_an_active_layer(0 if opened else self._active_layer)
        self.answer_changed.emit(answer)
        self._note_pending()
        if opened is not None:
            self.opened.emit()

    def _recall(self, work: Work) -> None:
        """Let edits that an earlier window has left be undone as they were in it."""
        if work.draft is not None:
            for text, change in recalled(work.project, work.saved):
                self._undo_stack.push(Edit(text, change, self._present, self._place, is_done=True))

    def _keep_an_active_layer(self, index: int) -> None:
        last = len(self._answer.result.layers) - 1 if self._answer else 0
        self.set_active_layer(min(index, last))

    def _fail(self, request: Request, error: BaseException) -> None:
        """Report a failure, unless it is of parameters that have changed since."""
        if self._opening is not None:
            self._stop_opening()
            self._ask()
        elif isinstance(error, StepfieldError) and request != request_for(self._project):
            return
        self.failed.emit(error)
