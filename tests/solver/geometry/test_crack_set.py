"""Cracks as the set of points that they are: against fractions, and drawn in every way."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import Crack, Family, disc, rectangle
from solver.geometry import Body, CrackSet, Frame, Lattice
from tests.solver.bodies import block, exact, few
from tests.solver.geometry.rational import is_cut

eighths = st.integers(0, 64).map(lambda k: k / 8)
halves = st.integers(0, 16).map(lambda k: k / 2)
point = st.one_of(st.tuples(eighths, eighths), st.tuples(halves, halves))


@st.composite
def drawings(draw):
    """Two to four pieces that often share ends, cross, or lie on particles."""
    points = draw(st.lists(point, min_size=3, max_size=5, unique=True))
    pairs = st.tuples(st.sampled_from(points), st.sampled_from(points))
    pieces = draw(st.lists(pairs.filter(lambda ab: ab[0] != ab[1]), min_size=2, max_size=4))
    return pieces


FAMILY = Family(2, 1.0)
LATTICE = Lattice(block(8, 8), 1.0, FAMILY.reach)


def cut(cracks, lattice=LATTICE, family=FAMILY, body=None):
    """Ordered pairs that are cut, by coordinates in cells; and how many particles lie on cracks."""
    joined = CrackSet.joined(Frame.of(lattice), cracks, body)
    particles, mask, _, lying = joined.cut(lattice, family.offsets)
    points = np.rint(2 * lattice.points / lattice.spacing) / 2
    found = set()
    for k, p in enumerate(particles):
        x, y = points[p]
        found |= {(x, y, x + i, y + j) for i, j in family.offsets[mask[:, k]]}
    return found, lying


@exact
@given(drawings())
def test_bonds_are_cut_as_fractions_say(pieces):
    found, _ = cut([Crack(*piece) for piece in pieces])
    whole = [tuple(tuple(map(Fraction, end)) for end in piece) for piece in pieces]
    boxes = [(np.min(piece, axis=0), np.max(piece, axis=0)) for piece in pieces]
    centres = {tuple(map(float, p)) for p in LATTICE.points}
    exactly = {value: Fraction(value) for centre in centres for value in centre}
    for x, y in centres:
        for i, j in FAMILY.offsets[: FAMILY.size // 2].tolist():
            there = x + i, y + j
            if there not in centres:
                continue
            left, right, low, high = min(x, x + i), max(x, x + i), min(y, y + j), max(y, y + j)
            near = any(
                right >= a[0] and left <= b[0] and high >= a[1] and low <= b[1] for a, b in boxes
            )
            p, q = ((exactly[u], exactly[v]) for u, v in ((x, y), there))
            # Fractions are slow; no bond is cut by what its box does not meet.
            wanted = near and is_cut(p, q, whole)
            assert ((x, y, *there) in found) == wanted
            assert ((*there, x, y) in found) == wanted


@exact
@given(drawings(), st.randoms(use_true_random=False))
def test_how_a_set_is_drawn_does_not_matter(pieces, random):
    wanted = cut([Crack(*piece) for piece in pieces])
    drawn = []
    for a, b in pieces:
        if random.random() < 0.5:
            a, b = b, a
        middle = tuple(0.5 * (x + y) for x, y in zip(a, b, strict=True))
        way = random.randrange(4)
        if way == 0:
            drawn += [Crack(a, middle), Crack(b, middle)]
        elif way == 1:
            drawn.append(Crack(a, middle, middle, b))
        else:
            drawn += [Crack(a, b)] * (way - 1)
    random.shuffle(drawn)
    assert cut(drawn) == wanted


@exact
@given(drawings())
def test_mirror_images_are_alike_where_no_particle_lies_on_a_crack(pieces):
    wanted, lying = cut([Crack(*piece) for piece in pieces])
    if lying:
        return
    for mirror in (lambda x, y: (8 - x, y), lambda x, y: (x, 8 - y), lambda x, y: (y, x)):
        found, _ = cut([Crack(mirror(*a), mirror(*b)) for a, b in pieces])
        assert found == {(*mirror(*pair[:2]), *mirror(*pair[2:])) for pair in wanted}


@few
@given(drawings(), st.sampled_from([1e-9, 1 / 60, 1e3]), st.sampled_from([0, 3e7]))
def test_units_and_distance_do_not_matter(pieces, spacing, away):
    wanted, _ = cut([Crack(*piece) for piece in pieces])

    def moved(end):
        return tuple((x + away) * spacing for x in end)

    middle = moved((4.0, 4.0))
    lattice = Lattice(rectangle(8 * spacing, 8 * spacing, middle), spacing, FAMILY.reach)
    family = Family(2, spacing)
    found, _ = cut([Crack(moved(a), moved(b)) for a, b in pieces], lattice, family)
    assert found == {tuple(x + away for x in pair) for pair in wanted}


def test_ends_that_meet_up_to_rounding_are_one():
    # 0.1 + 0.2 is not 0.3, and the foot of the branch lies beside the trunk by some roundings.
    trunk = Crack((0.7, 0.9), (7.3, 5.3))
    share = 1 / 3
    foot = tuple(a + share * (b - a) for a, b in zip(*trunk.points, strict=True))
    for off in (-3e-7, 0.0, 3e-7):
        joined = CrackSet.joined(
            Frame.of(LATTICE), [trunk, Crack((foot[0] + off, foot[1] + off), (2.0, 6.0))]
        )
        assert joined.tips.sum() == 3
    two = [Crack((0.0, 0.0), (0.1 + 0.2, 3.0)), Crack((0.3, 3.0), (5.0, 3.0))]
    assert CrackSet.joined(Frame.of(LATTICE), two).tips.sum() == 2


def mouths(region, crack, spacing=1.0):
    lattice = Lattice(region, spacing, 2)
    joined = CrackSet.joined(Frame.of(lattice), [crack], Body.of(lattice))
    return int((~joined.tips).sum())


@pytest.mark.parametrize("end", [-3.0, 0.0, 1e-9, 1e-6, 0.01, 0.3, 0.49])
def test_an_end_at_the_edge_is_a_mouth(end):
    assert mouths(block(8, 8), Crack((end, 4.0), (4.0, 4.0))) == 1
    assert mouths(block(8, 8), Crack((4.0, 8.0 - end), (4.0, 4.0))) == 1


def test_an_end_half_a_cell_from_the_edge_is_a_tip():
    assert mouths(block(8, 8), Crack((0.51, 4.0), (4.0, 4.0))) == 0
    # One that runs along an edge nearby does not meet it.
    assert mouths(block(8, 8), Crack((2.0, 0.1), (4.0, 0.1))) == 0


@pytest.mark.parametrize("angle", np.arange(0, 90, 7))
def test_radial_cracks_open_into_a_hole_at_every_angle(angle):
    region = rectangle(4.0, 4.0) - disc(0.5)
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    for start in (0.4, 0.5, 0.5 + 1e-6, 0.51):
        crack = Crack((start * c, start * s), (1.2 * c, 1.2 * s))
        assert mouths(region, crack, 0.05) == 1


def test_free_ends_are_those_of_the_set():
    frame = Frame.of(LATTICE)
    joined = CrackSet.joined(frame, [Crack((1, 1), (4, 4)), Crack((7, 1), (4, 4), (4, 7))])
    np.testing.assert_allclose(joined.free_ends(), [(1, 1), (4, 7), (7, 1)], atol=1e-6)
