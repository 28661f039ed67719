"""The empty window: what can be opened, and how."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QScrollArea, QVBoxLayout, QWidget

from stepfield.formats import FORMATS
from stepfield_app.appearance import ICON_SIZE, icon
from stepfield_app.settings import Files

_WIDTH = 480
_SHOWN = 6


class WelcomePage(QWidget):
    """Offers a scan, the demo and what was open before."""

    open_wanted = Signal()
    demo_wanted = Signal()
    files_chosen = Signal(tuple)  # of Path: a recent scan

    def __init__(self, recent: Sequence[Files] = (), parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("Welcome")
        self._recent = QVBoxLayout()
        self._recent.setSpacing(0)
        self._nothing_recent = _muted("Scans that were open will be listed here.")
        self._page = page = QWidget()
        page.setFixedWidth(_WIDTH)
        self._fill(QVBoxLayout(page))
        middle = QWidget()
        outer = QVBoxLayout(middle)
        outer.addStretch(2)
        outer.addLayout(_centred(page))
        outer.addStretch(3)
        whole = QVBoxLayout(self)
        whole.setContentsMargins(0, 0, 0, 0)
        whole.addWidget(_scrolled(middle))
        self.set_recent(recent)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Keep the page as high as its wrapped lines are: what scrolls it does not ask."""
        super().resizeEvent(event)
        self._page.setMinimumHeight(self._page.heightForWidth(_WIDTH))

    def set_recent(self, recent: Sequence[Files]) -> None:
        """List what was open before, the newest first."""
        while (item := self._recent.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.hide()
                widget.deleteLater()
        for files in recent[:_SHOWN]:
            self._recent.addWidget(self._recent_button(files))
        self._nothing_recent.setVisible(not recent)

    def _fill(self, layout: QVBoxLayout) -> None:
        layout.setSpacing(8)
        title = QLabel("Stepfield")
        title.setProperty("role", "title")
        layout.addWidget(title)
        layout.addWidget(_muted("Layered height-maps for robot simulators, from laser scans."))
        layout.addSpacing(16)
        layout.addWidget(self._open_button())
        layout.addWidget(self._demo_button())
        kinds = ", ".join(suffix[1:].upper() for suffix in FORMATS)
        layout.addWidget(_muted(f"Or drop a scan here: {kinds}."))
        layout.addSpacing(16)
        heading = QLabel("RECENT")
        heading.setProperty("role", "heading")
        layout.addWidget(heading)
        layout.addWidget(self._nothing_recent)
        layout.addLayout(self._recent)

    def _open_button(self) -> QPushButton:
        button = _tall(QPushButton("Open a scan or a project…"))
        button.setProperty("primary", True)
        button.setToolTip("Choose the files of one scan, or a project (Ctrl+O)")
        button.clicked.connect(self.open_wanted)
        return button

    def _demo_button(self) -> QPushButton:
        button = _tall(QPushButton("Open the demo: a collapsed building, 1 million points"))
        button.setToolTip("Make the scan of a collapsed building with the virtual scanner, once, and open it")
        button.clicked.connect(self.demo_wanted)
        return button

    def _recent_button(self, files: Files) -> QPushButton:
        more = f" and {len(files) - 1} more" if len(files) > 1 else ""
        text = self.fontMetrics().elidedText(
            f"{files[0].name}{more}  \N{EN DASH}  {files[0].parent}",
            Qt.TextElideMode.ElideMiddle,
            _WIDTH - 64,
        )
        button = _tall(QPushButton(text.replace("&", "&&")))
        button.setIcon(icon("project" if _is_project(files) else "scan"))
        button.setIconSize(QSize(ICON_SIZE, ICON_SIZE))
        button.setFlat(True)
        button.setProperty("flat", True)
        button.setToolTip("\n".join(str(path) for path in files))
        button.setAccessibleName(f"Open {files[0].name}{more} again")
        button.clicked.connect(lambda: self.files_chosen.emit(files))
        return button


def _scrolled(page: QWidget) -> QScrollArea:
    """Let a page be scrolled in a window too low for it: its lines would lie over one another."""
    area = QScrollArea(widgetResizable=True)
    area.setFrameShape(QFrame.Shape.NoFrame)
    area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
    area.setWidget(page)
    for part in (area, area.viewport(), page):
        part.setAutoFillBackground(False)
    return area


def _centred(page: QWidget) -> QHBoxLayout:
    """Put a page in the middle; an alignment would not ask it how high its wrapped lines are."""
    row = QHBoxLayout()
    row.addStretch(1)
    row.addWidget(page)
    row.addStretch(1)
    return row


def _is_project(files: Files) -> bool:
    return files[0].suffix.lower() == ".stepfield"


def _tall(button: QPushButton) -> QPushButton:
    button.setMinimumHeight(32)
    return button


def _muted(text: str) -> QLabel:
    label = QLabel(text)
    label.setProperty("role", "muted")
    label.setWordWrap(True)
    return label
