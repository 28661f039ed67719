"""The house stays as it is drawn: what the core loads, and where packages may begin."""

import subprocess
import sys

import pytest
from tests.conftest import REPOSITORY

HEAVY = {
    "open3d",
    "PySide6",
    "scipy",
    "laspy",
    "pye57",
    "rasterio",
    "trimesh",
    "numba",
    "matplotlib",
    "pyarrow",
}


def loaded_by(statement: str) -> set[str]:
    """Top-level modules a fresh interpreter holds after a statement."""
    probe = f"{statement}\nimport sys\nprint(' '.join({{name.partition('.')[0] for name in sys.modules}}))"
    done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


@pytest.mark.parametrize(
    "statement",
    ["import stepfield", "import stepfield.cli.commands", "import stepfield.pipeline, stepfield.stack"],
)
def test_nothing_heavy_is_loaded_before_it_is_needed(statement: str) -> None:
    assert not loaded_by(statement) & HEAVY


def test_help_needs_not_even_numpy() -> None:
    assert "numpy" not in loaded_by("import stepfield.cli.commands")


@pytest.mark.parametrize(
    "statement",
    ["import stepfield_app.application", "import stepfield_app.feeds.drawing, stepfield_app.export"],
)
def test_the_window_never_loads_open3d(statement: str) -> None:
    """It takes seconds and may take the window down: it lives in a process of its own."""
    assert not loaded_by(statement) & {"open3d", "matplotlib", "numba"}


def test_the_core_knows_no_window() -> None:
    everything = (
        "import stepfield.cli.commands, stepfield.pipeline, stepfield.stack, stepfield.synth, stepfield.scan"
    )
    assert not loaded_by(everything) & {"PySide6", "pyqtgraph", "stepfield_app", "stepfield_resources"}


def test_scenes_and_the_drawing_process_need_no_qt() -> None:
    scenes = [
        path.stem for path in (REPOSITORY / "app/stepfield_app/scenes").glob("*.py") if path.stem[0] != "_"
    ]
    names = [f"stepfield_app.scenes.{name}" for name in scenes]
    assert len(names) > 10
    statement = f"import {', '.join([*names, 'stepfield_app.requests', 'stepfield_app.render.server'])}"
    assert "PySide6" not in loaded_by(statement)


@pytest.mark.parametrize("root", ["core", "app", "resources"])
def test_source_roots_are_no_packages(root: str) -> None:
    """With an __init__.py there, every class would exist twice under two names."""
    assert not (REPOSITORY / root / "__init__.py").exists()
