"""Runs of neighbouring particles of one kind in one grid row, as the kernels read them.

Rows of an unsigned array: first cell, length, first packed row, kind, first column of `diagonal`,
first column of the bonds' factors, phase (see `solver.operators.kernels`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Indices
from ..geometry import Lattice

#: Kinds of particles as the kernels know them.
BULK, TRUNCATED, SPECIAL = 0, 1, 2


def runs(lattice: Lattice, particles: Indices, kind: Indices) -> tuple[Indices, Indices, Indices]:
    """First cell on the flattened grid, length and first position of each run of particles.

    A new run starts where the row, the kind or the neighbourhood along a row breaks.

    Parameters
    ----------
    lattice : Lattice
    particles : ndarray of int, shape (n,)
        In the lattice's order.
    kind : ndarray of int, shape (n,)
    """
    rows, columns = (axis[particles] for axis in lattice.rows_columns)
    step = np.ones(len(rows), dtype=bool)
    step[1:] = (rows[1:] != rows[:-1]) | (columns[1:] != columns[:-1] + 1) | (kind[1:] != kind[:-1])
    first = np.nonzero(step)[0]
    size = np.diff(np.append(first, len(rows)))
    return rows[first] * lattice.shape[1] + columns[first], size, first


def of(
    lattice: Lattice,
    particles: Indices,
    kind: Indices,
    diagonal: Indices,
    factors: Indices,
    phase: Indices | None = None,
) -> NDArray[np.uint64]:
    """Segments of some particles.

    Parameters
    ----------
    lattice, particles, kind
        As for `runs`.
    diagonal, factors : ndarray of int, shape (n,)
        Column of each particle in `diagonal` and in the factors, −1 without one. Within a run
        they follow each other, because both follow the lattice's order.
    phase : ndarray of int, shape (n,), optional
        Of each particle, 0 for all by default.
    """
    phase = np.zeros_like(kind) if phase is None else phase
    cell, size, first = runs(lattice, particles, kind + (SPECIAL + 1) * phase)
    columns = [cell, size, first, kind[first]]
    columns += [np.maximum(column[first], 0) for column in (diagonal, factors)]
    columns.append(phase[first])
    return np.ascontiguousarray(np.column_stack(columns), dtype=np.uint64)


def clipped(
    segments: NDArray[np.uint64], width: int, boxes: NDArray[np.int64]
) -> NDArray[np.uint64]:
    """The parts of segments within disjoint boxes of a grid of `width` columns.

    Parameters
    ----------
    segments : ndarray of uint, shape (s, 7)
    width : int
    boxes : ndarray of int, shape (n, 4)
        First row, first column, last row, last column of each, ends included.
    """
    whole = segments.astype(np.int64)
    # Segments follow the lattice's order, row by row.
    row, column = whole[:, 0] // width, whole[:, 0] % width
    first = np.searchsorted(row, boxes[:, 0])
    last = np.searchsorted(row, boxes[:, 2], side="right")
    count = last - first
    box = np.repeat(np.arange(len(boxes)), count)
    number = np.arange(count.sum()) + np.repeat(first - (np.cumsum(count) - count), count)
    column, parts = column[number], whole[number]
    start = np.maximum(column, boxes[box, 1]) - column
    stop = np.minimum(column + parts[:, 1], boxes[box, 3] + 1) - column
    kept = stop > start
    parts += start[:, None] * np.array([1, 0, 1, 0, 1, 1, 0])
    parts[:, 1] = stop - start
    return np.ascontiguousarray(parts[kept], dtype=np.uint64)
