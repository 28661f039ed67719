"""Opens the window as the command does, and notes when it is painted, filled and drawn; for ``test_window``.

    python start_window.py REPORT OPTION...

It imports nothing before the command would; ages of the process go into REPORT as JSON.
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path
from typing import Any

#: Milliseconds between two looks whether the scan is drawn.
LOOK = 20


def age() -> float:
    """Seconds since this process was started.

    On Linux by the clock the kernel notes it with: psutil adds the time of the boot, cut to a second.
    """
    if sys.platform != "linux":
        import psutil

        return float(time.time() - psutil.Process().create_time())
    ticks = Path("/proc/self/stat").read_text().rpartition(")")[2].split()[19]
    return time.clock_gettime(time.CLOCK_BOOTTIME) - int(ticks) / os.sysconf("SC_CLK_TCK")


def watch(window: Any, report: dict[str, Any]) -> None:
    """Note when a window is painted, filled and drawn, and close it then."""
    from PySide6.QtCore import QTimer

    looking = QTimer(window, interval=LOOK)

    def look() -> None:
        if window.is_ready and window.bench.document.answer is not None and window.is_settled():
            looking.stop()
            report["drawn"] = age()
            window.filing.close_without()

    def note() -> None:
        report["visible"] = age()
        report["imported"] = "open3d" in sys.modules

    looking.timeout.connect(look)
    window.first_paint.happened.connect(note)
    window.when_ready(lambda: report.update(ready=age()))
    window.when_ready(looking.start)


def main() -> None:
    """Open the window and write the report."""
    file, *words = sys.argv[1:]
    report: dict[str, Any] = {}
    from stepfield.cli import run, view

    imported = view._imported

    def watched(name: str) -> Any:
        module = imported(name)
        made = module.MainWindow

        def make(*given: Any, **named: Any) -> Any:
            window = made(*given, **named)
            watch(window, report)
            return window

        module.MainWindow = make
        return module

    setattr(view, "_imported", watched)  # noqa: B010 - what view calls
    code = run(["view", *words])
    Path(file).write_text(json.dumps(report))
    sys.exit(code)


if __name__ == "__main__":
    main()
