"""What is remembered survives, and what is damaged or gone does no harm."""

from __future__ import annotations

from pathlib import Path

import pytest
from PySide6.QtCore import QByteArray, QSettings

from stepfield_app.settings import MOST_RECENT, Settings


@pytest.fixture
def store(tmp_path: Path) -> QSettings:
    """Return an empty store."""
    return QSettings(str(tmp_path / "s.ini"), QSettings.Format.IniFormat)


def scans(folder: Path, count: int) -> list[Path]:
    """Make some files."""
    files = [folder / f"scan {number}.ply" for number in range(count)]
    for file in files:
        file.touch()
    return files


def test_another_start_finds_what_was_remembered(tmp_path: Path, store: QSettings) -> None:
    """If it failed, theme, folders and docks would be lost from one day to the next."""
    first = Settings(store)
    first.theme = "light"
    first.geometry = QByteArray(b"\x00\xffplace")
    first.arrangement = QByteArray(b"\x01docks")
    first.remember_folder("export", tmp_path)
    first.remember_opened(scans(tmp_path, 2))
    store.sync()
    second = Settings(QSettings(store.fileName(), QSettings.Format.IniFormat))
    assert second.theme == "light"
    assert second.geometry == QByteArray(b"\x00\xffplace")
    assert second.arrangement == QByteArray(b"\x01docks")
    assert second.folder("export") == tmp_path
    assert second.recent == ((tmp_path / "scan 0.ply", tmp_path / "scan 1.ply"),)


def test_recent_is_newest_first_and_bounded(tmp_path: Path, store: QSettings) -> None:
    """If it failed, the list would grow without end or name one scan twice."""
    settings, files = Settings(store), scans(tmp_path, MOST_RECENT + 3)
    for file in [*files, files[5]]:
        settings.remember_opened([file])
    assert len(settings.recent) == MOST_RECENT
    assert settings.recent[0] == (files[5],)
    assert settings.recent[1] == (files[-1],)
    assert len(set(settings.recent)) == MOST_RECENT


def test_recent_leaves_out_what_is_gone(tmp_path: Path, store: QSettings) -> None:
    """If it failed, the list would offer files that cannot be opened."""
    settings, (kept, lost) = Settings(store), scans(tmp_path, 2)
    settings.remember_opened([kept])
    settings.remember_opened([kept, lost])
    lost.unlink()
    assert list(settings.recent) == [(kept,)]
    settings.forget_recent()
    assert not settings.recent


@pytest.mark.parametrize("damage", ["{", "[1, 2]", "[[]]", "7", "null", '[["a", 3]]', '{"a": 1}'])
def test_damaged_entries_count_as_absent(damage: str, store: QSettings) -> None:
    """If it failed, a settings file edited by hand would keep the window from opening."""
    for key in ("recent", "theme", "window/geometry", "folders/open"):
        store.setValue(key, damage)
    settings = Settings(store)
    assert settings.recent == ()
    assert settings.theme == "system"
    assert settings.geometry == QByteArray()
    assert settings.folder("open").is_dir()


def test_a_folder_that_is_gone_is_not_offered(tmp_path: Path, store: QSettings) -> None:
    """If it failed, a file dialog would open nowhere."""
    settings, folder = Settings(store), tmp_path / "gone"
    settings.remember_folder("open", folder)
    assert settings.folder("open") != folder
