"""The smoother is the polynomial that it is said to be, in either precision and any unit."""

import numpy as np
import pytest

from solver import Crack, ElasticTensor, Scene, Support, disc
from solver.linear import BlockJacobi
from solver.linear.smoother import Smoother, size_of
from solver.operators import BondOperator, kernels
from solver.operators.assembled import to_csr

VOIGT = np.array([[1, 0.2, 0.1], [0.2, 0.8, 1 / 6], [0.1, 1 / 6, 1 / 3]])
LARGEST = 2.3


def _operator(surface: str = "extrapolated", unit: float = 1.0) -> BondOperator:
    supports = [
        Support.where(lambda x, y: y < -0.6, u2=0.0),
        Support.where(lambda x, y: x < -0.6, u1=0.0),
    ]
    cracks = [Crack((-1.5, 0.0), (0.0, 0.0))]
    scene = Scene(
        disc(1.0), 0.1, ElasticTensor(unit * VOIGT), supports, m=3, cracks=cracks, surface=surface
    )
    return scene.discretise().operator


def _smoother(operator: BondOperator, degree: int, precision: type = np.float64) -> Smoother:
    jacobi = BlockJacobi(operator)
    return Smoother(operator, jacobi.bulk, jacobi.own, LARGEST, degree, precision)


def _swept(smoother: Smoother, residual: np.ndarray) -> np.ndarray:
    given = residual.reshape(smoother.x.shape)
    unit = size_of(given)
    smoother.start(given, unit)
    smoother.sweep()
    return smoother.answer(given, unit)


@pytest.mark.parametrize("surface", ["volume", "extrapolated"])
def test_a_sweep_is_the_chebyshev_polynomial(surface):
    operator = _operator(surface)
    free = ~operator.identity_rows.ravel()
    stiffness = to_csr(operator).toarray()
    jacobi = np.stack([BlockJacobi(operator).matvec(e) for e in np.eye(len(free))], axis=1)
    stiffness, jacobi = stiffness[np.ix_(free, free)], jacobi[np.ix_(free, free)]
    residual = np.where(free, np.random.default_rng(1).normal(size=len(free)), 0.0)
    for degree in (1, 2, 4):
        found = _swept(_smoother(operator, degree), residual)
        assert not found[~free].any()
        # What is left of a residual is T(z(1 − ...)) of the scaled operator: smallest possible
        # on the upper four fifths of its interval.
        centre, radius = 0.6 * LARGEST, 0.4 * LARGEST
        reduced = (centre * np.eye(free.sum()) - stiffness @ jacobi) / radius
        polynomial = [np.eye(len(reduced)), reduced]
        for _ in range(degree - 1):
            polynomial.append(2 * reduced @ polynomial[-1] - polynomial[-2])
        left = polynomial[degree] @ residual[free] / np.cosh(degree * np.arccosh(centre / radius))
        np.testing.assert_allclose(residual[free] - stiffness @ found[free], left, atol=1e-12)


def test_what_is_left_after_a_correction():
    operator = _operator()
    smoother, rng = _smoother(operator, 2), np.random.default_rng(2)
    residual = np.where(operator.identity_rows, 0.0, rng.normal(size=smoother.x.shape))
    unit = size_of(residual)
    smoother.start(residual, unit)
    smoother.sweep()
    first = smoother.answer(residual, unit)
    left = unit * smoother.leave()
    expected = residual.ravel() - operator.matvec(first)
    np.testing.assert_allclose(left.ravel(), expected, atol=1e-13)
    correction = rng.normal(size=smoother.x.shape)
    smoother.step[:] = correction
    smoother.correct()
    gained = smoother.answer(residual, unit) - first
    kept = np.where(operator.identity_rows, 0.0, correction) * unit / smoother.unit
    np.testing.assert_allclose(gained, kept.ravel(), atol=1e-13)


def test_single_precision_is_near_double_whatever_the_units():
    found = []
    for unit in (2.0**-90, 1.0, 2.0**40):
        operator = _operator(unit=unit)
        residual = np.random.default_rng(3).normal(size=operator.shape[0])
        double = _swept(_smoother(operator, 2), residual)
        single = _swept(_smoother(operator, 2, np.float32), residual)
        np.testing.assert_allclose(single, double, atol=1e-6 * np.abs(double).max())
        found.append(unit * single)
        # A power of two changes no digit.
        larger = _swept(_smoother(operator, 2, np.float32), 2.0**70 * residual)
        np.testing.assert_array_equal(larger, 2.0**70 * single)
    np.testing.assert_array_equal(found[0], found[1])
    np.testing.assert_array_equal(found[2], found[1])


def test_zeros_and_negligible_values():
    assert size_of(np.zeros((2, 3))) == 0.0
    assert size_of(np.array([0.0, -5.0])) == 4.0
    operator = _operator()
    out = np.ones((3, len(operator.active)), dtype=np.float32)
    values = np.full(out.shape, 1e-39)
    values[:, 0] = 3.0
    kernels.narrow(operator.segments, values, 2.0, out)
    assert (out[:, 0] == 1.5).all()
    assert not out[:, 1:].any()
