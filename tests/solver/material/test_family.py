"""The family: sizes, area sums and symmetry of the offsets."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import Family
from solver.bonds.volume_method import full_volume
from tests.solver.bodies import exact

RULES = ["full", "partial", "exact"]


@pytest.mark.parametrize("spacing", [1.0, 0.1, 1 / 60, 1e-9, 3e5])
@pytest.mark.parametrize(
    # Lattice points in a disc (Gauss), without the centre; 5 has the 3-4-5 ties.
    ("m", "size"),
    [(1, 4), (2, 12), (3, 28), (4, 48), (5, 80), (10, 316)],
)
def test_full_families_have_gauss_counts_at_any_spacing(m, size, spacing):
    family = Family(m, spacing, "full")
    assert family.size == size
    np.testing.assert_array_equal(family.fraction, 1.0)


def test_rounded_horizons_do_not_lose_the_ties():
    assert Family(0.3 / 0.1, 0.1, "full").size == 28
    assert Family(5 * (1 - 1e-12), 1.0, "full").size == 80
    assert Family(5 * (1 - 1e-6), 1.0, "full").size < 80


@exact
@given(st.floats(1.0, 8.0))
def test_exact_fractions_sum_to_the_disc(m):
    family = Family(m, 0.37, "exact")
    assert full_volume(family) == pytest.approx(np.pi * m**2, rel=1e-12)
    # A second moment as well: ∫ over cells is not the midpoint, so only the bound by cells holds.
    assert family.fraction.max() <= 1 + 1e-14


@pytest.mark.parametrize("m", [1.0, 2.5, 3.0, 4.7])
def test_exact_fractions_against_quadrature(m):
    family = Family(m, 1.0, "exact")
    step = np.linspace(-0.5, 0.5, 4001)
    middle = 0.5 * (step[1:] + step[:-1])
    for (i, j), fraction in zip(family.offsets, family.fraction, strict=True):
        top = np.sqrt(np.maximum(m**2 - (i + middle) ** 2, 0.0))
        height = np.clip(np.minimum(top, j + 0.5) - np.maximum(-top, j - 0.5), 0.0, None)
        assert fraction == pytest.approx(height.mean(), abs=2e-5)


@exact
@given(st.floats(1.0, 8.0))
def test_partial_fractions_are_the_clipped_line(m):
    family = Family(m, 0.2, "partial")
    r = np.hypot(*family.offsets.T)
    np.testing.assert_allclose(family.fraction, np.clip(m + 0.5 - r, 0, 1), atol=1e-14)
    whole = [
        (i, j)
        for i in range(-10, 11)
        for j in range(-10, 11)
        if 0 < np.hypot(i, j) < m + 0.5 - 1e-9
    ]
    assert {tuple(o) for o in family.offsets.tolist()} == set(whole)


@exact
@given(st.floats(1.0, 6.0), st.sampled_from(RULES), st.sampled_from(["constant", "gaussian"]))
def test_offsets_are_mirrored_halves_with_the_square_s_symmetry(m, rule, function):
    family = Family(m, 0.1, rule, function)
    half = family.size // 2
    np.testing.assert_array_equal(family.offsets[half:], -family.offsets[:half])
    weight = {tuple(o): w for o, w in zip(family.offsets.tolist(), family.weight, strict=True)}
    assert len(weight) == family.size
    assert (0, 0) not in weight
    for (i, j), w in weight.items():
        for image in ((-j, i), (j, i), (i, -j)):
            assert weight[image] == pytest.approx(w, rel=1e-12)


def test_geometry():
    family = Family(3.5, 0.25, "partial", "conical")
    xi = family.offsets * 0.25
    np.testing.assert_allclose(family.length, np.linalg.norm(xi, axis=1), rtol=1e-15)
    np.testing.assert_allclose(family.length[:, None] * family.normal, xi, rtol=1e-14)
    cross = family.normal[:, 0] * family.tangent[:, 1] - family.normal[:, 1] * family.tangent[:, 0]
    np.testing.assert_allclose(cross, 1.0, rtol=1e-14)
    np.testing.assert_allclose(np.cos(family.angle), family.normal[:, 0], atol=1e-15)
    assert family.horizon == 0.875
    assert family.cell_area == 0.0625
    assert family.reach == np.abs(family.offsets).max()
    np.testing.assert_allclose(
        family.weight, family.fraction * (1 - family.length / family.horizon), rtol=1e-14
    )


def test_bonds_without_influence_are_left_out():
    # At r = m the conical Λ vanishes, and the partial rule's rim beyond it has none either.
    conical = Family(5, 1.0, "partial", "conical")
    assert np.hypot(*conical.offsets.T).max() < 5
    assert conical.size == 68  # 80 within 5 less the 12 on the circle (3-4-5 and the axes)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.5,), "at least one cell"),
        ((0.999999,), "at least one cell"),
        ((-3,), "at least one cell"),
        ((np.nan,), "at least one cell"),
        ((np.inf,), "at least one cell"),
        ((3, 0.0), "spacing"),
        ((3, -1.0), "spacing"),
        ((3, np.nan), "spacing"),
        ((3, 1.0, "half"), "area rule"),
        ((3, 1.0, "full", "cone"), "influence"),
    ],
)
def test_bad_families(arguments, message):
    with pytest.raises(ValueError, match=message):
        Family(*arguments)


def test_a_family_without_bonds_is_refused():
    # The conical Λ vanishes at the horizon: at m = 1 it leaves no neighbour.
    with pytest.raises(ValueError, match="no neighbour"):
        Family(1, 1.0, "full", "conical")
