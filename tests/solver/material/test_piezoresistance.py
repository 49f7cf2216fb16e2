"""Piezoresistance: laws, lengths, moments; what cannot be is refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver import CalibrationError, ElectricConductivityTensor, Family, Piezoresistance, SceneError
from solver.material import bond_weights, calibrate
from solver.material.calibration import quartic_moments, quartic_target

few = settings(derandomize=True, deadline=None, max_examples=25)
ISOTROPIC = ElectricConductivityTensor.isotropic(2.0)


def fourth(family, moduli, material, gauge) -> np.ndarray:
    """½ Σ α Λ Δv k a n n n n."""
    weight = bond_weights(family, material) * moduli.conductivity
    return (weight * gauge * quartic_moments(family.angle)).sum(axis=1)


@few
@given(
    st.sampled_from(["continuum", "lattice", "positive"]),
    st.sampled_from(["partial", "full", "exact"]),
    st.sampled_from(["conductivity", "resistivity"]),
    st.sampled_from(["reference", "actual"]),
    st.floats(-8.0, 8.0),
    st.floats(0.0, 3.0),
    st.floats(2.5, 5.0),
)
def test_calibrated_slopes_have_the_moments_of_the_continuum(
    calibration, rule, law, length, gauge, angle, m
):
    """What a bond's factor does to first order, summed; opposite bonds agree."""
    material = ElectricConductivityTensor.of_resistivities(1.0, 2.5, angle)
    family = Family(m, 0.3, rule)
    moduli = calibrate(family, material, calibration)
    piezo = Piezoresistance(gauge, law, length)
    gauges = piezo.gauges(family, moduli, material)
    half = family.size // 2
    np.testing.assert_array_equal(gauges[:half], gauges[half:])
    step = 1e-6
    up, down = (piezo.factor(gauges, s, s) for s in (step, -step))
    slope = (up - down) / (2 * step)
    wanted = piezo.slope * quartic_target(family, material, None)
    size = np.linalg.norm(quartic_target(family, material, None)) * (2 + abs(gauge))
    assert np.abs(fourth(family, moduli, material, slope) - wanted).max() < 1e-8 * size


def test_an_isotropic_conductor_shows_three_quarters_and_one_quarter():
    target = quartic_target(Family(3, 0.2), ISOTROPIC, None) / 2.0
    np.testing.assert_allclose(target, [0.75, 0.0, 0.25, 0.0, 0.75], atol=1e-15)
    # With a uniform gauge the lattice's own sum is near it, and the traces are exact.
    family = Family(5)
    moduli = calibrate(family, ISOTROPIC)
    own = fourth(family, moduli, ISOTROPIC, Piezoresistance(1.0, moments="lattice").gauges(
        family, moduli, ISOTROPIC)) / 2.0  # fmt: skip
    assert own[0] == pytest.approx(0.7548, abs=1e-4)
    assert own[0] + own[2] == pytest.approx(1.0, rel=1e-12)


def test_laws_and_lengths_are_what_they_say():
    s, total = np.array([0.1, -0.05]), np.array([0.12, -0.05])
    change = 1 + 2 * s
    for law, wanted in (("conductivity", change), ("resistivity", 1 / change)):
        piezo = Piezoresistance(2.0, law)
        np.testing.assert_allclose(piezo.factor(2.0, s, total), wanted)
        longer = Piezoresistance(2.0, law, "actual")
        np.testing.assert_allclose(longer.factor(2.0, s, total), wanted / (1 + total) ** 2)
    assert Piezoresistance(3.0).slope == 3.0
    assert Piezoresistance(3.0, "resistivity", "actual").slope == -5.0


def test_where_the_law_ends():
    piezo = Piezoresistance(4.0)
    s = np.array([0.0, -0.24, -0.25, -0.3])
    assert piezo.wrong(4.0, s, s).tolist() == [False, False, True, True]
    shrunk = np.array([-0.5, -1.0])
    assert Piezoresistance(0.0, length="actual").wrong(0.0, shrunk, shrunk).tolist() == [
        False, True,
    ]  # fmt: skip


def test_what_is_no_law_is_refused():
    with pytest.raises(SceneError, match="finite number"):
        Piezoresistance(np.nan)
    with pytest.raises(SceneError, match="law of a piezoresistance must be one of conductivity"):
        Piezoresistance(1.0, "linear")
    small = Family(1.0, area_rule="full")
    with pytest.raises(CalibrationError, match="too few directions"):
        Piezoresistance(1.0).gauges(small, calibrate(small, ISOTROPIC), ISOTROPIC)
