"""Which lines stay in the body: against fractions, turned, mirrored and moved; what is cheap."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from solver import Family, disc, polygon, rectangle
from solver.geometry import Body, Lattice
from tests.solver.bodies import block, few
from tests.solver.geometry.rational import on_segment, stays_inside

eighths = st.integers(0, 72).map(lambda k: k / 8)
corner = st.tuples(eighths, eighths)


@st.composite
def notched(draw):
    """A square of eight cells without one or two triangles, corners anywhere."""
    region = block(9, 8)
    for _ in range(draw(st.integers(1, 2))):
        try:
            region = region - polygon([draw(corner) for _ in range(3)])
        except ValueError:
            assume(False)
    return region


def pairs(lattice, offsets):
    """Ordered pairs that leave, by (column, row) of both ends."""
    particles, mask = Body.of(lattice).leaving(lattice, offsets)
    rows, columns = lattice.rows_columns
    found = set()
    for k, p in enumerate(particles):
        at = int(columns[p]), int(rows[p])
        found |= {(at, (at[0] + int(i), at[1] + int(j))) for i, j in offsets[mask[:, k]]}
    return found


def whole(point):
    return tuple(int(x) for x in point)


@few
@given(notched(), st.sampled_from([1.5, 2]))
def test_lines_stay_inside_as_fractions_say(region, m):
    family = Family(m, 1.0)
    try:
        lattice = Lattice(region, 1.0, family.reach)
    except ValueError:
        return
    body = Body.of(lattice)
    rings = []
    for part in body.shape.geoms:
        for ring in (part.exterior, *part.interiors):
            rings.append([whole(point) for point in ring.coords[:-1]])
    # Bodies that touch themselves in a point are parted there, though the point is theirs.
    for ring in rings:
        for other in rings:
            edges = list(zip(other, [*other[1:], other[0]], strict=True))
            for point in ring:
                touching = [e for e in edges if on_segment(point, *e)]
                assume(len(touching) == (2 if other is ring else 0))
    found = pairs(lattice, family.offsets)
    rows, columns = lattice.rows_columns
    asked = body.drawn_in(2.0**20 * np.column_stack([columns, rows]))
    number = lattice.number()
    for p in range(lattice.count):
        for i, j in family.offsets[: family.size // 2]:
            q = number[rows[p] + j, columns[p] + i]
            if q < 0:
                continue
            a = int(columns[p]), int(rows[p])
            b = a[0] + int(i), a[1] + int(j)
            stays = stays_inside(whole(asked[p]), whole(asked[q]), rings)
            assert ((a, b) in found) == (not stays)
            assert ((b, a) in found) == (not stays)


TRIANGLE = [(2.0, 9.0), (4.25, 2.5), (4.5, 9.0)]


@pytest.mark.parametrize("m", [2, 3])
def test_mirror_images_and_turns_are_alike(m):
    family = Family(m, 1.0)
    turns = [
        lambda x, y: (x, y),
        lambda x, y: (-x, y),
        lambda x, y: (x, -y),
        lambda x, y: (y, x),
        lambda x, y: (-y, x),
    ]
    wanted = None
    for turn in turns:
        square = polygon([turn(x, y) for x, y in [(0, 0), (8, 0), (8, 8), (0, 8)]])
        region = square - polygon([turn(*point) for point in TRIANGLE])
        lattice = Lattice(region, 1.0, family.reach)
        particles, mask = Body.of(lattice).leaving(lattice, family.offsets)
        found = set()
        for k, p in enumerate(particles):
            for step in family.offsets[mask[:, k]]:
                ends = lattice.points[p], lattice.points[p] + step
                # The turn's inverse: all but the last are their own.
                back = (lambda x, y: (y, -x)) if turn is turns[-1] else turn
                found.add(tuple(back(*end) for end in ends))
        wanted = found if wanted is None else wanted
        assert found == wanted
    assert wanted


@pytest.mark.parametrize("spacing", [1e-9, 1 / 60, 1e3])
@pytest.mark.parametrize("away", [0, 3e7])
def test_units_and_distance_do_not_matter(spacing, away):
    family = Family(3, spacing)

    def found(spacing, away):
        move = np.array([(x + away) * spacing for x in (0, 8)])
        low, high = move
        region = polygon([(low, low), (high, low), (high, high), (low, high)])
        region -= polygon([tuple((x + away) * spacing for x in point) for point in TRIANGLE])
        lattice = Lattice(region, spacing, 3)
        particles, mask = Body.of(lattice).leaving(lattice, family.offsets)
        return particles.tolist(), mask.tolist()

    assert found(spacing, away) == found(1.0, 0)


@pytest.mark.parametrize(
    "region", [disc(1.0), rectangle(1.0, 0.3, angle=0.4), rectangle(1.0, 1.0), disc(0.07)]
)
def test_convex_bodies_lose_no_bond_and_pay_nothing(region):
    family = Family(5, 0.02)
    lattice = Lattice(region, 0.02, family.reach)
    body = Body.of(lattice)
    assert body.convex
    assert not len(body.critical(family.reach))
    assert body.leaving(lattice, family.offsets)[1].shape == (family.size, 0)


def test_a_convex_curve_loses_no_bond_beside_a_notch():
    family = Family(3, 0.05)
    plain = Lattice(disc(1.0), 0.05, family.reach)
    # The slot makes every particle near it be asked; those beyond the disc's chords too.
    cut = Lattice(disc(1.0) - rectangle(0.01, 0.4, (0.0, 1.0)), 0.05, family.reach)
    assert plain.count == cut.count
    particles, mask = Body.of(cut).leaving(cut, family.offsets)
    points = cut.points[particles]
    for point, lost in zip(points, mask.T, strict=True):
        ends = point[0] + 0.05 * family.offsets[lost, 0]
        assert (np.sign(ends) == -np.sign(point[0])).all()


@pytest.mark.parametrize("width", [0.001, 0.1, 0.5, 1.0, 2.5])
def test_a_slot_of_any_width_parts_the_body(width):
    family = Family(5, 1.0)
    region = rectangle(20.0, 20.0) - rectangle(width, 30.0)
    lattice = Lattice(region, 1.0, family.reach)
    left = lattice.points[:, 0] < 0
    particles, mask = Body.of(lattice).leaving(lattice, family.offsets)
    number, (rows, columns) = lattice.number(), lattice.rows_columns
    lost = np.zeros((family.size, lattice.count), dtype=bool)
    lost[:, particles] = mask
    for o, (i, j) in enumerate(family.offsets):
        q = number[rows + j, columns + i]
        np.testing.assert_array_equal(lost[o], (q >= 0) & (left != left[q]))


def test_lines_along_an_edge_and_through_a_corner_stay():
    # The corner lies between four particles; the edges of the notch run through others.
    region = polygon([(0, 0), (6, 0), (6, 3.5), (3.5, 3.5), (3.5, 6), (0, 6)])
    lattice = Lattice(region, 1.0, 2)
    found = pairs(lattice, Family(2, 1.0).offsets)
    points = {(int(r), int(c)) for r, c in zip(*lattice.rows_columns, strict=True)}
    at = [(c, r) for r, c in points]
    for a, b in found:
        assert a in at
        assert b in at
        # From one arm to the other, past the corner.
        assert (a[0] > 5 and b[1] > 5) or (a[1] > 5 and b[0] > 5)
