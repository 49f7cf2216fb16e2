"""Strips: what particles stand for adds up to the body, and lies where the body does."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from solver import disc, rectangle
from solver.geometry import Lattice, Region, volumes
from tests.solver.bodies import Cells, exact, masks


@exact
@given(st.floats(0.6, 1.4), st.floats(0.3, 0.9), st.floats(0, 1.5), st.floats(0.02, 0.2))
def test_the_sum_is_the_area_whatever_the_edges_cut(width, height, angle, spacing):
    lattice = Lattice(rectangle(width, height, (0.31, -0.17), angle), spacing, 2)
    found = volumes(lattice)
    assert found.sum() * spacing**2 == pytest.approx(width * height, rel=1e-12)
    assert found.min() > 0
    # Within a cell: the strip's own place differs from the particle's by no more.
    middle = found @ lattice.points / found.sum()
    np.testing.assert_allclose(middle, (0.31, -0.17), atol=spacing**2 / min(width, height))


@exact
@given(masks())
def test_whole_cells_are_whole(mask):
    np.testing.assert_allclose(volumes(Lattice(Cells(mask), 1.0, 2)), 1.0, rtol=1e-12)


def test_a_strip_goes_to_the_row_beside_it():
    # 0.2 cells beyond the last row at either end; 0.3 of the last rows missing.
    for length, count, last in ((10.4, 10, 1.2), (10.6, 11, 0.8)):
        lattice = Lattice(rectangle(length, 4.0), 1.0, 2)
        assert lattice.count == 4 * count
        x = np.abs(lattice.points[:, 0])
        np.testing.assert_allclose(
            volumes(lattice), np.where(x > x.max() - 0.5, last, 1.0), rtol=1e-12
        )


def test_a_disc_and_what_a_hole_leaves():
    for spacing in (0.1, 0.03):
        found = volumes(Lattice(disc(1.0), spacing, 2)).sum() * spacing**2
        assert found == pytest.approx(np.pi, rel=1e-3 * spacing**2)
    plate = rectangle(2.0, 1.0) - disc(0.3, (0.2, 0.07))
    found = volumes(Lattice(plate, 0.05, 2)).sum() * 0.05**2
    assert found == pytest.approx(2 - 0.09 * np.pi, rel=1e-5)


def test_a_slit_s_sides_stay_apart():
    # Two halves, 0.4 cells apart along a row: cut cells are shared out each to its own side.
    body = rectangle(10, 6.0) - rectangle(12, 0.4, (0.0, 0.3))
    lattice = Lattice(body, 1.0, 2)
    found, y = volumes(lattice), lattice.points[:, 1]
    for side, area in ((y > 0.3, 25.0), (y < 0.3, 31.0)):
        assert found[side].sum() == pytest.approx(area, rel=1e-12)


@exact
@given(st.floats(0.1, 0.9), st.floats(-0.4, 0.4), st.floats(0, 1.5))
def test_a_part_of_the_body_has_its_own_area(size, shift, angle):
    part = rectangle(size, 0.5 * size, (shift, 0.3 * shift), angle)
    lattice = Lattice(rectangle(1.0, 1.0), 0.05, 2)
    area = shapely.intersection(part.shape, shapely.box(-0.5, -0.5, 0.5, 0.5)).area
    assert volumes(lattice, part).sum() * 0.05**2 == pytest.approx(area, rel=1e-10)


def test_mirror_images_carry_alike():
    body = rectangle(1.13, 0.94, angle=np.pi / 4) - disc(0.21)
    lattice = Lattice(body, 0.05, 2)
    grid = lattice.to_grid(volumes(lattice))
    np.testing.assert_allclose(grid, np.rot90(grid, 2), atol=1e-9)
    square = Lattice(rectangle(1.03, 1.03, angle=0.3) - disc(0.2), 0.05, 2)
    turned = Lattice(rectangle(1.03, 1.03, angle=-0.3) - disc(0.2), 0.05, 2)
    one, other = (a.to_grid(volumes(a)) for a in (square, turned))
    np.testing.assert_allclose(one, other[:, ::-1], atol=1e-9)


class Shapeless(Region):
    """A region that knows its members only."""

    @property
    def bounds(self):
        return -1.0, -1.0, 1.0, 1.0

    def contains(self, x, y):
        return np.maximum(np.abs(x), np.abs(y)) <= 1.0

    def edge_distance(self, x, y):
        return 1.0 - np.maximum(np.abs(x), np.abs(y))


def test_without_an_outline_particles_are_whole():
    lattice = Lattice(Shapeless(), 0.3, 2)
    np.testing.assert_array_equal(volumes(lattice), 1.0)
    inside = volumes(Lattice(rectangle(4.0, 4.0), 0.4, 2), Shapeless())
    assert set(inside) == {0.0, 1.0}
