"""Heaps of debris and the ground they lie on.

The heaps are part of the ground's one surface, and lumps end where they touch it, so that no point is
drawn where neither a scanner nor a robot could ever be.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stepfield.synth.geometry import Floats
from stepfield.synth.pieces import chunks
from stepfield.synth.scene import Surface


@dataclass(frozen=True)
class Mound:
    """A heap of debris: middle, height and radius (metres), lumps lying on it."""

    x: float
    y: float
    height: float
    radius: float
    lumps: int


MOUNDS = (
    Mound(10.5, -1.2, 1.5, 3.6, 60),
    Mound(3.0, -0.6, 0.7, 2.2, 25),
    Mound(17.0, -1.3, 1.2, 3.0, 40),
    Mound(21.4, 6.5, 1.0, 2.6, 35),
    Mound(11.0, 16.6, 1.4, 3.4, 55),
    Mound(18.0, 16.0, 0.8, 2.4, 25),
    Mound(6.8, 6.4, 0.8, 1.8, 30),
    Mound(14.2, 6.9, 1.3, 2.0, 40),
    Mound(14.0, 13.0, 0.7, 1.6, 20),
    Mound(-1.4, 9.0, 0.6, 1.8, 20),
)


class Ground:
    """Street and ground floor with heaps of debris, each a little elsewhere with every generator."""

    def __init__(self, rng: np.random.Generator) -> None:
        moved = rng.uniform(-0.4, 0.4, (len(MOUNDS), 2))
        self.mounds = [
            Mound(m.x + dx, m.y + dy, m.height, m.radius, m.lumps)
            for m, (dx, dy) in zip(MOUNDS, moved.tolist(), strict=True)
        ]
        self._waves = rng.normal(0, 1, (24, 2)) * np.geomspace(0.8, 9, 24)[:, None]
        self._phases = rng.uniform(0, 2 * np.pi, 24)

    def height(self, x: Floats, y: Floats) -> Floats:
        """Elevations at x and y, metres."""
        rough = self._rough(x, y)
        height = 0.012 * rough
        for mound in self.mounds:
            away = np.hypot(x - mound.x, y - mound.y) / mound.radius * (1 + 0.12 * rough)
            height = height + mound.height * np.clip(1 - away, 0, 1) ** 1.2 * (1 + 0.16 * rough)
        result: Floats = height
        return result

    def _rough(self, x: Floats, y: Floats) -> Floats:
        """Waves of every length and direction, about normal at every place."""
        rough = np.zeros_like(x)
        for (kx, ky), phase in zip(self._waves, self._phases, strict=True):
            rough += np.sin(kx * x + ky * y + phase)
        rough /= np.sqrt(len(self._waves) / 2)
        return rough


def debris(ground: Ground, rng: np.random.Generator) -> list[Surface]:
    """Lumps on every heap, small ones in between."""
    surfaces = []
    for number, mound in enumerate(ground.mounds, 1):
        away = mound.radius * 1.15 * np.sqrt(rng.random(mound.lumps))
        angle = rng.uniform(0, 2 * np.pi, mound.lumps)
        x, y = mound.x + away * np.cos(angle), mound.y + away * np.sin(angle)
        size = np.clip(rng.lognormal(-0.75, 0.45, mound.lumps), 0.2, 1.3)
        centres = np.column_stack([x, y, ground.height(x, y) + 0.12 * size])
        surfaces.append(Surface(f"debris {number}", chunks(centres, size, ground.height, rng)))
    x, y = rng.uniform(-2.5, 22.5, 150), rng.uniform(-3, 18, 150)
    size = rng.uniform(0.12, 0.4, 150)
    scattered = np.column_stack([x, y, ground.height(x, y) + 0.1 * size])
    return [*surfaces, Surface("scattered debris", chunks(scattered, size, ground.height, rng))]
