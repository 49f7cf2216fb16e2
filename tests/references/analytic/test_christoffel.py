"""Wave speeds: balance of a plane wave, isotropic values, symmetry."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from references.analytic import christoffel
from references.analytic.voigt import isotropic_voigt, turned_axes
from tests.references.analytic.tensors import random_voigt

quick = settings(deadline=None, max_examples=40, derandomize=True)


@quick
@given(random_voigt(), st.floats(-3.2, 3.2))
def test_plane_wave_balances(voigt, angle):
    """rho u,tt = div(stress) with stress = voigt @ strain, by the chain rule."""
    density = 2.3
    n = np.array([np.cos(angle), np.sin(angle)])
    speeds = christoffel.wave_speeds(voigt, density, angle)
    assert speeds[0] >= speeds[1] > 0
    for k in range(2):
        d = christoffel.polarisations(voigt, angle)[:, k]
        gradient = np.outer(d, n)
        stress = voigt @ [gradient[0, 0], gradient[1, 1], gradient[0, 1] + gradient[1, 0]]
        push = np.array([stress[0] * n[0] + stress[2] * n[1], stress[2] * n[0] + stress[1] * n[1]])
        assert np.abs(push - density * speeds[k] ** 2 * d).max() <= 1e-12 * np.abs(voigt).max()


@quick
@given(random_voigt(), st.floats(-3.2, 3.2), st.floats(-3.2, 3.2))
def test_speeds_turn_with_the_body(voigt, angle, turn):
    one = christoffel.wave_speeds(voigt, 1.0, angle)
    two = christoffel.wave_speeds(turned_axes(voigt, turn), 1.0, angle - turn)
    assert one == pytest.approx(two, rel=1e-9)


def test_isotropic_speeds():
    voigt = isotropic_voigt(70e9, 0.3, "strain")
    speeds = christoffel.wave_speeds(voigt, 2700.0, np.linspace(0, np.pi, 7))
    # sqrt((lambda + 2 mu)/rho) and sqrt(mu/rho).
    mu = 70e9 / 2.6
    lam = 70e9 * 0.3 / (1.3 * 0.4)
    assert speeds[:, 0] == pytest.approx(np.full(7, np.sqrt((lam + 2 * mu) / 2700)), rel=1e-12)
    assert speeds[:, 1] == pytest.approx(np.full(7, np.sqrt(mu / 2700)), rel=1e-12)


def test_one_per_cent_in_a_modulus_is_seen():
    voigt = isotropic_voigt(1.0, 0.3)
    off = voigt.copy()
    off[0, 0] *= 1.01
    ratio = christoffel.wave_speeds(off, 1.0, 0.0) / christoffel.wave_speeds(voigt, 1.0, 0.0)
    assert ratio[0] - 1 > 1e-3


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="density"):
        christoffel.wave_speeds(np.eye(3), 0.0, 0.0)
    with pytest.raises(ValueError, match="direction"):
        christoffel.wave_speeds(np.eye(3), 1.0, np.nan)
    with pytest.raises(ValueError, match="positive definite"):
        christoffel.wave_speeds([[1, 2, 0], [2, 1, 0], [0, 0, 1]], 1.0, 0.0)
