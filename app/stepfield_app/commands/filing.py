"""What happens to files: opening, saving and leaving, with every question that has to be asked on the way."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from PySide6.QtCore import QObject, QTimer

from stepfield.errors import ProjectError
from stepfield.parameters import Parameters
from stepfield_app.dialogs.missing import MissingScans
from stepfield_app.dialogs.question import Answer, Question, Role
from stepfield_app.dropping import PROJECT
from stepfield_app.opening import Missing, Opener, ask_for_files, ask_for_place
from stepfield_app.recovery import Draft, Recovery
from stepfield_app.saving import FileWatch, Saving
from stepfield_app.settings import Files
from stepfield_app.views.message_bar import Choice
from stepfield_app.views.remembered import Remembered
from stepfield_app.workbench import Workbench

Then = Callable[[], object]


class Filing(QObject):
    """Opens, saves and recovers what is in a window.

    One that remembers nothing, for pictures, keeps no edits for the case of a crash and asks nothing.

    Parameters
    ----------
    bench : Workbench
        With its views and feeds made.
    """

    def __init__(self, bench: Workbench) -> None:
        super().__init__(bench.frame)
        self._bench, self._window, self._leaves = bench, bench.frame, False
        self._remembers = remembers = bench.frame.remembers
        self._document = document = bench.document
        self.opener = Opener(document, self)
        self.saving = Saving(document, self.look, self)
        self.watch = FileWatch(document, self.saving, self)
        self.recovery = Recovery(document, self.look, parent=self) if remembers else None
        self._waiting: Then | None = None
        self._connect()

    def _connect(self) -> None:
        document, tell = self._document, self._window.tell
        for part in (self.opener, self.saving):
            part.failed.connect(tell)
        self.opener.missing.connect(self._ask_where)
        self.opener.scans_differ.connect(self._warn_of_scans)
        self.saving.refused.connect(self._ask_about_another)
        self.saving.busy_changed.connect(self._go_on)
        self.saving.saved.connect(self._note_saved)
        self.watch.changed.connect(self._warn_of_another)
        self.watch.gone.connect(self._warn_of_loss)
        document.opened.connect(self._note_opened)
        document.file.changed.connect(self._show_title)
        document.file.dirty_changed.connect(self._show_title)
        if self.recovery is not None:
            self.recovery.failed.connect(tell)
            self.recovery.found.connect(self._offer)
            QTimer.singleShot(0, self.recovery, self.recovery.look_for_leftovers)

    @property
    def is_idle(self) -> bool:
        """Whether no project is being read or written."""
        return not (self.opener.busy or self.saving.busy)

    def look(self) -> dict[str, Any]:
        """Return how the project is looked at, as its file holds it."""
        bench = self._bench
        origin = bench.feeds.scene.origin
        return Remembered.of(bench.trio, bench.map, self._document.active_layer, origin).content()

    # --- Opening --------------------------------------------------------------------------------------------

    def choose_files(self) -> None:
        """Let the operator choose files, and open them."""
        if files := ask_for_files(self._window, self._window.settings):
            self.open(files)

    def open(self, files: Sequence[Path], parameters: Parameters | None = None) -> None:
        """Open a scan or a project once the present edits are safe."""
        self.leave(lambda: self._open(tuple(files), parameters))

    def cancel(self) -> None:
        """Stop opening."""
        self.opener.cancel()

    def _open(self, files: Files, parameters: Parameters | None) -> None:
        self._window.message_bar.dismiss_all()
        self.opener.open(files, parameters)

    def _ask_where(self, missing: Missing) -> None:
        if self._remembers:
            MissingScans(missing, self.opener.open_work, self._window).open()
        else:
            self._window.tell(ProjectError(missing.sentence))

    def _note_opened(self) -> None:
        """Look at what was opened as it was left."""
        bench, document = self._bench, self._document
        remembered = Remembered.read(document.project.view)
        if document.project.view:
            remembered.show(bench.trio, bench.map)
            last = len(document.answer.result.layers) - 1 if document.answer else 0
            document.set_active_layer(max(-1, min(remembered.layer, last)))
        if camera := remembered.camera_from(bench.feeds.scene.origin):
            bench.feeds.scene.begin_with(camera)
        stored = document.file.stored
        self._remember((stored.path,) if stored else document.scans)
        self._show_title()

    # --- Saving ---------------------------------------------------------------------------------------------

    def save(self, then: Then | None = None) -> None:
        """Save to the project's file, or ask for one."""
        if self._document.file.stored is None:
            self.save_as(then)
        else:
            self.saving.save(then=then)

    def save_as(self, then: Then | None = None) -> None:
        """Ask for a file and save to it."""
        if path := ask_for_place(self._window, self._usual_place()):
            self._window.settings.remember_folder("open", path.parent)
            self.saving.save(path, then=then)

    def _usual_place(self) -> Path:
        stored, scans = self._document.file.stored, self._document.scans
        return stored.path if stored else scans[0].with_suffix(PROJECT)

    def _note_saved(self, path: Path) -> None:
        self._remember((path,))

    def _ask_about_another(self, path: Path) -> None:
        """Ask before the work of another window is replaced."""
        self._ask(
            "Changed by another window",
            f"{path.name} was changed by another window or program since this one read or saved it.",
            "Nothing was written. Overwriting gives up what the other one saved.",
            Answer("Save &as…", "Save under another name: both stay", Role.AcceptRole, self.save_as),
            Answer("&Overwrite", "Give up what the other one saved", Role.DestructiveRole, self._overwrite),
            Answer("Cancel", "Write nothing (Esc)"),
        )

    def _overwrite(self) -> None:
        if self._document.file.stored is not None:
            self.saving.save(over_another=True)

    # --- Leaving --------------------------------------------------------------------------------------------

    def leave(self, then: Then, without: Then | None = None) -> None:
        """Do what parts with the present edits, once they are saved or the operator does without them.

        Parameters
        ----------
        then : callable
            What is to be done.
        without : callable, optional
            Done in its place when the edits are not to be saved.
        """
        if self.saving.busy:
            self._waiting = lambda: self.leave(then, without)
        elif not self._document.file.dirty or not self._remembers:
            then()
        else:
            self._ask(
                "Save the project?",
                f"{self._name()} has edits that are not saved.",
                "They are lost if you do not save them.",
                Answer("&Save", "Save, then go on", Role.AcceptRole, lambda: self.save(then)),
                Answer("&Don't save", "Go on without the edits", Role.DestructiveRole, without or then),
                Answer("Cancel", "Go back to the window (Esc)"),
            )

    def may_close(self) -> bool:
        """Whether the window may close now; else it closes itself once the operator has decided."""
        if self._leaves or not self._remembers or (self.is_idle and not self._document.file.dirty):
            return True
        self.leave(self._window.close, self.close_without)
        return False

    def close_without(self) -> None:
        """Close the window and do without the edits that are not saved."""
        self._document.file.give_up()
        self._leaves = True
        self._window.close()

    def close_at_once(self) -> None:
        """Close the window without a question; edits that are not saved are offered at the next start."""
        self._leaves = True
        self._window.close()

    def close(self) -> None:
        """Finish what is being written, and end the workers."""
        for part in (self.opener, self.watch, self.saving):
            part.close()
        if self.recovery is not None:
            self.recovery.close()

    def _go_on(self, is_busy: bool) -> None:
        waiting, self._waiting = self._waiting, None
        if waiting is not None and not is_busy:
            waiting()
        else:
            self._waiting = waiting

    # --- Telling --------------------------------------------------------------------------------------------

    def _ask(self, title: str, sentence: str, more: str, *answers: Answer) -> None:
        """Ask one question at a time."""
        if not self._window.findChildren(Question):
            Question(title, sentence, more, answers, self._window).open()

    def _offer(self, draft: Draft) -> None:
        """Offer what a window has left that ended without leave."""
        recovery = self.recovery
        assert recovery is not None
        self._window.message_bar.tell(
            "info",
            draft.sentence(datetime.now()),
            choices=(
                Choice("&Recover", "Open them; they are kept until you save", lambda: self._recover(draft)),
                Choice("&Discard", "Remove them for good", lambda: recovery.discard(draft)),
                Choice("Later", "Ask again at the next start (Esc)", lambda: recovery.leave(draft)),
            ),
        )

    def _recover(self, draft: Draft) -> None:
        self.leave(lambda: self.opener.open_work(draft.work))

    def _warn_of_scans(self, names: tuple[str, ...]) -> None:
        those, made = (
            (names[0], "is not the file") if len(names) == 1 else (", ".join(names), "are not those")
        )
        self._warn(
            f"{those} {made} the project was made from; edits that no longer fit are listed under Edits."
        )

    def _warn_of_another(self, path: Path) -> None:
        self._warn(
            f"{path.name} was changed by another window or program; saving asks before it overwrites that."
        )

    def _warn_of_loss(self, path: Path) -> None:
        self._warn(f"{path.name} is no longer in {path.parent}; saving writes it anew.")

    def _warn(self, sentence: str) -> None:
        self._window.message_bar.tell("warning", sentence)

    def _remember(self, files: Files) -> None:
        if self._remembers:
            self._window.settings.remember_opened(files)
            self._window.welcome.set_recent(self._window.settings.recent)

    def _name(self) -> str:
        """Name the project, or the scan where there is none."""
        stored, scans = self._document.file.stored, self._document.scans
        more = f" and {len(scans) - 1} more" if len(scans) > 1 else ""
        return stored.path.name if stored else f"{scans[0].name}{more}" if scans else ""

    def _show_title(self) -> None:
        """Name what is open, marked in the way of the system while it is not saved."""
        name, dirty = self._name().replace("[*]", "[*][*]"), self._document.file.dirty
        mark = "[*]" if dirty else ""
        self._window.setWindowModified(False)
        self._window.setWindowTitle(f"{name}{mark} \N{EN DASH} Stepfield" if name else "Stepfield")
        self._window.setWindowModified(dirty)
