"""Which targets an operator wants, and what the command says of those written."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

from stepfield.cli.report import counted
from stepfield.targets.target import Options, Written
from stepfield.targets.writing import checked, wishes


@dataclass(frozen=True)
class Wanted:
    """Names of targets, and how they are to be."""

    names: tuple[str, ...]
    options: Options

    @classmethod
    def checked(
        cls,
        names: Sequence[str],
        thicken: float | None,
        decimate: float | None,
        reconstruction: str | None = None,
    ) -> Self:
        """Check what was given, before anything long begins; raise ParameterError in one sentence."""
        return cls(checked(names), wishes(thicken, decimate, reconstruction))


def described(targets: Mapping[str, Written]) -> dict[str, Any]:
    """Return what was written, for JSON."""
    each = {name: {"files": list(made.files), "notes": list(made.notes)} for name, made in targets.items()}
    return {"targets": each}


def notes(targets: Mapping[str, Written]) -> Iterator[str]:
    """Give what an operator should know."""
    return (f"{name}: {note}" for name, made in targets.items() for note in made.notes)


def sentences(targets: Mapping[str, Written]) -> list[str]:
    """Return a line a target."""
    return [f"  {name}/  {counted(len(made.files), 'file')}" for name, made in targets.items()]
