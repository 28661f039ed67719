"""What can be opened: by dialog, by drop, from the empty window; and the demo."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent
from PySide6.QtWidgets import QApplication, QFileDialog, QLabel, QPushButton, QWidget
from pytestqt.qtbot import QtBot

from stepfield.errors import Cancelled, ProjectError, ScanError
from stepfield.formats import FORMATS
from stepfield.parameters import Parameters
from stepfield.project import Project, ScanFile
from stepfield.scan import read_scan
from stepfield_app import demo
from stepfield_app.dropping import DropTarget, openable
from stepfield_app.opening import ask_for_files, file_filters, work_at
from stepfield_app.settings import Settings
from stepfield_app.views.header import ViewHeader
from stepfield_app.views.status import Status
from stepfield_app.views.strip import Detail
from stepfield_app.views.welcome import WelcomePage

#: Qt's platform for tests without a screen says so at every window.
pytestmark = pytest.mark.qt_log_ignore("This plugin does not support", extend=True)


def test_every_format_of_the_core_is_offered() -> None:
    """If it failed, a scan the core reads could not be seen in the dialog."""
    filters = file_filters()
    assert all(f"*{suffix} " in filters.replace(")", " ") for suffix in (*FORMATS, ".stepfield"))


def test_a_project_is_opened_alone_and_strangers_are_left_out() -> None:
    """If it failed, a drop of mixed files would open something half understood."""
    a, b, project, other = Path("a.LAZ"), Path("b.ply"), Path("p.stepfield"), Path("notes.md")
    assert openable([a, other, b]) == (a, b)
    assert openable([a, project]) == (project,)
    assert openable([other]) == ()


def test_the_dialog_starts_where_the_last_scan_was(
    tmp_path: Path, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """If it failed, every scan would mean walking through the folders anew."""
    widget, settings, starts = QWidget(), Settings(), []
    qtbot.addWidget(widget)

    def answer(_parent: QWidget, _title: str, start: str, _filters: str) -> tuple[list[str], str]:
        starts.append(start)
        return [str(tmp_path / "a.ply")], ""

    monkeypatch.setattr(QFileDialog, "getOpenFileNames", answer)
    assert ask_for_files(widget, settings) == (tmp_path / "a.ply",)
    ask_for_files(widget, settings)
    assert starts[1] == str(tmp_path)


@pytest.fixture
def target(qtbot: QtBot) -> QWidget:
    """Return a widget files can be dropped on."""
    widget = QWidget()
    qtbot.addWidget(widget)
    return widget


def held(names: Iterable[str]) -> QMimeData:
    """Return files in the hand."""
    data = QMimeData()
    data.setUrls([QUrl(name) if "://" in name else QUrl.fromLocalFile(name) for name in names])
    return data


def entered(widget: QWidget, data: QMimeData) -> bool:
    """Say whether a widget takes what is dragged over it."""
    return sent(widget, data, QEvent.Type.DragEnter)


def sent(widget: QWidget, data: QMimeData, kind: QEvent.Type) -> bool:
    """Send a drag event and say whether it was accepted."""
    buttons, action = Qt.MouseButton.LeftButton, Qt.DropAction.CopyAction
    event = QDropEvent(QPointF(5, 5), action, data, buttons, Qt.KeyboardModifier.NoModifier, kind)
    event.ignore()
    QApplication.sendEvent(widget, event)
    return event.isAccepted()


def test_dropped_scans_arrive_together(target: QWidget, qtbot: QtBot) -> None:
    """If it failed, a scan in several files would have to be opened file by file."""
    drop = DropTarget(target)
    data = held(["/scans/a.laz", "/scans/b.laz", "/scans/readme.md"])
    assert entered(target, data)
    with qtbot.waitSignal(drop.dropped) as heard:
        assert sent(target, data, QEvent.Type.Drop)
    assert heard.args == [(Path("/scans/a.laz"), Path("/scans/b.laz"))]


@pytest.mark.parametrize("names", [["/notes.md"], ["https://example.org/a.laz"], []])
def test_what_cannot_be_opened_is_refused_in_the_hand(names: list[str], target: QWidget) -> None:
    """If it failed, the cursor would promise something that then fails."""
    DropTarget(target)
    assert not entered(target, held(names))


def test_the_empty_window_offers_three_ways(qtbot: QtBot) -> None:
    """If it failed, a newcomer would not know how to begin."""
    page = WelcomePage()
    qtbot.addWidget(page)
    chosen: list[object] = []
    page.open_wanted.connect(lambda: chosen.append("open"))
    page.demo_wanted.connect(lambda: chosen.append("demo"))
    page.files_chosen.connect(chosen.append)
    files = (Path("/scans/a & b.laz"), Path("/scans/c.laz"))
    page.set_recent([files])
    page.set_recent([files])
    page.show()
    for button in page.findChildren(QPushButton):
        if button.isVisible():
            button.click()
    assert chosen == ["open", "demo", files]


def test_the_welcome_page_is_scrolled_where_it_is_too_high(qtbot: QtBot) -> None:
    """In a small window its lines lay over one another, and letters were cut."""
    page = WelcomePage([(Path(f"/scans/{at}.laz"),) for at in range(6)])
    qtbot.addWidget(page)
    page.resize(720, 260)
    page.show()
    for part in page.findChildren(QLabel):
        assert part.isHidden() or part.height() >= part.heightForWidth(part.width())


def test_the_name_of_a_view_is_never_cut(qtbot: QtBot) -> None:
    """The last letter was, beside the colours in a window of 1280 pixels."""
    header = ViewHeader("Reconstruction", "Ctrl+3")
    qtbot.addWidget(header)
    header.set_colours((("layer", "Layer"), ("height", "Height")), "layer")
    header.show()
    for width in range(160, 320, 5):
        header.resize(width, header.height())
        QApplication.processEvents()
        assert header.title.width() >= header.title.sizeHint().width(), width


def test_the_status_bar_does_not_jump(qtbot: QtBot) -> None:
    """If it failed, figures would shift sideways while the pointer moves or work begins."""
    status = Status()
    qtbot.addWidget(status)
    status.resize(1600, 24)
    status.show()
    before = [child.geometry() for child in status.findChildren(QWidget)]
    status.show_position(-1234.5678, 5_600_123.4, -0.001)
    status.show_cell(31, 124, 2)
    status.show_result(1_234_567, 12, 10_000_000, 1.25)
    status.show_progress(0.5, "reading a scan whose name is much longer than there is room for it.laz")
    QApplication.processEvents()
    assert [child.geometry() for child in status.findChildren(QWidget)] == before


def test_a_sentence_has_the_room_of_the_figures(qtbot: QtBot) -> None:
    """What was done would be cut in the middle of the bar, by a place for work that nobody does."""
    status = Status()
    qtbot.addWidget(status)
    status.resize(1600, 24)
    status.show()
    before = status._work.geometry()
    status.say("Move 2508 pillars to Layer 2: 62 pillars swapped, 2036 pillars stayed")
    qtbot.waitUntil(lambda: not status._result.isVisible())
    QApplication.processEvents()
    assert status._work.geometry() == before


def test_a_remark_is_never_cut(qtbot: QtBot) -> None:
    """The style leaves room beside it: a bracket was lost there."""
    remark = Detail()
    qtbot.addWidget(remark)
    remark.setStyleSheet("padding: 0 8px")
    remark.say("selected (Layer 1: 1328)", "selected")
    remark.resize(remark.fontMetrics().horizontalAdvance("selected (Layer 1: 1328)") + 10, 20)
    remark.show()
    assert remark.text() == "selected"


def test_work_can_be_stopped_from_the_status_bar(qtbot: QtBot) -> None:
    """If it failed, a long load could not be left."""
    status = Status()
    qtbot.addWidget(status)
    status.show()
    status.show_progress(0.2, "reading")
    with qtbot.waitSignal(status.cancel_wanted):
        status._work.cancel.click()
    status.clear_progress()
    assert not status._work.cancel.isVisible()


def test_the_demo_is_made_once(tmp_path: Path) -> None:
    """If it failed, the demo would take seconds each time, or be another scene than the command's."""
    made = demo.make_demo(tmp_path, points=4000)
    stamp = made.stat().st_mtime_ns
    assert demo.make_demo(tmp_path, points=4000) == made == demo.demo_file(tmp_path)
    assert made.stat().st_mtime_ns == stamp
    assert 2000 < len(read_scan([made])) < 8000
    assert np.ptp(read_scan([made]).bounds(), axis=0)[2] > 1


def test_a_demo_that_was_stopped_leaves_nothing(tmp_path: Path) -> None:
    """If it failed, half a scan would be taken for the demo the next time."""

    def stop(share: float, what: str) -> None:
        if share >= 0.9:
            raise Cancelled

    with pytest.raises(Cancelled):
        demo.make_demo(tmp_path, stop, points=4000)
    assert not demo.demo_file(tmp_path).exists()


def test_a_cache_that_cannot_be_written_is_one_sentence(tmp_path: Path) -> None:
    """If it failed, a read-only home would show a traceback."""
    (tmp_path / "file").touch()
    with pytest.raises(ScanError, match="cannot be kept there"):
        demo.make_demo(tmp_path / "file", points=4000)


def test_a_project_names_its_scans_from_where_it_lies(tmp_path: Path) -> None:
    """Paths in a project are relative to it, not to where the program was started."""
    Project(scans=(ScanFile(path="scans/room.ply"),), parameters=Parameters(bits=8)).save(
        tmp_path / "a.stepfield"
    )
    project = work_at(tmp_path / "a.stepfield").project
    assert project.scans[0].path == str(tmp_path / "scans" / "room.ply")
    assert project.parameters.bits == 8


def test_what_is_no_project_is_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "a.stepfield").write_text("{}")
    with pytest.raises(ProjectError, match="not a project"):
        work_at(tmp_path / "a.stepfield")
