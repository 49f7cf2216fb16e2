"""Angular laws: how bond moduli depend on the bond's direction ψ.

A law is a small linear space of functions of ψ; calibration picks the member whose moments are
the macroscopic tensor. In elasticity a law gives the axial modulus k_n and the shear modulus k_t
together (they share coefficients in the paper's law), in conduction one micro-conductivity k.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..errors import CalibrationError
from .tensors import ElasticTensor, GradientTensor


def _even(n: int) -> int:
    if n != int(n) or n < 2 or int(n) % 2:
        raise ValueError(f"the exponent of a cosine law must be an even integer ≥ 2, not {n}")
    return int(n)


@dataclass(frozen=True)
class TwoHarmonic:
    """The paper's law: bond moduli follow the off-axis moduli of the tensor.

    Elastic: k_n(ψ), k_t(ψ) as Ĉ1111(ψ), Ĉ1212(ψ) with six micromoduli (Eqs. 48–49).
    Conductive: k(ψ) as K̂11(ψ) with three (Eq. 142, where the second 𝒦_T11 should be 𝒦_T22).
    """

    @property
    def degree(self) -> int:
        """Highest harmonic of the law."""
        return 4

    def elastic(self, psi: Array, material: ElasticTensor) -> tuple[Array, Array]:
        """Basis values of k_n and k_t at ψ, each of shape (6, n).

        Coefficients are 𝒦1111, 𝒦2222, 𝒦1122, 𝒦1212, 𝒦1112, 𝒦2212.
        """
        c, s = np.cos(psi), np.sin(psi)
        cs, c2 = c * s, c * c - s * s
        normal = np.array([c**4, s**4, 2 * cs**2, 4 * cs**2, 4 * c**2 * cs, 4 * s**2 * cs])
        shear = np.array([cs**2, cs**2, -2 * cs**2, c2**2, -2 * cs * c2, 2 * cs * c2])
        return normal, shear

    def conductive(self, psi: Array, material: GradientTensor, extended: bool) -> Array:
        """Basis values of k at ψ, shape (3, n): 𝒦_T11, 𝒦_T22, 𝒦_T12."""
        c, s = np.cos(psi), np.sin(psi)
        return np.array([c * c, s * s, 2 * c * s])


@dataclass(frozen=True)
class UniformShear:
    """k_n with the harmonics 0, 2, 4 and k_t the same in every direction: also six parameters.

    Beyond the paper. Its k_t has one sign, that of C66 − C12, where the two-harmonic k_t may vary
    as cos 4ψ about a small or zero mean and leave the rotation block singular. For a solid with
    Cauchy's symmetry, C66 = C12, no bond resists shear and rotations drop out.
    """

    @property
    def degree(self) -> int:
        """Highest harmonic of the law."""
        return 4

    def elastic(self, psi: Array, material: ElasticTensor) -> tuple[Array, Array]:
        """Basis values of k_n and k_t at ψ, each of shape (6, n)."""
        one, zero = np.ones_like(psi), np.zeros_like(psi)
        harmonics = [np.cos(2 * psi), np.sin(2 * psi), np.cos(4 * psi), np.sin(4 * psi)]
        return np.array([one, *harmonics, zero]), np.array([zero] * 5 + [one])

    def conductive(self, psi: Array, material: GradientTensor, extended: bool) -> Array:
        """Refused: conduction has no shear."""
        raise CalibrationError("the uniform-shear law is one of elasticity; use Cosine")


@dataclass(frozen=True)
class Cosine:
    """k = k₂ + (k₁ − k₂) cosⁿ(ψ − ζ), n even (Eqs. 93 and 163; end of Sect. 3 for elasticity).

    In elasticity k_n follows cosⁿ(ψ − ζ) and k_t the fourfold cosⁿ 2(ψ − ζ): a twofold k_t would
    couple the rotation to homogeneous strain, and the two together have just the four
    parameters that an orthotropic solid needs.

    Parameters
    ----------
    n : int, optional
        Even exponent. By default the smallest for which the conductive law is non-negative,
        K1/K2 ≤ n + 1; 2 in elasticity.
    axis : float, optional
        ζ in rad; by default the material's principal axis.
    """

    n: int | None = None
    axis: float | None = None

    def __post_init__(self) -> None:
        if self.n is not None:
            object.__setattr__(self, "n", _even(self.n))

    @property
    def degree(self) -> int:
        """Highest harmonic of the law."""
        return 2 * (self.n or 512)

    def exponent(self, material: GradientTensor) -> int:
        """The exponent used for a conductor: the one given, or the smallest even n ≥ K1/K2 − 1."""
        if self.n is not None:
            return self.n
        high, low, _ = material.principal()
        return max(2, 2 * int(np.ceil((high / low - 1 - 1e-9) / 2)))

    def conductive(self, psi: Array, material: GradientTensor, extended: bool) -> Array:
        """Basis values of k at ψ: 1, cosⁿ and, if `extended`, the odd cosⁿ⁻¹ sin.

        The odd function is what a lattice needs when ζ is not one of its axes: its sums then
        have an off-diagonal moment that integrals over the circle do not.
        """
        n = self.exponent(material)
        zeta = material.principal()[2] if self.axis is None else self.axis
        c, s = np.cos(psi - zeta), np.sin(psi - zeta)
        basis = [np.ones_like(psi), c**n]
        if extended:
            basis.append(c ** (n - 1) * s)
        return np.array(basis)

    def elastic(self, psi: Array, material: ElasticTensor) -> tuple[Array, Array]:
        """Basis values of k_n and k_t at ψ, each (6, n): even and odd members of both laws.

        Raises
        ------
        CalibrationError
            If the solid is not orthotropic and no axis is given.
        """
        zeta, n = _material_axis(material, self.axis), self.n or 2
        return _independent(_powers(psi - zeta, n, 1), _powers(psi - zeta, n, 2))


@dataclass(frozen=True)
class Fourfold:
    """k_n and k_t both as k₂ + (k₁ − k₂) cosⁿ 2(ψ − ζ), n even (Eq. 101): square symmetry.

    Parameters
    ----------
    n : int
        Even exponent.
    axis : float, optional
        ζ in rad; by default the material's axis.
    """

    n: int = 2
    axis: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "n", _even(self.n))

    @property
    def degree(self) -> int:
        """Highest harmonic of the law."""
        return 2 * self.n

    def elastic(self, psi: Array, material: ElasticTensor) -> tuple[Array, Array]:
        """Basis values of k_n and k_t at ψ, each of shape (6, n).

        Raises
        ------
        CalibrationError
            If the solid is not orthotropic and no axis is given.
        """
        zeta = _material_axis(material, self.axis)
        member = _powers(psi - zeta, self.n, 2)
        return _independent(member, member)

    def conductive(self, psi: Array, material: GradientTensor, extended: bool) -> Array:
        """Refused: a fourfold micro-conductivity conducts isotropically."""
        raise CalibrationError(
            "the fourfold law conducts equally in all directions; use Cosine for conduction"
        )


AngularLaw = TwoHarmonic | UniformShear | Cosine | Fourfold


def _material_axis(material: ElasticTensor, axis: float | None) -> float:
    """ζ: the axis given, or the stiffer of the material's two, so that laws turn with the solid."""
    zeta = material.orthotropy_angle() if axis is None else axis
    if zeta is None:
        raise CalibrationError(
            "cosine laws have a material axis, and this elastic tensor has none (it is not "
            "orthotropic): use the two-harmonic law or the positive calibration"
        )
    if axis is None:
        along = material.rotated(-zeta).voigt
        # Equal within rounding: either axis will do.
        if along[0, 0] < along[1, 1] * (1 - 1e-12):
            return zeta + 0.5 * np.pi
    return zeta


def _powers(angle: Array, n: int, frequency: int) -> Array:
    """1, cosⁿ and the odd cosⁿ⁻¹ sin of frequency·angle, shape (3, n)."""
    c, s = np.cos(frequency * angle), np.sin(frequency * angle)
    return np.array([np.ones_like(angle), c**n, c ** (n - 1) * s])


def _independent(normal: Array, shear: Array) -> tuple[Array, Array]:
    """Bases with separate coefficients for k_n and k_t."""
    zero_n, zero_t = np.zeros_like(normal), np.zeros_like(shear)
    return np.vstack([normal, zero_t]), np.vstack([zero_n, shear])
