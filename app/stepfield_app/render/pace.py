"""How much detail a moving picture can afford, learned from how long the last ones took."""

from __future__ import annotations

from dataclasses import dataclass

#: Points, and by how much the picture is smaller, from the fastest on.
STEPS = (
    (25_000, 3),
    (50_000, 2),
    (50_000, 1),
    (100_000, 1),
    (150_000, 1),
    (250_000, 1),
    (400_000, 1),
    (700_000, 1),
    (1_200_000, 1),
    (2_000_000, 1),
)
FIRST = STEPS.index((150_000, 1))
MOST_POINTS = STEPS[-1][0]
#: A triangle takes about as long as this many points, without a graphics card.
POINTS_PER_TRIANGLE = 3
#: Seconds for a picture, and the shares of it beyond which the next one differs.
TARGET, SLOW, QUICK = 0.09, 1.25, 0.6


@dataclass(frozen=True)
class Pace:
    """Detail of the next moving picture.

    Attributes
    ----------
    step : int
        Row of STEPS.
    """

    step: int = FIRST

    @property
    def points(self) -> int:
        """Most points to draw."""
        return STEPS[self.step][0]

    @property
    def triangles(self) -> int:
        """Most triangles to draw, where there is a choice."""
        return self.points // POINTS_PER_TRIANGLE

    @property
    def scale(self) -> int:
        """By how much the picture is smaller than asked for."""
        return STEPS[self.step][1]

    def after(self, seconds: float, limited: bool) -> Pace:
        """Pace after a picture that took some time; ``limited`` if more detail could have been drawn."""
        if seconds > TARGET * SLOW:
            return Pace(max(self.step - (2 if seconds > 3 * TARGET else 1), 0))
        if seconds < TARGET * QUICK and limited:
            return Pace(min(self.step + 1, len(STEPS) - 1))
        return self
