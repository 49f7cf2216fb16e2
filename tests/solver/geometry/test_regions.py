"""Shapes: particle counts, membership, distance to the edge."""

import numpy as np
import pytest
import shapely
from hypothesis import example, given
from hypothesis import strategies as st

from solver import Family, disc, rectangle
from solver.errors import EmptyRegionError
from solver.geometry import Body, Lattice, Outline
from solver.geometry.regions import Difference
from tests.solver.bodies import exact, few

coordinate = st.floats(-0.9, 0.9)


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


def same_body(one, other, spacing=0.055):
    """Particles, bonds and outline of two regions are alike."""
    first, second = (Lattice(region, spacing, 3) for region in (one, other))
    np.testing.assert_allclose(first.points, second.points, atol=1e-12)
    offsets = Family(2, spacing).offsets
    for a, b in zip(*(Body.of(x).leaving(x, offsets) for x in (first, second)), strict=True):
        np.testing.assert_array_equal(a, b)
    nodes = (Outline.of(region, (), spacing).nodes for region in (one, other))
    a, b = (found[np.lexsort(np.rint(found / spacing * 1e6).T)] for found in nodes)
    np.testing.assert_allclose(a, b, atol=1e-11)


@few
@example(0.0, 0.0093, 0.4140625, False)
@given(st.floats(-1.2, 1.2), st.floats(-0.3, 0.3), st.floats(0, 3), st.booleans())
def test_the_pieces_of_a_body_are_the_body_again(turn, place, angle, overlapping):
    """Whatever the line along which it is cut, also where the pieces overlap."""
    c, s = np.cos(angle), np.sin(angle)
    knife = rectangle(4, 4, (c * (2 + place), s * (2 + place)), angle)
    body = rectangle(1.3, 0.9, (0.0, 0.0), turn) - disc(0.17, (0.1, 0.05))
    rest = body if overlapping else body - knife
    same_body((body & knife) | rest, body)
    same_body(rest | (body & knife), body)


def test_edges_that_rounding_parts_are_one():
    pieces = [rectangle(0.1, 1.0, (0.1 * k + 0.05, 0.0)) for k in range(7)]
    united = pieces[0]
    for piece in pieces[1:]:
        united = united | piece
    # 0.1 k ± 0.05 differ by roundings from piece to piece.
    assert shapely.get_num_geometries(united.outline(0.1)) == 1
    same_body(united, rectangle(0.7, 1.0, (0.35, 0.0)))


def test_membership_and_bounds_of_unions_and_intersections():
    one, other = disc(1.0), rectangle(1.0, 3.0, (0.6, 0.2))
    x, y = np.random.default_rng(1).uniform(-2, 2, (2, 400))
    a, b = one.contains(x, y), other.contains(x, y)
    np.testing.assert_array_equal((one | other).contains(x, y), a | b)
    np.testing.assert_array_equal((one & other).contains(x, y), a & b)
    np.testing.assert_allclose((one | other).bounds, (-1.0, -1.3, 1.1, 1.7))
    np.testing.assert_allclose((one & other).bounds, (0.1, -1.0, 1.0, 1.0))
    far = (one | other).moved((3.0, 4.0))
    np.testing.assert_array_equal(far.contains(x + 3.0, y + 4.0), a | b)
    for wrong in (lambda: one | 3.0, lambda: one & 3.0, lambda: one - 3.0):
        with pytest.raises(TypeError, match="combines with a Region"):
            wrong()


@st.composite
def shapes(draw):
    """Discs and turned rectangles, single and combined, of all proportions to each other."""

    def simple():
        place = draw(st.tuples(coordinate, coordinate))
        size = draw(st.floats(0.05, 3.0))
        if draw(st.booleans()):
            return disc(size, place)
        return rectangle(size, draw(st.floats(0.05, 3.0)), place, draw(st.sampled_from([0, 0.3])))

    made = simple()
    for how in draw(st.lists(st.sampled_from("|-&"), max_size=2)):
        one = simple()
        try:
            made = made | one if how == "|" else made - one if how == "-" else made & one
        except EmptyRegionError:
            break
    return made


@few
@example(rectangle(1, 1), rectangle(1, 1, (1, 0)))
@example(rectangle(0.1, 1, (0.15, 0)), rectangle(0.1, 1, (0.25, 0)))
@example(disc(1.0), disc(1.0))
@example(disc(0.7), disc(0.7, (0.0, 1.4)))
@example(disc(0.1, (-0.8, -0.8)), disc(0.1, (-0.65, -0.65)))
@example(rectangle(1, 1, (3e6, 1e6), 0.3), rectangle(2, 2, (3e6, 1e6), 0.3))
@given(shapes(), shapes())
def test_what_has_no_area_is_refused_by_name(one, other):
    """Also where boxes around the shapes overlap, and where edges meet but for rounding."""
    step = 1e-3
    a, b = one.outline(step), other.outline(step)
    for make, shape, said in (
        (lambda: one & other, shapely.intersection(a, b), "nothing in common"),
        (lambda: one - other, shapely.difference(a, b), "covers it"),
    ):
        # Chords leave slivers.
        if shape.area > 1e-6:
            assert make().outline(step).area > 0
        elif shape.area < 1e-9:
            with pytest.raises(EmptyRegionError, match=said):
                make()


def test_the_edge_of_a_union_is_that_of_the_whole():
    both = disc(1.0) | disc(1.0, (1.0, 0.0))
    x, y = np.array([0.5, -0.5, 0.5]), np.array([0.0, 0.0, 0.7])
    corner = np.sqrt(0.75)
    np.testing.assert_allclose(both.edge_distance(x, y), [corner, 0.5, corner - 0.7], atol=1e-7)
    # Exact but for the corner.
    assert both.edge_distance(x, y)[1] == 0.5
    lens = disc(1.0) & disc(1.0, (1.0, 0.0))
    np.testing.assert_allclose(lens.edge_distance(x[:1], y[:1]), 0.5)


def test_bodies_that_meet_in_a_point_are_two():
    corner = rectangle(1, 1, (-0.5, -0.5)) | rectangle(1, 1, (0.5, 0.5))
    lattice = Lattice(corner, 0.1, 3)
    offsets = Family(2, 0.1).offsets
    particles, mask = Body.of(lattice).leaving(lattice, offsets)
    number = np.full(lattice.count, -1)
    number[particles] = np.arange(len(particles))
    rows, columns = lattice.rows_columns
    there = lattice.number()
    left = lattice.points[:, 0] < 0
    for p in np.nonzero(left)[0]:
        for o, (dx, dy) in enumerate(offsets):
            q = there[rows[p] + dy, columns[p] + dx]
            if q >= 0 and not left[q]:
                assert mask[o, number[p]]
