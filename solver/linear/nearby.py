"""A first guess near what has changed: some particles find their balance while all others hold.

When bonds break, what is out of balance is so at their ends. Most of what the body does about it
is done by the particles around, and what these leave to conjugate gradients on the whole body is
smooth and small. A polynomial of their own stiffness is all that it takes: it lowers the energy
of the error at any degree.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Indices
from ..operators import BondOperator
from ..operators.part import part_of
from .smoother import Smoother, size_of
from .two_level import TwoLevel, block_inverses

# Products, and the ratio of the eigenvalues of a part some twenty-five cells wide that they serve.
_DEGREE, _RATIO = 8, 20.0
# Cells about what has changed, the largest share of the body that they may be, and the most
# particles that may have changed: beyond, the whole body is solved at once.
_AROUND, _SHARE, _CHANGED = 12, 0.4, 1_000


def around(operator: BondOperator, particles: Indices) -> Indices:
    """Positions of the active particles around some, or of none where that is much of the body.

    Without those that are partly prescribed or feel the surface's nodes: `change` holds them.
    """
    lattice, centres = operator.bonds.lattice, np.unique(particles)
    near = np.zeros(lattice.shape, dtype=bool)
    rows, columns = lattice.rows_columns
    if len(centres) > _CHANGED:
        return np.zeros(0, dtype=np.int64)
    for row, column in zip(rows[centres], columns[centres], strict=True):
        top, left = max(row - _AROUND, 0), max(column - _AROUND, 0)
        near[top : row + _AROUND + 1, left : column + _AROUND + 1] = True
    taken = near[rows[operator.active], columns[operator.active]]
    if operator.identity_rows is not None:
        taken &= ~operator.identity_rows.any(axis=0)
    if operator.ended_stiffness is not None:
        taken[operator.at_surface] = False
    found = np.nonzero(taken)[0]
    return found if len(found) <= _SHARE * len(taken) else found[:0]


def change(
    operator: BondOperator, inverse: TwoLevel, positions: Indices, residual: Array
) -> tuple[Array, Array]:
    """Change of the unknowns that balances some particles, and what it does to the residual.

    Parameters
    ----------
    operator : BondOperator
        Positive.
    inverse : TwoLevel
        Of the same body, perhaps before some bonds broke.
    positions : ndarray of int, shape (n,)
        Among the active particles, see `solver.operators.part`.
    residual : ndarray
        Of the equations.

    Returns
    -------
    change, loss : ndarray
        d and K d.
    """
    part = part_of(operator, positions)
    own = block_inverses(part, part.own_blocks, part.own)
    smoother = Smoother(part, inverse.jacobi.bulk, own, inverse.largest, _DEGREE, ratio=_RATIO)
    given = np.ascontiguousarray(residual.reshape(operator.components, -1)[:, positions])
    whole, lost = np.zeros((2, operator.components, len(operator.active)))
    if unit := size_of(given):
        smoother.start(given, unit)
        smoother.sweep()
        whole[:, positions] = smoother.answer(given, unit).reshape(given.shape)
        # Rows that feel the part, no more.
        reach = operator.bonds.family.reach
        rows, columns = (axis[part.active] for axis in operator.bonds.lattice.rows_columns)
        box = [rows.min() - reach, columns.min() - reach, rows.max() + reach, columns.max() + reach]
        operator.clear()
        near = operator.windows(np.array([box]))
        operator.product(whole, masked=True, segments=near, out=lost)
    return whole.ravel(), lost.ravel()
