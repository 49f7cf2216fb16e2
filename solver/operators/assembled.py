"""The operator as a matrix, for small checks and factorisations: solves never need it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ..arrays import Array
from .blocks import bond_blocks
from .bond_operator import BondOperator


def to_csr(operator: BondOperator) -> sparse.csr_array:
    """The same operator as a sparse matrix, shape (components·active, components·active)."""
    bonds, lattice, c = operator.bonds, operator.bonds.lattice, operator.components
    count = len(operator.active)
    number = np.full(lattice.shape, -1, dtype=np.int64)
    rows, columns = (axis[operator.active] for axis in lattice.rows_columns)
    number[rows, columns] = np.arange(count)
    values: list[Array] = []
    ends: list[NDArray[np.int32]] = []
    starts: list[NDArray[np.int32]] = []
    coupling = np.stack([bond_blocks(bonds.family, own)[1] for own in operator.moduli.each])
    for o, (dx, dy) in enumerate(bonds.family.offsets):
        neighbour = number[rows + dy, columns + dx]
        here = np.nonzero(neighbour >= 0)[0]
        factor = bonds.strength(o)[operator.active[here]]
        for a in range(c):
            for b in range(c):
                values.append(factor * coupling[operator.phase[here], o, a, b])
                starts.append((a * count + here).astype(np.int32))
                ends.append((b * count + neighbour[here]).astype(np.int32))
    # As the kernels have them: the nodes' part follows as a whole.
    diagonal = operator.bulk_blocks[operator.phase]
    diagonal[operator.own] = operator.as_blocks(operator.diagonal)
    for a in range(c):
        for b in range(c):
            values.append(diagonal[:, a, b])
            starts.append((a * count + np.arange(count)).astype(np.int32))
            ends.append((b * count + np.arange(count)).astype(np.int32))
    matrix = sparse.coo_array(
        (np.concatenate(values), (np.concatenate(starts), np.concatenate(ends))),
        shape=operator.shape,
    ).tocsr()
    if operator.ended_stiffness is not None:
        matrix = sparse.csr_array(
            matrix + operator.ended_stiffness.condensed(operator.surface_basis())
        )
    for at, tip in zip(operator.at_tips, operator.tips, strict=True):
        here = (np.arange(c)[:, None] * count + at).ravel()
        pick = sparse.csr_array(
            (np.ones(len(here)), (np.arange(len(here)), here)), shape=(len(here), c * count)
        )
        matrix = sparse.csr_array(matrix + pick.T @ sparse.csr_array(tip.matrix) @ pick)
    if operator.identity_rows is not None:
        free = sparse.diags_array((~operator.identity_rows).ravel().astype(np.float64))
        identity = sparse.diags_array(operator.identity_rows.ravel() * operator.identity_scale)
        matrix = (free @ matrix @ free + identity).tocsr()
    matrix.eliminate_zeros()
    return matrix
