"""Shapes: particle counts, membership, distance to the edge."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from solver import Crack, disc, polygon, rectangle
from solver.geometry import Lattice
from solver.geometry.regions import Difference
from tests.solver.bodies import exact

coordinate = st.floats(-0.9, 0.9)


@pytest.mark.parametrize(
    ("cells", "count"),
    # the paper's figures, but for a/120, where it prints 45344.
    [(30, 2828), (60, 11304), (100, 31428), (120, 45244)],
)
def test_particles_of_the_disc(cells, count):
    assert Lattice(disc(1.0), 1 / cells, 6).count == count


def test_counts_do_not_depend_on_the_unit_of_length():
    for scale in (1e-6, 0.3, 1e4):
        assert Lattice(disc(scale), scale / 30, 6).count == 2828


@exact
@given(coordinate, coordinate)
def test_disc_membership_and_distance(x, y):
    region = disc(0.5, centre=(0.1, -0.2))
    r = np.hypot(x - 0.1, y + 0.2)
    assert region.contains(np.array(x), np.array(y)) == (r <= 0.5)
    assert region.edge_distance(np.array(x), np.array(y)) == pytest.approx(abs(0.5 - r), abs=1e-15)
    assert region.bounds == pytest.approx((-0.4, -0.7, 0.6, 0.3))


@exact
@given(coordinate, coordinate, st.floats(-3, 3))
def test_turned_rectangle(x, y, angle):
    region = rectangle(1.2, 0.6, centre=(0.1, 0.2), angle=angle)
    c, s = np.cos(angle), np.sin(angle)
    along = abs(c * (x - 0.1) + s * (y - 0.2))
    across = abs(-s * (x - 0.1) + c * (y - 0.2))
    inside = along < 0.6 and across < 0.3
    if min(abs(along - 0.6), abs(across - 0.3)) > 1e-12:
        assert region.contains(np.array([x]), np.array([y]))[0] == inside
    if inside:
        depth = region.edge_distance(np.array([x]), np.array([y]))[0]
        assert depth == pytest.approx(min(0.6 - along, 0.3 - across), abs=1e-12)


@exact
@given(coordinate, coordinate)
def test_difference_of_overlapping_shapes_measures_its_real_edge(x, y):
    # A notch that reaches over the edge and a hole inside: parts of the outlines are no edges.
    region = rectangle(2.0, 2.0) - rectangle(0.6, 0.5, centre=(1.0, 0.0)) - disc(0.3, (-0.4, 0.1))
    assert isinstance(region, Difference)
    circle = shapely.Point(-0.4, 0.1).buffer(0.3, quad_segs=500)
    shape = shapely.box(-1, -1, 1, 1) - shapely.box(0.7, -0.25, 1.3, 0.25) - circle
    point = shapely.Point(x, y)
    distance = shapely.distance(shape.boundary, point)
    if distance > 1e-5:
        inside = region.contains(np.array([x]), np.array([y]))[0]
        assert inside == shape.contains(point)
        if inside:
            found = region.edge_distance(np.array([x]), np.array([y]))[0]
            assert found == pytest.approx(distance, abs=1e-5)


def test_particles_of_a_plate_with_a_hole():
    plate, hole, spacing = rectangle(2.0, 1.0), disc(0.3), 0.05
    whole = Lattice(plate, spacing, 3).count
    assert whole == 40 * 20
    points = Lattice(plate - hole, spacing, 3).points
    r = np.hypot(*points.T)
    assert r.min() > 0.3
    # What is left out is what a disc of that radius holds.
    assert whole - len(points) == Lattice(hole, spacing, 3).count


@pytest.mark.parametrize(
    "vertices",
    [
        [],
        [(0, 0), (1, 1)],
        [(0, 0), (1, 1), (2, 2)],
        [(0, 0), (1, 1), (1, 0), (0, 1)],
    ],
)
def test_bad_polygons(vertices):
    with pytest.raises(ValueError, match="not a simple polygon"):
        polygon(vertices)


@pytest.mark.parametrize("radius", [0.0, -1.0, np.nan, np.inf])
def test_bad_discs(radius):
    with pytest.raises(ValueError, match="positive radius"):
        disc(radius)


@pytest.mark.parametrize(("width", "height"), [(0, 1), (1, -1), (np.nan, 1)])
def test_bad_rectangles(width, height):
    with pytest.raises(ValueError, match="positive sides"):
        rectangle(width, height)


def test_crack_pieces():
    crack = Crack((0, 0), (1, 0), (1, 2))
    assert crack.segments == (((0.0, 0.0), (1.0, 0.0)), ((1.0, 0.0), (1.0, 2.0)))
    assert Crack((0, 0), (0, 0), (1, 0), (1, 0), (1, 2), (1, 2)) == crack


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ((), "two or more points"),
        (((0, 0),), "two or more points"),
        (((0, 0, 0), (1, 1, 1)), "two or more points"),
        (((0, 0), (0, 0)), "no length"),
        (((0, 0), (np.inf, 0)), "not finite"),
    ],
)
def test_bad_cracks(points, message):
    with pytest.raises(ValueError, match=message):
        Crack(*points)
