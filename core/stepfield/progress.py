"""Progress and cancellation through one callback."""

from collections.abc import Callable

#: Called between chunks of work with the share done (0 to 1) and what is being done.
#: Raising :class:`stepfield.errors.Cancelled` from it stops the work.
Progress = Callable[[float, str], None]


def silent(share: float, what: str) -> None:
    """Ignore progress: the default of every function that reports it."""


def part(progress: Progress, start: float, stop: float) -> Progress:
    """Map a stage's own 0 to 1 onto ``start`` to ``stop`` of the whole."""

    def report(share: float, what: str) -> None:
        progress(start + (stop - start) * share, what)

    return report
