"""Which bonds exist: edges, cracks with their exact ties, and factors that both ends share."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import Crack, Family, SceneError, disc, rectangle
from solver.bonds import Bonds
from solver.geometry import Lattice
from tests.solver.bodies import Cells, block, cut_by, exact, few, masks

eighths = st.integers(-8, 64).map(lambda k: k / 8)


def bonds_of(region, spacing=1.0, m=2.0, cracks=(), rule="partial", **options):
    family = Family(m, spacing, rule)
    return Bonds(Lattice(region, spacing, family.reach), family, cracks, **options)


def pair_factors(bonds):
    """Factor of every directed bond {(p, q): factor}, from `factor`, which kernels follow."""
    lattice = bonds.lattice
    number, (rows, columns) = lattice.number(), lattice.rows_columns
    found = {}
    for o, (dx, dy) in enumerate(bonds.family.offsets):
        there = number[rows + dy, columns + dx]
        values = bonds.strength(o)
        assert not values[there < 0].any()
        for p in np.flatnonzero(there >= 0):
            found[int(p), int(there[p])] = float(values[p])
    return found


def cut_pairs(bonds):
    """Unordered pairs that are cut, as sorted coordinates."""
    points = bonds.lattice.points
    return {
        tuple(sorted([tuple(points[p]), tuple(points[q])]))
        for (p, q), factor in pair_factors(bonds).items()
        if factor == 0.0
    }


@exact
@given(masks(), st.sampled_from([1, 2, 2.5]))
def test_short_particles_are_those_that_lack_a_neighbour(mask, m):
    bonds = bonds_of(Cells(mask), m=m)
    lattice = bonds.lattice
    rows, columns = lattice.rows_columns
    lacks = [
        not all(lattice.mask[r + dy, c + dx] for dx, dy in bonds.family.offsets)
        for r, c in zip(rows, columns, strict=True)
    ]
    np.testing.assert_array_equal(bonds.short, np.flatnonzero(lacks))
    assert not len(bonds.special)
    assert all(factor == 1.0 for factor in pair_factors(bonds).values())


@exact
@given(st.tuples(eighths, eighths), st.tuples(eighths, eighths), st.sampled_from([1.5, 2, 3]))
def test_cut_bonds_are_those_whose_segment_meets_the_crack(start, end, m):
    if start == end:
        return
    crack = Crack(start, end)
    try:
        bonds = bonds_of(block(7, 6), m=m, cracks=[crack])
    except SceneError:
        bonds = bonds_of(block(7, 6), m=m)
        judge = cut_by(bonds.lattice, crack)
        assert all(judge(p, q) == 1.0 for p, q in pair_factors(bonds))
        return
    judge = cut_by(bonds.lattice, crack)
    for (p, q), factor in pair_factors(bonds).items():
        assert factor == judge(p, q)


@few
@given(st.integers(0, 10**6))
def test_factors_are_the_same_from_both_ends(seed):
    rng = np.random.default_rng(seed)
    mask = rng.random((9, 9)) < 0.9
    mask[4, 2:6] = True
    cracks = [Crack((2.0, 5.0), tuple(rng.uniform(3, 8, 2))), Crack((1, 1), (4, 4.5), (7, 3))]
    prescribed = rng.random(mask.sum()) < 0.2
    bonds = bonds_of(Cells(mask), m=2.5, cracks=cracks, treatment="volume", prescribed=prescribed)
    factors = pair_factors(bonds)
    for (p, q), factor in factors.items():
        assert factors[q, p] == factor


# ---- ties ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("m", [2, 3, 5])
def test_a_tip_between_four_particles_is_mirror_symmetric(m):
    bonds = bonds_of(disc(9.0), m=m, cracks=[Crack((-20.0, 0.0), (0.0, 0.0))])
    cut = cut_pairs(bonds)
    flipped = {tuple(sorted((x, -y) for x, y in pair)) for pair in cut}
    assert cut == flipped
    # Both diagonals through the tip itself stay; the vertical bond just behind it is cut.
    for pair in [((-0.5, -0.5), (0.5, 0.5)), ((-0.5, 0.5), (0.5, -0.5))]:
        assert pair not in cut
    assert ((-0.5, -0.5), (-0.5, 0.5)) in cut
    assert ((0.5, -0.5), (0.5, 0.5)) not in cut


def test_the_cut_set_does_not_depend_on_the_unit_or_the_sense_of_the_crack():
    wanted = cut_pairs(bonds_of(disc(9.0), m=3, cracks=[Crack((-20, 0), (0, 0))]))
    back = cut_pairs(bonds_of(disc(9.0), m=3, cracks=[Crack((0, 0), (-20, 0))]))
    assert back == wanted
    for dx in (1 / 60, 1e-6, 1e5):
        bonds = bonds_of(disc(9 * dx), spacing=dx, m=3, cracks=[Crack((-20 * dx, 0), (0, 0))])
        scaled = {
            tuple((round(x / dx, 6), round(y / dx, 6)) for x, y in pair)
            for pair in cut_pairs(bonds)
        }
        assert scaled == wanted


@pytest.mark.parametrize("angle", [0.0, np.pi / 2, np.pi, -np.pi / 2])
def test_turning_the_crack_by_a_right_angle_turns_the_cut_set(angle):
    tip = (0.0, 0.0)
    mouth = (-20 * np.cos(angle), -20 * np.sin(angle))
    cut = cut_pairs(bonds_of(disc(9.0), m=3, cracks=[Crack(mouth, tip)]))
    c, s = round(np.cos(angle)), round(np.sin(angle))
    plain = cut_pairs(bonds_of(disc(9.0), m=3, cracks=[Crack((-20, 0), (0, 0))]))
    turned = {tuple(sorted((c * x - s * y, s * x + c * y) for x, y in pair)) for pair in plain}
    assert cut == turned


def test_bonds_through_the_joint_of_two_pieces_are_cut():
    # The joint lies between four particles, where a tip would let both diagonals stay.
    bent = cut_pairs(bonds_of(block(8, 8), cracks=[Crack((2, 4), (4, 4), (6, 4))]))
    straight = cut_pairs(bonds_of(block(8, 8), cracks=[Crack((2, 4), (6, 4))]))
    assert bent == straight
    two = cut_pairs(bonds_of(block(8, 8), cracks=[Crack((2, 4), (4, 4)), Crack((4, 4), (6, 4))]))
    assert straight - two == {((3.5, 3.5), (4.5, 4.5)), ((3.5, 4.5), (4.5, 3.5))}
    corner = cut_pairs(bonds_of(block(8, 8), cracks=[Crack((4, 2), (4, 4), (6, 4))]))
    assert ((3.5, 4.5), (4.5, 3.5)) in corner


def test_particles_on_the_crack_line_belong_to_its_left_side():
    cut = cut_pairs(bonds_of(block(6, 5), m=1, rule="full", cracks=[Crack((-1, 2.5), (7, 2.5))]))
    assert cut == {((k + 0.5, 1.5), (k + 0.5, 2.5)) for k in range(6)}
    back = cut_pairs(bonds_of(block(6, 5), m=1, rule="full", cracks=[Crack((7, 2.5), (-1, 2.5))]))
    assert back == {((k + 0.5, 2.5), (k + 0.5, 3.5)) for k in range(6)}


def test_several_cracks_add_up():
    one, other = Crack((-1, 2), (3, 2)), Crack((4, 3), (4, 9))
    both = cut_pairs(bonds_of(block(7, 7), m=3, cracks=[one, other]))
    apart = [cut_pairs(bonds_of(block(7, 7), m=3, cracks=[crack])) for crack in (one, other)]
    assert both == apart[0] | apart[1]


@pytest.mark.parametrize("crack", [Crack((20, 20), (30, 20)), Crack((-5.0, 0.0), (-1.0, 0.0))])
def test_a_crack_outside_the_body_is_refused(crack):
    with pytest.raises(SceneError, match="lies outside the body"):
        bonds_of(block(6, 6), cracks=[crack])


def test_a_crack_too_short_to_cut_a_bond_is_refused():
    with pytest.raises(SceneError, match="cuts no bond"):
        bonds_of(block(6, 6), m=1, rule="full", cracks=[Crack((2.9, 3.0), (3.1, 3.0))])


# ---- cost ---------------------------------------------------------------------------------------


def test_nothing_is_stored_for_bulk_bonds():
    family = Family(3, 0.02)
    bonds = Bonds(Lattice(rectangle(1.0, 1.0), 0.02, family.reach), family)
    assert bonds.strengths.shape == (family.size, 0)
    cracked = Bonds(bonds.lattice, family, [Crack((-1.0, 0.0), (0.0, 0.0))])
    # A crack of 25 cells concerns the particles within the horizon beside it, no others.
    near = np.abs(bonds.lattice.points[cracked.special, 1]) < family.length.max()
    assert near.all()
    assert len(cracked.special) < 2 * 4 * (25 + 4)
    assert bonds.nbytes < cracked.nbytes < 100_000


def test_a_closed_crack_cuts_an_island_off():
    family = Family(2)
    loop = Crack((6, 3), (8, 3), (8, 5), (6, 5), (6, 3))
    bonds = Bonds(Lattice(block(10, 8), 1.0, family.reach), family, [loop])
    # Where the loop closes is a joint, not two tips.
    assert ((5.5, 2.5), (6.5, 3.5)) in cut_pairs(bonds)
