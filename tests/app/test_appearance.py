"""The look: readable in both themes, following the choice, and no token forgotten."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QFont, QFontMetricsF, QIcon, QPalette
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from stepfield_app.appearance import GLYPHS, Appearance, icon, numbers_font, palette, text_font
from stepfield_app.style_sheet import mixed, on_accent, style_sheet
from stepfield_app.theme import DARK, LIGHT, Theme, rgb


@pytest.fixture
def appearance(qapp: QApplication) -> Iterator[Appearance]:
    """Dress the application, and undress it for the other tests."""
    dressed = Appearance(qapp, "dark")
    yield dressed
    qapp.styleHints().unsetColorScheme()
    qapp.setStyleSheet("")
    dressed.deleteLater()


def test_a_window_that_is_made_undressed_is_dressed_afterwards(
    appearance: Appearance, qapp: QApplication
) -> None:
    """What is shown would be bare."""
    sheet = qapp.styleSheet()
    assert sheet
    with appearance.undressed():
        assert not qapp.styleSheet()
    assert qapp.styleSheet() == sheet


def test_a_choice_changes_palette_and_says_so_once(
    appearance: Appearance, qapp: QApplication, qtbot: QtBot
) -> None:
    """If it failed, part of the window would keep the colours of the other theme, or be drawn twice."""
    heard: list[Theme] = []
    appearance.changed.connect(heard.append)
    appearance.choose("light")
    appearance.choose("light")
    assert heard == [LIGHT]
    assert qapp.palette().color(QPalette.ColorRole.Window).name() == LIGHT.window
    assert LIGHT.accent in qapp.styleSheet()


def test_the_system_is_followed(appearance: Appearance, qapp: QApplication) -> None:
    """If it failed, the window would stay dark on a desktop that turned light."""
    appearance.choose("system")
    for scheme, theme in ((Qt.ColorScheme.Light, LIGHT), (Qt.ColorScheme.Dark, DARK)):
        qapp.styleHints().colorSchemeChanged.emit(scheme)
        assert appearance.theme == theme
    appearance.choose("light")
    qapp.styleHints().colorSchemeChanged.emit(Qt.ColorScheme.Dark)
    assert appearance.theme == LIGHT, "what the operator chose must outlive the desktop's evening"


@pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])
def test_every_mark_of_the_style_sheet_exists(theme: Theme, tmp_path: Path) -> None:
    """If it failed, arrows and ticks would be missing from controls, which Qt does not report."""
    sheet = style_sheet(theme, tmp_path)
    assert "$" not in sheet
    named = [part.split(")")[0] for part in sheet.split("url(")[1:]]
    assert named
    assert all(Path(name).is_file() for name in named)


@pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])
def test_text_can_be_read(theme: Theme) -> None:
    """If it failed, text would fall short of the contrast that WCAG AA asks for."""
    for ground in (theme.window, theme.panel, theme.field):
        assert contrast(theme.text, ground) >= 7
        assert contrast(theme.muted, ground) >= 4.5
    assert contrast(on_accent(theme), theme.accent) >= 4.5


def test_disabled_text_is_fainter_than_the_other(qapp: QApplication) -> None:
    """If it failed, nobody could tell what can be used."""
    made = palette(DARK)
    disabled = made.color(QPalette.ColorGroup.Disabled, QPalette.ColorRole.ButtonText).name()
    assert contrast(disabled, DARK.panel) < contrast(DARK.text, DARK.panel)


@pytest.mark.parametrize("meaning", GLYPHS)
def test_every_meaning_has_a_glyph(meaning: str, qapp: QApplication) -> None:
    """If it failed, a button would be blank: the font does not have what the table names."""
    image = icon(meaning).pixmap(QSize(18, 18)).toImage()
    assert any(image.pixelColor(x, y).alpha() > 128 for x in range(18) for y in range(18))


def test_an_icon_takes_the_theme_of_the_moment(appearance: Appearance) -> None:
    """If it failed, icons would vanish on the ground of the other theme."""
    sign = icon("open")
    dark = sign.pixmap(QSize(18, 18)).toImage()
    appearance.choose("light")
    assert sign.pixmap(QSize(18, 18)).toImage() != dark


def test_an_icon_is_sharp_on_a_dense_screen(qapp: QApplication) -> None:
    """If it failed, icons would be stretched at 200 % scaling."""
    assert icon("open").pixmap(QSize(18, 18), 2.0).size() == QSize(36, 36)


def test_a_disabled_icon_is_fainter(appearance: Appearance) -> None:
    """If it failed, a button that does nothing would look like one that does."""
    sign = icon("open")
    assert sign.pixmap(QSize(18, 18)).toImage() != sign.pixmap(QSize(18, 18), QIcon.Mode.Disabled).toImage()


def test_numbers_do_not_jump(appearance: Appearance) -> None:
    """If it failed, a running number would shift what stands beside it."""
    metrics = QFontMetricsF(numbers_font())
    assert len({metrics.horizontalAdvance(digit) for digit in "0123456789"}) == 1
    assert numbers_font().pixelSize() == text_font().pixelSize() == 13
    assert numbers_font(QFont("Serif")).family() == "Serif"


def test_icons_do_not_import_qtawesome() -> None:
    """If it failed, the window would open some 200 ms later."""
    code = (
        "import sys; from PySide6.QtWidgets import QApplication; app = QApplication([]);"
        "from stepfield_app.appearance import icon; icon('open').pixmap(18, 18);"
        "sys.exit('qtawesome' in sys.modules or 'qtpy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_mixing_goes_from_one_colour_to_the_other() -> None:
    """If it failed, hover and disabled states would have colours of no theme."""
    assert mixed("#000000", "#ffffff", 0) == "#000000"
    assert mixed("#000000", "#ffffff", 1) == "#ffffff"


def contrast(one: str, other: str) -> float:
    """Contrast ratio by WCAG 2."""
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def luminance(colour: str) -> float:
    """Relative luminance by WCAG 2."""
    linear = [
        c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in (v / 255 for v in rgb(colour))
    ]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
