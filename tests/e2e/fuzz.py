"""Damage real scans at random, always the same way for a seed, and read what is left of them.

Run as a program, ``fuzz.py SCAN FIRST COUNT FOLDER``, so that a crash or a hang of native code ends this
process and not the tests: it prints each seed before it tries it, and last of all one line of figures.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

#: What one file may take, and what the whole process may hold, most of it the libraries themselves.
SECONDS, BYTES = 20, 2 << 30
#: Bytes at either end that are called the header: LAZ, COPC, E57 and NPZ keep half of theirs at the end.
HEADER, TAIL = 1024, 2048
_EXTREMES = (0, 1, 0x7F, 0x80, 0xFF)
_PAGE = 1024

Random = np.random.Generator


def _cut(content: bytearray, rng: Random) -> None:
    """Leave off the end: half of the time anywhere, else near the beginning."""
    most = len(content) if rng.random() < 0.5 else min(len(content), 4 * HEADER)
    del content[int(rng.integers(0, most)) :]


def _flip(content: bytearray, rng: Random, start: int, stop: int) -> None:
    for at in rng.integers(start, stop, rng.integers(1, 9)):
        content[at] ^= int(rng.integers(1, 256))


def _flip_header(content: bytearray, rng: Random) -> None:
    _flip(content, rng, 0, min(HEADER, len(content)))


def _flip_tail(content: bytearray, rng: Random) -> None:
    _flip(content, rng, max(0, len(content) - TAIL), len(content))


def _flip_data(content: bytearray, rng: Random) -> None:
    _flip(content, rng, 0, len(content))


def _lie(content: bytearray, rng: Random) -> None:
    """Overwrite a few bytes of the header with the values that counts and sizes overflow at."""
    at = int(rng.integers(0, min(HEADER, len(content))))
    value = _EXTREMES[rng.integers(len(_EXTREMES))]
    width = int(rng.choice([1, 2, 4, 8]))
    content[at : at + width] = bytes([value]) * len(content[at : at + width])


def _change_digit(content: bytearray, rng: Random) -> None:
    """Change some digits, which makes other numbers of text and other bytes of anything else."""
    head = np.frombuffer(bytes(content[: 4 * HEADER]), np.uint8)
    digits = np.flatnonzero((head >= ord("0")) & (head <= ord("9")))
    for at in rng.choice(digits, min(len(digits), 3)) if len(digits) else ():
        content[int(at)] = int(rng.integers(ord("0"), ord("9") + 1))


def _lose(content: bytearray, rng: Random) -> None:
    """Take a stretch out, as a broken download does."""
    at = int(rng.integers(0, len(content)))
    del content[at : at + int(rng.integers(1, 5000))]


def _repeat(content: bytearray, rng: Random) -> None:
    """Put a stretch in twice."""
    at = int(rng.integers(0, len(content)))
    content[at:at] = content[at : at + int(rng.integers(1, 5000))]


DAMAGE: tuple[Callable[[bytearray, Random], None], ...] = (
    *(_cut, _flip_header, _lie, _flip_data, _flip_tail),
    *(_change_digit, _lie, _lose, _flip_header, _repeat),
)


def damaged(content: bytes, seed: int, suffix: str) -> bytes:
    """Return the content with the damage that a seed stands for."""
    rng = np.random.default_rng(seed)
    broken = bytearray(content)
    DAMAGE[seed % len(DAMAGE)](broken, rng)
    if suffix == ".e57" and len(broken) == len(content):
        _sign(broken, content)
    return bytes(broken)


def _sign(broken: bytearray, content: bytes) -> None:
    """Put right the checksums of the E57 pages that differ: else nothing gets behind the first look."""
    for at in range(0, len(broken) - _PAGE + 1, _PAGE):
        if broken[at : at + _PAGE] != content[at : at + _PAGE]:
            broken[at + _PAGE - 4 : at + _PAGE] = checksum(broken[at : at + _PAGE - 4]).to_bytes(4, "big")


def checksum(data: bytearray) -> int:
    """Return the CRC-32C of some bytes."""
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def judge(path: Path) -> tuple[str, str]:
    """Read a file and return what came of it: ``read``, ``refused`` or ``fault``, and the words."""
    from stepfield.errors import ScanError
    from stepfield.scan import read_scan

    try:
        scan = read_scan([path])
    except ScanError as error:
        return _judged_sentence(str(error), path)
    except BaseException as error:  # noqa: BLE001  # the very thing looked for; panics of native code are no Exception
        return "fault", f"{type(error).__name__}: {error}"
    if not len(scan) or {len(axis) for axis in scan.axes} != {len(scan)}:
        return "fault", "a scan without points, or with columns of different lengths"
    if not np.isfinite(scan.bounds()).all():
        return "fault", "coordinates that are not finite"
    if any("\n" in warning for warning in scan.warnings):
        return "fault", f"a warning of several lines: {scan.warnings}"
    return "read", ""


def _judged_sentence(sentence: str, path: Path) -> tuple[str, str]:
    if "\n" in sentence or "\r" in sentence or not sentence.isprintable():
        return "fault", f"not one printable line: {sentence!r}"
    if path.name not in sentence or "; " not in sentence:
        return "fault", f"does not say where or what to do: {sentence}"
    if "memory" in sentence:
        return "fault", f"memory without bound: {sentence}"
    return "refused", sentence


def main() -> None:
    """Try the seeds in turn, and say how many were read, refused and at fault."""
    scan, first, count, folder = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), Path(sys.argv[4])
    resource.setrlimit(resource.RLIMIT_DATA, (BYTES, BYTES))
    warnings.simplefilter("error")
    content = scan.read_bytes()
    figures: dict[str, int] = {"read": 0, "refused": 0, "fault": 0}
    faults = []
    path = folder / f"damaged{''.join(scan.suffixes[-2:]) if '.copc' in scan.suffixes else scan.suffix}"
    for seed in range(first, first + count):
        sys.stdout.write(f"{seed}\n")
        sys.stdout.flush()
        path.write_bytes(damaged(content, seed, scan.suffix))
        signal.alarm(SECONDS)  # ends the process, whatever code it is in
        kind, words = judge(path)
        signal.alarm(0)
        figures[kind] += 1
        if kind == "fault":
            faults.append(f"seed {seed}: {words}")
    peak = most_memory()
    sys.stdout.write(json.dumps({"figures": figures, "faults": faults, "peak": peak}) + "\n")
    sys.stdout.flush()
    os._exit(0)  # not waiting for anything a damaged file may have left behind


def most_memory() -> int:
    """Most bytes this process has held; what getrusage says counts what it was forked from."""
    status = Path("/proc/self/status").read_text()
    return int(status.split("VmHWM:")[1].split()[0]) * 1024


if __name__ == "__main__":
    main()
