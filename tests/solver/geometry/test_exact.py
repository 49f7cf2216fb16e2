"""Signs of areas are exact, and positions in cells forget units and the origin."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import SceneError, rectangle
from solver.geometry import Lattice
from solver.geometry.exact import CELL, Frame, side, sign_of_cross
from tests.solver.bodies import exact

large = st.integers(-(2**49), 2**49)


@exact
@given(large, large, large, large, st.integers(-2, 2), st.integers(1, 7))
def test_signs_are_those_of_integers(ax, ay, bx, by, off, share):
    def sign(a, b, c, d):
        whole = a * d - b * c
        return (whole > 0) - (whole < 0)

    assert sign_of_cross(*map(float, (ax, ay, bx, by))) == sign(ax, ay, bx, by)
    # Nearly parallel: what is left of the products is far below their rounding.
    cx, cy = ax // share + off, ay // share
    assert sign_of_cross(*map(float, (ax, ay, cx, cy))) == sign(ax, ay, cx, cy)


def test_sides():
    assert side(0.0, 0.0, 2.0, 0.0, 1.0, 1.0) == 1
    assert side(0.0, 0.0, 2.0, 0.0, 1.0, -1.0) == -1
    assert side(0.0, 0.0, 2.0, 2.0, 5.0, 5.0) == 0


@pytest.mark.parametrize("spacing", [1e-9, 0.1, 1e3])
@pytest.mark.parametrize("away", [0, 30_000_000])
def test_particles_are_whole_cells_wherever_the_body_is(spacing, away):
    at = away * spacing
    lattice = Lattice(rectangle(6 * spacing, 4 * spacing, (at, at)), spacing, 2)
    rows, columns = lattice.rows_columns
    frame = Frame.of(lattice)
    units = frame.units(lattice.points)
    np.testing.assert_array_equal(units, CELL * np.column_stack([columns, rows]))
    np.testing.assert_allclose(
        frame.metres(units), lattice.points, rtol=1e-12, atol=1e-12 * spacing
    )


def test_points_beyond_all_measure_are_refused():
    frame = Frame(np.zeros(2), 1e-9)
    with pytest.raises(SceneError, match="half a billion cells"):
        frame.units(np.array([[1.0, 0.0]]))
