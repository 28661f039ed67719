"""What the command shows: results on stdout, progress and warnings on stderr."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Iterator, Mapping
from typing import Any

from stepfield.files import one_line
from stepfield.progress import Progress, silent


def counted(number: int, thing: str) -> str:
    """Return a number with the word for one or several of a thing."""
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


class Reporter:
    """Writes results as sentences or, when asked, as one JSON object."""

    def __init__(self, as_json: bool) -> None:
        self._as_json = as_json

    def result(self, values: Mapping[str, Any], sentences: str) -> None:
        """Show a result in the form the operator asked for."""
        text = json.dumps(values, ensure_ascii=False) if self._as_json else sentences.rstrip()
        sys.stdout.write(text + "\n")

    @staticmethod
    def warn(sentence: str) -> None:
        """Show something the operator should know."""
        sys.stderr.write(f"warning: {one_line(sentence)}\n")

    @staticmethod
    @contextlib.contextmanager
    def progress() -> Iterator[Progress]:
        """Give a progress callback: a bar on a terminal, nothing in a pipe."""
        if not sys.stderr.isatty():
            yield silent
            return
        from rich.console import Console
        from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
        from rich.progress import Progress as Bars

        columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
        with Bars(*columns, console=Console(stderr=True), transient=True) as bars:
            task = bars.add_task("", total=1.0)

            def report(share: float, what: str) -> None:
                bars.update(task, completed=share, description=what)

            yield report
