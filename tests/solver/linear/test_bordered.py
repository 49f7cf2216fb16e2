"""Bordered systems against the dense ones."""

import numpy as np
import pytest
from scipy.sparse.linalg import aslinearoperator

from solver.linear import Border, Bordered, BorderedInverse


@pytest.mark.parametrize("count", [0, 1, 3])
def test_the_preconditioner_of_an_exact_inverse_is_the_exact_inverse(count):
    rng = np.random.default_rng(count)
    root = rng.standard_normal((12 + count, 12 + count))
    whole = root @ root.T + np.eye(12 + count)
    K, W, D = whole[:12, :12], whole[:12, 12:], whole[12:, 12:]
    border = Border(W, D, np.zeros(count))
    operator = Bordered(aslinearoperator(K), border)
    inverse = BorderedInverse(aslinearoperator(np.linalg.inv(K)), border)
    eye = np.eye(12 + count)
    np.testing.assert_allclose(operator.matmat(eye), whole, atol=1e-12)
    np.testing.assert_allclose(inverse.matmat(operator.matmat(eye)), eye, atol=1e-8)
    # One that is only about right is still symmetric and positive.
    rough = BorderedInverse(aslinearoperator(np.diag(2.0 / np.diagonal(K))), border)
    matrix = rough.matmat(eye)
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-12)
    assert np.linalg.eigvalsh(matrix).min() > 0
