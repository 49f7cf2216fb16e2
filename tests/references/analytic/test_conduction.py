"""Anisotropic heat fields: balance, flux and derivatives for any conductivity."""

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from references.analytic import conduction as heat
from tests.references.analytic.tensors import random_conductivity

quick = settings(deadline=None, max_examples=40, derandomize=True)
X, Y = np.meshgrid(np.linspace(-1, 1, 5), np.linspace(-0.9, 1.1, 5))
H = 1e-3


def central(function):
    """Sixth-order central difference at zero."""
    weights = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    return sum(w * (function(k * H) - function(-k * H)) for k, w in weights.items()) / H


def numeric_gradient(function):
    by_x, by_y = central(lambda d: function(X + d, Y)), central(lambda d: function(X, Y + d))
    return np.stack([by_x, by_y], axis=-1)


def check_field(field, tolerance=1e-9):
    """Gradient and hessian against differences, flux and source against their definitions."""
    gradient, hessian = field.gradient(X, Y), field.hessian(X, Y)
    size = np.abs(gradient).max() + np.abs(field.value(X, Y)).max()
    assert np.abs(numeric_gradient(field.value) - gradient).max() <= tolerance * size
    second = numeric_gradient(field.gradient)
    expected = np.stack([second[..., 0, 0], second[..., 1, 1], second[..., 0, 1]], axis=-1)
    assert np.abs(expected - hessian).max() <= tolerance * (size + np.abs(hessian).max())
    flux = -np.einsum("ij,...j", field.conductivity, gradient)
    assert field.flux(X, Y) == pytest.approx(flux, rel=1e-13, abs=1e-13)
    divergence = numeric_gradient(field.flux)
    balance = divergence[..., 0, 0] + divergence[..., 1, 1] - field.source(X, Y)
    assert np.abs(balance).max() <= tolerance * (size + np.abs(divergence).max())


def relative_source(field):
    d = np.abs(field.conductivity).max()
    return np.abs(field.source(X, Y)).max() / (d * np.abs(field.hessian(X, Y)).max())


@quick
@given(random_conductivity(), st.integers(0, 9))
def test_polynomials_of_any_degree_are_source_free(conductivity, degree):
    fields = heat.harmonic_polynomials(conductivity, degree)
    assert len(fields) == (1 if degree == 0 else 2)
    for field in fields:
        check_field(field, 1e-8)
        if degree >= 2:
            assert relative_source(field) <= 1e-12


@quick
@given(random_conductivity(), st.floats(-2, 2), st.floats(-2, 2))
def test_exponentials_are_source_free(conductivity, a, b):
    field = heat.harmonic_exponential(conductivity, 0.3 * complex(a, b) + 0.1, 1.0 - 0.4j)
    check_field(field, 1e-8)
    assert relative_source(field) <= 1e-12


def test_an_exponential_off_the_harmonic_direction_reports_its_source():
    field = heat.Exponential(np.eye(2), 0.3, 0.2)
    assert field.source(X, Y) == pytest.approx(-(0.09 + 0.04) * field.value(X, Y), rel=1e-13)
    check_field(field)


def test_the_disc_fields_by_symbols():
    """div(D grad T), exactly, for the three fields of the disc problem."""
    x, y = sympy.symbols("x y", real=True)

    def residual(t):
        return sympy.simplify(
            5 * sympy.diff(t, x, 2) + 4 * sympy.diff(t, x, y) + sympy.diff(t, y, 2)
        )

    cubic = x**3 / 5 - x**2 * y + x * y**2
    fields = [
        (heat.disc_cubic(), cubic + y**3 / 3, sympy.Integer(0)),
        (heat.disc_cubic_printed(), cubic + y**3 / 5, -sympy.Rational(4, 5) * y),
        (heat.disc_exponential(), sympy.exp(x - 2 * y) * sympy.cos(y), sympy.Integer(0)),
    ]
    for field, symbolic, expected in fields:
        assert sympy.simplify(residual(symbolic) - expected) == 0
        values = sympy.lambdify((x, y), symbolic)(X, Y)
        assert field.value(X, Y) == pytest.approx(values, rel=1e-13, abs=1e-14)
        sources = -sympy.lambdify((x, y), expected)(X, Y) + 0 * X
        assert field.source(X, Y) == pytest.approx(sources, abs=1e-12)
        check_field(field)


@quick
@given(random_conductivity())
def test_steady_source_carries_its_power(conductivity):
    field = heat.PointSource(conductivity, power=2.5, position=(0.1, -0.2))
    angle = 2 * np.pi * np.arange(400) / 400
    # An ellipse of D, on which the integrand is smooth whatever the anisotropy.
    root = np.linalg.cholesky(conductivity)
    circle = np.stack([np.cos(angle), np.sin(angle)])
    x, y = root @ circle + np.array([[0.1], [-0.2]])
    tangent = root @ np.stack([-np.sin(angle), np.cos(angle)])
    normal = np.stack([tangent[1], -tangent[0]], axis=-1)
    power = np.sum(field.flux(x, y) * normal) * 2 * np.pi / 400
    assert power == pytest.approx(2.5, rel=1e-12)
    scale = np.abs(conductivity).max() * np.abs(field.hessian(x, y)).max()
    assert np.abs(field.source(x, y)).max() <= 1e-12 * scale


@quick
@given(random_conductivity())
def test_instantaneous_source_conserves_heat_and_diffuses(conductivity):
    source = heat.InstantaneousSource(conductivity, heat=3.0, capacity=1.7, position=(0.2, 0.1))
    t = 0.9
    # Gauss-Hermite in the axes in which the bell is round.
    node, weight = np.polynomial.hermite.hermgauss(20)
    root = np.linalg.cholesky(conductivity) * np.sqrt(4 * t / 1.7)
    a, b = np.meshgrid(node, node)
    x = 0.2 + root[0, 0] * a
    y = 0.1 + root[1, 0] * a + root[1, 1] * b
    bell = source.value(x, y, t) * np.exp(a**2 + b**2)
    total = 1.7 * np.sum(np.outer(weight, weight) * bell) * np.linalg.det(root)
    assert total == pytest.approx(3.0, rel=1e-12)

    points = (x[8:12, 8:12], y[8:12, 8:12])
    size = np.sqrt(conductivity.min() ** 2 + np.linalg.eigvalsh(conductivity)[0])
    step = 2e-2 * min(size, 1.0)

    def difference(function):
        weights = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}
        return (
            sum(w * (function(k * step) - function(-k * step)) for k, w in weights.items()) / step
        )

    qx = difference(lambda d: source.flux(points[0] + d, points[1], t)[..., 0])
    qy = difference(lambda d: source.flux(points[0], points[1] + d, t)[..., 1])
    rate = 1.7 * source.rate(*points, t)
    assert np.abs(rate + qx + qy).max() <= 1e-7 * (np.abs(qx).max() + np.abs(qy).max())
    assert np.all(source.source(*points, t) == 0.0)


def test_harmonic_direction_of_the_disc():
    # lam^2 + 4 lam + 5 = 0 for D = [[5, 2], [2, 1]].
    assert heat.harmonic_direction(heat.DISC_CONDUCTIVITY) == pytest.approx(-2 + 1j, rel=1e-15)


def test_one_per_cent_in_the_conductivity_is_seen():
    off = np.array(heat.DISC_CONDUCTIVITY)
    off[0, 0] *= 1.01
    assert relative_source(heat.Polynomial(off, heat.disc_cubic().coefficients)) > 1e-3


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="positive definite"):
        heat.harmonic_exponential([[1, 2], [2, 1]])
    with pytest.raises(ValueError, match="NaN"):
        heat.harmonic_direction([[1, np.nan], [0, 1]])
    with pytest.raises(ValueError, match="symmetric"):
        heat.harmonic_direction([[1, 0.2], [0.1, 1]])
    with pytest.raises(ValueError, match="2x2"):
        heat.harmonic_direction(np.eye(3))
    with pytest.raises(ValueError, match="degree"):
        heat.harmonic_polynomials(np.eye(2), -1)
    with pytest.raises(ValueError, match="t > 0"):
        heat.InstantaneousSource(np.eye(2)).value(0.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="capacity"):
        heat.InstantaneousSource(np.eye(2), capacity=0.0)
    with pytest.raises(ValueError, match="point source"):
        heat.PointSource(np.eye(2)).value(0.0, 0.0)
    with pytest.raises(ValueError, match="coordinate"):
        heat.disc_cubic().value(np.nan, 0.0)
