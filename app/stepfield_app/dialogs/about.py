"""About: what this is, whose method it follows, and the libraries it stands on with their licences."""

from __future__ import annotations

import re
from collections.abc import Iterable
from importlib.metadata import PackageMetadata, PackageNotFoundError, metadata, requires

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QAbstractItemView,
    QDialog,
    QDialogButtonBox,
    QHeaderView,
    QLabel,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

import stepfield

#: Name, version and licence of a library.
Library = tuple[str, str, str]

_WHAT = "Layered height-maps for robot simulators, from laser scans of rough, multi-level terrain."
_PAPER = (
    "After G. Roberts, S. Balakirsky and S. Foufou, 3D Reconstruction of Rough Terrain for USARSim Using a "
    "Height-map Method, Performance Metrics for Intelligent Systems (PerMIS), 2008."
)
_LICENCE = (
    "Stepfield is free software under the MIT licence. Copyright 2026 The Stepfield authors. "
    "Icons: Material Design Icons, Apache-2.0."
)
_SPDX = {
    "Apache License, Version 2.0": "Apache-2.0",
    "Apache License 2.0": "Apache-2.0",
    "MIT License": "MIT",
    "3-Clause BSD License": "BSD-3-Clause",
    "BSD 3-Clause License": "BSD-3-Clause",
    "BSD License": "BSD",
}


def libraries() -> list[Library]:
    """Return the libraries Stepfield declares, with the versions and licences that are installed."""
    names = {_name(each) for each in requires("stepfield") or [] if "extra ==" not in each}
    return sorted(_described(names), key=lambda library: library[0].casefold())


class AboutDialog(QDialog):
    """Version, method, licences."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle("About Stepfield")
        self.resize(560, 520)
        title = QLabel(f"Stepfield {stepfield.__version__}")
        title.setProperty("role", "title")
        close = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        close.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(16, 16, 16, 16)
        layout.setSpacing(8)
        layout.addWidget(title)
        for text in (_WHAT, _PAPER, _LICENCE):
            layout.addWidget(_paragraph(text))
        layout.addSpacing(8)
        layout.addWidget(_table(libraries()), 1)
        layout.addWidget(close)


def _described(names: Iterable[str]) -> Iterable[Library]:
    for name in names:
        try:
            about = metadata(name)
        except PackageNotFoundError:  # declared for another system
            continue
        yield about["Name"], about["Version"], _licence(about)


def _licence(about: PackageMetadata) -> str:
    """Return the licence in a word or two, from whichever of three places a package says it in."""
    classifiers = [text for text in about.get_all("Classifier") or [] if text.startswith("License ::")]
    said = next((about[key] for key in ("License-Expression", "License") if key in about), "")
    if (not said or "\n" in said or len(said) > 60) and classifiers:
        said = classifiers[0].rpartition(" :: ")[2]
    first = said.strip().splitlines()[0] if said.strip() else "see its own files"
    return _SPDX.get(first, first)


def _name(requirement: str) -> str:
    return re.split(r"[^A-Za-z0-9._-]", requirement, maxsplit=1)[0]


def _paragraph(text: str) -> QLabel:
    label = QLabel(text)
    label.setWordWrap(True)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    return label


def _table(rows: list[Library]) -> QTableWidget:
    table = QTableWidget(len(rows), 3)
    table.setHorizontalHeaderLabels(["Library", "Version", "Licence"])
    table.setAccessibleName("Libraries and their licences")
    table.setToolTip("The libraries Stepfield stands on, with their licences")
    table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
    table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
    table.setShowGrid(False)
    table.setTabKeyNavigation(False)
    table.verticalHeader().hide()
    table.verticalHeader().setDefaultSectionSize(24)
    header = table.horizontalHeader()
    header.setHighlightSections(False)
    header.setDefaultAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
    header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
    header.setSectionResizeMode(2, QHeaderView.ResizeMode.Stretch)
    for row, cells in enumerate(rows):
        for column, text in enumerate(cells):
            table.setItem(row, column, QTableWidgetItem(text))
    return table
