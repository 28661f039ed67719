"""Data files that ship with Stepfield: JSON schemas of the files it writes, the style sheet of the window."""

import json
from importlib.resources import files
from typing import Any, Literal


def schema(name: Literal["stack", "project", "scene"]) -> dict[str, Any]:
    """Return the JSON schema of a stack's manifest, a project file or a scene description."""
    text = (files(__name__) / "schemas" / f"{name}.schema.json").read_text(encoding="utf-8")
    document: dict[str, Any] = json.loads(text)
    return document


def style_sheet() -> str:
    """Return the style sheet of the window, with $names where a theme puts its colours."""
    return (files(__name__) / "style.qss").read_text(encoding="ascii")
