"""The lattice: where it lies, which particles it has, and how they are kept in a padded array."""

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from solver import SceneError, disc, polygon, rectangle
from solver.geometry import Lattice
from tests.solver.bodies import Cells, exact, masks


@exact
@given(st.floats(0.3, 3.0), st.floats(0.2, 2.0), st.floats(-2, 2), st.floats(0.03, 0.3))
def test_every_centre_in_the_region_and_no_other(width, height, shift, spacing):
    region = rectangle(width, height, centre=(shift, -0.3 * shift), angle=0.4)
    assume(min(width, height) > 3 * spacing)
    points = Lattice(region, spacing, 4, phase=(0.0, 0.0)).points
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


def test_the_middle_of_some_particles():
    lattice = Lattice(rectangle(0.7, 0.5), 0.1, 3)
    all_of_it = np.ones(lattice.count, dtype=bool)
    assert lattice.middle(all_of_it).tolist() == [0.0, 0.0]
    right = lattice.places[:, 0] > 0.05
    np.testing.assert_allclose(lattice.middle(right), [0.2, 0.0], atol=1e-15)


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
    # Not empty, but thinner than any cell.
    with pytest.raises(SceneError, match="no particle"):
        Lattice(disc(1.0) - disc(0.999), 0.1, 2)


def test_a_grid_that_nobody_meant():
    with pytest.raises(SceneError, match="makes a grid of"):
        Lattice(disc(1.0), 1e-6, 2)


# ---- where it lies ------------------------------------------------------------------------------

units = st.sampled_from([1.0, 1e-9, 1e3, 0.3])
places = st.sampled_from([(0.0, 0.0), (0.37, -0.11), (5e5, 5e6), (-3e6, 3e6 + 0.1)])


@exact
@given(st.integers(2, 30), st.integers(2, 30), places, units)
def test_a_body_of_whole_cells_is_filled_by_them(columns, rows, place, unit):
    spacing = 0.1 * unit
    place = (place[0] * unit, place[1] * unit)
    lattice = Lattice(rectangle(columns * spacing, rows * spacing, place), spacing, 2)
    assert lattice.count == columns * rows
    np.testing.assert_allclose((lattice.points - place).mean(axis=0) / spacing, 0.0, atol=2e-8)


def test_an_odd_number_of_cells_lies_symmetrically():
    points = Lattice(rectangle(1.0, 1.0), 0.2, 2).points
    assert len(points) == 25
    np.testing.assert_allclose(points.mean(axis=0), 0.0, atol=1e-15)
    np.testing.assert_allclose(np.unique(points.round(12)), [-0.4, -0.2, 0.0, 0.2, 0.4])


@exact
@given(st.floats(4.05, 30.0), st.floats(0.0, 0.4), places)
def test_what_is_left_over_is_left_at_both_ends(cells, shift, place):
    assume(abs(cells % 1 - 0.5) > 1e-3)
    centre = (place[0] + shift, place[1])
    lattice = Lattice(rectangle(0.1 * cells, 1.0, centre), 0.1, 2)
    assert lattice.count == 10 * round(cells)
    np.testing.assert_allclose((lattice.points - centre).mean(axis=0), 0.0, atol=2e-9)


def test_cells_begin_at_the_only_straight_side():
    half = disc(1.0) - rectangle(4.0, 4.0, (-2.0, 0.0))
    x = Lattice(half, 0.13, 2).points[:, 0]
    assert x.min() == pytest.approx(0.065)


@pytest.mark.parametrize("unit", [1.0, 1e-9, 1e-3, 1e3, 1 / 3])
def test_a_disc_in_any_unit(unit):
    # Its rim runs through twelve centres.
    h = 0.1 * unit
    assert Lattice(disc(5 * h, (2.5 * h, 4.5 * h)), h, 6).count == 81
    assert Lattice(disc(5 * h), h, 6).count == 80


@exact
@given(st.integers(3, 20), places, units)
def test_oblique_edges_through_centres_are_straight(half, place, unit):
    # |x| + |y| <= half cells, with corners in centres: a diamond of 2 half² + 2 half + 1.
    h = 0.1 * unit
    x, y = place[0] * unit, place[1] * unit
    r = half * h
    diamond = polygon([(x + r, y), (x, y + r), (x - r, y), (x, y - r)])
    phase = ((x / h + 0.5) % 1.0, (y / h + 0.5) % 1.0)
    lattice = Lattice(diamond, h, 2, phase)
    assert lattice.count == 2 * half**2 + 2 * half + 1
    # A hole of that shape takes its rim.
    plate = rectangle(2 * r + 7 * h, 2 * r + 7 * h, (x, y)) - diamond
    assert Lattice(plate, h, 2, phase).count == (2 * half + 7) ** 2 - lattice.count


@exact
@given(st.integers(0, 10**6), st.floats(0.04, 0.11))
def test_mirror_images_have_mirrored_particles(seed, spacing):
    rng = np.random.default_rng(seed)
    # Vertices on halves of cells, where ties are.
    angle = np.sort(rng.uniform(0, 2 * np.pi, 7))
    assume(np.diff(angle, append=angle[0] + 2 * np.pi).max() < 2.8)
    vertices = np.rint(rng.uniform(6, 20, 7) * np.array([np.cos(angle), np.sin(angle)]))
    vertices = 0.5 * spacing * vertices.T
    hole = 0.5 * spacing * rng.integers(-3, 4, 2)
    assume(shapely.Polygon(vertices).is_valid and shapely.Polygon(vertices).area > 0)

    def mask(turn):
        body = polygon([turn(x, y) for x, y in vertices]) - disc(1.5 * spacing, turn(*hole))
        return Lattice(body, spacing, 2).mask

    one = mask(lambda x, y: (x, y))
    np.testing.assert_array_equal(mask(lambda x, y: (-x, y)), one[:, ::-1])
    np.testing.assert_array_equal(mask(lambda x, y: (x, -y)), one[::-1])
    np.testing.assert_array_equal(mask(lambda x, y: (y, x)), one.T)


def test_a_phase_of_the_user_s():
    points = Lattice(rectangle(1.0, 1.0), 0.2, 2, phase=(0.5, 0.25)).points / 0.2
    np.testing.assert_allclose(points[:, 0] % 1, 0.0, atol=1e-12)
    np.testing.assert_allclose(points[:, 1] % 1, 0.75)
    with pytest.raises(SceneError, match="a pair of shares"):
        Lattice(disc(1.0), 0.1, 2, phase=(0.5, np.nan))
