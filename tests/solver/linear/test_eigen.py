"""Eigenpairs against dense solvers, and the proofs of completeness seen to fail."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import sparse
from scipy.linalg import eigh, null_space
from scipy.sparse.linalg import LinearOperator, aslinearoperator

from solver import NegativeCurvatureError
from solver.linear import eigen
from tests.solver.bodies import exact


def laplacian(n: int, ends: float = 0.0):
    """Second differences on a square n × n, free (with one null vector) or held."""
    line = sparse.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n)).tolil()
    line[0, 0] = line[-1, -1] = 1.0 + ends
    one = sparse.eye_array(n)
    return sparse.csr_array(sparse.kron(line, one) + sparse.kron(one, line))


def pencil(matrix, mass=None, rigid=None):
    """With a diagonal preconditioner."""
    size = matrix.shape[0]
    diagonal = np.abs(matrix.diagonal())
    return eigen.Pencil(
        aslinearoperator(matrix),
        np.ones(size) if mass is None else mass,
        LinearOperator(matrix.shape, matvec=lambda r: r.ravel() / diagonal, dtype=float),
        np.zeros((size, 0)) if rigid is None else rigid,
        4.0,
    )


@pytest.fixture(scope="module")
def square():
    """A free square: pairs of double eigenvalues, one null vector."""
    matrix = laplacian(20)
    return pencil(matrix, rigid=np.ones((400, 1))), np.linalg.eigvalsh(matrix.toarray())


def test_multiple_values_come_with_all_their_copies(square):
    found = eigen.lowest(square[0], 12, 1e-8)
    assert found.values[:12] == pytest.approx(square[1][1:13], rel=1e-10)
    assert (found.residuals[:12] <= 1e-8).all()
    vectors = found.vectors[:, :12]
    assert vectors.T @ vectors == pytest.approx(np.eye(12), abs=1e-7)
    assert not eigen.missing(square[0], found, 12)[0].shape[1]


def test_a_search_says_how_far_it_is_and_finds_the_same(square):
    told: list[float] = []
    found = eigen.lowest(square[0], 12, 1e-8, progress=told.append)
    np.testing.assert_array_equal(found.values, eigen.lowest(square[0], 12, 1e-8).values)
    assert len(told) > 10
    # What convergence promises comes to about the whole.
    assert 0.0 < told[0] < 0.2
    assert 0.6 < told[-1] < 1.0


@pytest.mark.parametrize("lost", [0, 1, 5])
def test_a_lost_copy_is_noticed(square, lost):
    found = eigen.lowest(square[0], 8, 1e-8)
    kept = [k for k in range(len(found.values)) if k != lost]
    fewer = eigen.Eigenpairs(found.values[kept], found.vectors[:, kept], found.residuals[kept], 0)
    more, _ = eigen.missing(square[0], fewer, 7)
    assert more.shape[1]
    again = eigen.lowest(square[0], 7, 1e-8, np.column_stack([fewer.vectors[:, :7], more[:, :1]]))
    assert again.values[:7] == pytest.approx(square[1][1:8], rel=1e-9)


@exact
@given(st.integers(0, 2**32 - 1), st.integers(1, 6), st.floats(-1.0, 4.0))
def test_inertia_counts_values_below(seed, massless, shift):
    """Whatever the signs of the massless block."""
    random = np.random.default_rng(seed)
    a = random.standard_normal((12, 12))
    a = a + a.T + np.diag(random.choice([-6.0, 6.0], 12))
    mass = np.r_[np.zeros(massless), random.uniform(0.5, 2.0, 12 - massless)]
    values, vectors = eigen.dense(sparse.csr_array(a), mass)
    assert eigen.below(sparse.csr_array(a), mass, shift) == (values < shift).sum()
    left = a @ vectors - (mass[:, None] * vectors) * values
    assert np.abs(left).max() < 1e-8 * max(1.0, np.abs(vectors).max()) * np.abs(values).max()


@exact
@given(st.integers(0, 2**32 - 1))
def test_dense_condenses_as_the_projection_does(seed):
    """Against the pencil on the null space of the massless rows."""
    random = np.random.default_rng(seed)
    a = random.standard_normal((9, 9))
    a = a @ a.T + np.eye(9)
    mass = np.r_[np.zeros(3), random.uniform(0.5, 2.0, 6)]
    basis = null_space(a[:3])
    wanted = eigh(basis.T @ a @ basis, basis.T @ (mass[:, None] * basis), eigvals_only=True)
    assert eigen.dense(sparse.csr_array(a), mass)[0] == pytest.approx(wanted, rel=1e-9)


def test_massless_unknowns_follow():
    """The lowest pairs of a chain on a square, half of whose points carry no mass."""
    matrix = laplacian(16, ends=1.0)
    mass = np.where(np.arange(256) % 2, 1.0, 0.0)
    found = eigen.lowest(pencil(matrix, mass), 5, 1e-8)
    assert found.values[:5] == pytest.approx(eigen.dense(matrix, mass)[0][:5], rel=1e-10)


def test_negative_curvature_is_noticed_and_only_that(square):
    eigen.definite(square[0])
    weak = laplacian(20).tolil()
    # One bond out of 760 pushes more than its neighbours pull.
    for i, j in ((210, 211), (211, 210)):
        weak[i, j] += 4.0
        weak[i, i] -= 4.0
    matrix = weak.tocsr()
    assert np.linalg.eigvalsh(matrix.toarray())[0] < 0
    positive = pencil(laplacian(20), rigid=np.ones((400, 1)))
    unstable = eigen.Pencil(
        aslinearoperator(matrix), positive.mass, positive.preconditioner, positive.rigid, 4.0
    )
    with pytest.raises(NegativeCurvatureError):
        eigen.definite(unstable)
