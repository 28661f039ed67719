"""A picture of the drives: moments of every world, or their paths where nothing can draw those."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from stepfield.simulate.drive import Track
from stepfield.simulate.engine import engine
from stepfield.simulate.ground import topmost
from stepfield.simulate.painter import HEIGHT, WIDTH
from stepfield.simulate.route import SETTLING
from stepfield.simulate.worlds import World
from stepfield.targets.terrain import Terrain

Drives = Sequence[tuple[World, Track]]

#: Moments of a strip.
MOMENTS = 5
#: Seconds after which a driver that draws nothing is given up.
PATIENCE = 120
#: Pixels: above every row of a strip for its name, and the longer side of a plan.
CAPTION, PLAN = 22, 900
_INK, _PAPER = (40, 40, 40), (255, 255, 255)
_PATHS = ((20, 20, 20), (214, 69, 65), (38, 110, 189), (35, 145, 80), (160, 90, 180))


def strip(drives: Drives) -> bytes | None:
    """Return a PNG with a row a world, moments from left to right; None where MuJoCo cannot draw."""
    rows = [_row(world, track) for world, track in drives]
    whole = [row for row in rows if row is not None]
    if len(whole) < len(rows):
        return None
    image = Image.new("RGB", (WIDTH * MOMENTS, (HEIGHT + CAPTION) * len(rows)), _PAPER)
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(13)
    for number, ((world, track), row) in enumerate(zip(drives, whole, strict=True)):
        top = number * (HEIGHT + CAPTION)
        draw.text((8, top + 4), _caption(world, track), _INK, font)
        for moment, picture in enumerate(row):
            image.paste(Image.fromarray(picture), (moment * WIDTH, top + CAPTION))
    return _png(image)


def plan(terrain: Terrain, drives: Drives) -> bytes:
    """Return a PNG of the paths over the topmost layers, north up; lighter is higher."""
    top = topmost(terrain)
    low, span = float(np.nanmin(top)), max(1e-6, float(np.nanmax(top) - np.nanmin(top)))
    shade = np.where(np.isnan(top), 255, 120 + 110 * (top - low) / span).astype(np.uint8)
    scale = PLAN / max(shade.shape)
    size = max(1, round(terrain.columns * scale)), max(1, round(terrain.rows * scale))
    image = Image.new("RGB", (size[0], size[1] + CAPTION * len(drives)), _PAPER)
    image.paste(Image.fromarray(shade).resize(size, Image.Resampling.NEAREST), (0, 0))
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(13)
    for number, (world, track) in enumerate(drives):
        colour = _PATHS[number % len(_PATHS)]
        x = ((track.positions[:, 0] - terrain.west) / terrain.cell_size + 0.5) * scale
        y = ((terrain.north - track.positions[:, 1]) / terrain.cell_size + 0.5) * scale
        draw.line(np.column_stack([x, y]).ravel().tolist(), colour, 2)
        draw.text((8, size[1] + number * CAPTION + 4), _caption(world, track), colour, font)
    return _png(image)


def _row(world: World, track: Track) -> NDArray[np.uint8] | None:
    """Draw a drive's moments, shape (MOMENTS, HEIGHT, WIDTH, 3), by a process of its own."""
    first = int(np.searchsorted(track.times, SETTLING)) if track.times[-1] > SETTLING else 0
    states = track.states[np.linspace(first, len(track.states) - 1, MOMENTS).round().astype(int)]
    with tempfile.TemporaryDirectory(prefix="stepfield-") as made:
        model, moments, out = (str(Path(made) / name) for name in ("model.mjb", "states.npy", "pictures.npy"))
        engine().mj_saveModel(world.model, model)
        np.save(moments, states)
        command = [sys.executable, "-m", "stepfield.simulate.painter", model, moments, out]
        try:
            subprocess.run(command, env=_environment(), check=True, capture_output=True, timeout=PATIENCE)
            pictures: NDArray[np.uint8] = np.load(out)
        except (OSError, subprocess.SubprocessError, ValueError):
            return None
    return pictures if pictures.any() else None


def _environment() -> dict[str, str]:
    """Draw without a screen on Linux, unless the operator has chosen."""
    headless = {"MUJOCO_GL": "egl"} if sys.platform == "linux" else {}
    return headless | os.environ


def _caption(world: World, track: Track) -> str:
    return f"{world.name}: {track.times[-1]:.1f} s" + (", fell out of the world" if track.fell else "")


def _png(image: Image.Image) -> bytes:
    stream = BytesIO()
    image.save(stream, format="PNG")
    return stream.getvalue()
