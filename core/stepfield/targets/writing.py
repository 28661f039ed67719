"""Writing targets: each into a folder of its name, made beside its place and moved there when it is whole."""

from __future__ import annotations

import importlib
import json
import math
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, cast, get_args

from stepfield.errors import ParameterError
from stepfield.files import read_json
from stepfield.parameters import Way
from stepfield.progress import Progress, part, silent
from stepfield.reconstruction import Reconstruction
from stepfield.stack import Manifest, write_stack
from stepfield.stack.folder import new_folder
from stepfield.targets import NAMES
from stepfield.targets.target import USUAL, Options, Target, Written
from stepfield.targets.terrain import Terrain, TerrainLayer
from stepfield.targets.text import write_text

#: Says in every target's folder what it is, and all numbers another program may want.
FILE_NAME = "target.json"
FORMAT = "stepfield-target"
VERSION = 1


def checked(names: Sequence[str]) -> tuple[str, ...]:
    """Return each name once, in the order of :data:`NAMES`; raise ParameterError at an unknown one."""
    for name in names:
        if name not in NAMES:
            raise ParameterError(f"unknown target {name!r}; choose among {', '.join(NAMES)}")
    return tuple(name for name in NAMES if name in names)


def write_targets(
    stack: Path,
    names: Sequence[str],
    output: Path,
    options: Options = USUAL,
    *,
    overwrite: bool = False,
    progress: Progress = silent,
) -> dict[str, Written]:
    """Write targets of the stack in a folder: all of them, or none.

    Parameters
    ----------
    stack : Path
    names : sequence of str
        Among :data:`stepfield.targets.NAMES`.
    output : Path
        Gets a folder a target; what else it holds stays.
    options : Options
    overwrite : bool
        Replace folders of targets found there.
    progress : Progress
        May raise Cancelled.

    Returns
    -------
    dict
        What was written, by name.

    Raises
    ------
    StackError, TargetError, ParameterError
        In one sentence; all is then as it was.
    """
    wanted = checked(names)
    progress(0.0, "reading the stack")
    terrain = Terrain.of_stack(stack, options.reconstruction)
    with ExitStack() as whole:
        folders = [
            whole.enter_context(new_folder(output / name, is_target if overwrite else None, "a target"))
            for name in wanted
        ]
        written = _fill(terrain, dict(zip(wanted, folders, strict=True)), options, part(progress, 0.1, 1))
    progress(1.0, "done")
    return written


def write_stack_and_targets(
    result: Reconstruction,
    folder: Path,
    names: Sequence[str],
    options: Options = USUAL,
    *,
    overwrite: bool = False,
    progress: Progress = silent,
) -> tuple[Manifest, dict[str, Written]]:
    """Write a stack with targets in it, all or nothing, as ``stepfield build --target`` does.

    Raises
    ------
    StackError, TargetError, ParameterError
        In one sentence; the folder is then as it was.
    """
    wanted = checked(names)
    written: dict[str, Written] = {}

    def also(new: Path) -> None:
        folders = {name: new / name for name in wanted}
        for each in folders.values():
            each.mkdir()
        terrain = Terrain.of_stack(new, options.reconstruction)
        written.update(_fill(terrain, folders, options, part(progress, share, 1)))

    share = 0.3 if wanted else 1.0
    manifest = write_stack(
        result, folder, overwrite=overwrite, progress=part(progress, 0, share), also=also if wanted else None
    )
    progress(1.0, "done")
    return manifest, written


def limits(terrain: Terrain, name: str) -> list[str]:
    """Say in sentences what of a terrain a target cannot hold."""
    return _module(name).limits(terrain)


def is_target(folder: Path) -> bool:
    """Whether a folder holds a target, so that replacing it loses nothing else."""
    try:
        document = read_json(folder / FILE_NAME, ParameterError, "target")
    except ParameterError:
        return False
    return isinstance(document, dict) and document.get("format") == FORMAT


def _fill(
    terrain: Terrain, folders: dict[str, Path], options: Options, progress: Progress
) -> dict[str, Written]:
    written = {}
    for number, (name, folder) in enumerate(folders.items()):
        progress(number / len(folders), f"writing {name}")
        written[name] = _module(name).write(terrain, folder, options)
        write_text(folder / FILE_NAME, _document(terrain, name, written[name]))
    return written


def _module(name: str) -> Target:
    return cast(Target, importlib.import_module(f"stepfield.targets.{name}"))


def _document(terrain: Terrain, name: str, written: Written) -> str:
    """Return target.json: the numbers that most targets need and few of their formats carry."""
    values = {
        "format": FORMAT,
        "version": VERSION,
        "target": name,
        "generator": terrain.manifest.generator,
        "name": terrain.name,
        "local_origin": terrain.local_origin,
        "cell_size": terrain.cell_size,
        "columns": terrain.columns,
        "rows": terrain.rows,
        "west": terrain.west,
        "north": terrain.north,
        "base_elevation": terrain.base_elevation,
        "reconstruction": terrain.reconstruction,
        "layers": [_entry(layer) for layer in terrain.layers],
        "files": sorted(written.files),
        "notes": written.notes,
    }
    return json.dumps(values, ensure_ascii=True, indent=1, allow_nan=False) + "\n"


def _entry(layer: TerrainLayer) -> dict[str, Any]:
    there = layer.elevations[layer.occupied]
    return {
        "index": layer.index,
        "name": layer.name,
        "z_min": float(there.min()) if there.size else None,
        "z_max": float(there.max()) if there.size else None,
        "samples": int(there.size),
        "half_level": layer.half_level,
    }


def wishes(thicken: float | None, decimate: float | None, reconstruction: str | None) -> Options:
    """Make the options, or raise ParameterError where one is none."""
    for name, value in (("thicken", thicken), ("decimate", decimate)):
        if value is not None and not (math.isfinite(value) and 0 < value <= 1000):
            raise ParameterError(f"impossible {name} {value!r}; give a length in metres above 0, up to 1000")
    if reconstruction not in {None, *get_args(Way)}:
        raise ParameterError(
            f"unknown reconstruction {reconstruction!r}; choose among {', '.join(get_args(Way))}"
        )
    return Options(thicken, decimate, cast(Way | None, reconstruction))
