"""Shapes: particle counts, membership, distance to the edge."""

import numpy as np
import pytest
import shapely
from hypothesis import example, given
from hypothesis import strategies as st

from solver import Crack, Family, disc, polygon, rectangle
from solver.errors import EmptyRegionError
from solver.geometry import Body, Lattice, Outline
from solver.geometry.regions import Difference
from tests.solver.bodies import exact, few

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
