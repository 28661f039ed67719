"""The ``stepfield`` command: exit codes, signals, and the one place that shows errors."""

from __future__ import annotations

import contextlib
import io
import os
import signal
import sys
from collections.abc import Sequence
from types import FrameType

from typer import TyperException

from stepfield.errors import Cancelled, ParameterError, StepfieldError
from stepfield.files import one_line, reason

DONE, FAILED, WRONG_USAGE, INTERRUPTED = 0, 1, 2, 130


def main() -> None:
    """Run the command line and leave with its exit code."""
    signal.signal(signal.SIGTERM, _interrupt)
    # Looking for plug-ins in all that is installed takes time, and none may change what a file means.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    _open_closed_streams()
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # names of files need not be text
    code = run(sys.argv[1:])
    try:
        sys.stdout.flush()
    except OSError as error:
        code = _unshown(error) or code
    sys.exit(code)


def run(arguments: Sequence[str]) -> int:
    """Run one command and return its exit code; a failure is one line on stderr."""
    try:
        from stepfield.cli.commands import application

        code = application(args=list(arguments), prog_name="stepfield", standalone_mode=False) or DONE
    except (KeyboardInterrupt, Cancelled):
        code = INTERRUPTED
    except TyperException as error:
        message = error.format_message()  # empty when the help has been shown instead
        return (
            _failed(f"{message} (stepfield --help lists what there is)", WRONG_USAGE)
            if message
            else WRONG_USAGE
        )
    except StepfieldError as error:
        if "--debug" in arguments:
            raise
        return _failed(str(error), WRONG_USAGE if isinstance(error, ParameterError) else FAILED)
    except OSError as error:
        if "--debug" in arguments:
            raise
        if error.filename is None:
            return _unshown(error)
        return _failed(f"{error.filename}: cannot be used ({reason(error)}); choose another", FAILED)
    return _failed("interrupted; nothing was written", code) if code == INTERRUPTED else code


def _open_closed_streams() -> None:
    """Send what goes to a closed stream nowhere: else the next file opened would receive it."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number, which is this one
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, "w" if number else "r", closefd=False))


def _unshown(error: OSError) -> int:
    """Give up on stdout; a pipe whose reader has left got what it wanted, anything else is a failure."""
    with contextlib.suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # for what is still to be flushed on leaving
    if isinstance(error, BrokenPipeError):
        return DONE
    return _failed(f"the result cannot be shown ({reason(error)}); send it to another place", FAILED)


def _failed(sentence: str, code: int) -> int:
    with contextlib.suppress(OSError):
        sys.stderr.write(f"error: {one_line(sentence)}\n")
    return code


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Let SIGTERM unwind like Ctrl+C, so that half-written folders are removed."""
    raise KeyboardInterrupt
