"""Carries a correction out in the real window; run by ``test_editing`` under Xvfb.

    python -m tests.e2e.drive_correction mouse|keyboard FILE FOLDER
    python -m tests.e2e.drive_correction mouse|keyboard FOLDER

The first opens FILE, edits, saves FOLDER/room.stepfield, edits again, tells so in FOLDER/ready.json and waits
for being killed; FOLDER/edited.json says what has kept it from getting there. The second recovers, saves, and
exports. FOLDER/recovered.json says what was true on the way.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.e2e.by_keyboard import Keyboard
from tests.e2e.by_mouse import Mouse
from tests.e2e.correction import Hand, correct, recover
from tests.e2e.driving import Steps, run

from stepfield_app.main_window import MainWindow

HANDS: dict[str, Callable[[MainWindow, dict[str, Any]], Hand]] = {"mouse": Mouse, "keyboard": Keyboard}


def main() -> None:
    """Do one of both parts and write its report."""
    hand, *files, folder = HANDS[sys.argv[1]], *map(Path, sys.argv[2:])

    def todo(window: MainWindow, report: dict[str, Any]) -> Steps:
        if files:
            return correct(hand(window, report), window, files[0], folder, report)
        return recover(hand(window, report), window, folder, report)

    run(todo, folder / ("edited.json" if files else "recovered.json"))


if __name__ == "__main__":
    main()
