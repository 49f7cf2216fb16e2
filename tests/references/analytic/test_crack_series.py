"""Crack eigenfunctions: equilibrium, free faces, and what the first orders are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from references.analytic.crack_series import crack_tip_term
from references.analytic.elasticity import acoustic_blocks
from references.analytic.lekhnitskii import crack_tip_displacement, crack_tip_gradient
from references.analytic.voigt import isotropic_voigt
from tests.references.analytic.tensors import random_voigt

few = settings(derandomize=True, deadline=None, max_examples=25)
orders = st.integers(-3, 7)


@few
@given(random_voigt(), st.floats(-3.1, 3.1))
def test_order_one_is_the_singular_field(voigt, w):
    x, y = np.cos(w), np.sin(w)
    both = crack_tip_term(voigt, x, y, 1)
    for field, mode in zip(both, ((1.0, 0.0), (0.0, 1.0)), strict=True):
        wanted = crack_tip_displacement(voigt, x, y, *mode)
        np.testing.assert_allclose(field, wanted, atol=1e-13 * np.abs(both).max())


@few
@given(random_voigt(), orders, st.floats(-2.9, 2.9))
def test_every_order_is_in_equilibrium(voigt, n, w):
    x, y, h = np.cos(w), np.sin(w), 2e-3
    q, r, t = acoustic_blocks(voigt)

    def u(i, j):
        return crack_tip_term(voigt, x + i * h, y + j * h, n)

    second = [
        -u(2, 0) + 16 * u(1, 0) - 30 * u(0, 0) + 16 * u(-1, 0) - u(-2, 0),
        -u(0, 2) + 16 * u(0, 1) - 30 * u(0, 0) + 16 * u(0, -1) - u(0, -2),
    ]
    weight = {-2: 1, -1: -8, 1: 8, 2: -1}
    mixed = sum(a * b * u(i, j) for i, a in weight.items() for j, b in weight.items())
    terms = [second[0] @ q.T / 12, mixed @ (r + r.T).T / 144, second[1] @ t.T / 12]
    scale = max(np.abs(term).max() for term in terms) + 1e-9
    assert np.abs(sum(terms)).max() < 1e-3 * scale


@few
@given(random_voigt(), orders, st.sampled_from([1.0, -1.0]))
def test_faces_are_free(voigt, n, side):
    """Tractions at a small distance from either face vanish beside the stresses there."""
    y = side * 1e-9
    g = gradient_near(voigt, n, y)
    strain = np.stack([g[:, 0, 0], g[:, 1, 1], g[:, 0, 1] + g[:, 1, 0]], axis=-1)
    stress = strain @ voigt
    scale = np.abs(g).max() * np.abs(voigt).max()
    assert np.abs(stress[:, 1:]).max() < 1e-6 * scale + 1e-10


def gradient_near(voigt, n, y):
    """Differences along the face, and one-sided ones away from it, all on its own side."""
    h, x = 1e-3, -0.8
    sign = np.sign(y)
    steps = np.arange(7)

    def one_sided(values):
        # derivative at the first of seven equidistant points, sixth order
        weights = np.array([-49 / 20, 6, -15 / 2, 20 / 3, -15 / 4, 6 / 5, -1 / 6])
        return np.tensordot(weights, values, 1) / h

    along = one_sided(np.array([crack_tip_term(voigt, x + k * h, y, n) for k in steps]))
    away = one_sided(np.array([crack_tip_term(voigt, x, y + sign * k * h, n) for k in steps]))
    return np.stack([along, sign * away], axis=-1)


@few
@given(random_voigt())
def test_low_orders_are_rigid_motions_and_a_stress_along_the_crack(voigt):
    w = np.linspace(-3, 3, 7)
    x, y = 0.7 * np.cos(w), 0.7 * np.sin(w)
    translations = crack_tip_term(voigt, x, y, 0)
    assert np.abs(translations - translations[:, :1]).max() < 1e-12 * np.abs(translations).max()
    assert abs(np.linalg.det(translations[:, 0])) > 0
    for field in crack_tip_term(voigt, x, y, 2):
        slope = np.linalg.lstsq(np.stack([x, y], 1), field, rcond=None)[0].T
        np.testing.assert_allclose(np.stack([x, y], 1) @ slope.T, field, atol=1e-10)
        strain = np.array([slope[0, 0], slope[1, 1], slope[0, 1] + slope[1, 0]])
        stress = voigt @ strain
        assert np.abs(stress[1:]).max() < 1e-9 * (np.abs(slope).max() * np.abs(voigt).max())


def test_the_order_below_is_the_derivative_along_the_crack():
    voigt = isotropic_voigt(1.0, 0.3)  # coincident roots
    x, y = 0.3, -0.4
    below = crack_tip_term(voigt, x, y, -1)
    for mode, field in zip(((1.0, 0.0), (0.0, 1.0)), below, strict=True):
        wanted = 2 * crack_tip_gradient(voigt, x, y, *mode)[:, 0]
        np.testing.assert_allclose(field, wanted, rtol=1e-13)


def test_bad_input_is_refused():
    voigt = isotropic_voigt(1.0, 0.3)
    with pytest.raises(ValueError, match="integer"):
        crack_tip_term(voigt, 1.0, 0.0, 0.5)
    with pytest.raises(ValueError, match="unbounded at the crack tip"):
        crack_tip_term(voigt, 0.0, 0.0, -1)
