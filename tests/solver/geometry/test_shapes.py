"""Discs and polygons: what they hold and how far their edge is."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import disc, polygon, rectangle
from solver.geometry import Lattice
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


@given(st.integers(0, 2**32 - 1), st.integers(3, 9))
def test_vertices_that_are_said_again_are_one(seed, count):
    """A side without length would have no normal: outlines are those of the ring without it."""
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0, 2 * np.pi, count)) + 1e-3 * np.arange(count)
    ring = [(float(np.cos(a)), float(np.sin(a))) for a in angle]
    again = [p for p in ring for _ in range(int(rng.integers(1, 4)))]
    closed = [*again, again[0]] if rng.uniform() < 0.5 else again
    one, other = polygon(ring), polygon(closed)
    assert set(other.vertices) == set(ring)
    assert len(other.vertices) == count
    assert other.shape.equals(one.shape)


@pytest.mark.parametrize("radius", [0.0, -1.0, np.nan, np.inf])
def test_bad_discs(radius):
    with pytest.raises(ValueError, match="positive radius"):
        disc(radius)


@pytest.mark.parametrize(("width", "height"), [(0, 1), (1, -1), (np.nan, 1)])
def test_bad_rectangles(width, height):
    with pytest.raises(ValueError, match="positive sides"):
        rectangle(width, height)
