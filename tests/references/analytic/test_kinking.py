"""Kink angles: isotropic values, balance identity, symmetries, global maximum."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from references.analytic import kinking
from references.analytic.voigt import isotropic_voigt
from tests.references.analytic.tensors import random_voigt

SILICON = np.array([[141.1, 39.3, 0.0], [39.3, 141.1, 0.0], [0.0, 0.0, 79.6]])
quick = settings(deadline=None, max_examples=30, derandomize=True)
DENSE = np.linspace(-np.pi + 1e-6, np.pi - 1e-6, 40001)


def orthotropic(E1, E2, G12, nu12):
    return np.linalg.inv(
        np.array([[1 / E1, -nu12 / E1, 0], [-nu12 / E1, 1 / E2, 0], [0, 0, 1 / G12]])
    )


@pytest.mark.parametrize("nu", [-0.3, 0.2, 0.3, 0.45])
@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_isotropic_angles_solve_erdogan_and_sih(nu, plane):
    voigt = isotropic_voigt(3.0, nu, plane)
    for alpha in np.radians([-90, -60, -20, 15, 45, 70, 90]):
        KI, KII = np.cos(alpha), np.sin(alpha)
        # KI sin w + KII (3 cos w - 1) = 0, Erdogan and Sih (1963), on the side of -KII.
        expected = brentq(
            lambda w, KI=KI, KII=KII: KI * np.sin(w) + KII * (3 * np.cos(w) - 1),
            *sorted((0.0, -np.sign(alpha) * 1.4)),
            xtol=1e-14,
        )
        assert kinking.hoop_kink_angle(voigt, KI, KII) == pytest.approx(expected, abs=1e-9)
    # arccos(1/3) and 2 arctan(1/2), closed forms of the same equation.
    assert kinking.hoop_kink_angle(voigt, 0, 1) == pytest.approx(-np.arccos(1 / 3), abs=1e-9)
    assert kinking.hoop_kink_angle(voigt, 1, 1) == pytest.approx(-2 * np.arctan(0.5), abs=1e-9)
    assert kinking.hoop_kink_angle(voigt, 1, 0) == pytest.approx(0.0, abs=1e-9)


@quick
@given(random_voigt(0.03), st.floats(-1.57, 1.57))
def test_shear_factor_vanishes_and_maximum_is_global(voigt, alpha):
    KI, KII = np.cos(alpha), np.sin(alpha)
    angle = kinking.hoop_kink_angle(voigt, KI, KII)
    hoop, shear = kinking.hoop_factors(voigt, angle, KI, KII)
    assert abs(shear) <= 1e-9 * hoop
    everywhere = kinking.hoop_factors(voigt, DENSE, KI, KII)[0]
    assert hoop >= everywhere.max() * (1 - 1e-12)


@quick
@given(random_voigt(), st.floats(-1.5, 1.5))
def test_slope_of_the_hoop_factor_is_the_shear_factor(voigt, alpha):
    w, h = np.linspace(-2.9, 2.9, 15), 1e-3
    KI, KII = np.cos(alpha), np.sin(alpha)

    def hoop(d):
        return kinking.hoop_factors(voigt, w + d, KI, KII)[0]

    weights = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}
    slope = sum(c * (hoop(k * h) - hoop(-k * h)) for k, c in weights.items()) / h
    shear = kinking.hoop_factors(voigt, w, KI, KII)[1]
    assert np.abs(slope + 1.5 * shear).max() <= 1e-7 * (np.abs(shear).max() + np.abs(hoop(0)).max())


@quick
@given(random_voigt(), st.floats(-1.5, 1.5), st.floats(1e-6, 1e9))
def test_mirror_and_scale(voigt, alpha, scale):
    KI, KII = np.cos(alpha), np.sin(alpha)
    maxima = kinking.hoop_maxima(voigt, KI, KII)
    if len(maxima) > 1 and maxima[1].factor > 0.999 * maxima[0].factor:
        return  # two maxima about equal: rounding may pick either
    mirrored = voigt * np.array([[1, 1, -1], [1, 1, -1], [-1, -1, 1]])
    assert kinking.hoop_kink_angle(mirrored, KI, -KII) == pytest.approx(-maxima[0].angle, abs=1e-7)
    assert kinking.hoop_kink_angle(scale * voigt, scale * KI, scale * KII) == pytest.approx(
        maxima[0].angle, abs=1e-7
    )


def test_strongly_orthotropic_mode_one_leaves_the_crack_plane():
    """Stiff along the crack, the tip carries s11 = sqrt(E1/E2) s22 ahead: two equal maxima."""
    voigt = orthotropic(140.0, 10.0, 5.0, 0.3)
    maxima = kinking.hoop_maxima(voigt, 1.0, 0.0)
    assert maxima[0].angle == pytest.approx(-maxima[1].angle, abs=1e-9)
    assert maxima[0].angle > 0.5
    brute = kinking.hoop_factors(voigt, DENSE, 1.0, 0.0)[0]
    assert abs(DENSE[brute.argmax()]) == pytest.approx(maxima[0].angle, abs=2e-4)
    # Stiff across the crack it goes straight, and so does the tensor with E1 = E2.
    for straight in (orthotropic(10.0, 140.0, 5.0, 0.3 / 14), SILICON):
        assert kinking.hoop_kink_angle(straight, 1.0, 0.0) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("ratio", [1e2, 1e3, 1e4])
@pytest.mark.parametrize("turn", [0.0, 0.3, 1.0])
def test_sharp_peaks_of_stiff_fibres_are_found(ratio, turn):
    from references.analytic.voigt import turned_axes

    voigt = turned_axes(orthotropic(ratio, 1.0, 0.5, 0.3), -turn)
    for alpha in (-1.2, 0.0, 0.7):
        KI, KII = np.cos(alpha), np.sin(alpha)
        angle = kinking.hoop_kink_angle(voigt, KI, KII)
        hoop = kinking.hoop_factors(voigt, angle, KI, KII)[0]
        fine = np.linspace(-np.pi + 1e-7, np.pi - 1e-7, 400001)
        assert hoop >= kinking.hoop_factors(voigt, fine, KI, KII)[0].max() * (1 - 1e-9)


def test_one_per_cent_in_a_modulus_moves_the_angle():
    right = kinking.hoop_kink_angle(SILICON, 1.0, 1.0)
    off = SILICON.copy()
    off[2, 2] *= 1.01
    assert abs(kinking.hoop_kink_angle(off, 1.0, 1.0) - right) > 1e-4


def test_negative_opening_factor_still_has_a_direction():
    angle = kinking.hoop_kink_angle(isotropic_voigt(1.0, 0.3), -0.2, 1.0)
    assert -np.pi < angle < -np.arccos(1 / 3)


def test_bad_input_is_refused():
    voigt = isotropic_voigt(1.0, 0.3)
    with pytest.raises(ValueError, match="without load"):
        kinking.hoop_kink_angle(voigt, 0.0, 0.0)
    with pytest.raises(ValueError, match="closed"):
        kinking.hoop_kink_angle(voigt, -1.0, 0.0)
    with pytest.raises(ValueError, match="not finite"):
        kinking.hoop_kink_angle(voigt, np.nan, 0.0)
    with pytest.raises(ValueError, match="between -pi and pi"):
        kinking.hoop_factors(voigt, 3.5, 1.0, 0.0)
    with pytest.raises(ValueError, match="positive definite"):
        kinking.hoop_kink_angle([[1, 2, 0], [2, 1, 0], [0, 0, 1]], 1.0, 0.0)
