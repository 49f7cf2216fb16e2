"""Which bonds are overloaded, and which of them break next (Sect. 3, Eq. 104).

A bond of the pair {p, q} stores the energy density w = ½ |ξ| (k_n s² + k_t γ²) and holds
w α Λ f Δv_p Δv_q in all, f being its surface factor. It breaks when f w reaches its critical w_c:
what breaking costs is then w_c α Λ Δv_p Δv_q, whatever the surface treatment, so that a cut
costs what the toughness was calibrated for.

Bonds are held once, by half offset and particle of origin, the only bond state there is.
"""

from __future__ import annotations

from typing import Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from .. import threads
from ..arrays import Array, Indices, Mask
from ..errors import SceneError
from ..geometry import Where, select
from ..magnitude import STRAINS, outside
from ..material import ChiralModuli, ElasticModuli, Family, PolarModuli
from ..material.strains import elongations
from ..operators import kernels, segments
from ..problem import Discretisation, thickness
from . import bond_kernels
from .broken import BrokenBonds

Criterion = Literal["total", "axial"]

# Utilisations that differ by less than this share are one event: mirror images break together,
# though the solver's tolerance tells them apart.
TIE = 1e-4


class Critical(Protocol):
    """Anything that knows the critical energy density of every bond of a family."""

    def energies(self, family: Family) -> Array:
        """w_c, shape (family size,), J/m⁶."""


def critical_energies(toughness: Critical | ArrayLike, family: Family) -> Array:
    """w_c of the half offsets from a toughness object or one value a family offset.

    Raises
    ------
    SceneError
        If a value is not positive and finite, or opposite bonds differ.
    """
    if hasattr(toughness, "energies"):
        given = np.asarray(toughness.energies(family), dtype=np.float64)
    else:
        given = np.asarray(toughness, dtype=np.float64)
    if given.ndim == 0:
        given = np.full(family.size, float(given))
    if given.shape != (family.size,):
        raise SceneError(
            f"critical bond energies need one value for each of the {family.size} bonds of a "
            f"family, got shape {given.shape}"
        )
    half = family.size // 2
    if not np.allclose(given[:half], given[half:], rtol=1e-9, atol=0.0):
        raise SceneError("a bond and its opposite need the same critical energy")
    if not (np.all(np.isfinite(given)) and np.all(given > 0)):
        raise SceneError(
            f"critical bond energies must be positive and finite, not {given.min():g} … "
            f"{given.max():g}: a bond without toughness has broken before it is loaded"
        )
    return given[:half].copy()


class Breakable:
    """Energies and strengths of all bonds of a body.

    Parameters
    ----------
    discretisation : Discretisation
        Of an elastic scene.
    toughness : object with ``energies(family)``, or array of shape (family size,)
        Critical energy densities w_c, J/m⁶.
    no_fail : sequence of Region or callable
        Bonds with an end in one of these never break.
    tension_only : bool
        Bonds that are shortened (s < 0) do not break.
    criterion : {"total", "axial"}
        ``total``: w as stored (Eq. 4): w_s + w_γ, and w_χ of the bending of a polar bond.
        ``axial``: its part ½ |ξ| k_n s² only.

    Raises
    ------
    SceneError
        If a modulus is negative for which the criterion has no meaning.

    Notes
    -----
    Where k_t < 0 (isotropic ν > 1/3, generally C66 < C12) a bond that is sheared stores
    *negative* energy: w is no measure of its load, breaking it takes energy out of nothing, and
    the total criterion is refused. The axial criterion compares the energy of the stretch alone
    with w_c; the balance of energies still closes, because what a bond held beyond its w_c (here
    possibly less than nothing) is booked as excess. A negative k_n is refused in any case.
    """

    def __init__(
        self,
        discretisation: Discretisation,
        toughness: Critical | ArrayLike,
        no_fail: tuple[Where, ...] = (),
        tension_only: bool = True,
        criterion: Criterion = "total",
    ) -> None:
        moduli, family = discretisation.moduli, discretisation.family
        if discretisation.scene.inclusions:
            raise SceneError(
                "cracks do not grow in a body with inclusions: bonds that end at an interface "
                "have no strength"
            )
        if not moduli.physics.breakable or not isinstance(moduli, ElasticModuli):
            raise SceneError(
                f"bonds break in elastic bodies only: {moduli.physics.name} has no bond energy"
            )
        if criterion not in ("total", "axial"):
            raise SceneError(f"criterion must be 'total' or 'axial', not {criterion!r}")
        _refuse_negative(moduli, criterion)
        half = family.size // 2
        lattice = discretisation.lattice
        self.lattice, self.family, self.tension_only = lattice, family, bool(tension_only)
        self.critical = critical_energies(toughness, family)
        #: Thickness of every bond, (half, N), or of all, m: breaking costs w_c per thickness.
        self.thickness: Array = _thickness(discretisation, half)
        #: Energy of a pair per unit of its energy density, m⁴ per unit thickness.
        self.pair = family.weight[:half] * family.cell_area**2
        axial = 0.5 * moduli.normal[:half] / family.length[:half]
        shear = 0.5 * moduli.shear[:half] / family.length[:half]
        _require_range(self.critical, axial * family.length[:half] ** 2)
        arm = 0.5 * family.length[:half] / family.spacing
        terms = [family.normal[:half], arm, axial, shear]
        #: |ξ| times the strains that temperatures cause by themselves at unit load, (2, half, N).
        self.free: Array = free_strains(discretisation)
        #: Whether bonds store energy of bending, or temperatures strain them.
        self.rich = isinstance(moduli, PolarModuli) or self.free.shape[2] > 0
        if self.rich:
            bending = np.zeros(half)
            if isinstance(moduli, PolarModuli):
                # The kernels know rotations as θ Δx.
                bending = 0.5 * moduli.bending[:half] / family.length[:half]
            terms.append(bending / family.spacing**2)
        geometry = np.column_stack(terms)
        stored = geometry.copy()
        stored[:, 3:] *= self.pair[:, None]
        self._stored = stored
        load = geometry.copy()
        load[:, 3:] /= self.critical[:, None]
        if criterion == "axial":
            load[:, 4:] = 0.0
        self._load = load
        row = lattice.shape[1]
        dx, dy = family.offsets[:half].T
        self._steps = (dy * row + dx).astype(np.uint64)
        rows, columns = lattice.rows_columns
        self._cells = rows * row + columns
        self._segments = self._runs(np.arange(lattice.count))
        self._number = lattice.number()
        #: Factor of every bond as it was at the start, 0 where there is none, (half, N).
        self.whole: Array = np.stack([discretisation.bonds.strength(o) for o in range(half)])
        #: The record of those that have broken.
        self.broken = BrokenBonds()
        self._strengths, self._followed = self.whole.copy(), 0
        #: Bonds that must not break, (half, N), or None.
        self.kept: Mask = self._kept(discretisation, no_fail)
        # What utilisation counts of each bond: nothing of those that must not break.
        self._weakness = np.where(self.kept, 0.0, self.whole / self.thickness)
        self._out = np.empty_like(self.whole)
        #: How often utilisation was asked for: its last answer is overwritten.
        self.asked = 0
        self._grids = np.zeros((2, 3, int(np.prod(lattice.shape))))
        self._threads = threads.worth(discretisation.operator)

    def _kept(self, discretisation: Discretisation, no_fail: tuple[Where, ...]) -> Mask:
        zone = np.zeros(self.lattice.count, dtype=bool)
        for where in no_fail:
            zone |= select(self.lattice, where)
        held = discretisation.held
        rows, columns = self.lattice.rows_columns
        kept = np.zeros(self.whole.shape, dtype=bool)
        for o, (dx, dy) in enumerate(self.family.offsets[: len(kept)]):
            there = self._number[rows + dy, columns + dx]
            # Between prescribed particles nothing can be relieved: the support is rigid.
            kept[o] = zone | zone[there] | (held & held[there])
        return kept

    @property
    def strengths(self) -> Array:
        """Factor of every bond as the record of broken bonds leaves it, shape (half, N)."""
        self._follow()
        return self._strengths

    def _follow(self) -> None:
        """Catch up with the record of broken bonds."""
        if self._followed != len(self.broken):
            gone = self.broken.between(self._followed)
            self._strengths.ravel()[gone] = self._weakness.ravel()[gone] = 0.0
            self._followed = len(self.broken)

    # ---- energies -----------------------------------------------------------------------

    def _grid(self, which: int, unknowns: Array) -> Array:
        grid = self._grids[which]
        # Kernels are compiled for arrays that may be written to.
        given = np.array(unknowns) if np.isfinite(unknowns).all() else np.nan_to_num(unknowns)
        kernels.scatter(self._segments, given, grid[: len(unknowns)])
        return grid

    def utilisation(self, unknowns: Array) -> Array:
        """f w / w_c of every bond, shape (half, N); 0 where it cannot break.

        Parameters
        ----------
        unknowns : ndarray, shape (components, N)
            u1, u2 and θ Δx.

        Returns
        -------
        ndarray
            Overwritten by the next call.
        """
        grid = self._grid(0, unknowns)
        self._follow()
        self.asked += 1
        rest = self._load, self._weakness, self.tension_only, self._out
        with threads.at_most(self._threads):
            if self.rich:
                bond_kernels.rich_energies(grid, self.free, self._segments, self._steps, *rest)
            else:
                bond_kernels.bond_energies(grid, self._segments, self._steps, *rest)
        return self._out

    def stored(self, unknowns: Array, others: Array | None = None) -> float:
        """Energy of all bonds between particles, J per unit thickness.

        With `others`, half the mutual energy of the two fields: of the mechanical strain of the
        first and all of the second's.
        """
        grid = self._grid(0, unknowns)
        other = grid if others is None else self._grid(1, others)
        runs = self._segments if others is None else self._runs(self._straining(other))
        out = np.empty(len(runs))
        rest = runs, self._steps, self._stored, self.strengths, out
        with threads.at_most(self._threads):
            if self.rich:
                more = self.free if others is None else self.free[:, :, :0]
                bond_kernels.rich_work(grid, self.free, other, more, *rest)
            else:
                bond_kernels.bond_work(grid, other, *rest)
        return float(out.sum())

    def expansion_work(self, unknowns: Array, free: Array) -> float:
        """−Σ L k (ε − e)·e′ Δv Δv: what an expansion e′ does against the bonds, J per thickness.

        Parameters
        ----------
        unknowns : ndarray, shape (components, N)
        free : ndarray, shape (2, half, N)
            |ξ| times the strains e′, as in `free`.
        """
        grid, still = self._grid(0, unknowns), np.zeros_like(self._grids[1])
        out = np.empty(len(self._segments))
        rest = self._segments, self._steps, self._stored, self.strengths, out
        with threads.at_most(self._threads):
            bond_kernels.rich_work(grid, self.free, still, free, *rest)
        return 2.0 * float(out.sum())

    def _straining(self, grid: Array) -> Indices:
        """Particles of origin of bonds that a field on the padded grid may strain."""
        near = grid.any(axis=0).reshape(self.lattice.shape)
        for axis in (0, 1):
            near = ndimage.maximum_filter1d(near, 2 * self.family.reach + 1, axis=axis)
        return np.nonzero(near.ravel()[self._cells])[0]

    def _runs(self, particles: Indices) -> NDArray[np.uint64]:
        """These particles as the kernels read them."""
        cell, size, first = segments.runs(self.lattice, particles, np.zeros_like(particles))
        return np.column_stack([cell, size, particles[first]]).astype(np.uint64)

    def energy_of(self, unknowns: Array, bonds: Indices) -> Array:
        """Energy that single bonds hold, J per unit thickness; `bonds` are flat indices."""
        o, p, q = self.ends(bonds)
        nx, ny, half, *stored = self._stored[o].T
        here, there = np.zeros((2, 3, len(bonds)))
        here[: len(unknowns)] = np.nan_to_num(unknowns[:, p])
        there[: len(unknowns)] = np.nan_to_num(unknowns[:, q])
        turn = half * (there[2] + here[2])
        strains = ("s", "γ", "χ")[: len(stored)]
        found = elongations(strains, np.stack([nx, ny]), there - here, turn)
        if self.free.shape[2]:
            found[:2] -= self.free[:, o, p]
        return self.strengths.ravel()[bonds] * np.einsum("ak,ak->k", np.stack(stored), found**2)

    def cost_of(self, bonds: Indices) -> Array:
        """Energy that breaking these bonds takes, w_c α Λ Δv_p Δv_q."""
        offsets, origins = np.divmod(bonds, self.lattice.count)
        thick = np.broadcast_to(self.thickness, self.whole.shape)[offsets, origins]
        return thick * (self.critical * self.pair)[offsets]

    # ---- geometry -----------------------------------------------------------------------

    def ends(self, bonds: Indices) -> tuple[Indices, Indices, Indices]:
        """Half offset, particle of origin and particle at the far end of bonds by flat index."""
        o, p = np.divmod(bonds, self.lattice.count)
        rows, columns = self.lattice.rows_columns
        dx, dy = self.family.offsets[o].T
        return o, p, self._number[rows[p] + dy, columns[p] + dx]

    def midpoints(self, bonds: Indices) -> Array:
        """Midpoints of bonds, shape (n, 2), m."""
        points = self.lattice.points
        _, p, q = self.ends(bonds)
        return 0.5 * (points[p] + points[q])

    def lengths(self, bonds: Indices) -> Array:
        """Lengths of bonds, m."""
        return self.family.length[bonds // self.lattice.count]

    def of_particles(self, particles: Indices) -> Indices:
        """Flat indices of all bonds with an end at one of `particles` that still exist."""
        rows, columns = self.lattice.rows_columns
        half, count = self.strengths.shape
        mine = np.zeros(count, dtype=bool)
        mine[particles] = True
        found = []
        for o, (dx, dy) in enumerate(self.family.offsets[:half]):
            back = self._number[rows[particles] - dy, columns[particles] - dx]
            starts = np.union1d(particles, back[back >= 0])
            found.append(o * count + starts[self.strengths[o, starts] != 0])
        return np.concatenate(found)


def free_strains(body: Discretisation) -> Array:
    """|ξ| times stretch and shear without stress of every bond, (2, half, N), or (2, half, 0)."""
    family, half = body.family, body.family.size // 2
    if body.eigenstrain is None:
        return np.zeros((2, half, 0))
    found = np.zeros((2, half, body.lattice.count))
    for o in range(half):
        strains = body.eigenstrain.of_offset(o)[:2]
        found[: len(strains), o] = family.length[o] * strains
    return found


def next_batch(utilisation: Array, least: float, size: int) -> tuple[Indices, Array]:
    """The most loaded bonds: `size` of them, or a few more where bonds tie.

    Parameters
    ----------
    utilisation : ndarray, shape (half, N)
    least : float
        Bonds below this utilisation (less about `TIE`) stay.
    size : int

    Returns
    -------
    flat indices, ascending, and their utilisations
    """
    flat = utilisation.ravel()
    # A little below what is needed: `_line` looks there.
    reach = np.nonzero(flat >= max(least * (1 - 3 * TIE), np.finfo(float).tiny))[0]
    candidates = reach[flat[reach] >= _line(flat[reach], least)]
    values = flat[candidates]
    if len(candidates) > size:
        threshold = np.partition(values, len(values) - size)[len(values) - size]
        taken = values >= _line(values, threshold)
        candidates, values = candidates[taken], values[taken]
    return candidates, values


def _line(values: Array, threshold: float) -> float:
    """Where to part bonds a little below a threshold: in the widest gap there.

    Mirror images differ by the solver's noise: a line anywhere might run between two of them.
    """
    if not np.isfinite(threshold):
        return threshold
    low, high = threshold * (1 - 2 * TIE), threshold * (1 - 0.5 * TIE)
    near = np.sort(values[(values > low) & (values < high)])
    marks = np.concatenate([[low], near, [high]])
    widest = int(np.argmax(np.diff(marks)))
    return float(0.5 * (marks[widest] + marks[widest + 1]))


def _thickness(discretisation: Discretisation, half: int) -> Array:
    """Thickness of every bond, (half, N), or one for all, (1, 1)."""
    scene = discretisation.scene
    varying = thickness.factors(scene, discretisation.lattice, discretisation.bonds)
    return thickness.of_phases(scene)[None, :1] if varying is None else varying.whole[:half]


def _require_range(critical: Array, energy: Array) -> None:
    """Refuse energies at which bonds would break at strains that are no numbers any more."""
    stiff = np.sqrt(energy.max())
    for size in (critical.min(), critical.max()):
        if wrong := outside(float(np.sqrt(size) / stiff), STRAINS):
            raise SceneError(f"the strain at which bonds break is {wrong}")


def _refuse_negative(moduli: ElasticModuli, criterion: Criterion) -> None:
    if isinstance(moduli, ChiralModuli):
        raise SceneError(
            "bonds of a chiral solid do not break yet: what of their energy k_nt s γ counts "
            "towards w_c is not known"
        )
    if moduli.normal.min() < 0:
        raise SceneError(
            "some bonds of this material have a negative axial stiffness k_n: stretching them "
            "sets energy free, so that no energy criterion says when they break. Use "
            "calibration='positive' or another m"
        )
    if criterion == "total" and isinstance(moduli, PolarModuli) and moduli.bending.min() < 0:
        raise SceneError(
            "some bonds of this material have a negative bending stiffness k_b: bending them sets "
            "energy free, so that w ≥ w_c does not say when they break. Use "
            "calibration='positive', or criterion='axial' (the energy of the stretch alone)"
        )
    if criterion == "total" and moduli.shear.min() < 0:
        raise SceneError(
            "some bonds of this material have a negative shear stiffness k_t (ν > 1/3 in plane "
            "stress, generally C66 < C12): sheared bonds store negative energy, so that "
            "w ≥ w_c does not say when they break. Use criterion='axial' (the energy of the "
            "stretch alone), or calibration='positive' where C66 ≥ C12"
        )
