"""The coarse space: bilinear hats on a coarse grid, one for each side of a crack.

Hats reach across cracks, and a correction that ties both faces together is worthless there. So a
hat whose support is cut into separate pieces (by whatever bonds are broken: straight or curved
cracks, damage) becomes one hat a piece.

In the Galerkin matrix Pᵀ K P the entries between hats of the bulk are one stencil (`stencil`), the
others are found by probing: hats further apart than their supports plus two horizons do not feel
each other, so that one product with the fine operator serves a whole colour of them. Some hundred
products near what is special, and the fine matrix never exists.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.ndimage import maximum_filter1d
from scipy.sparse.csgraph import connected_components

from ..arrays import Array, Float, Indices
from ..operators import BondOperator, kernels
from . import stencil
from .coarse_grid import CoarseGrid

# Hats a node at most; a support in more pieces than this is rubble.
_PIECES = 4
# Entries of what the surface's nodes add, relative to the largest, that are not worth their place
# in the factors.
_SMALL = 1e-6


@dataclass(frozen=True)
class _Rows:
    """Compressed rows in the form that the kernel reads."""

    pointer: NDArray[np.uint64]
    index: NDArray[np.uint64]
    weight: Float

    @classmethod
    def of(cls, matrix: sparse.csr_array) -> _Rows:
        return cls(matrix.indptr.astype(np.uint64), matrix.indices.astype(np.uint64), matrix.data)

    def rounded(self, precision: type[np.floating]) -> _Rows:
        """The same with weights of another precision."""
        return replace(self, weight=self.weight.astype(precision))

    def __call__(
        self, values: Float, rows: NDArray[np.uint64] | None = None, out: Float | None = None
    ) -> Float:
        """The matrix times each component; only some rows, into `out`, if those are given."""
        count = len(self.pointer) - 1
        rows = np.arange(count, dtype=np.uint64) if rows is None else rows
        out = np.empty((values.shape[0], count)) if out is None else out
        kernels.weighted_rows(rows, self.pointer, self.index, self.weight, values, out)
        return out


class Hats:
    """Bilinear hats over the active particles of an operator.

    Parameters
    ----------
    operator : BondOperator
    coarsening : int
        Distance of the coarse nodes in cells of the lattice, but for strongly anisotropic solids,
        see `CoarseGrid.of`.
    grid : CoarseGrid, optional
        The grid of nodes, where it is known.

    Attributes
    ----------
    count : int
        Number of hats, split ones counted for each piece.
    split : int
        Nodes whose support is cut.
    node, piece : ndarray of int, shape (count,)
        Coarse node of each hat, row by row `width` to a row, and the piece of its support.
    """

    def __init__(
        self, operator: BondOperator, coarsening: int, grid: CoarseGrid | None = None
    ) -> None:
        self.operator, self.coarsening = operator, int(coarsening)
        self.grid = CoarseGrid.of(operator, self.coarsening) if grid is None else grid
        lattice, count = operator.bonds.lattice, len(operator.active)
        cells = (axis[operator.active] for axis in lattice.rows_columns)
        place, self.width = self.grid.places(*cells), self.grid.size[1]
        (row, fy), (column, fx) = (np.divmod(axis, self.grid.cells) for axis in place)
        fy, fx = fy / self.grid.cells, fx / self.grid.cells
        here = row * self.width + column
        node = np.stack([here, here + 1, here + self.width, here + self.width + 1], axis=1)
        weight = np.stack([(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy], axis=1)
        piece = self._pieces(node, weight)
        self.split = len(np.unique(node[piece > 0]))
        used = (weight > 0) & (piece < _PIECES)
        self._pieces_most = int(piece[used].max(initial=0)) + 1
        key = node[used] * _PIECES + piece[used]
        there = np.zeros(_PIECES * self.grid.size[0] * self.width, dtype=bool)
        there[key] = True
        keys, hat = np.nonzero(there)[0], (np.cumsum(there) - 1)[key]
        self.count = len(keys)
        # A particle's hats come in the order of their nodes: these are compressed rows already.
        pointer = np.concatenate([[0], np.cumsum(used.sum(axis=1))])
        prolongation = sparse.csr_array((weight[used], hat, pointer), shape=(count, self.count))
        self.prolongation = prolongation
        self.prolong = _Rows.of(prolongation)
        self.restrict = _Rows.of(prolongation.T.tocsr())
        self.node, self.piece = keys // _PIECES, keys % _PIECES

    def _pieces(self, node: Indices, weight: Array) -> Indices:
        """Piece of the hat's support that each (particle, hat) pair belongs to, like `node`."""
        operator = self.operator
        bonds, lattice = operator.bonds, operator.bonds.lattice
        piece = np.zeros(node.shape, dtype=np.int64)
        broken = np.zeros(lattice.count, dtype=bool)
        broken[bonds.special] = ((bonds.strengths == 0) & bonds.exist(bonds.special)).any(axis=0)
        broken = broken[operator.active]
        if not broken.any():
            return piece
        suspect = np.zeros(self.grid.size[0] * self.width, dtype=bool)
        suspect[node[broken][weight[broken] > 0]] = True
        # Pairs of a suspect and a particle of its support, by suspect and then by particle.
        chosen = np.nonzero((suspect[node] & (weight > 0)).ravel())[0]
        count = len(operator.active)
        key = node.ravel()[chosen] * count + chosen // 4
        chosen, key = chosen[np.argsort(key)], np.sort(key)
        hat, member = np.divmod(key, count)
        # Pieces are what the nearest intact bonds connect.
        number = np.full(lattice.shape, -1, dtype=np.int64)
        rows, columns = (axis[operator.active] for axis in lattice.rows_columns)
        number[rows, columns] = np.arange(count)
        some = np.zeros(count, dtype=bool)
        some[member] = True
        place, some = np.cumsum(some) - 1, np.nonzero(some)[0]
        own, links = bonds.column[operator.active[some]], []
        for o in np.argsort(bonds.family.length, kind="stable")[:8]:
            dx, dy = bonds.family.offsets[o]
            neighbour = number[rows[some] + dy, columns[some] + dx]
            special = own >= 0
            neighbour[special] = np.where(
                bonds.strengths[o, own[special]] != 0, neighbour[special], -1
            )
            links.append(neighbour[place[member]])
        starts, ends = [], []
        for neighbour in links:
            wanted = hat * count + neighbour
            where = np.minimum(np.searchsorted(key, wanted), len(key) - 1)
            linked = (neighbour >= 0) & (key[where] == wanted)
            starts.append(np.nonzero(linked)[0])
            ends.append(where[linked])
        i, j = np.concatenate(starts), np.concatenate(ends)
        graph = sparse.coo_array((np.ones(len(i), np.int8), (i, j)), shape=(len(key),) * 2)
        _, labels = connected_components(graph, directed=False)
        # The heaviest piece of a hat first: pieces beyond the fourth get no hat of their own.
        _, first = np.unique(labels, return_index=True)
        heavy = np.lexsort((first, -np.bincount(labels, weight.ravel()[chosen]), hat[first]))
        begin = np.searchsorted(hat[first][heavy], hat[first][heavy])
        rank = np.empty(len(heavy), dtype=np.int64)
        rank[heavy] = np.arange(len(heavy)) - begin
        piece.ravel()[chosen] = rank[labels]
        return piece

    def galerkin(
        self, known: tuple[Hats, sparse.csc_array] | None = None, changed: Indices | None = None
    ) -> sparse.csc_array:
        """Pᵀ K P, component by component.

        Parameters
        ----------
        known : (Hats, csc_array), optional
            Hats and matrix of the same body before some bonds changed.
        changed : ndarray of int, optional
            Active particles (positions) whose bonds have changed since. Only hats that feel
            them are probed again, with products on a window around them.

        Returns
        -------
        csc_array, shape (components·count, components·count)
        """
        c = self.operator.components
        # Offsets of nodes whose hats can meet through a bond, and the periods that keep the
        # hats of one colour apart.
        high, wide = self.grid.windows(self.operator.bonds.family)
        rows, columns = 2 * high + 1, 2 * wide + 1
        row, column = self.node // self.width, self.node % self.width
        lookup = np.full(
            (self._pieces_most, row.max() + 2 * rows + 1, column.max() + 2 * columns + 1), -1
        )
        lookup[self.piece, row + rows, column + columns] = np.arange(self.count)
        if known is None:
            phase = stencil.phases(self.operator, self.grid, self.prolongation)
            stale = phase < 0
            standing = self._regular(phase, lookup[0], (rows, columns), (high, wide))
        else:
            stale = self._stale(changed)
            if not stale.any():
                return known[1]
            standing = self._standing(*known, stale)
        probe = _Probe(self)
        values, starts, ends = [standing[0]], [standing[1]], [standing[2]]
        near = self._near(stale, high, wide)
        up_to, right_to = (row[near] - high) % rows, (column[near] - wide) % columns
        for piece, colour_row, colour_column in np.ndindex(self._pieces_most, rows, columns):
            up = (colour_row - up_to) % rows - high
            right = (colour_column - right_to) % columns - wide
            lit = near[(up == 0) & (right == 0) & stale[near] & (self.piece[near] == piece)]
            if not len(lit):
                continue
            source = lookup[piece, row[near] + up + rows, column[near] + right + columns]
            some = (source >= 0) & stale[source]
            felt, source = near[some], source[some]
            probe.light(lit)
            # Columns of stale hats are probed; their rows follow by symmetry, the rest stands.
            mirrored = ~stale[felt]
            for b in range(c):
                answer = probe(b, felt)
                for a in range(c):
                    here, there = a * self.count + felt, b * self.count + source
                    values += [answer[a], answer[a, mirrored]]
                    starts += [here, there[mirrored]]
                    ends += [there, here[mirrored]]
        size = c * self.count
        data, i, j = np.concatenate(values), np.concatenate(starts), np.concatenate(ends)
        return sparse.coo_array((data, (i, j)), shape=(size, size)).tocsc()

    def ended(self) -> sparse.csr_array | None:
        """Pᵀ S P of what the surface's nodes add, which reaches too far to be probed."""
        if self.operator.ended_stiffness is None:
            return None
        return self.operator.ended_stiffness.condensed(
            self.operator.surface_basis(self.prolongation), _SMALL
        )

    def _near(self, stale: NDArray[np.bool_], high: int, wide: int) -> Indices:
        """Hats that stale ones can feel, themselves among them, in order."""
        nodes = np.zeros(self.grid.size, dtype=bool)
        nodes.ravel()[self.node[stale]] = True
        for axis, far in enumerate((high, wide)):
            nodes = maximum_filter1d(nodes, 2 * far + 1, axis, mode="constant")
        return np.nonzero(nodes.ravel()[self.node])[0]

    def _stale(self, changed: Indices | None) -> NDArray[np.bool_]:
        """Hats whose image under K may differ because of particles with changed bonds."""
        lattice, cells = self.operator.bonds.lattice, self.grid.cells
        nodes = np.zeros(self.grid.size, dtype=bool)
        if changed is not None and len(changed):
            particles = self.operator.active[changed]
            row, column = self.grid.places(*(axis[particles] for axis in lattice.rows_columns))
            high, wide = (cells + far for far in self.grid.reach(self.operator.bonds.family))
            for up in range(-high, high + 1, cells):
                for right in range(-wide, wide + 1, cells):
                    r = np.clip((row + up) // cells, 0, nodes.shape[0] - 2)
                    k = np.clip((column + right) // cells, 0, nodes.shape[1] - 2)
                    for one in (0, 1):
                        nodes[r + one, k] = nodes[r + one, k + 1] = True
        return nodes.ravel()[self.node]

    def _regular(
        self,
        phase: Indices,
        lookup: Indices,
        margin: tuple[int, int],
        window: tuple[int, int],
    ) -> tuple[Array, Indices, Indices]:
        """Entries between hats of the bulk, by the stencil of their phase."""
        c = self.operator.components
        row, column = self.node // self.width + margin[0], self.node % self.width + margin[1]
        values, starts, ends = [np.zeros(0)], [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
        for number in range(len(self.operator.bulk)):
            hats = np.nonzero(phase == number)[0]
            if not len(hats):
                continue
            found = stencil.entries(self.operator, number, self.grid, window)
            for up, right in np.ndindex(found.shape[:2]):
                other = lookup[row[hats] + up - window[0], column[hats] + right - window[1]]
                both = (other >= 0) & (phase[other] == number)
                here, there = hats[both], other[both]
                for a, b in np.ndindex(c, c):
                    if entry := found[up, right, a, b]:
                        values.append(np.full(len(here), entry))
                        starts.append(a * self.count + here)
                        ends.append(b * self.count + there)
        return np.concatenate(values), np.concatenate(starts), np.concatenate(ends)

    def _standing(
        self, before: Hats, matrix: sparse.csc_array, stale: NDArray[np.bool_]
    ) -> tuple[Array, Indices, Indices]:
        """Entries of the old matrix between hats that are not stale, renumbered."""
        keys = self.node * _PIECES + self.piece
        old_keys = before.node * _PIECES + before.piece
        where = np.minimum(np.searchsorted(keys, old_keys), self.count - 1)
        same = (keys[where] == old_keys) & ~stale[where]
        renumber = np.where(same, where, -1)
        entries = matrix.tocoo()
        i, j = renumber[entries.row % before.count], renumber[entries.col % before.count]
        kept = (i >= 0) & (j >= 0)
        offset_i = entries.row // before.count * self.count
        offset_j = entries.col // before.count * self.count
        return entries.data[kept], (offset_i + i)[kept], (offset_j + j)[kept]


class _Probe:
    """Products with hats of one colour, on the part of the lattice that they reach."""

    def __init__(self, hats: Hats) -> None:
        self.hats, operator = hats, hats.operator
        self.fine = np.zeros((operator.components, len(operator.active)))
        self.image = np.zeros_like(self.fine)
        self.segments = operator.segments[:0]
        self.particles = np.zeros(0, dtype=np.uint64)
        operator.clear()

    def light(self, lit: Indices) -> None:
        """Turn to other hats; their rows of windows do not overlap."""
        hats, operator = self.hats, self.hats.operator
        self.lit = lit
        # What other windows left must be neither read nor restricted.
        self.fine[:, self.particles] = self.image[:, self.particles] = 0.0
        kernels.scatter(self.segments, self.fine, operator.grid)
        row, column = np.divmod(hats.node[lit], hats.width)
        reach = operator.bonds.family.reach
        self.segments = operator.windows(hats.grid.boxes(row, column, reach))
        _, size, first = self.segments[:, :3].astype(np.int64).T
        # Positions first, first + 1, … of every segment.
        shift = np.repeat(first - np.concatenate([[0], np.cumsum(size)[:-1]]), size)
        self.particles = (np.arange(size.sum()) + shift).astype(np.uint64)

    def __call__(self, component: int, felt: Indices) -> Float:
        """Some rows of Pᵀ K P e for the sum e of the lit hats in one component."""
        hats = self.hats
        unit = np.zeros((1, hats.count))
        unit[0, self.lit] = 1.0
        if component:
            self.fine[component - 1, self.particles] = 0.0
        hats.prolong(unit, self.particles, self.fine[component : component + 1])
        hats.operator.product(self.fine, masked=True, segments=self.segments, out=self.image)
        out = np.empty((len(self.image), hats.count))
        return hats.restrict(self.image, felt.astype(np.uint64), out)[:, felt]
