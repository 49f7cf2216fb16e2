"""Half of a form is as good as the whole."""

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from solver.operators.halves import Halves, _forward

CHAIN = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0}


def _chain(size: int, seed: int) -> sparse.csc_array:
    rng = np.random.default_rng(seed)
    bands = [rng.uniform(-1.0, 1.0, size=size - k) for k in (1, 2)]
    matrix = sparse.diags_array(bands, offsets=[1, 2], shape=(size, size))
    return sparse.csc_array(matrix + matrix.T + sparse.diags_array(rng.uniform(5, 6, size)))


def test_forms_of_sparse_columns():
    for sign in (1.0, -1.0):
        matrix = sign * _chain(60, 3)
        # Indefinite too: signs of pivots are kept.
        one = sparse.csc_array(([12.0], ([7], [7])), shape=matrix.shape)
        matrix = sparse.csc_array(matrix + one)
        factors = splu(matrix, options={"SymmetricMode": True}, **CHAIN)
        columns = sparse.random_array((60, 9), density=0.1, rng=np.random.default_rng(4))
        columns = sparse.csc_array(columns)
        halves = Halves(factors)
        assert halves.symmetric
        half, signed = halves.of(columns)
        expected = columns.T.toarray() @ np.linalg.solve(matrix.toarray(), columns.toarray())
        np.testing.assert_allclose((half.T @ signed).toarray(), expected, atol=1e-13)


def test_a_column_leads_to_few_unknowns():
    factors = splu(_chain(2000, 5), options={"SymmetricMode": True}, **CHAIN)
    column = sparse.csc_array(([1.0], ([1000], [0])), shape=(2000, 1))
    half, _ = Halves(factors).of(column)
    assert half.nnz < 100


def test_factors_that_are_not_symmetric():
    matrix = sparse.csc_array([[0.0, 2.0, 0.0], [2.0, 0.0, 1.0], [0.0, 1.0, 4.0]])
    halves = Halves(splu(matrix))
    columns = sparse.csc_array([[1.0, 0.0], [0.0, 2.0], [3.0, 0.0]])
    half, signed = halves.of(columns)
    expected = columns.T.toarray() @ np.linalg.solve(matrix.toarray(), columns.toarray())
    np.testing.assert_allclose((half.T @ signed).toarray(), expected, atol=1e-14)
    assert not halves.symmetric


def test_compiled_substitution_is_that_of_python():
    factors = splu(_chain(30, 6), options={"SymmetricMode": True}, **CHAIN)
    halves = Halves(factors)
    columns = sparse.csc_array(np.eye(30)[:, :4])
    given = (
        columns.indptr.astype(np.uint64), columns.indices.astype(np.uint64), columns.data,
    )  # fmt: skip
    arguments = (*halves._lower, halves._place, np.ones(30), *given)
    with np.errstate(over="ignore"):
        plain = _forward.py_func(*arguments)
    for one, other in zip(_forward(*arguments), plain, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-13)
