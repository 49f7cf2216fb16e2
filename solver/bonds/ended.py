"""Bonds that end at the surface: the treatment ``extrapolated``.

Every particle keeps its full family. Where a neighbour is missing, or lies behind a crack, the
bond ends where it meets the surface, at a point whose displacement is interpolated between
surface nodes. It is a shorter bond of the same moduli: with ℓ the length that is left of |ξ|,

    energy = ½ ℓ (k_n s² + k_t γ²) α Δv_p Δv_q,   s = n·(u_s − u_p)/ℓ,
    γ = t·(u_s − u_p)/ℓ − [½ |ξ| θ_p + (ℓ − ½ |ξ|) θ_s]/ℓ,

(in conduction ½ (ℓ/|ξ|) k g², g = (T_s − T_p)/ℓ). Why so:

* In a homogeneous state s and γ, so also the force k_n s n + k_t γ t on p and its moment
  ½ |ξ| k_t γ, are those of the whole bond: every particle is in equilibrium, as in the bulk.
* What a bond gives to the surface is the force that it would carry across it, and the sum over
  all bonds through a piece of surface is σ·n: zero on a free surface, the traction on a loaded one.
  The couples (ℓ − ½|ξ|) k_t γ cancel, because bonds meet the surface at all shares of their length
  alike. Without the nodes (ghost particles beyond the surface, say) forces of the stress *along*
  the surface would remain in a layer of one horizon.
* The energy is that of the part of the bond within the body; summed over the bonds through a
  piece of surface it completes the energy density of the families there. It is positive
  wherever the bonds' moduli are, rigid motions cost nothing, the operator stays symmetric.

The nodes' displacements u_s are no unknowns: without inertia they follow from their own
equilibrium, K_ss u_s = f_s − K_sp u_p, which extrapolates the particles' field to the surface;
f_s are the tractions' work on u_s. What remains acts on the particles alone,
K_pp − K_ps K_ss⁻¹ K_sp. A surface node feels only particles within a horizon, and K_ss, like a
mass matrix along the outline, is banded and well conditioned: its factorisation costs next to
nothing.

Edges along the lattice's rows need one thing more, a thin membrane on the nodes: see
`solver.operators.skin`.

A bond that a load breaks does not end at a surface: it carries nothing. Ended bonds themselves
have no strength: a crack that grows through them and out through an edge cuts them (`parting`).
Where cracks branch, cross or bend every sector of the body between them has a node of its own
(`solver.geometry.faces`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import Array, Indices, Mask
from ..geometry import Lattice, Outline
from ..material import Family
from .factors import Factors

# Share of the spacing below which a bond's stiffness grows no more, and a chord does not count.
SHORTEST = 0.1
# Chords looked at together.
_AT_ONCE = 1 << 18
# Turn (rad) of the region's edge that makes a corner.
_CORNER = 0.2


@dataclass(frozen=True, eq=False)
class Chords:
    """What corners of the body cut out of bonds between two missing particles.

    Without them the forces that bonds give to the surface would not add up to σ·n within a
    horizon of a corner.

    Attributes
    ----------
    offset : ndarray of int, shape (k,)
    edge, position : ndarray, shape (k, 2)
        Where each enters and leaves the body.
    length : ndarray, shape (k,), m
        Between the two.
    arm : ndarray, shape (k, 2), m
        What the rotations at both ends contribute to ℓ γ: distance of the bond's far end from
        the point, less ½ |ξ|.
    factor : ndarray, shape (k,), optional
        On its modulus.
    """

    offset: Indices
    edge: Indices
    position: Array
    length: Array
    arm: Array
    factor: Array | None = None

    @classmethod
    def joined(cls, found: Sequence[Chords | None], starts: Sequence[int]) -> Chords | None:
        """Those of several outlines in one, in which their edges have these first numbers."""
        some = [(c, n) for c, n in zip(found, starts, strict=True) if c is not None]
        if not some:
            return None
        names = ("offset", "edge", "position", "length", "arm")
        both: dict[str, Any] = {
            name: np.concatenate([getattr(c, name) + (n if name == "edge" else 0) for c, n in some])
            for name in names
        }
        return cls(**both)

    def kept(self, kept: Mask) -> Chords:
        """Some of them."""
        names = ("offset", "edge", "position", "length", "arm")
        factor = None if self.factor is None else self.factor[kept]
        fewer: dict[str, Any] = {name: getattr(self, name)[kept] for name in names}
        return Chords(**fewer, factor=factor)

    @classmethod
    def of(cls, lattice: Lattice, family: Family, outline: Outline) -> Chords | None:
        """Chords at the convex corners of the region, None if there are none."""
        corners = outline.corners(_CORNER)
        if not len(corners):
            return None
        spacing, mask = lattice.spacing, lattice.mask
        x, y = lattice.axes
        # Cells around each corner, beyond the array too.
        reach = family.reach
        around = np.arange(-reach, reach + 1)
        column = np.rint((corners[:, 0] - x[0]) / spacing).astype(int)[:, None] + around
        row = np.rint((corners[:, 1] - y[0]) / spacing).astype(int)[:, None] + around
        cells = {
            (int(r), int(c))
            for rows, columns in zip(row, column, strict=True)
            for r in rows
            for c in columns
        }
        cell = np.array(sorted(cells))

        def empty(cells: Indices) -> Mask:
            inside = (cells >= 0).all(axis=1) & (cells < mask.shape).all(axis=1)
            full = np.zeros(len(cells), dtype=bool)
            full[inside] = mask[tuple(cells[inside].T)]
            return ~full

        half, box = family.size // 2, (outline.nodes.min(axis=0), outline.nodes.max(axis=0))
        found = [(np.zeros((0, 2)), np.zeros(0, dtype=np.int64))]
        # A chord for every offset of every cell, and nearly all pass the body by: few at a time.
        for start in _slices(cell[empty(cell)], max(1, _AT_ONCE // half)):
            begin = np.repeat(start, half, axis=0)
            offset = np.tile(np.arange(half), len(start))
            step = family.offsets[offset]
            origin = np.column_stack([x[0], y[0]]) + spacing * begin[:, ::-1]
            end = origin + np.multiply(step, spacing)
            near = (np.maximum(origin, end) >= box[0]) & (np.minimum(origin, end) <= box[1])
            tried = np.nonzero(near.all(axis=1))[0]
            tried = tried[empty(begin[tried] + step[tried, ::-1])]
            found.append((origin[tried], offset[tried]))
        origin, offset = (np.concatenate(each) for each in zip(*found, strict=True))
        bond = np.multiply(family.offsets[offset], spacing)
        line, edge, position, share = outline.passages(origin, bond)
        whole = family.length[offset[line]]
        length = (share[:, 1] - share[:, 0]) * whole
        kept = length > SHORTEST * spacing
        arm = np.column_stack([1 - share[:, 0], share[:, 1]]) - 0.5
        return cls(
            offset[line][kept],
            edge[kept],
            position[kept],
            length[kept],
            (arm * whole[:, None])[kept],
        )

    def touching(self, outline: Outline, touched: Mask) -> Chords:
        """Those of which all nodes are among the `touched`."""
        return self.kept(np.asarray(touched[outline.edges[self.edge]].all(axis=(1, 2))))


@dataclass(frozen=True, eq=False)
class EndedBonds:
    """Bonds that end at the surface.

    Attributes
    ----------
    outline : Outline
    particle, offset : ndarray of int, shape (k,)
        Where each starts, and its index in the family.
    edge : ndarray of int, shape (k,)
        Edge of the outline that it meets.
    position : ndarray, shape (k,)
        Where on it, 0 to 1.
    length : ndarray, shape (k,), m
        ℓ, what is left of |ξ|.
    chords : Chords, optional
    held : ndarray of bool, shape (components, nodes of the outline), optional
        Components of the nodes that are prescribed, and not in equilibrium.
    given : ndarray, shape (components, nodes of the outline), optional
        Their values, in the units of the unknowns.
    factor : ndarray, shape (k,), optional
        On the modulus of each (`factors`), and where a treatment of surfaces stiffens bonds.
    edge_factor : ndarray, shape (edges of the outline, family size / 2), optional
        What the membrane along the edge takes for bonds of each half offset (`factors`).
    surface : bool
        Whether they end at the body's surface, and not at interfaces only.
    """

    outline: Outline
    particle: Indices
    offset: Indices
    edge: Indices
    position: Array
    length: Array
    chords: Chords | None = None
    held: Mask | None = None
    given: Array | None = None
    factor: Array | None = None
    edge_factor: Array | None = None
    surface: bool = True

    @classmethod
    def of(
        cls, lattice: Lattice, family: Family, outline: Outline, particles: Indices, lost: Mask
    ) -> EndedBonds:
        """From `lost`, shape (family size, particles): the bonds that do not reach a neighbour."""
        column, offset = np.nonzero(lost.T)
        particle = particles[column]
        bond = np.multiply(family.offsets[offset], lattice.spacing)
        edge, position, share = outline.first_hit(lattice.points[particle], bond)
        met = edge >= 0
        length = share * family.length[offset]
        return cls(outline, particle[met], offset[met], edge[met], position[met], length[met])

    def joined(self, others: EndedBonds) -> EndedBonds:
        """These bonds, and those of `others` that end beside a node of these."""
        kept = self.touched[self.outline.edges[others.edge]].any(axis=1)
        names = _each(self)
        both: dict[str, Any] = {
            name: np.concatenate([getattr(self, name), getattr(others, name)[kept]])
            for name in names
        }
        return replace(self, **both)

    @property
    def touched(self) -> Mask:
        """Nodes of the outline that bonds end beside, shape (nodes,)."""
        return self.outline.touched(self.edge)

    @property
    def phase(self) -> Indices | None:
        """Phase of the body that each lies in, None in a body of one."""
        return None if self.outline.phase is None else self.outline.phase[self.edge]

    def kept(self, kept: Mask) -> EndedBonds:
        """Some of these bonds."""
        fewer: dict[str, Any] = {name: getattr(self, name)[kept] for name in _each(self)}
        return replace(self, **fewer)

    def without(self, particles: Indices) -> EndedBonds | None:
        """These bonds less those of some particles, None if that leaves none."""
        kept = ~np.isin(self.particle, particles)
        if not kept.any():
            return None
        left = self.kept(kept)
        if self.chords is not None:
            left = replace(left, chords=self.chords.touching(self.outline, left.touched))
        return left

    def with_chords(self, lattice: Lattice, family: Family) -> EndedBonds:
        """The same with what the body's corners cut out of other bonds."""
        return self.between(Chords.of(lattice, family, self.outline))

    def between(self, chords: Chords | None) -> EndedBonds:
        """The same with those of some chords that touch nodes of these."""
        if chords is None:
            return self
        return replace(self, chords=chords.touching(self.outline, self.touched))

    def holding(self, held: Mask, given: Array) -> EndedBonds:
        """The same bonds with some components of the outline's nodes prescribed."""
        return replace(self, held=held, given=given)

    def scaled(self, factors: Factors) -> EndedBonds:
        """The same bonds with a factor on each."""
        chords = self.chords
        if chords is not None:
            chords = replace(chords, factor=factors.chords)
        return replace(self, chords=chords, factor=factors.ended, edge_factor=factors.edges)

    def __len__(self) -> int:
        return len(self.particle)

    @property
    def nbytes(self) -> int:
        """Memory of the arrays, bytes."""
        arrays = (self.particle, self.offset, self.edge, self.position, self.length)
        return sum(a.nbytes for a in arrays)


def _each(bonds: EndedBonds) -> tuple[str, ...]:
    """Names of what there is one of for every bond."""
    names = ("particle", "offset", "edge", "position", "length")
    return names if bonds.factor is None else (*names, "factor")


def _slices(values: Indices, count: int) -> Iterator[Indices]:
    """So many rows at a time."""
    for begin in range(0, len(values), count):
        yield values[begin : begin + count]
