"""What tips add to products, matrices, reactions and energies."""

import numpy as np

from solver.operators import TipStiffness
from solver.operators.assembled import to_csr
from tests.solver.problem.test_tips import cracked


def test_force_is_the_slope_of_the_energy():
    rng = np.random.default_rng(2)
    root = rng.normal(size=(6, 6))
    tip = TipStiffness(np.arange(2), root + root.T)
    values, other = rng.normal(size=(2, 3, 2))
    slope = tip.energy(values + 1e-5 * other) - tip.energy(values - 1e-5 * other)
    np.testing.assert_allclose(slope / 2e-5, (tip.force(values) * other).sum(), rtol=1e-7)


def test_product_and_matrix_agree_and_are_symmetric_and_positive():
    operator = cracked().discretise(constrained=True).operator
    assert len(operator.tips) == 2
    matrix = to_csr(operator)
    x = np.random.default_rng(3).normal(size=operator.shape[0])
    size = np.abs(matrix @ x).max()
    np.testing.assert_allclose(operator.matvec(x), matrix @ x, atol=1e-11 * size)
    assert abs(matrix - matrix.T).max() < 1e-12 * abs(matrix).max()
    np.linalg.cholesky(matrix.toarray())
