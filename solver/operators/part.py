"""The operator on some particles while all others are held: a small copy of it."""

from __future__ import annotations

from copy import copy

import numpy as np

from ..arrays import Indices
from . import segments
from .bond_operator import BondOperator


def part_of(operator: BondOperator, positions: Indices) -> BondOperator:
    """Stiffness of some of the active particles, all others at zero.

    Products cost what the part costs, not what the body does: fields, grid and strengths are its
    own.

    Parameters
    ----------
    operator : BondOperator
    positions : ndarray of int, shape (n,)
        Among the active particles, ascending. None of them is partly prescribed or feels the
        surface's nodes or a calibrated tip.
    """
    bonds, lattice = operator.bonds, operator.bonds.lattice
    particles = operator.active[positions]
    rows, columns = (axis[particles] for axis in lattice.rows_columns)
    reach = bonds.family.reach
    first = [int(axis.min()) - reach for axis in (rows, columns)]
    height, width = (
        int(axis.max()) - low + reach + 1 for axis, low in zip((rows, columns), first, strict=True)
    )
    special = bonds.column[particles]
    at = np.minimum(np.searchsorted(operator.own, positions), max(len(operator.own) - 1, 0))
    own = operator.own[at] == positions if len(operator.own) else np.zeros(len(at), dtype=bool)
    kind = np.where(own, segments.TRUNCATED, segments.BULK)
    kind[special >= 0] = segments.SPECIAL
    found = copy(operator)
    for name in ("own", "block_diagonal"):
        found.__dict__.pop(name, None)
    found.active, found.phase = particles, operator.phase[positions]
    found.shape = (operator.components * len(positions),) * 2
    found.identity_rows, found.ended_stiffness, found.tips, found.at_tips = None, None, (), ()
    found.diagonal = np.ascontiguousarray(operator.diagonal[:, at[own]])
    found.strengths = np.ascontiguousarray(operator.strengths[:, special[special >= 0]])
    found.segments = segments.of(
        lattice,
        particles,
        kind,
        np.where(own, np.cumsum(own) - 1, -1),
        np.where(special >= 0, np.cumsum(special >= 0) - 1, -1),
        found.phase,
    )
    # Cells on a grid of its own.
    row, column = np.divmod(found.segments[:, 0].astype(np.int64), lattice.shape[1])
    found.segments[:, 0] = (row - first[0]) * width + column - first[1]
    dx, dy = bonds.family.offsets[: len(operator.steps)].T
    found.steps = (dy * width + dx).astype(np.uint64)
    found.grid = np.zeros((operator.components, height * width))
    return found
