"""The ``stepfield`` command: exit codes, signals, and the one place that shows errors."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence
from types import FrameType

from typer import TyperException

from stepfield.errors import Cancelled, ParameterError, StepfieldError

DONE, FAILED, WRONG_USAGE, INTERRUPTED = 0, 1, 2, 130


def main() -> None:
    """Run the command line and leave with its exit code."""
    signal.signal(signal.SIGTERM, _interrupt)
    code = run(sys.argv[1:])
    try:
        sys.stdout.flush()
    except BrokenPipeError:  # the reader of a pipe has left; what it wanted, it got
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
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
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    return _failed("interrupted; nothing was written", code) if code == INTERRUPTED else code


def _failed(sentence: str, code: int) -> int:
    sys.stderr.write(f"error: {sentence}\n")
    return code


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Let SIGTERM unwind like Ctrl+C, so that half-written folders are removed."""
    raise KeyboardInterrupt
