"""Two collinear cracks: limits, equilibrium, and tension across them far away."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from references.analytic.crack_pair import displacement_and_rotation, intensities
from references.analytic.elasticity import acoustic_blocks
from references.analytic.voigt import isotropic_voigt

few = settings(derandomize=True, deadline=None, max_examples=25)
YOUNG, POISSON = 3.0, 0.2
ratios = st.floats(0.02, 0.95)


def field(x, y, inner=0.3):
    return displacement_and_rotation(x, y, inner, 1.0, 0.7, YOUNG, POISSON)


def test_near_and_far_cracks_are_one_and_single_ones():
    single = np.sqrt(np.pi)
    assert intensities(1e-12, 1.0)[1] == pytest.approx(single, rel=0.05)
    assert intensities(1e-60, 1.0)[1] == pytest.approx(single, rel=0.01)
    inner, outer = intensities(99.0, 101.0)
    assert inner == pytest.approx(single, rel=1e-4)
    assert outer == pytest.approx(single, rel=1e-4)


@few
@given(ratios, st.floats(0.1, 10.0))
def test_inner_tips_bear_more_and_factors_scale(ratio, size):
    inner, outer = intensities(ratio, 1.0)
    assert inner > outer > 0
    np.testing.assert_allclose(
        intensities(ratio * size, size, 2.0), 2.0 * np.sqrt(size) * np.array([inner, outer])
    )


@few
@given(st.floats(0.02, 0.8), st.floats(1.3, 2.0), st.floats(-3.1, 3.1))
def test_displacements_are_in_equilibrium(ratio, r, w):
    # Near enough for the field to stand out from the uniform one and its rounding.
    x, y, h = r * np.cos(w), r * np.sin(w), 4e-3
    q, s, t = acoustic_blocks(isotropic_voigt(YOUNG, POISSON))

    def u(i, j):
        return field(x + i * h, y + j * h, ratio)[0]

    xx = -u(2, 0) + 16 * u(1, 0) - 30 * u(0, 0) + 16 * u(-1, 0) - u(-2, 0)
    yy = -u(0, 2) + 16 * u(0, 1) - 30 * u(0, 0) + 16 * u(0, -1) - u(0, -2)
    xy = 3 * (u(1, 1) - u(1, -1) - u(-1, 1) + u(-1, -1))
    parts = np.array([q @ xx, (s + s.T) @ xy, t @ yy]) / (12 * h**2)
    # The mixed difference is of second order only.
    assert np.abs(parts.sum(axis=0)).max() < 5e-3 * np.abs(parts).max() + 1e-6


@few
@given(ratios, st.floats(1.3, 4.0), st.floats(-3.1, 3.1))
def test_the_rotation_is_that_of_the_displacement(ratio, r, w):
    x, y, h = r * np.cos(w), r * np.sin(w), 1e-4
    across = (field(x + h, y, ratio)[0] - field(x - h, y, ratio)[0])[1]
    up = (field(x, y + h, ratio)[0] - field(x, y - h, ratio)[0])[0]
    assert (across - up) / (4 * h) == pytest.approx(field(x, y, ratio)[1], abs=1e-6)


def test_far_away_there_is_tension_across_the_cracks():
    far = 1e4
    (u1, _), _ = field(far, 0.0)
    (_, u2), _ = field(0.0, far)
    assert u1 / far == pytest.approx(-POISSON * 0.7 / YOUNG, rel=1e-6)
    assert u2 / far == pytest.approx(0.7 / YOUNG, rel=1e-6)


def test_what_cannot_be_answered_is_refused():
    with pytest.raises(ValueError, match="inner"):
        intensities(1.0, 0.5)
    with pytest.raises(ValueError, match="circle"):
        field(0.5, 0.1)
