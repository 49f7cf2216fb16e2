"""Toughness: how much energy each bond can store before it breaks (Sect. 3).

Fracture energies are measured for two directions of the cut. An angular law turns them into a
critical energy density w_c of every bond, with constants either from the integral over the
horizon (Eq. 92) or from the lattice's own sum, so that a straight cut between rows of particles
costs just what it should.

A bond of the unordered pair {p, q} holds the energy w α Λ Δv_p Δv_q with the energy density
w = ½ |ξ| (k_n s² + k_t γ²), and breaks when w reaches its w_c. All is per unit thickness.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import binom

from ..arrays import Array
from ..errors import ToughnessError
from ..material import CONSTANT, Family, Influence
from .directions import directions, levelled

ToughnessCalibration = Literal["lattice", "continuum", "even", "directions"]

#: Largest exponent that is searched for a ratio: sharper lobes than any family resolves.
LARGEST_EXPONENT = 512
_EXPONENTS = range(2, LARGEST_EXPONENT + 1, 2)
# Ratios this near to a limit are on it: w_c = 0 exactly would otherwise depend on rounding.
_TIE = 1e-12


@dataclass(frozen=True)
class Toughness:
    """Critical bond energies w_c = w_c2 + (w_c1 − w_c2) cosⁿ A(ψ − ζ) (Eqs. 93 and 101).

    Parameters
    ----------
    G1 : float
        Fracture energy, J/m², of a cut *normal* to the axis ζ: across the fibres, the paper's
        G at ζ = 0 (Fig. 13).
    G2 : float, optional
        Fracture energy of a cut normal to ζ + π/(2A): along the fibres for A = 1, at 45° for
        A = 2. Without it all bonds share one w_c (Eq. 100): the toughness is isotropic, on a
        lattice as far as the lattice is.
    n : int
        Even exponent ≥ 2. Larger ones allow larger ratios of the two energies.
    frequency : int
        A: 1 for two lobes (Eq. 93), 2 for square symmetry (Eq. 101), any other by footnote 7.
    axis : float
        ζ, rad, anticlockwise from axis 1.
    calibration : {"lattice", "continuum", "even", "directions"}
        Where the constants come from: the sum over the bonds that a straight cut through the
        lattice breaks, or the integral of Eq. 92 (its closed form, Eqs. 97–103). With the
        lattice's sum G1 and G2 are exact; for A > 2, where a square lattice tells the A
        equivalent cuts apart, in their mean. ``even``, beyond the paper, is the lattice's with
        the law multiplied by `evenness`: the same fracture energies, but cuts along the rows of
        the lattice are hardly cheaper than others, and cracks are less drawn to them.
        ``directions``, beyond the paper too: cuts along every direction of bonds cost exactly
        what the continuum's law gives there, those in between a little more (0.5 % at m = 5);
        see `solver.fracture.directions`.

    Raises
    ------
    ToughnessError
        If a fracture energy is not positive, n is not even, or A is not a positive integer.

    Notes
    -----
    The influence function scales w_c as it scales the stored energy, so that whether a bond
    breaks depends on its deformation and direction only.

    Examples
    --------
    >>> from solver import Family
    >>> bone = Toughness(2106.0, 989.0, n=8, calibration="continuum")
    >>> w1, w2 = bone.constants(Family(5, 0.2))
    >>> round(w1, 1), round(w2, 1)
    (6528.0, 852.9)
    """

    G1: float
    G2: float | None = None
    n: int = 2
    frequency: int = 1
    axis: float = 0.0
    calibration: ToughnessCalibration = "lattice"

    def __post_init__(self) -> None:
        for name, value in (("G1", self.G1), ("G2", self.across_second)):
            if not (np.isfinite(value) and value > 0):
                raise ToughnessError(f"the fracture energy {name} must be positive, not {value}")
        if self.n != int(self.n) or not 2 <= self.n <= LARGEST_EXPONENT or int(self.n) % 2:
            raise ToughnessError(
                f"the exponent of a toughness law must be even and from 2 to "
                f"{LARGEST_EXPONENT}, not {self.n}"
            )
        if self.frequency != int(self.frequency) or self.frequency < 1:
            raise ToughnessError(
                f"the frequency A of a toughness law must be a positive integer, "
                f"not {self.frequency}"
            )
        if not np.isfinite(self.axis):
            raise ToughnessError(f"the axis of a toughness law must be an angle, not {self.axis}")
        if self.calibration not in get_args(ToughnessCalibration):
            raise ToughnessError(
                f"unknown calibration {self.calibration!r} of the toughness; known: "
                f"{', '.join(get_args(ToughnessCalibration))}"
            )

    @property
    def across_second(self) -> float:
        """Fracture energy of a cut normal to ζ + π/(2A), J/m²: G2, or G1 without one."""
        return self.G1 if self.G2 is None else self.G2

    @property
    def isotropic(self) -> bool:
        """Whether one fracture energy is given, and all bonds share one w_c."""
        return self.G2 is None

    def energies(self, family: Family) -> Array:
        """Critical energy density of the bond of each offset, shape (family size,), J/m⁶.

        A bond breaks when ½ |ξ| (k_n s² + k_t γ²), with the micromoduli before Λ, reaches it.
        What it then releases is w_c α Λ Δv_p Δv_q, and the bonds cut by a straight line sum up
        to the fracture energy times the length of the cut.

        Raises
        ------
        ToughnessError
            If no non-negative w_c of this law have the ratio of the fracture energies.
        """
        w1, w2 = self.constants(family)
        if self.calibration == "directions":
            return levelled(family, self.fracture_energy)
        law = w2 + (w1 - w2) * self._lobes(family.angle, self.n)
        return law * evenness(family) if self.calibration == "even" else law

    def constants(self, family: Family) -> tuple[float, float]:
        """w_c1 and w_c2, of bonds along ζ and along ζ + π/(2A).

        Raises
        ------
        ToughnessError
            As `energies`; the message names the ratios that n allows and the n that would do.
        """
        matrix = self._matrix(family, self.n)
        self._check_ratio(family)
        if self.isotropic:
            w = self.G1 / float(matrix[0].sum())
            return w, w
        w1, w2 = np.linalg.solve(matrix, [self.G1, self.across_second])
        return max(float(w1), 0.0), max(float(w2), 0.0)

    def ratios(self, family: Family, n: int | None = None) -> tuple[float, float]:
        """Smallest and largest G1/G2 that the law allows with w_c ≥ 0 (n: another exponent).

        In the continuum the largest is 2, 8/3, 128/35 and 7.145 for n = 2, 4, 8, 32 and A = 1.
        """
        along, between = self._matrix(family, self.n if n is None else n).T
        ends = sorted((along[0] / along[1], between[0] / between[1]))
        return float(ends[0]), float(ends[1])

    def smallest_exponent(self, family: Family) -> int | None:
        """The smallest even n that allows G1/G2; None if none up to 512 does."""
        ratios = (self.ratios(family, n) for n in _EXPONENTS)
        return next((n for n, r in zip(_EXPONENTS, ratios, strict=True) if self._allows(r)), None)

    def fracture_energy(self, direction: ArrayLike, family: Family | None = None) -> Array:
        """What a straight cut costs per unit area, J/m²: the effective G of Figs. 16–18.

        Parameters
        ----------
        direction : array_like
            Direction in which the cut runs, rad from axis 1.
        family : Family, optional
            Sum over the bonds of this lattice that the cut breaks, whatever the calibration of
            w_c: exact for any rational slope, where no particle lies on the cut. Without it, the
            integral of Eq. 92 with its own constants.

        Returns
        -------
        ndarray, shape of `direction`
        """
        normal = np.asarray(direction, dtype=np.float64) + np.pi / 2
        if family is not None:
            return _cut_sum(family, self.energies(family), normal)
        disc = Family(1.0)  # any: the horizon cancels
        w1, w2 = replace(self, calibration="continuum").constants(disc)
        radial = disc.horizon**3 * disc.influence.moment(2)
        return radial * (
            2 * w2 + (w1 - w2) * _half_circle(self.n, self.frequency, normal - self.axis)
        )

    def _lobes(self, psi: Array, n: int) -> Array:
        return np.cos(self.frequency * (psi - self.axis)) ** n

    def _matrix(self, family: Family, n: int) -> Array:
        """Rows: cuts normal to ζ and to ζ + π/(2A). Columns: their G per w_c1 and per w_c2."""
        step = np.pi / self.frequency
        first = self.axis + step * np.arange(self.frequency)
        normals = np.stack([first, first + 0.5 * step])
        if self.calibration in ("continuum", "directions"):
            radial = family.horizon**3 * _second_moment(family.influence)
            lobes = radial * _half_circle(n, self.frequency, normals - self.axis)
            total = np.full_like(lobes, 2 * radial)
        else:
            share = evenness(family) if self.calibration == "even" else np.ones(family.size)
            lobes = _cut_sum(family, share * self._lobes(family.angle, n), normals)
            total = _cut_sum(family, share, normals)
        along, both = lobes.mean(axis=1), total.mean(axis=1)
        return np.column_stack([along, both - along])

    def _allows(self, ratios: tuple[float, float]) -> bool:
        ratio = self.G1 / self.across_second
        return ratios[0] * (1 - _TIE) <= ratio <= ratios[1] * (1 + _TIE)

    def _check_ratio(self, family: Family) -> None:
        low, high = self.ratios(family)
        if self.isotropic or self._allows((low, high)):
            return
        best = self.smallest_exponent(family)
        if best is not None:
            remedy = f"the smallest exponent that does is n = {best}"
        else:
            limits = np.array([self.ratios(family, n) for n in _EXPONENTS])
            remedy = (
                f"no exponent up to {LARGEST_EXPONENT} does, ratios of this law stay within "
                f"{limits[:, 0].min():.4g} and {limits[:, 1].max():.4g}"
            )
            quarter = np.pi / (2 * self.frequency)
            turned = replace(
                self, G1=self.across_second, G2=self.G1, axis=self.axis + quarter
            ).smallest_exponent(family)
            if turned is not None:
                remedy += (
                    f"; with the energies exchanged and the axis turned by "
                    f"{np.degrees(quarter):g}° n = {turned} does"
                )
        raise ToughnessError(
            f"bonds would release energy in breaking (w_c < 0): with n = {self.n} and A = "
            f"{self.frequency} the ratio G1/G2 of fracture energies can be from {low:.4g} to at "
            f"most {high:.4g}, not {self.G1 / self.across_second:.4g}; {remedy}"
        )


def evenness(family: Family) -> Array:
    """Factors on w_c that give every direction of bonds its due share of the toughness.

    A square lattice has many bonds along its rows and none close to them, so that a cut between
    two rows, which these bonds do not cross, is cheaper than at a small angle to it. Here all
    bonds of one direction together get the weight of the angle between its neighbours.

    Returns
    -------
    ndarray, shape (family size,)
        With a mean, weighted as in the sum over a cut, of one.
    """
    half = family.size // 2
    angle, member = directions(family)
    gap = np.diff(angle, append=angle[0] + np.pi)
    sector = 0.5 * (gap + np.roll(gap, 1))
    mass = np.bincount(member, family.weight[:half] * family.length[:half])
    share = (sector / np.pi) * mass.sum() / mass
    return np.tile(share[member], 2)


def _second_moment(influence: Influence) -> float:
    return 1 / 3 if influence is CONSTANT else influence.moment(2)


def _half_circle(n: int, frequency: int, phase: ArrayLike) -> Array:
    """∫ cosⁿ[A(ψ + phase)] cos ψ dψ over the half circle, from the finite Fourier series of cosⁿ.

    With it Eq. 92 is h ∫ |ξ|² Λ d|ξ| times this: h δ³/3 for Λ = 1.
    """
    k = np.arange(n // 2 + 1)
    q = frequency * (n - 2 * k)
    share = binom(n, k) / 2.0**n * np.where(q == 0, 1.0, 2.0)
    sign = np.where(q // 2 % 2, -1.0, 1.0)
    return np.cos(np.multiply.outer(phase, q)) @ (share * sign * 2.0 / (1.0 - q.astype(float) ** 2))


def _cut_sum(family: Family, critical: Array, normal: ArrayLike) -> Array:
    """Energy per unit length of a straight cut with this normal (rad), per unit thickness.

    A line without particles on it meets |ξ·ν|/Δx² bonds of the offset ξ per unit length: the
    particles lie on rows along the line, and each bond steps over the rows between its ends.
    """
    half = family.size // 2
    angle = np.asarray(normal, dtype=np.float64)
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    met = (
        np.abs(direction @ (family.length[:half, None] * family.normal[:half]).T) / family.cell_area
    )
    return met @ (critical[:half] * family.weight[:half] * family.cell_area**2)
