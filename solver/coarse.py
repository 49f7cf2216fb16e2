"""The coarse space: bilinear hats on a coarse grid, one for each side of a crack.

Hats reach across cracks, and a correction that ties both faces together is worthless there. So a
hat whose support is cut into separate pieces (by whatever bonds are broken: straight or curved
cracks, damage) becomes one hat a piece.

The Galerkin matrix Pᵀ K P is found by probing: hats further apart than their supports plus two
horizons do not feel each other, so that one product with the fine operator serves a whole colour
of them. Some hundred products, whatever the size of the body, and the fine matrix never exists.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from . import kernels
from .operators import BondOperator

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True)
class _Rows:
    """Compressed rows in the form that the kernel reads."""

    pointer: NDArray[np.uint64]
    index: NDArray[np.uint64]
    weight: Array

    @classmethod
    def of(cls, matrix: sparse.csr_array) -> _Rows:
        return cls(matrix.indptr.astype(np.uint64), matrix.indices.astype(np.uint64), matrix.data)

    def __call__(self, values: Array) -> Array:
        out = np.empty((values.shape[0], len(self.pointer) - 1))
        kernels.weighted_rows(self.pointer, self.index, self.weight, values, out)
        return out


class Hats:
    """Bilinear hats over the active particles of an operator.

    Parameters
    ----------
    operator : BondOperator
    cells : int
        Distance of the coarse nodes in cells of the lattice.

    Attributes
    ----------
    count : int
        Number of hats, split ones counted for each piece.
    split : int
        Nodes whose support is cut.
    """

    def __init__(self, operator: BondOperator, cells: int) -> None:
        self.operator, self.cells = operator, int(cells)
        lattice = operator.bonds.lattice
        rows, columns = (axis[operator.active] for axis in lattice.cells)
        h, count = self.cells, len(rows)
        row, column, fy, fx = rows // h, columns // h, (rows % h) / h, (columns % h) / h
        self._width = lattice.shape[1] // h + 2
        here = row * self._width + column
        node = np.stack([here, here + 1, here + self._width, here + self._width + 1], axis=1)
        weight = np.stack([(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy], axis=1)
        piece = self._pieces(node, weight)
        self.split = len(np.unique(node[piece > 0]))
        used = weight > 0
        self._pieces_most = int(piece.max(initial=0)) + 1
        key = node[used] * self._pieces_most + piece[used]
        keys, hat = np.unique(key, return_inverse=True)
        self.count = len(keys)
        particle = np.repeat(np.arange(count), 4).reshape(count, 4)[used]
        prolongation = sparse.csr_array((weight[used], (particle, hat)), shape=(count, self.count))
        self.prolong = _Rows.of(prolongation)
        self.restrict = _Rows.of(prolongation.T.tocsr())
        self._node, self._piece = keys // self._pieces_most, keys % self._pieces_most

    def _pieces(self, node: Indices, weight: Array) -> Indices:
        """Piece of the hat's support that each (particle, hat) pair belongs to, like `node`."""
        operator = self.operator
        bonds, lattice = operator.bonds, operator.bonds.lattice
        piece = np.zeros(node.shape, dtype=np.int64)
        broken = np.zeros(lattice.count, dtype=bool)
        broken[bonds.special] = ((bonds.factors == 0) & bonds.exist(bonds.special)).any(axis=0)
        broken = broken[operator.active]
        if not broken.any():
            return piece
        suspects = np.unique(node[broken][weight[broken] > 0])
        # Pieces are what the nearest intact bonds connect.
        number = np.full(lattice.shape, -1, dtype=np.int64)
        rows, columns = (axis[operator.active] for axis in lattice.cells)
        number[rows, columns] = np.arange(len(rows))
        links = []
        for o in np.argsort(bonds.family.length, kind="stable")[:8]:
            dx, dy = bonds.family.offsets[o]
            neighbour = number[rows + dy, columns + dx]
            links.append(np.where(bonds.factor(int(o))[operator.active] != 0, neighbour, -1))
        slots = np.argsort(node.ravel(), kind="stable")
        sorted_nodes = node.ravel()[slots]
        first = np.searchsorted(sorted_nodes, suspects)
        last = np.searchsorted(sorted_nodes, suspects, side="right")
        flat_piece, flat_weight = piece.ravel(), weight.ravel()
        for a, b in zip(first, last, strict=True):
            mine = slots[a:b]
            mine = mine[flat_weight[mine] > 0]
            particles = mine // 4
            order = np.argsort(particles)
            members = particles[order]
            starts, ends = [], []
            for link in links:
                neighbour = link[members]
                where = np.minimum(np.searchsorted(members, neighbour), len(members) - 1)
                linked = members[where] == neighbour
                starts.append(np.nonzero(linked)[0])
                ends.append(where[linked])
            i, j = np.concatenate(starts), np.concatenate(ends)
            size = len(members)
            graph = sparse.coo_array((np.ones(len(i), np.int8), (i, j)), shape=(size, size))
            _, labels = connected_components(graph, directed=False)
            flat_piece[mine[order]] = labels
        return piece

    def galerkin(self) -> sparse.csc_array:
        """Pᵀ K P, shape (components·count, components·count), component by component."""
        operator, h = self.operator, self.cells
        reach = operator.bonds.family.reach
        # Offsets of nodes whose hats can meet through a bond, and the period that keeps the
        # hats of one colour apart.
        window = (2 * (h - 1) + reach) // h
        period = 2 * window + 1
        row, column = self._node // self._width, self._node % self._width
        lookup = np.full(
            (self._pieces_most, row.max() + 2 * period + 1, column.max() + 2 * period + 1), -1
        )
        lookup[self._piece, row + period, column + period] = np.arange(self.count)
        c, values, starts, ends = operator.components, [], [], []
        for colour in range(self._pieces_most * period**2):
            piece, rest = divmod(colour, period**2)
            colour_row, colour_column = divmod(rest, period)
            lit = (self._piece == piece) & (row % period == colour_row)
            lit &= column % period == colour_column
            if not lit.any():
                continue
            up = (colour_row - row + window) % period - window
            right = (colour_column - column + window) % period - window
            source = lookup[piece, row + up + period, column + right + period]
            felt = np.nonzero(source >= 0)[0]
            for b in range(c):
                unit = np.zeros((c, self.count))
                unit[b, lit] = 1.0
                image = operator.product(self.prolong(unit), masked=True)
                answer = self.restrict(image)[:, felt]
                for a in range(c):
                    values.append(answer[a])
                    starts.append(a * self.count + felt)
                    ends.append(b * self.count + source[felt])
        size = c * self.count
        matrix = sparse.coo_array(
            (np.concatenate(values), (np.concatenate(starts), np.concatenate(ends))),
            shape=(size, size),
        ).tocsc()
        return matrix
