"""``stepfield view``: the window, which is a package of its own and depends on this one."""

from __future__ import annotations

import gc
import importlib
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from stepfield.errors import ParameterError, StepfieldError
from stepfield.parameters import Parameters

#: Found by name: the core runs without a window, so nothing here may import it outright.
WINDOW = "stepfield_app.application"
#: Width and height of a window in pixels, at least and at most.
LEAST_SIDE, GREATEST_SIDE = 200, 10_000


def open_window(
    scans: Sequence[Path],
    given: dict[str, Any],
    *,
    screenshot: Path | None,
    size: str | None,
    theme: str | None,
) -> int:
    """Open the window on a scan, or draw it and save a picture; return the exit code."""
    parameters = Parameters.checked(**given)
    shape = None if size is None else _size(size)
    if theme not in (None, "dark", "light"):
        raise ParameterError(f"impossible theme {theme!r}; choose dark or light")
    try:
        window = _imported(WINDOW)
    except ImportError as error:
        raise StepfieldError(f"the window cannot be opened ({error}); install Stepfield anew") from None
    code: int = window.run(scans, parameters, screenshot=screenshot, size=shape, theme=theme)
    return code


def _imported(name: str) -> Any:
    """Import a module without looking for garbage, then or later: there is none, and looking takes long."""
    gc.disable()
    try:
        return importlib.import_module(name)
    finally:
        gc.freeze()  # or what was put off would come at once
        gc.enable()


def _size(text: str) -> tuple[int, int]:
    """Read 1600x1000."""
    match = re.fullmatch(r"(\d{1,6})[xX](\d{1,6})", text.strip())
    sides = tuple(int(side) for side in match.groups()) if match else ()
    if len(sides) != 2 or not all(LEAST_SIDE <= side <= GREATEST_SIDE for side in sides):
        raise ParameterError(
            f"impossible size {text!r}; give width and height in pixels like 1600x1000, "
            f"{LEAST_SIDE} to {GREATEST_SIDE} each"
        )
    return sides[0], sides[1]
