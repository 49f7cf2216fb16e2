"""Halves of a quadratic form: what is condensed out, without solving for it to the end.

With K = L D Lᵀ the form Bᵀ K⁻¹ B is Wᵀ D⁻¹ W, W = L⁻¹ B. Where the columns of B are sparse and the
factors those of a chain, as along the edge of a body, so are the columns of W: substitution goes
through the few unknowns that a column leads to, and there is no way back.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import SuperLU

from ..arrays import Array, Indices
from ..compiled import kernel

# Parts of a column of W over √D, relative to the largest of all, that are left out: their products
# are roundings.
_GONE = 1e-16

_Places = NDArray[np.uint64]


class Halves:
    """The forms of a symmetric factorisation.

    Parameters
    ----------
    factors : SuperLU
        Of a symmetric matrix, pivots taken from the diagonal.
    """

    def __init__(self, factors: SuperLU) -> None:
        self.factors = factors
        #: Whether the factors are those of L D Lᵀ.
        self.symmetric: bool = np.array_equal(factors.perm_r, factors.perm_c)
        lower = sparse.tril(factors.L, -1, format="csc")
        self._lower = tuple(
            np.ascontiguousarray(part, dtype=kind)
            for part, kind in (
                (lower.indptr, np.uint64),
                (lower.indices, np.uint64),
                (lower.data, np.float64),
            )
        )
        self._place = factors.perm_r.astype(np.uint64)
        self._pivots: Array = factors.U.diagonal()

    def of(self, columns: sparse.csc_array) -> tuple[sparse.csc_array, sparse.csc_array]:
        """W/√|D|, and the same with the signs of D; the form is the product of their columns."""
        if not self.symmetric:
            # The way back, and forth, for the rare matrix whose diagonal made no pivots.
            dense = columns.toarray()
            return sparse.csc_array(dense), sparse.csc_array(self.factors.solve(dense))
        root = np.sqrt(np.abs(self._pivots))
        given = (
            columns.indptr.astype(np.uint64),
            columns.indices.astype(np.uint64),
            columns.data.astype(np.float64),
        )
        shape = columns.shape
        pointer, index, entry = _forward(*self._lower, self._place, root, *given)
        half = sparse.csc_array((entry, index.astype(np.int64), pointer), shape=shape)
        half.data[np.abs(half.data) < _GONE * np.abs(half.data).max(initial=0.0)] = 0.0
        half.eliminate_zeros()
        signs = sparse.diags_array(np.sign(self._pivots))
        return half, sparse.csc_array(signs @ half)


@kernel(nogil=True)
def _forward(
    pointer: _Places,
    index: _Places,
    entry: Array,
    place: _Places,
    root: Array,
    columns: _Places,
    rows: _Places,
    values: Array,
) -> tuple[Indices, _Places, Array]:
    """Columns of L⁻¹ P B over the roots of the pivots, as compressed columns.

    Parameters
    ----------
    pointer, index : uint64 (n + 1,), (k,)
    entry : float64 (k,)
        Columns of L below its diagonal of ones.
    place : uint64 (n,)
        Row of L of each row of B.
    root : float64 (n,)
    columns, rows : uint64 (c + 1,), (b,)
    values : float64 (b,)
        Columns of B.
    """
    count = columns.size - 1
    first = np.zeros(count + 1, np.int64)
    capacity, size = max(16 * rows.size, 16), 0
    found, where = np.empty(capacity), np.empty(capacity, np.uint64)
    x = np.zeros(root.size)
    for c in range(count):
        low = np.uint64(root.size)
        for k in range(columns[c], columns[c + 1]):
            row = place[rows[k]]
            x[row] += values[k]
            low = min(low, row)
        for j in range(low, np.uint64(root.size)):
            value = x[j]
            if value == 0.0:
                continue
            x[j] = 0.0
            for k in range(pointer[j], pointer[j + np.uint64(1)]):
                x[index[k]] -= entry[k] * value
            if size == capacity:
                capacity *= 2
                longer, further = np.empty(capacity), np.empty(capacity, np.uint64)
                longer[:size], further[:size] = found, where
                found, where = longer, further
            found[size], where[size] = value / root[j], j
            size += 1
        first[c + 1] = size
    return first, where[:size], found[:size]
