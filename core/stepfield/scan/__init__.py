"""Scans: every format of the field, in metres, z up, nothing rounded."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from stepfield.errors import ScanError
from stepfield.files import Digest, reason, storable
from stepfield.formats import FORMATS
from stepfield.parameters import Parameters, Unit, Up
from stepfield.progress import Progress, part, silent
from stepfield.scan.cleaning import clean
from stepfield.scan.cloud import Axis, Cloud, Reader
from stepfield.scan.scan import Scan, SourceFile, joined

__all__ = ["Axis", "Cloud", "Scan", "SourceFile", "clean", "cleaned", "open_scan", "read_scan"]

#: Metres from the origin beyond which points are damage, whatever unit was forgotten.
FARTHEST = 1e12


def read_scan(
    paths: Sequence[Path], unit: Unit | None = None, up: Up = "z", progress: Progress = silent
) -> Scan:
    """Read one scan from one or more files.

    Parameters
    ----------
    paths : sequence of Path
        Files of any of :data:`FORMATS`, all in the same coordinates.
    unit : str, optional
        Unit of the coordinates; by default what the files declare, else metres.
    up : str
        The files' axis that points up.
    progress : Progress

    Raises
    ------
    ScanError
        In one sentence: which file, what is wrong, what to do.
    """
    if not paths:
        raise ScanError("no scan was named; give at least one file")
    clouds, files = [], []
    for done, path in enumerate(paths):
        progress(done / len(paths), f"reading {path.name}")
        cloud, digest = _read(Path(path), part(progress, done / len(paths), (done + 1) / len(paths)))
        clouds.append(cloud)
        files.append(SourceFile(storable(path.name), len(cloud), digest))
    scan = joined(clouds, files, unit, up)
    warnings = tuple(storable(warning) for warning in scan.warnings)
    return replace(scan, warnings=warnings + _advice(scan, unit))


def open_scan(paths: Sequence[Path], parameters: Parameters, progress: Progress = silent) -> Scan:
    """Read a scan and clean it as the parameters say; raise ScanError when what is left is no scan."""
    unit = None if parameters.unit == "auto" else parameters.unit
    return cleaned(read_scan(paths, unit, parameters.up, progress), parameters, progress)


def cleaned(scan: Scan, parameters: Parameters, progress: Progress = silent) -> Scan:
    """Clean a scan as the parameters say; raise ScanError when what is left is no scan."""
    scan = clean(scan, parameters, progress)
    farthest = float(np.abs(scan.bounds()).max())
    if farthest > FARTHEST:
        where = scan.files[0].name if len(scan.files) == 1 else "the scan"
        raise ScanError(
            f"{where}: has points {farthest:.2g} m away, which is damage; copy the file again, or keep its "
            "true part with --crop"
        )
    return scan


def _read(path: Path, progress: Progress) -> tuple[Cloud, Digest]:
    """Read one file and begin to take its digest."""
    try:
        if not path.is_dir() and path.suffix.lower() not in FORMATS:
            known = " ".join(sorted(FORMATS))
            raise ScanError(f"{path.name}: unknown kind of file; Stepfield reads {known}")
        if not path.is_file():
            raise ScanError(f"{path}: {_no_file(path)}; check the name")
        digest = Digest(path)
        return _reader(path)(path, progress), digest
    except OSError as error:
        raise ScanError(f"{path}: cannot be read ({reason(error)}); check the file") from None
    except MemoryError:
        raise ScanError(f"{path.name}: too large for this machine's memory; crop or split it") from None


def _no_file(path: Path) -> str:
    """Say what there is in place of a file; reading a device or a pipe might never end."""
    if path.is_dir():
        return "is a folder, not a scan"
    return "is a device or a pipe, not a file" if path.exists() else "there is no such file"


def _reader(path: Path) -> Reader:
    module = importlib.import_module(f"stepfield.scan.{FORMATS[path.suffix.lower()]}")
    reader: Reader = module.read
    return reader


def _advice(scan: Scan, unit: Unit | None) -> tuple[str, ...]:
    """Say what the operator may want to confirm, because no file declares it reliably."""
    if scan.organised and scan.up == "z":
        return ("this looks like a depth-camera frame, whose y axis usually points down; try --up=-y",)
    low, high = scan.bounds()
    if unit is None and scan.unit == "m" and max(high - low) > 100_000:
        return ("the scan is over 100 km wide in metres; if its unit is another, say so with --unit",)
    return ()
