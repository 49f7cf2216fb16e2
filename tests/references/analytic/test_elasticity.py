"""Polynomial equilibrium fields: balance, Hooke's law and completeness for any tensor."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from references.analytic import elasticity
from references.analytic.voigt import isotropic_voigt
from tests.references.analytic.tensors import random_voigt

quick = settings(deadline=None, max_examples=40, derandomize=True)
X, Y = np.meshgrid(np.linspace(-1, 1, 4), np.linspace(-0.9, 1.1, 4))


def difference_gradient(function, h=1e-2):
    """Eighth-order differences: exact, up to rounding, on polynomials of degree eight or less."""
    weights = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}

    def along(dx, dy):
        terms = [
            w
            * (function(X + k * h * dx, Y + k * h * dy) - function(X - k * h * dx, Y - k * h * dy))
            for k, w in weights.items()
        ]
        return sum(terms) / h

    return np.stack([along(1, 0), along(0, 1)], axis=-1)


@quick
@given(random_voigt(), st.integers(0, 8))
def test_fields_are_in_equilibrium(voigt, degree):
    fields = elasticity.equilibrium_polynomials(voigt, degree)
    assert len(fields) == (2 if degree == 0 else 4)
    flat = np.array([f.coefficients.ravel() for f in fields])
    assert np.linalg.matrix_rank(flat) == len(fields)
    for f in fields:
        size = np.abs(voigt).max() * max(degree, 1) ** 2
        assert np.abs(f.body_force(X, Y)).max() <= 1e-11 * size * 2**degree
        # The same by differences of the stress, which shares no code with body_force.
        d = difference_gradient(f.stress)
        residual = np.stack([d[..., 0, 0] + d[..., 2, 1], d[..., 2, 0] + d[..., 1, 1]])
        assert np.abs(residual).max() <= 1e-9 * size * 2**degree


@quick
@given(random_voigt(), st.integers(1, 6))
def test_gradient_rotation_and_stress_belong_to_the_displacement(voigt, degree):
    for f in elasticity.equilibrium_polynomials(voigt, degree):
        g = f.gradient(X, Y)
        assert np.abs(difference_gradient(f.displacement) - g).max() <= 1e-10 * 2**degree
        assert f.rotation(X, Y) == pytest.approx(0.5 * (g[..., 1, 0] - g[..., 0, 1]), abs=1e-14)
        strain = np.stack([g[..., 0, 0], g[..., 1, 1], g[..., 0, 1] + g[..., 1, 0]], axis=-1)
        assert (
            np.abs(f.stress(X, Y) - strain @ voigt).max() <= 1e-12 * np.abs(voigt).max() * 2**degree
        )


def test_degree_one_holds_every_gradient():
    fields = elasticity.equilibrium_polynomials(isotropic_voigt(1.0, 0.3), 1)
    gradients = np.array([f.gradient(0.0, 0.0).ravel() for f in fields])
    assert np.linalg.matrix_rank(gradients) == 4


def test_isotropic_quadratics_hold_the_pure_bending_field():
    """u1 = x y, u2 = -(x^2 + nu y^2)/2: plane-stress bending (Timoshenko and Goodier, art. 20)."""
    nu = 0.3
    fields = elasticity.equilibrium_polynomials(isotropic_voigt(1.0, nu), 2)
    bending = np.zeros((2, 3, 3))
    bending[0, 1, 1], bending[1, 2, 0], bending[1, 0, 2] = 1.0, -0.5, -0.5 * nu
    flat = np.array([f.coefficients.ravel() for f in fields]).T
    weights, *_ = np.linalg.lstsq(flat, bending.ravel(), rcond=None)
    assert np.abs(flat @ weights - bending.ravel()).max() <= 1e-14
    stress = elasticity.combine(fields, list(weights)).stress(X, Y)
    assert stress[..., 0] == pytest.approx(Y, abs=1e-13)
    assert np.abs(stress[..., 1:]).max() <= 1e-13


@quick
@given(random_voigt())
def test_combining_degrees_stays_in_equilibrium(voigt):
    fields = [f for n in (1, 2, 3) for f in elasticity.equilibrium_polynomials(voigt, n)]
    weights = list(np.linspace(-1, 1, len(fields)))
    total = elasticity.combine(fields, weights)
    expected = sum(w * f.displacement(X, Y) for w, f in zip(weights, fields, strict=True))
    assert total.displacement(X, Y) == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert np.abs(total.body_force(X, Y)).max() <= 1e-10 * np.abs(voigt).max()


def test_one_per_cent_in_a_modulus_breaks_equilibrium():
    voigt = isotropic_voigt(1.0, 0.3)
    field = elasticity.equilibrium_polynomials(voigt, 3)[0]
    wrong = voigt.copy()
    wrong[0, 0] *= 1.01
    off = elasticity.PolynomialDisplacement(wrong, field.coefficients)
    assert np.abs(off.body_force(X, Y)).max() > 1e-3


def test_a_field_out_of_equilibrium_reports_its_body_force():
    coefficients = np.zeros((2, 3, 3))
    coefficients[0, 2, 0] = 1.0  # u1 = x^2: s11,1 = 2 C11
    field = elasticity.PolynomialDisplacement(isotropic_voigt(1.0, 0.0), coefficients)
    assert field.body_force(0.3, 0.2) == pytest.approx([-2.0, 0.0], abs=1e-14)


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="positive definite"):
        elasticity.equilibrium_polynomials([[1, 2, 0], [2, 1, 0], [0, 0, 1]], 2)
    with pytest.raises(ValueError, match="degree"):
        elasticity.equilibrium_polynomials(np.eye(3), -1)
    with pytest.raises(ValueError, match="coefficients"):
        elasticity.PolynomialDisplacement(np.eye(3), np.zeros((3, 2, 2)))
    one = elasticity.equilibrium_polynomials(np.eye(3), 1)[0]
    two = elasticity.equilibrium_polynomials(2 * np.eye(3), 1)[0]
    with pytest.raises(ValueError, match="different tensors"):
        elasticity.combine([one, two], [1.0, 1.0])
    with pytest.raises(ValueError, match="weight"):
        elasticity.combine([one], [1.0, 2.0])
