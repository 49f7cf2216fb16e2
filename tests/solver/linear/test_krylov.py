"""Conjugate gradients against a direct solver; what is not positive is refused."""

import numpy as np
import pytest
from scipy.sparse.linalg import LinearOperator, aslinearoperator

from solver import ElasticTensor, NegativeCurvatureError, Scene, Support, rectangle
from solver.linear import krylov
from solver.linear.krylov import Task
from solver.linear.two_level import BlockJacobi
from solver.operators.assembled import to_csr

N = 30


def spd(seed: int) -> np.ndarray:
    a = np.random.default_rng(seed).normal(size=(N, N))
    return a @ a.T + N * np.eye(N)


def solve(matrix: np.ndarray, **task) -> tuple[np.ndarray, int]:
    rhs = np.arange(1.0, N + 1)
    settings = {"guess": np.zeros(N), "tolerance": 1e-12, "limit": 1000, **task}
    identity = aslinearoperator(np.eye(N))
    return krylov.conjugate_gradients(aslinearoperator(matrix), identity, Task(rhs, **settings))


def test_the_residual_is_the_true_one():
    matrix = spd(1)
    x, count = solve(matrix)
    rhs = np.arange(1.0, N + 1)
    assert np.linalg.norm(rhs - matrix @ x) <= 1e-12 * np.linalg.norm(rhs)
    assert 0 < count <= 2 * N


def test_a_good_guess_costs_nothing():
    matrix = spd(2)
    x, _ = solve(matrix)
    again, count = solve(matrix, guess=x)
    assert count == 0
    np.testing.assert_array_equal(again, x)


def test_the_limit_holds_over_restarts():
    _, count = solve(spd(3), limit=3)
    assert count == 3


def test_a_direction_of_negative_energy_is_refused():
    matrix = spd(4)
    matrix -= 2 * np.linalg.eigvalsh(matrix)[-1] * np.eye(N)
    with pytest.raises(NegativeCurvatureError, match="non-positive energy"):
        solve(matrix)


def test_condensed_gradients_solve_an_indefinite_body():
    operator = Scene(
        region=rectangle(1.0, 1.0),
        spacing=0.1,
        m=2,
        material=ElasticTensor.isotropic(1.0, 0.45),
        supports=[Support.where(lambda x, y: x < -0.3, displacement=(0.0, 0.0), rotation=0.0)],
    ).discretise().operator  # fmt: skip
    matrix = to_csr(operator).toarray()
    lowest = np.linalg.eigvalsh(matrix)[0]
    assert lowest < 0
    rhs = np.random.default_rng(5).normal(size=operator.shape[0])
    inverse: LinearOperator = BlockJacobi(operator.companion())
    task = Task(rhs, np.zeros_like(rhs), 1e-11, 2000)
    x, count = krylov.condensed_gradients(operator, inverse, task)
    assert 0 < count < 2000
    np.testing.assert_allclose(x, np.linalg.solve(matrix, rhs), atol=1e-9 * np.abs(x).max())


def test_an_answer_knows_its_residual_and_what_it_aimed_at():
    matrix, rhs = spd(5), np.arange(1.0, N + 1)
    identity, size = aslinearoperator(np.eye(N)), np.linalg.norm(rhs)
    counts = []
    for aim in (1e-4, 1.0):
        task = Task(rhs, np.zeros(N), 1e-4, 1000, aim=aim)
        found = krylov.positive_answer(aslinearoperator(matrix), identity, task)
        np.testing.assert_array_equal(found.residual, rhs - matrix @ found.x)
        assert np.linalg.norm(found.residual) <= 1e-4 * size
        counts.append(found.iterations)
    assert counts[1] < counts[0]
