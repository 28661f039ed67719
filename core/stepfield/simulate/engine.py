"""MuJoCo, which comes with the extra ``simulate``; only here is it imported."""

from __future__ import annotations

import importlib
from typing import Any

from stepfield.errors import SimulationError
from stepfield.files import one_line


def engine() -> Any:
    """Return the module ``mujoco``, or raise SimulationError in one sentence."""
    try:
        return importlib.import_module("mujoco")
    except ImportError:
        sentence = "simulate needs MuJoCo; install it with: pip install 'stepfield[simulate]'"
        raise SimulationError(sentence) from None
    except Exception as error:  # noqa: BLE001  it looks for what MUJOCO_GL names, and raises whatever that does
        sentence = f"MuJoCo does not start ({one_line(str(error))[:150]}); try without MUJOCO_GL"
        raise SimulationError(sentence) from None


def viewer() -> Any:
    """Return the module of MuJoCo's own window, which needs a screen."""
    engine()
    return importlib.import_module("mujoco.viewer")
