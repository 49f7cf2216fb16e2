"""Cuts along every direction of bonds cost what is asked for, and no less can be had in between."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog

from solver import Family, Toughness
from solver.fracture.directions import directions, least_variation, levelled
from tests.solver.bodies import exact

FAMILIES = [Family(m, 0.2, rule) for m in (2, 3, 5, 7) for rule in ("partial", "full")]


def cost(family, critical, cut):
    """Of cuts along `cut`, from the definition."""
    half = family.size // 2
    normal = np.stack([-np.sin(cut), np.cos(cut)], axis=-1)
    met = np.abs(normal @ (family.length[:, None] * family.normal)[:half].T)
    return met @ (critical * family.weight)[:half] * family.cell_area


@pytest.mark.parametrize("family", FAMILIES)
def test_isotropic_cuts_cost_the_same_and_vary_by_what_no_energies_avoid(family):
    law = Toughness(2.0, calibration="directions")
    w = law.energies(family)
    assert w.min() > 0
    angle, _ = directions(family)
    np.testing.assert_allclose(law.fracture_energy(angle, family), 2.0, rtol=1e-12)
    middles = angle + 0.5 * np.diff(angle, append=angle[0] + np.pi)
    between = law.fracture_energy(middles, family)
    assert between.max() / 2.0 - 1 == pytest.approx(least_variation(family), rel=1e-9)


@pytest.mark.parametrize("m", [3, 5])
def test_no_energies_vary_less(m):
    # A linear programme over all non-negative energies: the smallest spread of G at many cuts.
    family = Family(m, 0.2)
    angle, _ = directions(family)
    middles = angle + 0.5 * np.diff(angle, append=angle[0] + np.pi)
    matrix = np.abs(np.sin(np.concatenate([angle, middles])[:, None] - angle))
    ones = np.ones((len(matrix), 1))
    found = linprog(
        np.append(np.zeros(len(angle)), 1.0),
        A_ub=np.block([[matrix, -ones], [-matrix, 0 * ones]]),
        b_ub=np.append(np.zeros(len(matrix)), -np.ones(len(matrix))),
    )
    assert found.fun - 1 == pytest.approx(least_variation(family), rel=1e-6)


@exact
@given(
    st.sampled_from([3, 5]), st.floats(0.0, np.pi), st.floats(0.7, 1.8), st.sampled_from([2, 4, 8])
)
def test_prescribed_costs_are_met_where_a_cut_can_vary_that_fast(m, axis, ratio, n):
    family = Family(m, 0.3)
    law = Toughness(ratio, 1.0, n=n, axis=axis, calibration="directions")
    w = law.energies(family)
    assert w.min() > 0
    np.testing.assert_allclose(w[: family.size // 2], w[family.size // 2 :])
    angle, _ = directions(family)
    asked, found = law.fracture_energy(angle), cost(family, w, angle)
    np.testing.assert_allclose(law.fracture_energy(angle, family), found, rtol=1e-12)
    # The law's own energies are non-negative, so that only the smallest ones give way.
    np.testing.assert_allclose(found, asked, rtol=2e-3)


def test_costs_that_vary_faster_than_any_cut_are_approached():
    family = Family(5, 0.2)
    angle, _ = directions(family)

    def notched(cut):
        return 1.0 + 0.5 * np.cos(8 * cut)

    w = levelled(family, notched)
    assert w.min() > 0
    assert np.abs(cost(family, w, angle) / notched(angle) - 1).max() > 0.01


def test_bonds_that_hold_nothing_do_no_harm():
    family = Family(5, 0.2, "partial", "conical")
    law = Toughness(2.0, calibration="directions")
    w = law.energies(family)
    assert np.isfinite(w).all()
    assert w.min() > 0
    assert law.fracture_energy(0.0, family) == pytest.approx(2.0, rel=1e-9)
