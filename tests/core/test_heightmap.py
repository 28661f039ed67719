"""Height-maps (5.2): Eq. 2 to the letter at 8 bits, half a level at both, holes apart from low ground."""

from typing import Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepfield.grid import Grid
from stepfield.heightmap import Frame, GrayScale, draw


def test_eight_bits_follow_equation_two() -> None:
    scale = GrayScale(4.0, 8)
    assert scale.encode(np.array([0.0, 1.0, 1.0156, 2.0, 3.999, 4.0])).tolist() == [0, 64, 64, 128, 255, 255]


@given(st.floats(1e-6, 1e5), st.lists(st.floats(0, 1), min_size=1, max_size=50), st.sampled_from([8, 16]))
def test_decoding_returns_the_height_within_half_a_level(
    white: float, shares: list[float], bits: Literal[8, 16]
) -> None:
    heights = np.array(shares) * white
    scale = GrayScale(white, bits)
    error = np.abs(scale.decode(scale.encode(heights)) - heights)
    assert error.max() <= scale.step / 2 * (1 + 1e-9)


def test_padding_centres_the_map_and_the_odd_pixel_goes_right_and_below() -> None:
    assert Frame.around(Grid(0, 0, 1, 5, 64), "pow2") == Frame(8, 64, 1, 0)
    assert Frame.around(Grid(0, 0, 1, 1, 65), "pow2") == Frame(1, 128, 0, 31)
    assert Frame.around(Grid(0, 0, 1, 5, 7), "none") == Frame(5, 7, 0, 0)


def test_an_occupied_pixel_is_never_zero_and_a_hole_always_is() -> None:
    grid = Grid(0, 0, 1.0, 3, 1)
    image = draw(
        grid, Frame.around(grid, "pow2"), np.array([0, 2]), np.array([0.001, 100.0]), GrayScale(100.0, 8)
    )
    assert image.gray.tolist() == [[1, 0, 255, 0]]
    assert image.mask.tolist() == [[True, False, True, False]]
    assert image.lifted == 1


@pytest.mark.parametrize("bits", [8, 16])
def test_north_is_the_top_of_the_image(bits: Literal[8, 16]) -> None:
    grid = Grid(0, 0, 1.0, 1, 2)
    north = grid.compartment(np.array([0.5]), np.array([1.5]))
    image = draw(grid, Frame.around(grid, "none"), north, np.array([1.0]), GrayScale(1.0, bits))
    assert image.mask.tolist() == [[True], [False]]
