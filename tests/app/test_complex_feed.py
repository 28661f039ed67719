"""Complex parts in the window: meshed at rest where wanted, drawn in their place, dropped when outdated."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from pytestqt.qtbot import QtBot
from tests.app.stubs import Bench

from stepfield.complex_parts import ComplexParts
from stepfield.errors import StepfieldError
from stepfield.progress import Progress
from stepfield.reconstruction import Reconstruction
from stepfield.surface import Mesh
from stepfield_app.feeds import complex_feed
from stepfield_app.feeds.complex_feed import ComplexFeed
from stepfield_app.feeds.plots import MapWish, map_picture
from stepfield_app.render.scene import PILLARS, RECONSTRUCTION
from stepfield_app.scenes.palette import layer_colours
from stepfield_app.theme import COMPLEX_COLOUR, rgb
from stepfield_app.views.map import MapView
from stepfield_app.views.marks import Marks

#: Stands in for what Open3D makes: far from zero, as scans are.
CORNER = np.array([5000.0, 7000.0, 50.0])
TRIANGLE = Mesh(np.array([[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 1.0, 6.0]]) + CORNER, np.array([[0, 1, 2]]))


def ground() -> NDArray[np.float64]:
    """Return level ground of 8 by 6 compartments."""
    x, y = (grid.ravel() for grid in np.meshgrid(np.arange(8) + 0.5, np.arange(6) + 0.5))
    corners = [[0.0, 0.0, 0.0], [8.0, 6.0, 0.0]]
    points: NDArray[np.float64] = np.vstack([np.column_stack([x, y, 0 * x]), corners]) + CORNER
    return points


def made(result: Reconstruction, progress: Progress) -> ComplexParts:
    """Mesh the first three pillars."""
    replaced = np.arange(len(result.field)) < 3
    return ComplexParts(replaced, replaced, TRIANGLE)


class Meshing(Bench):
    """A bench with a map and what meshes complex parts."""

    def __init__(self, qtbot: QtBot) -> None:
        super().__init__(qtbot)
        self.map, self.marks = MapView(), Marks(lambda _: (COMPLEX_COLOUR,))
        qtbot.addWidget(self.map)
        self.map.picture_wanted.connect(self.draw_map)
        self.feed = ComplexFeed(self.document, self.scene_feed, self.map, self.marks)
        self.told: list[str] = []
        self.errors: list[object] = []
        self.feed.told.connect(self.told.append)
        self.feed.failed.connect(self.errors.append)

    def draw_map(self, layer: int, mode: str) -> None:
        """Show a map at once."""
        answer = self.document.answer
        assert answer is not None
        wish = MapWish(answer, layer, mode, layer_colours(len(answer.result.layers)))
        self.map.set_picture(map_picture(wish, lambda share, what: None))

    def rest(self) -> None:
        """Wait until all that is wanted is shown."""
        self.qtbot.waitUntil(lambda: self.feed.is_idle and self.scene_feed.is_idle)

    def change(self, **parameters: object) -> None:
        """Choose other parameters."""
        self.document.set_parameters("Try other parameters", **parameters)
        self.settle()
        self.rest()

    def drawn(self, view: str) -> set[tuple[int, int, int]]:
        """Colours in which the triangles of a view are drawn, about."""
        meshes = self.client.scenes[view].meshes
        return {tuple(colour) for colour in meshes[0].colours.tolist()} if meshes else set()

    def close(self) -> None:
        """End every worker."""
        self.feed.close()
        super().close()


@pytest.fixture
def bench(qtbot: QtBot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Meshing]:
    monkeypatch.setattr(complex_feed, "build_complex_parts", made)
    monkeypatch.setattr(complex_feed, "QUIET", 0)
    bench = Meshing(qtbot)
    path = tmp_path / "ground.npy"
    np.save(path, ground())
    bench.open(path, cell_size=1.0, layer_tolerance=1.0, alpha=0.5, complex_parts="mesh")
    bench.scene_feed.set_visible((0,))
    bench.map.ask()
    bench.rest()
    yield bench
    bench.close()


def is_complex(colours: set[tuple[int, int, int]]) -> bool:
    """Whether any is a shade of the colour of complex parts."""
    red, green, blue = rgb(COMPLEX_COLOUR)
    return any(
        abs(r * green - red * g) < 6 * green and b * green < 2 * blue * g + green for r, g, b in colours
    )


def test_the_mesh_is_drawn_in_place_of_its_pillars(bench: Meshing) -> None:
    scene = bench.client.scenes[RECONSTRUCTION]
    assert is_complex(bench.drawn(RECONSTRUCTION))
    assert scene.meshes[0].vertices[:, 2].max() == pytest.approx(6.0)  # in local coordinates
    assert not is_complex(bench.drawn(PILLARS))  # which show what the method made
    legend = bench.trio.canvases[RECONSTRUCTION]._legend
    assert legend is not None
    assert legend.entries[0] == (rgb(COMPLEX_COLOUR), "Complex: 3 pillars")


def test_it_says_what_it_meshed_and_marks_it(bench: Meshing) -> None:
    assert bench.told == ["1 triangle in place of 3 complex pillars"]
    assert bench.marks.cells is not None
    assert len(bench.marks.cells.kind) == 3
    assert "lime: meshed" in bench.map.plot._legend.note


def test_off_draws_none(bench: Meshing) -> None:
    bench.change(complex_parts="off")
    assert not is_complex(bench.drawn(RECONSTRUCTION))
    assert bench.marks.cells is None
    bench.change(complex_parts="mesh")
    assert is_complex(bench.drawn(RECONSTRUCTION))


def test_what_changes_nothing_about_it_meshes_nothing_anew(bench: Meshing) -> None:
    """It takes seconds, and a slider for alpha would make it blink."""
    bench.change(alpha=0.7)
    assert len(bench.told) == 1
    assert is_complex(bench.drawn(RECONSTRUCTION))


def test_another_cell_size_meshes_anew(bench: Meshing) -> None:
    bench.change(cell_size=2.0)
    assert len(bench.told) == 2


def test_a_failure_is_told_and_the_rest_stays(bench: Meshing, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(result: Reconstruction, progress: Progress) -> ComplexParts:
        raise StepfieldError("the complex parts cannot be meshed: no memory")

    monkeypatch.setattr(complex_feed, "build_complex_parts", fail)
    bench.change(cell_size=2.0)
    assert [str(error) for error in bench.errors] == ["the complex parts cannot be meshed: no memory"]
    assert not is_complex(bench.drawn(RECONSTRUCTION))
