"""Which bonds exist: edges, cracks with their exact ties, and factors that both ends share."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    Family,
    Scene,
    SceneError,
    Support,
    disc,
    rectangle,
)
from solver.analyses.statics import solve
from solver.bonds import Bonds, damage
from solver.geometry import Lattice
from solver.operators import BondOperator
from tests.solver.bodies import Cells, Sites, block, cut_by, exact, few, masks

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


def leaving(bonds):
    """Directed bonds that leave the body between two particles."""
    lattice = bonds.lattice
    number, (rows, columns) = lattice.number(), lattice.rows_columns
    found = set()
    for p, lost in zip(bonds.outside_at, bonds.outside.T, strict=True):
        for dx, dy in bonds.family.offsets[lost]:
            found.add((int(p), int(number[rows[p] + dy, columns[p] + dx])))
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
    lost = leaving(bonds)
    np.testing.assert_array_equal(bonds.special, sorted({p for p, _ in lost}))
    assert all(factor == (pair not in lost) for pair, factor in pair_factors(bonds).items())


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


# ---- bodies, not particles -----------------------------------------------------------------------


@pytest.mark.parametrize("treatment", ["none", "volume", "extrapolated"])
def test_bodies_a_cell_apart_exchange_nothing(treatment):
    held = [
        Support.where(lambda x, y: x < -0.9, temperature=0.0),
        Support.where(lambda x, y: x > 0.9, temperature=1.0),
    ]
    region = rectangle(2.0, 0.4) - rectangle(0.04, 1.0)
    solution = Scene(
        region, 0.02, ConductivityTensor.isotropic(1.0), held, m=5, surface=treatment
    ).solve()
    temperature, left = solution.temperature, solution.points[:, 0] < 0
    # The solver's tolerance.
    np.testing.assert_allclose(temperature[left], 0.0, atol=1e-15)
    np.testing.assert_allclose(temperature[~left], 1.0, rtol=1e-9)
    # With one end left alone the other body floats.
    with pytest.raises(SceneError, match="no temperature is prescribed on the part about"):
        Scene(region, 0.02, ConductivityTensor.isotropic(1.0), held[:1], surface=treatment).solve()


def pulled(region, surface, cracks=(), conductive=False, cells=24, m=3):
    """Twice the energy of a plate between two grips that part."""
    h = 1 / cells
    if conductive:
        material = ConductivityTensor.isotropic(1.0)
        grips = Support.where(lambda x, y: abs(y) > 0.5, temperature=lambda x, y: np.sign(y))
    else:
        material = ElasticTensor.isotropic(1.0, 0.25)
        grips = Support.where(
            lambda x, y: abs(y) > 0.5,
            displacement=lambda x, y: np.stack([0 * x, np.sign(y)], axis=-1),
            rotation=0.0,
        )
    parts = Scene(region, h, material, [grips], cracks=cracks, m=m, surface=surface).discretise()
    u = solve(parts).unknowns
    operator = BondOperator(parts.bonds, parts.operator.moduli, np.zeros_like(parts.prescribed))
    return float(u.ravel() @ operator.matvec(u.ravel()))


@pytest.mark.parametrize("conductive", [False, True])
@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
def test_a_slot_of_any_width_holds_no_more_than_a_crack(surface, conductive):
    tall = rectangle(1.0, 1.25)
    crack = pulled(tall, surface, [Crack((-0.3, 0.0), (0.3, 0.0))], conductive)
    last = pulled(tall, surface, (), conductive)
    assert crack < 0.85 * last
    for cells in (0.1, 0.5, 1.0, 3.0):
        slotted = pulled(tall - rectangle(0.6, cells / 24), surface, (), conductive)
        assert slotted < (1 + 1e-9) * min(crack, last)
        last = slotted


def test_damage_counts_the_bonds_that_a_body_has():
    region = rectangle(10.0, 10.0) - rectangle(0.1, 6.0)
    assert not damage(bonds_of(region, m=3)).any()
    with_crack = bonds_of(region, m=3, cracks=[Crack((-6.0, 0.0), (6.0, 0.0))])
    assert damage(with_crack).max() > 0.3


def test_a_region_without_edges_is_judged_by_its_particles_and_says_so():
    bonds = bonds_of(Sites(np.ones((4, 4), dtype=bool)))
    assert "Sites has no outline" in bonds.warnings[0]
    assert not bonds_of(block(4, 4)).warnings


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
    assert two == straight
    corner = cut_pairs(bonds_of(block(8, 8), cracks=[Crack((4, 2), (4, 4), (6, 4))]))
    assert ((3.5, 4.5), (4.5, 3.5)) in corner


@pytest.mark.parametrize("back", [False, True])
def test_particles_on_a_crack_belong_to_its_upper_or_right_side(back):
    def cut(*points):
        crack = Crack(*(points[::-1] if back else points))
        bonds = bonds_of(block(6, 5), m=1, rule="full", cracks=[crack])
        assert "particles lie on a crack" in bonds.warnings[0]
        return cut_pairs(bonds)

    level, upright = cut((-1, 2.5), (7, 2.5)), cut((2.5, -1), (2.5, 6))
    assert level == {((k + 0.5, 1.5), (k + 0.5, 2.5)) for k in range(6)}
    assert upright == {((1.5, k + 0.5), (2.5, k + 0.5)) for k in range(5)}


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
