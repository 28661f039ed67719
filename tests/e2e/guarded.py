"""Run the command for many files at once, each in a process of its own with bounded memory and time.

As a program it reads jobs as JSON from its standard input. It loads the libraries once and forks for each
job: a crash, a hang or a hunger for memory then ends that job alone and is told by its outcome.
"""

from __future__ import annotations

import importlib
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from dataclasses import asdict, dataclass
from pathlib import Path

SECONDS, BYTES = 20, 2 << 30
#: What most jobs load: loaded before the fork it costs once what it would cost every one of them.
LIBRARIES = (
    "stepfield.cli.build",
    "stepfield.cli.commands",
    "stepfield.stack",
    "scipy.sparse.csgraph",
    "PIL.PngImagePlugin",
    "rasterio",
    "pye57",
)
#: One thread each: the pools of threads that numerical libraries keep do not survive a fork.
_ALONE = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


@dataclass(frozen=True)
class Outcome:
    """What came of a job: exit code (minus the signal that killed it), peak memory, and what it said."""

    code: int
    peak: int
    seconds: float
    stdout: str
    stderr: str


def run_all(jobs: dict[str, list[str]], workers: int = 2) -> dict[str, Outcome]:
    """Run jobs, each the arguments of the command or ``read FILE``, and return their outcomes by name."""
    names = list(jobs)
    shares = [{name: jobs[name] for name in names[start::workers]} for start in range(workers)]
    running = [
        subprocess.Popen(
            [sys.executable, __file__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=os.environ | _ALONE,
        )
        for _ in shares
    ]
    for process, share in zip(running, shares, strict=True):
        assert process.stdin is not None
        process.stdin.write(json.dumps(share))
        process.stdin.close()
        process.stdin = None
    outcomes: dict[str, Outcome] = {}
    for process in running:
        told, _ = process.communicate(timeout=SECONDS * len(jobs))
        assert process.returncode == 0, "the process that starts the jobs failed itself"
        outcomes |= {name: Outcome(**parts) for name, parts in json.loads(told).items()}
    return outcomes


def _forked(arguments: list[str], folder: Path) -> Outcome:
    """Run one job in a fork and wait for it."""
    out, err = folder / "out", folder / "err"
    began = time.monotonic()
    child = os.fork()
    if child == 0:
        _be_child(arguments, out, err)
    _, status, used = os.wait4(child, 0)
    return Outcome(
        os.waitstatus_to_exitcode(status),
        used.ru_maxrss * 1024,
        time.monotonic() - began,
        out.read_text(errors="replace"),
        err.read_text(errors="replace"),
    )


def _be_child(arguments: list[str], out: Path, err: Path) -> None:
    """Run a job in this process and end it, whatever happens."""
    for number, path in ((1, out), (2, err)):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
    code = 70
    try:
        resource.setrlimit(resource.RLIMIT_DATA, (BYTES, BYTES))
        signal.alarm(SECONDS)  # ends the process, whatever code it is in
        warnings.simplefilter("error")
        code = _read(arguments[1]) if arguments[0] == "read" else _command(arguments)
    except BaseException:  # noqa: BLE001  # a panic of native code is no Exception, and this must not return
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def _read(path: str) -> int:
    from stepfield.errors import ScanError
    from stepfield.scan import read_scan

    try:
        sys.stdout.write(f"{len(read_scan([Path(path)]))}\n")
    except ScanError as error:
        sys.stderr.write(f"error: {error}\n")
        return 1
    return 0


def _command(arguments: list[str]) -> int:
    from stepfield.cli import main

    sys.argv = ["stepfield", *arguments]
    try:
        main()
    except SystemExit as left:
        return int(left.code or 0)
    return 0


def _main() -> None:
    for name in LIBRARIES:
        importlib.import_module(name)
    jobs = json.load(sys.stdin)
    with tempfile.TemporaryDirectory() as folder:
        outcomes = {name: asdict(_forked(arguments, Path(folder))) for name, arguments in jobs.items()}
    sys.stdout.write(json.dumps(outcomes))


if __name__ == "__main__":
    _main()
