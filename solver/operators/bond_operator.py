"""Matrix-free bond operators: the stiffness of a body as products with fields.

The operator acts on the *active* particles (those with a free unknown), component by component:
a vector is ``x.reshape(components, active)``. Rotations enter as θ Δx, so that all unknowns and
all entries carry the same units and no tolerance depends on them. Rows are densities, force (or
heat) per unit volume.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import LinearOperator

from ..arrays import Array, Mask
from ..bonds import Bonds
from ..material import Mixture, Moduli, PolarModuli
from . import kernels, segments
from .blocks import each_offset_blocks
from .blocks import entries as block_entries
from .surface_stiffness import SurfaceStiffness, stiffness_of
from .tip_stiffness import TipStiffness

# Own stiffness, relative to the bulk's, beyond which a particle is tied to the surface's nodes.
STIFF = 2.0


class BondOperator(LinearOperator):
    """Stiffness of the active particles of a body.

    Parameters
    ----------
    bonds : Bonds
    moduli : Moduli
    prescribed : ndarray of bool, shape (components, N)
        Prescribed unknowns. Particles with all of them prescribed are not unknowns; single
        prescribed components of the others are kept as identity rows.
    before : BondOperator, optional
        Of the same body before bonds broke or particles were set aside: the diagonal blocks of
        particles whose bonds are what they were are taken from it, the same to the last bit.
    """

    def __init__(
        self,
        bonds: Bonds,
        moduli: Moduli,
        prescribed: Mask,
        before: BondOperator | None = None,
    ) -> None:
        self.bonds, self.moduli = bonds, moduli
        if before is not None and (
            before.moduli is not moduli or before.bonds.lattice is not bonds.lattice
        ):
            before = None
        self.blocks: Array = (
            each_offset_blocks(bonds.family, moduli) if before is None else before.blocks
        )
        self.components = moduli.components
        if prescribed.shape != (self.components, bonds.lattice.count):
            raise ValueError(f"prescribed must have shape {(self.components, bonds.lattice.count)}")
        #: Numbers of the active particles.
        self.active: NDArray[np.int64] = np.nonzero(~prescribed.all(axis=0))[0]
        #: Phase of each of them.
        self.phase: NDArray[np.int64] = np.zeros(len(self.active), dtype=np.int64)
        if isinstance(moduli, Mixture):
            self.phase = moduli.of[self.active]
        count = len(self.active)
        super().__init__(np.float64, (self.components * count, self.components * count))
        partly = prescribed[:, self.active]
        #: Identity rows, shape (components, active), or None if there are none.
        self.identity_rows: Mask | None = partly if partly.any() else None
        #: The last field on the padded grid.
        self.grid = np.zeros((self.components, int(np.prod(bonds.lattice.shape))))
        #: Of products, see `solver.operators.kernels`.
        self.kernel = {
            3: kernels.elastic_product,
            2: kernels.central_product,
            1: kernels.conductive_product,
        }[self.components]
        half = bonds.family.size // 2
        row = bonds.lattice.shape[1]
        dx, dy = bonds.family.offsets[:half].T
        #: What the kernels read, see `solver.operators.kernels`.
        self.steps = (dy * row + dx).astype(np.uint64)
        self.strengths: Array = bonds.strengths
        if before is None:
            coupling = self.blocks
            if isinstance(moduli, PolarModuli):
                coupling = each_offset_blocks(bonds.family, moduli, coupling=True)
            self.half_blocks = np.ascontiguousarray(coupling[:, :half])
            whole = np.ones((bonds.family.size, 1))
            self.bulk = np.stack([_diagonal_sums(own, whole)[:, 0] for own in self.blocks])
        else:
            self.half_blocks, self.bulk = before.half_blocks, before.bulk
        self._whole: NDArray[np.int64]
        self._whole_diagonal: Array
        self._whole, self._whole_diagonal = self._of_whole(before)
        #: Diagonal blocks of the bonds' special particles, surface's nodes apart, (entries, those).
        self.special_diagonal: Array = self._of_special(before)
        #: Runs of particles of one kind, as the kernels read them.
        self.segments, self.diagonal = self._layout()
        #: Stiffness of the bonds that end at the surface, if there are any.
        self.ended_stiffness: SurfaceStiffness | None = None
        if bonds.ended is not None:
            self.ended_stiffness = stiffness_of(bonds.ended, bonds.family, moduli)
            self._add_surface()
        #: What calibrated tips add; see `calibrate_tips`.
        self.tips: tuple[TipStiffness, ...] = ()
        #: Positions of their particles among the active ones.
        self.at_tips: tuple[NDArray[np.int64], ...] = ()

    def calibrate_tips(self, tips: Sequence[TipStiffness]) -> None:
        """Add the stiffness of calibrated tips, whose particles are active and wholly free.

        Diagonal blocks, and so preconditioners, know nothing of it: it changes energies by
        factors of 0.1 to 4 in few modes, and iterations by one at most (13 tips, m = 2).
        """
        self.tips = tuple(tips)
        self.at_tips = tuple(np.searchsorted(self.active, tip.particles) for tip in tips)

    def _add_surface(self) -> None:
        """Put the particles' part of the ended bonds into the diagonal blocks."""
        surface = self.ended_stiffness
        assert surface is not None
        position = np.full(self.bonds.lattice.count, -1)
        position[self.active] = np.arange(len(self.active))
        at = position[surface.particles]
        #: Active particles with ended bonds, and which of the surface's particles they are.
        self.at_surface: NDArray[np.int64] = at[at >= 0]
        self._on_surface = np.nonzero(at >= 0)[0]
        column = np.full(len(self.active), -1)
        column[self.own] = np.arange(len(self.own))
        self.diagonal[:, column[self.at_surface]] += surface.own[:, self._on_surface]

    def add_at_surface(self, out: Array, values: Array) -> None:
        """Add values of the surface's particles, (components, p), to a field of the active ones."""
        out[:, self.at_surface] += values[:, self._on_surface]

    def reaction(self, values: Array) -> Array:
        """What the surface's nodes do to the particles `at_surface`, both (components, those)."""
        assert self.ended_stiffness is not None
        given = np.zeros((self.components, len(self.ended_stiffness.particles)))
        given[:, self._on_surface] = values
        return self.ended_stiffness.reaction(given)[:, self._on_surface]

    def _sums(self, particles: NDArray[np.int64], factors: Array) -> Array:
        """Diagonal blocks of particles with factors (family size, n) on bonds: (entries, n)."""
        if not isinstance(self.moduli, Mixture):
            return _diagonal_sums(self.blocks[0], factors)
        found = np.empty((self.bulk.shape[1], len(particles)))
        of = self.moduli.of[particles]
        for phase, blocks in enumerate(self.blocks):
            found[:, of == phase] = _diagonal_sums(blocks, factors[:, of == phase])
        return found

    def _of_whole(self, before: BondOperator | None) -> tuple[NDArray[np.int64], Array]:
        """Particles short of neighbours or partly prescribed, and their blocks with whole bonds."""
        particles = self.bonds.short
        if self.identity_rows is not None:
            particles = np.union1d(particles, self.active[self.identity_rows.any(axis=0)])
        if before is not None and np.isin(particles, before._whole).all():
            return before._whole, before._whole_diagonal
        return particles, self._sums(particles, self.bonds.exist(particles).astype(np.float64))

    def _of_special(self, before: BondOperator | None) -> Array:
        """Diagonal blocks of special particles; only changed ones are summed up anew."""
        bonds = self.bonds
        if before is None or not np.isin(before.bonds.special, bonds.special).all():
            return self._sums(bonds.special, bonds.strengths)
        at = np.searchsorted(bonds.special, before.bonds.special)
        found = np.empty((self.bulk.shape[1], len(bonds.special)))
        found[:, at] = before.special_diagonal
        other = np.ones(len(bonds.special), dtype=bool)
        if len(at) == len(bonds.special):
            other = (bonds.strengths != before.bonds.strengths).any(axis=0)
        else:
            other[at] = (bonds.strengths[:, at] != before.bonds.strengths).any(axis=0)
        found[:, other] = self._sums(bonds.special[other], bonds.strengths[:, other])
        return found

    def _layout(self) -> tuple[NDArray[np.uint64], Array]:
        """Segments of the active particles and the diagonal blocks that differ from the bulk's."""
        bonds, lattice = self.bonds, self.bonds.lattice
        kind = np.full(lattice.count, segments.BULK, dtype=np.int64)
        kind[bonds.short] = segments.TRUNCATED
        kind[bonds.special] = segments.SPECIAL
        kind = kind[self.active]
        if self.identity_rows is not None:
            # Their blocks differ for whoever inverts them.
            kind[self.identity_rows.any(axis=0) & (kind == segments.BULK)] = segments.TRUNCATED
        own = kind != segments.BULK
        special = bonds.column[self.active]
        diagonal = np.empty((self.bulk.shape[1], int(own.sum())))
        some = kind == segments.SPECIAL
        diagonal[:, some[own]] = self.special_diagonal[:, special[some]]
        some = kind == segments.TRUNCATED
        known = np.searchsorted(self._whole, self.active[some])
        diagonal[:, some[own]] = self._whole_diagonal[:, known]
        column = np.cumsum(own) - 1
        found = segments.of(bonds.lattice, self.active, kind, column, special, self.phase)
        return found, diagonal

    # ---- products -----------------------------------------------------------------------

    def product(
        self,
        values: Array,
        masked: bool = False,
        segments: NDArray[np.uint64] | None = None,
        out: Array | None = None,
    ) -> Array:
        """K x for values of shape (components, active), in that shape.

        With `masked`, prescribed components of the values and of the result count as zero
        (instead of the identity rows of `matvec`). With `segments` (from `windows`,
        after `clear`) only their particles are read and written in `out`, and the reaction of
        the surface's nodes is left out, as is what calibrated tips add.
        """
        segments = self.segments if segments is None else segments
        values = np.ascontiguousarray(values, dtype=np.float64)
        masked_values = (
            values if self.identity_rows is None else np.where(self.identity_rows, 0.0, values)
        )
        # Only cells of active particles are ever written: the others stay zero.
        kernels.scatter(segments, masked_values, self.grid)
        out = self.apply_grid(self.grid, segments, out)
        if self.ended_stiffness is not None and segments is self.segments:
            out[:, self.at_surface] += self.reaction(masked_values[:, self.at_surface])
        if segments is self.segments:
            for at, tip in zip(self.at_tips, self.tips, strict=True):
                out[:, at] += tip.force(masked_values[:, at])
        if self.identity_rows is not None:
            out[self.identity_rows] = (
                0.0 if masked else self.identity_scale * values[self.identity_rows]
            )
        return out

    def clear(self) -> None:
        """Forget the last field: needed before products on a part of the body."""
        self.grid.fill(0.0)

    def windows(self, boxes: NDArray[np.int64]) -> NDArray[np.uint64]:
        """The parts of the segments within disjoint boxes of the padded grid.

        Parameters
        ----------
        boxes : ndarray of int, shape (n, 4)
            First row, first column, last row, last column of each, ends included.
        """
        return segments.clipped(self.segments, self.bonds.lattice.shape[1], boxes)

    def apply_grid(
        self, grid: Array, segments: NDArray[np.uint64] | None = None, out: Array | None = None
    ) -> Array:
        """Rows of the active particles for a field on the padded grid, (components, active)."""
        if out is None:
            out = np.empty((self.components, len(self.active)))
        self.kernel(
            grid,
            self.segments if segments is None else segments,
            self.steps,
            self.half_blocks,
            self.bulk,
            self.diagonal,
            self.strengths,
            out,
        )
        return out

    def _matvec(self, x: Array) -> Array:
        return self.product(np.asarray(x).reshape(self.components, -1)).ravel()

    def _adjoint(self) -> BondOperator:
        return self

    def coupling(self, prescribed: Array) -> Array:
        """K_fp u_p: rows of the active particles for prescribed values of shape (components, N)."""
        grid = np.zeros_like(self.grid)
        rows, columns = self.bonds.lattice.rows_columns
        # Parts set aside hold NaN and no bonds.
        grid[:, rows * self.bonds.lattice.shape[1] + columns] = np.nan_to_num(prescribed)
        out = self.apply_grid(grid)
        if self.ended_stiffness is not None:
            given = np.nan_to_num(prescribed[:, self.ended_stiffness.particles])
            self.add_at_surface(out, self.ended_stiffness.reaction(given))
        if self.identity_rows is not None:
            out[self.identity_rows] = 0.0
        return out

    def with_moduli(self, moduli: Moduli) -> BondOperator:
        """The operator of the same bonds and supports with other moduli."""
        fixed = np.ones((self.components, self.bonds.lattice.count), dtype=bool)
        fixed[:, self.active] = False if self.identity_rows is None else self.identity_rows
        return BondOperator(self.bonds, moduli, fixed)

    def shifted(self, diagonal: Array) -> BondOperator:
        """K plus a diagonal: the matrix of an implicit step, products at no extra cost.

        Parameters
        ----------
        diagonal : ndarray, shape (components, active)
            The same for all particles whose diagonal block is the bulk's.

        Raises
        ------
        ValueError
            If it is not.
        """
        place = {1: [0], 2: [0, 2], 3: [0, 2, 5]}[self.components]
        bulk = np.ones(len(self.active), dtype=bool)
        bulk[self.own] = False
        other = copy(self)
        other.__dict__.pop("block_diagonal", None)
        other.bulk, other.diagonal = self.bulk.copy(), self.diagonal.copy()
        for phase in range(len(self.bulk)):
            inner = diagonal[:, bulk & (self.phase == phase)]
            if not inner.size:
                continue
            if (inner != inner[:, :1]).any():
                raise ValueError("the diagonal differs between particles of the bulk")
            other.bulk[phase, place] += inner[:, 0]
        other.diagonal[place] += diagonal[:, self.own]
        return other

    def companion(self) -> BondOperator:
        """The same body with every negative modulus turned positive.

        Its condensed symbol is equivalent to that of the indefinite one, wave by wave, so that a
        preconditioner built on it takes as many iterations on any lattice; and the two have the
        same motions that strain no bond.
        """
        return self.with_moduli(self.moduli.absolute())

    def surface_basis(self, basis: sparse.csr_array | None = None) -> sparse.csr_array:
        """Values of the surface's particles for each unknown, or each column of `basis`.

        `basis` gives one component of the active particles, shape (active, columns), and serves
        all components alike.
        """
        assert self.ended_stiffness is not None
        size = (len(self.ended_stiffness.particles), len(self.active))
        pick = sparse.csr_array(
            (np.ones(len(self.at_surface)), (self._on_surface, self.at_surface)), shape=size
        )
        parts = []
        for component in range(self.components):
            part = pick
            if self.identity_rows is not None:
                part = part @ sparse.diags_array(
                    (~self.identity_rows[component]).astype(np.float64)
                )
            parts.append(part if basis is None else part @ basis)
        return sparse.csr_array(sparse.block_diag(parts, format="csr"))

    # ---- structure ----------------------------------------------------------------------

    @property
    def identity_scale(self) -> float:
        """Diagonal entry of the identity rows: the size of the bulk's."""
        return float(np.abs(self.bulk).max())

    @cached_property
    def block_diagonal(self) -> Array:
        """Diagonal blocks, shape (active, components, components)."""
        blocks = self.bulk_blocks[self.phase]
        blocks[self.own] = self.own_blocks
        return blocks

    @property
    def bulk_blocks(self) -> Array:
        """Diagonal block of a bulk particle of each phase, (phases, components, components)."""
        return self.as_blocks(np.ascontiguousarray(self.bulk.T))

    @cached_property
    def own(self) -> NDArray[np.int64]:
        """Positions among the active particles of those with a diagonal block of their own."""
        kinds, sizes = self.segments[:, [3, 1]].astype(np.int64).T
        return np.nonzero(np.repeat(kinds, sizes) != segments.BULK)[0]

    @property
    def own_blocks(self) -> Array:
        """Their diagonal blocks, shape (len(own), components, components)."""
        blocks = self.as_blocks(self.diagonal)
        if self.ended_stiffness is not None:
            self._relieve(blocks)
        if self.identity_rows is not None:
            where, component = np.nonzero(self.identity_rows.T[self.own])
            blocks[where, component, :] = blocks[where, :, component] = 0.0
            blocks[where, component, component] = self.identity_scale
        return blocks

    def _relieve(self, blocks: Array) -> None:
        """Let the surface's nodes give way to the particles that bonds tie to them stiffly.

        Exact for those; for the others what is left out is small and makes the block stiffer.
        """
        assert self.ended_stiffness is not None
        own = np.full(len(self.active), -1)
        own[self.own] = np.arange(len(self.own))
        at = own[self.at_surface]
        bulk = np.abs(np.einsum("pii->p", self.bulk_blocks))[self.phase[self.at_surface]]
        stiff = np.abs(np.einsum("pii->p", blocks[at])) > STIFF * bulk
        blocks[at[stiff]] += self.ended_stiffness.relief(self._on_surface[stiff])

    def as_blocks(self, entries: Array) -> Array:
        """Entries (entries, n) in the kernels' order as symmetric blocks (n, c, c)."""
        c = self.components
        blocks = np.empty((entries.shape[1], c, c))
        for values, (a, b) in zip(entries, block_entries(c), strict=True):
            blocks[:, a, b] = blocks[:, b, a] = values
        return blocks

    @property
    def directed_bonds(self) -> int:
        """Bonds that one product visits, each from both ends, missing and cut ones included."""
        return len(self.active) * self.bonds.family.size

    @property
    def nbytes(self) -> int:
        """Memory of what a product reads besides the fields."""
        arrays = (self.segments, self.steps, self.half_blocks, self.bulk, self.diagonal)
        surface = 0 if self.ended_stiffness is None else self.ended_stiffness.nbytes
        return sum(a.nbytes for a in arrays) + self.bonds.nbytes + surface


def _diagonal_sums(blocks: Array, factors: Array) -> Array:
    """Diagonal blocks for bond factors of shape (family size, n): (entries, n).

    Order 11, 22 … as the kernels read it: 11, 12, 22, 1θ, 2θ, θθ. Bond by bond, so that the bits
    of a particle's block do not depend on how many others are summed up with it.
    """
    total = np.zeros((blocks.shape[1], factors.shape[1]))
    for block, factor in zip(blocks, factors, strict=True):
        total += block[:, None] * factor
    return total
