"""The rule is exact for polynomials of degree 2 n − 1, and nobody can spoil the kept one."""

import numpy as np
import pytest

from references.analytic.quadrature import gauss


@pytest.mark.parametrize("points", [1, 3, 8])
def test_polynomials_of_degree_two_n_less_one_are_exact(points):
    x, weight = gauss(points)
    for power in range(2 * points):
        assert (weight * x**power).sum() == pytest.approx((1 + (-1) ** power) / (power + 1))
    assert abs((weight * x ** (2 * points)).sum() - 2 / (2 * points + 1)) > 1e-9


def test_the_kept_arrays_are_read_only():
    x, _ = gauss(4)
    with pytest.raises(ValueError, match="read-only"):
        x[0] = 0.0
    np.testing.assert_array_equal(gauss(4)[0], np.polynomial.legendre.leggauss(4)[0])
