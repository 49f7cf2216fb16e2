"""What single bonds know beyond their offset: missing, cut by a crack, stiffened at a surface.

A bulk bond is an offset and is stored nowhere. Only particles with at least one bond that
differs, the *special* ones, own a column of factors: 0 for a bond that is missing or cut, the
surface factor for the others. A particle that merely lacks neighbours needs no factors either,
because fields are zero outside the body; it is *truncated* and only its diagonal block differs.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from ..arrays import Array, Indices, Mask
from ..errors import NoOutlineError, SceneError
from ..geometry import Body, Crack, CrackSet, Frame, Lattice, Outline, Phases
from ..geometry.outline import INNER
from ..material import Family
from .ended import Chords, EndedBonds
from .factors import Factors
from .volume_method import Surface, full_volume, volume_factor

# Cells along an interface in which what is wrong at its end in a support has faded to rounding.
_FADED = 24
# Share of a length within which two are equal.
_TIE = 1e-9


class Bonds:
    """Bond factors of a body.

    Parameters
    ----------
    lattice : Lattice
    family : Family
    cracks : sequence of Crack
    treatment : {"none", "volume", "extrapolated"}
    prescribed : ndarray of bool, shape (N,)
        Particles that are wholly prescribed: the body's edge is no surface for them.
    broken : ndarray of bool, shape (family size / 2, N), optional
        Bonds, by half offset and particle of origin, that carry nothing. Unlike a crack that was
        always there they make no surface: the bonds that are left are not stiffened.
    sharp_tips : bool
        Whether the two faces of a crack share the node of each tip; they must not once it grows.
    outline : Outline, optional
        The body's, with these cracks and tips, where it has been drawn already.
    phases : Phases, optional
        Of a body of several: bonds end at their interfaces, whatever the treatment of surfaces.

    Raises
    ------
    SceneError
        If a crack lies outside the body, or `broken` has the wrong shape.
    """

    def __init__(
        self,
        lattice: Lattice,
        family: Family,
        cracks: Sequence[Crack] = (),
        treatment: Surface = "none",
        prescribed: Mask | None = None,
        broken: Mask | None = None,
        sharp_tips: bool = True,
        outline: Outline | None = None,
        phases: Phases | None = None,
    ) -> None:
        self.lattice, self.family, self.treatment = lattice, family, treatment
        self._drawn, self.phases = outline, phases
        rows, columns = lattice.rows_columns
        free = np.ones(lattice.count, bool) if prescribed is None else ~prescribed
        #: Particles that lack at least one neighbour.
        self.short: Indices = np.nonzero(~_whole(lattice.mask, family.offsets)[rows, columns])[0]
        #: What the answer leaves out or settles by a rule, one sentence each.
        self.warnings: tuple[str, ...] = ()
        #: The body's polygon, None where its region does not say where its edges run.
        self.body: Body | None = self._polygon()
        #: All cracks as one set.
        self.cracks: CrackSet
        cut_at, cut = self._cut_bonds(cracks)
        #: Particles with bonds that leave the body on their way to a neighbour that is there, and
        #: which these are, shape (family size, particles). They do not exist.
        self.outside_at: Indices
        self.outside: Mask
        self.outside_at, self.outside = self._outside()
        broken_at, broken_there = self._both_ends(broken)

        special = np.zeros(lattice.count, dtype=bool)
        special[cut_at] = True
        special[self.outside_at] = True
        special[broken_at] = True
        volume = np.full(lattice.count, full_volume(family))
        if treatment == "volume":
            physical = self.short[free[self.short]]
            missing = (family.fraction[:, None] * self._open(physical, free)).sum(axis=0)
            volume[physical] -= missing
            volume[cut_at] -= (family.fraction[:, None] * cut).sum(axis=0)
            deficient = volume < full_volume(family) * (1 - 1e-12)
            if deficient.any():
                grid = np.ones(lattice.shape, dtype=bool)
                grid[rows[deficient], columns[deficient]] = False
                special |= ~_whole(grid, _disc(family))[rows, columns]
        #: Particles that own a column of `factors`, in the lattice's order.
        self.special: Indices = np.nonzero(special)[0]
        factors = self.exist(self.special).astype(np.float64)
        if treatment == "volume" and len(self.special):
            volumes = np.zeros(lattice.shape)
            volumes[rows, columns] = volume
            here = volume[self.special]
            for o, (dx, dy) in enumerate(family.offsets):
                there = volumes[rows[self.special] + dy, columns[self.special] + dx]
                factors[o] *= volume_factor(family, here, there)
        for at, gone in ((cut_at, cut), (self.outside_at, self.outside)):
            factors[:, np.searchsorted(self.special, at)] *= ~gone
        if len(broken_at):
            factors[:, np.searchsorted(self.special, broken_at)] *= ~broken_there
        #: Factor of each bond of a special particle, shape (family size, special).
        self.strengths: Array = factors
        #: Bonds that end at the surface, if the treatment has any.
        self.ended: EndedBonds | None = None
        if phases is not None:
            self.ended = self._end_phases(phases, cracks, (cut_at, cut), free, sharp_tips)
            if self.ended is not None and treatment == "volume":
                self.ended = self._stiffened(self.ended, volume)
        elif treatment == "extrapolated":
            self.ended = self._end(cut_at, cut, free, broken_at, sharp_tips)

    def breaking(self, offsets: Indices, origins: Indices) -> Bonds:
        """These bonds with some more of them broken; what has not changed is shared.

        Parameters
        ----------
        offsets, origins : ndarray of int, shape (n,)
            Half offset and particle of origin of each bond that breaks. All must exist.
        """
        rows, columns = self.lattice.rows_columns
        half = self.family.size // 2
        dx, dy = self.family.offsets[offsets].T
        ends = self.lattice.number()[rows[origins] + dy, columns[origins] + dx]
        special = np.union1d(self.special, np.union1d(origins, ends))
        if len(special) == len(self.special):
            factors = self.strengths.copy()
        else:
            factors = np.empty((self.family.size, len(special)))
            known = np.zeros(len(special), dtype=bool)
            known[np.searchsorted(special, self.special)] = True
            factors[:, known] = self.strengths
            # A particle becomes special: as yet its bonds are those of the bulk.
            factors[:, ~known] = self.exist(special[~known])
        factors[offsets, np.searchsorted(special, origins)] = 0.0
        factors[offsets + half, np.searchsorted(special, ends)] = 0.0
        result = copy(self)
        result.__dict__.pop("column", None)
        result.special, result.strengths = special, factors
        return result

    def scaled(self, factors: Factors) -> Bonds:
        """These bonds with a factor on each: every particle becomes special."""
        result = self.times(np.arange(self.lattice.count), factors.whole)
        if self.ended is not None:
            result.ended = self.ended.scaled(factors)
        return result

    def times(self, particles: Indices, factors: Array) -> Bonds:
        """These bonds with factors on those of some particles, (family size, particles).

        Both ends of a bond must say the same.
        """
        result = copy(self)
        result.__dict__.pop("column", None)
        result.special = np.union1d(self.special, particles)
        result.strengths = self.strengths_of(result.special)
        result.strengths[:, np.searchsorted(result.special, particles)] *= factors
        return result

    def without_ends(self, particles: Indices) -> Bonds:
        """These bonds less those of some particles that end at the surface."""
        result = copy(self)
        if self.ended is not None:
            result.ended = self.ended.without(particles)
        return result

    def ending(self, ended: EndedBonds) -> Bonds:
        """These bonds with others that end at the surface."""
        result = copy(self)
        result.ended = ended if len(ended) else None
        return result

    def exist(self, particles: Indices) -> Mask:
        """Which neighbours the particles have, reached or not, shape (family size, particles)."""
        rows, columns = (axis[particles] for axis in self.lattice.rows_columns)
        dx, dy = self.family.offsets.T
        return self.lattice.mask[rows + dy[:, None], columns + dx[:, None]]

    def _open(self, particles: Indices, free: Mask) -> Mask:
        """Which neighbours the particles lack at a physical edge, like `exist`.

        An empty cell that is no nearer to a free particle than to a prescribed one lies beyond a
        support, thin as its layer may be, and is no surface.
        """
        lattice = self.lattice
        rows, columns = lattice.rows_columns
        beyond = np.zeros(lattice.shape, dtype=bool)
        if not free.all():
            away = _disc(self.family)
            distance = (away**2).sum(axis=1)
            kinds = []
            for kind in (free, ~free):
                grid = np.zeros(lattice.shape, dtype=bool)
                grid[rows[kind], columns[kind]] = True
                kinds.append(grid)
            # Cells that a free particle is within reach of, nearest ones first.
            reached = np.zeros(lattice.shape, dtype=bool)
            for level in np.unique(distance):
                near_free, near_held = (~_whole(~grid, away[distance == level]) for grid in kinds)
                beyond |= near_held & ~reached
                reached |= near_free
        dx, dy = self.family.offsets.T
        there = rows[particles] + dy[:, None], columns[particles] + dx[:, None]
        return ~(lattice.mask | beyond)[there]

    def _end(
        self,
        cut_at: Indices,
        cut: Mask,
        free: Mask,
        broken_at: Indices,
        sharp_tips: bool,
    ) -> EndedBonds | None:
        """The bonds that end at a surface which a particle with a free unknown feels."""
        lattice, family = self.lattice, self.family
        particles = np.union1d(np.union1d(self.short, cut_at), self.outside_at)
        # A particle that has lost all its bonds to others holds no surface.
        bare = broken_at[self.strengths_of(broken_at).sum(axis=0) == 0]
        particles = np.setdiff1d(particles, bare, assume_unique=True)
        if not free[particles].any():
            return None
        lost = ~self.exist(particles)
        for at, gone in ((cut_at, cut), (self.outside_at, self.outside)):
            kept = np.isin(at, particles)
            lost[:, np.searchsorted(particles, at[kept])] |= gone[:, kept]
        outline = self._drawn or Outline.of(
            lattice.region, self.cracks, lattice.spacing, sharp_tips=sharp_tips
        )
        free = free[particles]
        ended = EndedBonds.of(lattice, family, outline, particles[free], lost[:, free])
        if free.all():
            return ended.with_chords(lattice, family)
        # Prescribed particles hold the surface where free ones feel it.
        reach = 2 * float(family.length.max())
        tree = KDTree(lattice.points[particles[free]])
        distance, _ = tree.query(lattice.points[particles], distance_upper_bound=reach)
        near = ~free & np.isfinite(distance)
        others = EndedBonds.of(lattice, family, outline, particles[near], lost[:, near])
        return ended.joined(others).with_chords(lattice, family)

    def _polygon(self) -> Body | None:
        try:
            return Body.of(self.lattice)
        except NoOutlineError:
            self.warnings += (
                f"a {type(self.lattice.region).__name__} has no outline: whether bonds stay inside "
                f"the body is judged by their particles alone, and slots are bridged",
            )
            return None

    def _outside(self) -> tuple[Indices, Mask]:
        """Particles with bonds that leave the body on their way, and which these are."""
        if self.body is None:
            return np.zeros(0, dtype=np.int64), np.zeros((self.family.size, 0), dtype=bool)
        found = self.body.leaving(self.lattice, self.family.offsets)
        return found if self.phases is None else self._outside_phases(self.phases, found)

    def _outside_phases(
        self, phases: Phases, leaving: tuple[Indices, Mask]
    ) -> tuple[Indices, Mask]:
        """The same of a body of several phases: bonds stay in their own."""
        lattice, offsets = self.lattice, self.family.offsets
        gone = np.zeros((self.family.size, lattice.count), dtype=bool)
        for k, (part, body) in enumerate(zip(phases.lattices, phases.bodies, strict=True)):
            at, left = body.leaving(part, offsets)
            gone[:, np.nonzero(phases.of == k)[0][at]] = left
        grid = np.full(lattice.shape, -1, dtype=np.int64)
        grid[lattice.mask] = phases.of
        rows, columns = lattice.rows_columns
        for o, (dx, dy) in enumerate(offsets):
            there = grid[rows + dy, columns + dx]
            gone[o] |= (there >= 0) & (there != phases.of)
        gone[:, leaving[0]] |= leaving[1]
        at = np.nonzero(gone.any(axis=0))[0]
        return at, gone[:, at]

    def _end_phases(
        self,
        phases: Phases,
        cracks: Sequence[Crack],
        cut: tuple[Indices, Mask],
        free: Mask,
        sharp_tips: bool,
    ) -> EndedBonds | None:
        """As `_end`, of a body of several phases."""
        lattice, family, everything = self.lattice, self.family, self.treatment == "extrapolated"
        lost = np.zeros((family.size, lattice.count), dtype=bool)
        lost[:, self.outside_at] = self.outside
        if everything:
            lost[:, self.short] |= ~self.exist(self.short)
            lost[:, cut[0]] |= cut[1]
        elif self.body is not None:
            # What leaves the body, or meets a crack, is missing or cut as in a body of one phase.
            at, left = self.body.leaving(lattice, family.offsets)
            lost[:, at] &= ~left
            lost[:, cut[0]] &= ~cut[1]
        outline = self._drawn or phases.outline(cracks, sharp_tips)
        found, chords = [], []
        for k, piece in enumerate(outline.pieces):
            mine = np.nonzero((phases.of == k) & lost.any(axis=0))[0]
            part = EndedBonds.of(lattice, family, piece, mine, lost[:, mine])
            found.append(replace(part, outline=outline, edge=part.edge + outline.starts[k]))
            chords.append(Chords.of(phases.lattices[k], family, piece))
        corners = Chords.joined(chords, outline.starts)
        names = ("particle", "offset", "edge", "position", "length")
        all_of: dict[str, Any] = {
            name: np.concatenate([getattr(part, name) for part in found]) for name in names
        }
        ended = EndedBonds(outline, **all_of, surface=everything)
        if not everything:
            ended = ended.kept(outline.face[ended.edge] == INNER)
            if corners is not None:
                corners = corners.kept((outline.face[corners.edge] == INNER).all(axis=1))
        felt = free[ended.particle]
        if not felt.any():
            return None
        # Prescribed particles hold the nodes that free ones feel. Where the chain of nodes ends
        # within a support its last one is wrong, and each before it by a quarter of that.
        points = lattice.points[ended.particle]
        distance, _ = KDTree(points[felt]).query(points)
        far = (2 * family.reach + _FADED) * lattice.spacing
        return ended.kept(distance <= far).between(corners)

    def _stiffened(self, ended: EndedBonds, volume: Array) -> EndedBonds:
        """Bonds that end at an interface, stiffened as they would be if they went on."""
        rows, columns = (axis[ended.particle] for axis in self.lattice.rows_columns)
        dx, dy = self.family.offsets[ended.offset].T
        there = self.lattice.number()[rows + dy, columns + dx]
        factor = volume_factor(self.family, volume[ended.particle], volume[there])
        return replace(ended, factor=factor)

    def _both_ends(self, broken: Mask | None) -> tuple[Indices, Mask]:
        """Particles with broken bonds and which, from the half offsets of one end."""
        half = self.family.size // 2
        if broken is None:
            return np.zeros(0, dtype=np.int64), np.zeros((self.family.size, 0), dtype=bool)
        if broken.shape != (half, self.lattice.count) or broken.dtype != bool:
            raise SceneError(
                f"broken bonds are given as booleans of shape {(half, self.lattice.count)} "
                f"(half offsets × particles), not {broken.dtype} {broken.shape}"
            )
        rows, columns = self.lattice.rows_columns
        number = self.lattice.number()
        whole = np.zeros((2 * half, self.lattice.count), dtype=bool)
        for o, (dx, dy) in enumerate(self.family.offsets[:half]):
            neighbour = number[rows + dy, columns + dx]
            start = np.nonzero(broken[o] & (neighbour >= 0))[0]
            whole[o, start] = True
            whole[o + half, neighbour[start]] = True
        particles = np.nonzero(whole.any(axis=0))[0]
        return particles, whole[:, particles]

    def _cut_bonds(self, cracks: Sequence[Crack]) -> tuple[Indices, Mask]:
        """Particles with bonds that cracks cut, and which these are."""
        self.cracks = CrackSet.joined(Frame.of(self.lattice), cracks, self.body)
        particles, cut, met, lying = self.cracks.cut(self.lattice, self.family.offsets)
        for crack, found in zip(cracks, met, strict=True):
            if not found:
                raise SceneError(
                    f"the crack through {crack.drawn} cuts no bond: it lies outside the body "
                    f"or beyond its last particles"
                )
        if lying:
            self.warnings += (
                f"{lying} particles lie on a crack: they belong to its upper side, where it is "
                f"upright to its right, and it seems to run half a cell from where it is drawn",
            )
        return particles, cut

    @cached_property
    def column(self) -> NDArray[np.int64]:
        """Column of `factors` of every particle, −1 for those without one, shape (N,)."""
        columns = np.full(self.lattice.count, -1, dtype=np.int64)
        columns[self.special] = np.arange(len(self.special))
        return columns

    def strength(self, offset: int) -> Array:
        """Factor of the bond with family index `offset` of every particle, shape (N,)."""
        rows, columns = self.lattice.rows_columns
        dx, dy = self.family.offsets[offset]
        values = self.lattice.mask[rows + dy, columns + dx].astype(np.float64)
        values[self.special] = self.strengths[offset]
        return values

    def strengths_of(self, particles: Indices) -> Array:
        """Factors of all bonds of some particles, shape (family size, particles)."""
        factors = self.exist(particles).astype(np.float64)
        columns = self.column[particles]
        factors[:, columns >= 0] = self.strengths[:, columns[columns >= 0]]
        return factors

    def lengths_left(self, particles: Indices) -> Array:
        """What is left, m, of bonds that end at the surface, zero of others; as `strengths_of`."""
        found = np.zeros((self.family.size, len(particles)))
        if self.ended is not None:
            column = np.full(self.lattice.count, -1)
            column[particles] = np.arange(len(particles))
            at = column[self.ended.particle]
            mine = at >= 0
            found[self.ended.offset[mine], at[mine]] = self.ended.length[mine]
        return found

    @property
    def nbytes(self) -> int:
        """Memory of everything stored for single bonds."""
        ended = 0 if self.ended is None else self.ended.nbytes
        return int(self.strengths.nbytes + self.special.nbytes + self.short.nbytes + ended)


def _whole(grid: Mask, offsets: Indices) -> Mask:
    """Cells of a grid from which all offsets lead to cells of it; beyond its rim all are."""
    far, (rows, columns) = int(np.abs(offsets).max()), grid.shape
    padded = np.pad(grid, far, constant_values=True)
    found = np.ones_like(grid)
    for dx, dy in offsets + far:
        found &= padded[dy : dy + rows, dx : dx + columns]
    return found


def _disc(family: Family) -> Indices:
    """All cells no farther than the longest bond, (n, 2)."""
    longest = float(np.hypot(*family.offsets.T).max()) * (1 + _TIE)
    far = int(longest)
    cells = np.indices((2 * far + 1,) * 2).reshape(2, -1).T - far
    return np.asarray(cells[np.hypot(*cells.T) <= longest])


def damage(bonds: Bonds) -> Array:
    """Share of each particle's family that is cut or broken (Eq. 105), shape (N,).

    Neighbours count by their area fractions. Those that the body's edge leaves out are not part
    of the family; cuts by the scene's cracks count as damage.
    """
    family, count = bonds.family, bonds.lattice.count
    result = np.zeros(count)
    special = bonds.special
    if len(special):
        exist = bonds.exist(special)
        exist[:, np.searchsorted(special, bonds.outside_at)] &= ~bonds.outside
        gone = exist & (bonds.strengths == 0)
        whole = np.einsum("o,on->n", family.fraction, exist.astype(np.float64))
        lost = np.einsum("o,on->n", family.fraction, gone.astype(np.float64))
        result[special] = lost / np.where(whole > 0, whole, 1.0)
    return result
