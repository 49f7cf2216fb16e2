"""Critical bond energies: cuts cost what was asked for, ratios out of reach are refused."""

from math import gcd

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from solver import Family, Toughness, ToughnessError
from solver.fracture.toughness import evenness
from tests.solver.bodies import exact

FAMILY = Family(5, 0.2)


def counted(family, critical, p, q):
    """Bonds of a periodic strip along (p, q) that meet its middle line, one by one."""
    period = np.hypot(p, q)
    nu = np.array([-q, p]) / period
    # One particle of each row (rows are 1/period apart) in one period of the line.
    rows = np.arange(-3 * family.reach * int(np.ceil(period)), 0) + 0.5
    energy = 0.0
    for o, w, weight in zip(family.offsets, critical, family.weight, strict=True):
        step = (o @ nu) * period
        energy += w * weight * np.count_nonzero((rows < 0) & (rows + step > 0))
    return energy * family.cell_area**2 / (period * family.spacing)


@exact
@given(
    st.tuples(st.integers(-4, 4), st.integers(-4, 4)).filter(lambda v: gcd(*v) == 1),
    st.sampled_from([3, 4.5, 5]),
    st.sampled_from(["partial", "full", "exact"]),
    st.sampled_from(["constant", "conical"]),
    st.sampled_from([2, 4, 8]),
    st.floats(0.8, 1.6),
)
def test_a_cut_along_or_across_the_axis_costs_exactly_G(axis, m, rule, influence, n, ratio):
    family = Family(m, 0.3, rule, influence)
    law = Toughness(ratio * 7.0, 7.0, n=n, axis=np.arctan2(axis[1], axis[0]))
    low, high = law.ratios(family)
    assume(low < ratio < high)
    w = law.energies(family)
    assert w.min() >= 0
    p, q = axis
    assert counted(family, w, -q, p) == pytest.approx(ratio * 7.0, rel=1e-12)
    assert counted(family, w, p, q) == pytest.approx(7.0, rel=1e-12)


@exact
@given(
    st.tuples(st.integers(-4, 4), st.integers(-4, 4)).filter(lambda v: gcd(*v) == 1),
    st.floats(0, 3),
)
def test_the_cut_formula_counts_bonds_in_any_rational_direction(direction, zeta):
    law = Toughness(1.2, 1.0, n=4, axis=zeta)
    p, q = direction
    found = law.fracture_energy(np.arctan2(q, p), FAMILY)
    assert found == pytest.approx(counted(FAMILY, law.energies(FAMILY), p, q), rel=1e-12)


def test_fourfold_law_costs_exactly_G_in_both_directions():
    law = Toughness(1.0, 1.25, n=16, frequency=2)
    w = law.energies(FAMILY)
    assert counted(FAMILY, w, 0, 1) == pytest.approx(1.0, rel=1e-12)
    assert counted(FAMILY, w, 1, 0) == pytest.approx(1.0, rel=1e-12)
    assert counted(FAMILY, w, 1, 1) == pytest.approx(1.25, rel=1e-12)


@pytest.mark.parametrize("frequency", [3, 4])
def test_higher_frequencies_cost_G_in_the_mean_of_equivalent_cuts(frequency):
    # odd frequencies make cuts across the lobes dearer, even ones those between them
    energies = (1.02, 1.0) if frequency == 3 else (1.0, 1.02)
    law = Toughness(*energies, n=8, frequency=frequency, axis=0.2)
    turns = law.axis + np.pi / 2 + np.pi / frequency * np.arange(frequency)
    assert law.fracture_energy(turns, FAMILY).mean() == pytest.approx(law.G1, rel=1e-12)
    between = law.fracture_energy(turns + np.pi / (2 * frequency), FAMILY)
    assert between.mean() == pytest.approx(law.G2, rel=1e-12)


@pytest.mark.parametrize(
    ("n", "w1", "w2"),
    [
        # Eqs. 97-99 with G1 = 1.5, G2 = 1 and h delta^3 = 1
        (2, 3 * (2 * 1.5 - 1) / 2, 3 * (2 - 1.5) / 2),
        (4, 3 * (12 * 1.5 - 7) / 10, 3 * (8 - 3 * 1.5) / 10),
        (8, 3 * (280 * 1.5 - 187) / 186, 3 * (128 - 35 * 1.5) / 186),
    ],
)
def test_continuum_constants_are_the_printed_ones(n, w1, w2):
    law = Toughness(1.5, 1.0, n=n, calibration="continuum")
    assert law.constants(FAMILY) == pytest.approx((w1, w2), rel=1e-13)


def test_isotropic_and_fourfold_constants_of_the_continuum():
    isotropic = Toughness(2.0, calibration="continuum")
    np.testing.assert_allclose(isotropic.energies(FAMILY), 3.0, rtol=1e-14)  # Eq. 100
    fourfold = Toughness(1.0, 1.1, n=4, frequency=2, calibration="continuum")
    wanted = ((208 * 1.1 - 187) / 14, (128 - 107 * 1.1) / 14)  # Eq. 103
    assert fourfold.constants(FAMILY) == pytest.approx(wanted, rel=1e-12)


def test_an_isotropic_toughness_is_the_same_in_every_bond():
    w = Toughness(3.0, axis=0.4).energies(FAMILY)
    assert np.ptp(w) == 0
    assert Toughness(3.0).fracture_energy(0.0, FAMILY) == pytest.approx(3.0, rel=1e-14)


def test_lattice_constants_approach_those_of_the_continuum():
    law = Toughness(1.5, 1.0, n=4)
    wanted = Toughness(1.5, 1.0, n=4, calibration="continuum").constants(Family(1.0, 1.0))
    errors = [
        np.abs(np.array(law.constants(Family(m, 1 / m))) / wanted - 1).max() for m in (4, 8, 16)
    ]
    assert errors[0] > 2 * errors[1] > 4 * errors[2]


@pytest.mark.parametrize(
    ("n", "largest"),
    [(2, 2.0), (4, 8 / 3), (8, 128 / 35), (32, 7.1454124)],  # Sect. 3 after Eq. 100; PHYSICS
)
def test_largest_ratios_of_the_continuum(n, largest):
    law = Toughness(1.0, 1.0, n=n, calibration="continuum")
    assert law.ratios(FAMILY)[1] == pytest.approx(largest, rel=1e-7)
    assert (
        min(Toughness(largest * (1 - 1e-9), 1.0, n=n, calibration="continuum").constants(FAMILY))
        >= 0
    )
    with pytest.raises(ToughnessError, match=f"at most {largest:.4g}"):
        Toughness(1.01 * largest, 1.0, n=n, calibration="continuum").constants(FAMILY)


def test_the_refusal_names_the_smallest_exponent_that_does():
    law = Toughness(4.06, 1.0, n=8)
    best = law.smallest_exponent(FAMILY)
    with pytest.raises(ToughnessError, match=rf"at most 4\.026, not 4\.06; .* n = {best}$"):
        law.energies(FAMILY)
    assert Toughness(4.06, 1.0, n=best).energies(FAMILY).min() >= 0
    with pytest.raises(ToughnessError):
        Toughness(4.06, 1.0, n=best - 2).energies(FAMILY)


def test_a_ratio_out_of_reach_of_the_law_is_said_to_be():
    # four lobes along the axes: a diagonal cut meets √2 times as many at most
    with pytest.raises(ToughnessError, match=r"no exponent up to 512 does.* 0\.7071"):
        Toughness(1.0, 1.5, n=4, frequency=2).energies(FAMILY)
    with pytest.raises(ToughnessError, match=r"turned by 90° n = 6 does"):
        Toughness(0.3, 1.0, n=8).energies(FAMILY)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"G1": 0.0}, "G1 must be positive"),
        ({"G1": 1.0, "G2": float("nan")}, "G2 must be positive"),
        ({"G1": 1.0, "n": 3}, "even"),
        ({"G1": 1.0, "frequency": 0}, "frequency A"),
        ({"G1": 1.0, "axis": float("inf")}, "axis"),
        ({"G1": 1.0, "calibration": "exact"}, "unknown calibration"),
    ],
)
def test_bad_input_is_named(arguments, says):
    with pytest.raises(ToughnessError, match=says):
        Toughness(**arguments)


@pytest.mark.parametrize("m", [3, 5, 7])
def test_even_bonds_cost_the_same_and_level_the_cuts_along_rows(m):
    family = Family(m, 0.2)
    directions = np.linspace(0.0, np.pi, 361)
    spread = {}
    for calibration in ("lattice", "even"):
        law = Toughness(2.0, calibration=calibration)
        assert counted(family, law.energies(family), 1, 0) == pytest.approx(2.0, rel=1e-12)
        found = law.fracture_energy(directions, family)
        spread[calibration] = found.max() / found.min() - 1
    assert spread["even"] < 0.5 * spread["lattice"]


def test_even_bonds_cost_G_in_both_directions():
    law = Toughness(2.1, 1.0, n=8, axis=np.arctan2(1, 2), calibration="even")
    w = law.energies(FAMILY)
    assert w.min() >= 0
    assert counted(FAMILY, w, -1, 2) == pytest.approx(2.1, rel=1e-12)
    assert counted(FAMILY, w, 2, 1) == pytest.approx(1.0, rel=1e-12)


def test_evenness_by_hand():
    # Four neighbours: two directions, each with half of the angle and half of the mass. Eight:
    # four directions of 45° each, the diagonals √2 as long.
    np.testing.assert_allclose(evenness(Family(1, 0.5, "full")), 1.0, rtol=1e-14)
    eight = Family(np.sqrt(2), 0.5, "full")
    total = 2 + 2 * np.sqrt(2)
    wanted = np.where(
        np.abs(eight.offsets).sum(axis=1) == 1, 0.25 * total, 0.25 * total / np.sqrt(2)
    )
    np.testing.assert_allclose(evenness(eight), wanted, rtol=1e-14)


def test_the_influence_function_drops_out_of_the_criterion():
    # w_c before Λ: bonds near the horizon, where a conical Λ vanishes, need no infinite stretch.
    w = Toughness(2.0).energies(Family(5, 0.2, "partial", "conical"))
    assert np.ptp(w) == 0
    assert np.isfinite(w).all()
