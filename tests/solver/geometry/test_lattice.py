"""The lattice: centres at half-integer multiples of the spacing, in a padded array."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from solver import SceneError, disc, rectangle
from solver.geometry import Lattice
from tests.solver.bodies import Cells, exact, masks


@exact
@given(st.floats(0.3, 3.0), st.floats(0.2, 2.0), st.floats(-2, 2), st.floats(0.03, 0.3))
def test_every_centre_in_the_region_and_no_other(width, height, shift, spacing):
    region = rectangle(width, height, centre=(shift, -0.3 * shift), angle=0.4)
    assume(min(width, height) > 3 * spacing)
    points = Lattice(region, spacing, 4).points
    cells = points / spacing - 0.5
    np.testing.assert_allclose(cells, np.round(cells), atol=1e-9)
    reach = int(6 / spacing)
    i = np.arange(-reach, reach) + 0.5
    x, y = np.meshgrid(i * spacing, i * spacing)
    assert region.contains(x, y).sum() == len(points)


@exact
@given(masks(), st.integers(1, 4), st.sampled_from([1.0, 0.1]))
def test_grid_and_particles(mask, pad, spacing):
    lattice = Lattice(Cells(mask, spacing), spacing, pad)
    assert lattice.count == mask.sum()
    rows, columns = mask.shape
    # Rounding of the bounds may add an empty row or column (6 × 0.1 > 0.6), never lose one.
    for have, need in zip(lattice.shape, mask.shape, strict=True):
        assert need + 2 * pad <= have <= need + 2 * pad + 1
    np.testing.assert_array_equal(lattice.mask[pad : pad + rows, pad : pad + columns], mask)
    assert lattice.mask.sum() == mask.sum()
    values = np.arange(1.0, 2 * lattice.count + 1).reshape(2, -1)
    grid = lattice.to_grid(values)
    rows, columns = lattice.rows_columns
    np.testing.assert_array_equal(grid[:, rows, columns], values)
    assert grid.sum() == values.sum()
    number = lattice.number()
    np.testing.assert_array_equal(number[rows, columns], np.arange(lattice.count))
    assert (number == -1).sum() == number.size - lattice.count
    x, y = lattice.axes
    np.testing.assert_allclose(lattice.points, np.column_stack([x[columns], y[rows]]))


def test_particles_run_along_rows():
    points = Lattice(rectangle(3, 2, centre=(1.5, 1.0)), 1.0, 1).points
    order = np.lexsort((points[:, 0], points[:, 1]))
    np.testing.assert_array_equal(order, np.arange(6))


def test_edge_distance_is_the_region_s():
    lattice = Lattice(rectangle(1.0, 1.0), 0.1, 2)
    assert lattice.edge_distance.min() == pytest.approx(0.05)
    assert lattice.edge_distance.max() == pytest.approx(0.45)


@pytest.mark.parametrize("spacing", [0.0, -0.1, np.nan, np.inf])
def test_bad_spacing(spacing):
    with pytest.raises(SceneError, match="spacing must be positive"):
        Lattice(disc(1.0), spacing, 2)


def test_a_region_without_particles():
    with pytest.raises(SceneError, match="no particle"):
        Lattice(rectangle(0.01, 1.0, centre=(0.005, 0.0)), 0.1, 2)
    with pytest.raises(SceneError, match="no particle"):
        Lattice(disc(0.5) - disc(1.0), 0.1, 2)


def test_a_grid_that_nobody_meant():
    with pytest.raises(SceneError, match="makes a grid of"):
        Lattice(disc(1.0), 1e-6, 2)


def test_centres_on_an_edge_are_treated_alike_at_every_spacing():
    # 24.5/49 rounds below 1/2, the other two do not.
    for n in (47, 49, 51):
        assert Lattice(rectangle(1.0, 1.0), 1 / n, 2).count == n**2
