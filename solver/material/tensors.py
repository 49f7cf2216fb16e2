"""Macroscopic tensors of the solid: plane elasticity and conductivity.

A tensor is validated once, here, so that nothing downstream has to doubt it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..magnitude import MODULI, outside
from .physics import ELASTICITY, ELECTRICITY, HEAT, Physics

Plane = Literal["stress", "strain"]

# Entries that differ by less than this share of the largest are taken for rounding.
_SYMMETRY_TOLERANCE = 1e-10


def _validated(values: ArrayLike, size: int, what: str) -> Array:
    """Return a symmetric positive-definite float64 copy, or say in words why there is none."""
    array = np.array(values, dtype=np.float64)
    if array.shape != (size, size):
        raise ValueError(f"{what} must be {size}×{size}, got shape {array.shape}")
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{what} has entries that are not finite:\n{array}")
    scale = np.abs(array).max()
    half = 0.5 * array
    if scale == 0.0 or np.abs(half - half.T).max() > 0.5 * _SYMMETRY_TOLERANCE * scale:
        raise ValueError(f"{what} must be symmetric and not zero:\n{array}")
    if wrong := outside(float(scale), MODULI):
        raise ValueError(f"{what} is {wrong}")
    array = 0.5 * (array + array.T)
    smallest, largest = np.linalg.eigvalsh(array)[[0, -1]]
    if smallest <= 1e-14 * largest:
        raise ValueError(
            f"{what} is not positive definite (smallest eigenvalue {smallest:.6g}, "
            f"largest {largest:.6g}): its energy would not be bounded below"
        )
    array.setflags(write=False)
    return array


@dataclass(frozen=True, eq=False)
class ElasticTensor:
    """Plane elastic stiffness in Voigt notation with engineering shear (Eqs. 40–41).

    Parameters
    ----------
    voigt : array_like, shape (3, 3)
        [[C11, C12, C16], [C12, C22, C26], [C16, C26, C66]] in Pa; σ = C (ε11, ε22, 2 ε12).

    Raises
    ------
    ValueError
        If the matrix is not 3×3, not finite, not symmetric or not positive definite.

    Examples
    --------
    >>> ElasticTensor.isotropic(E=1.0, nu=0.25).voigt[0, 0]
    np.float64(1.0666666666666667)
    """

    physics: ClassVar[Physics] = ELASTICITY

    voigt: Array

    def __init__(self, voigt: ArrayLike) -> None:
        object.__setattr__(self, "voigt", _validated(voigt, 3, "the elastic tensor"))

    @classmethod
    def of_compliance(cls, compliance: ArrayLike) -> ElasticTensor:
        """Solid of the plane compliance S, 1/Pa: (ε11, ε22, 2 ε12) = S σ.

        Raises
        ------
        ValueError
            As for a stiffness.
        """
        return cls(np.linalg.inv(_validated(compliance, 3, "the compliance")))

    @classmethod
    def isotropic(cls, E: float, nu: float, plane: Plane = "stress") -> ElasticTensor:
        """Isotropic solid of Young modulus `E` (Pa) and Poisson ratio `nu`.

        Raises
        ------
        ValueError
            If E ≤ 0, or ν lies outside (−1, 1) in plane stress or (−1, 1/2) in plane strain.
        """
        largest = 1.0 if plane == "stress" else 0.5
        if not -1.0 < nu < largest:
            raise ValueError(
                f"Poisson's ratio must lie between -1 and {largest:g} in plane {plane}, not {nu}"
            )
        shear = E / (2.0 * (1.0 + nu))
        return cls.orthotropic(E, E, shear, nu, plane=plane, E3=E, nu13=nu, nu23=nu)

    @classmethod
    def orthotropic(
        cls,
        E1: float,
        E2: float,
        G12: float,
        nu12: float,
        plane: Plane = "stress",
        E3: float | None = None,
        nu13: float | None = None,
        nu23: float | None = None,
    ) -> ElasticTensor:
        """Orthotropic solid with material axes along the reference axes.

        Parameters
        ----------
        E1, E2, G12 : float
            Young and shear moduli, Pa.
        nu12 : float
            Contraction along 2 under tension along 1, divided by the extension.
        plane : {"stress", "strain"}
            Plane strain eliminates σ33 and needs the constants of the third axis.
        E3, nu13, nu23 : float, optional
            Out-of-plane constants, for plane strain only.

        Raises
        ------
        ValueError
            If a modulus is not positive, a constant is missing, or the solid (in three
            dimensions where it is given in three) is not positive definite.
        """
        if not all(np.isfinite(v) and v > 0.0 for v in (E1, E2, G12)):
            raise ValueError(f"moduli must be positive: E1={E1}, E2={E2}, G12={G12}")
        for modulus in (E1, E2, G12):
            if wrong := outside(modulus, MODULI):
                raise ValueError(f"a modulus is {wrong}")
        compliance = np.array(
            [[1 / E1, -nu12 / E1, 0.0], [-nu12 / E1, 1 / E2, 0.0], [0.0, 0.0, 1 / G12]]
        )
        if plane == "strain":
            if E3 is None or nu13 is None or nu23 is None:
                raise ValueError("plane strain of an orthotropic solid needs E3, nu13 and nu23")
            out_of_plane = np.array([-nu13 / E1, -nu23 / E2])
            solid = np.zeros((3, 3))
            solid[:2, :2] = compliance[:2, :2]
            solid[:2, 2] = solid[2, :2] = out_of_plane
            solid[2, 2] = 1 / E3
            _validated(solid, 3, "the compliance of the normal strains in three dimensions")
            compliance[:2, :2] -= np.outer(out_of_plane, out_of_plane) * E3
        elif plane != "stress":
            raise ValueError(f"plane must be 'stress' or 'strain', not {plane!r}")
        return cls(np.linalg.inv(_validated(compliance, 3, "the compliance")))

    @property
    def compliance(self) -> Array:
        """S = C⁻¹, shape (3, 3), 1/Pa."""
        return np.asarray(np.linalg.inv(self.voigt), dtype=np.float64)

    def rotated(self, angle: float) -> ElasticTensor:
        """The same solid turned anticlockwise by `angle` (rad), in the reference basis.

        Off-axis components are Ĉ(ψ) = Q_σ(ψ) C Q_σ(ψ)ᵀ (Eq. 45) for a turned *basis*; a turned
        solid is a basis turned the other way.
        """
        q = stress_rotation(-angle)
        return ElasticTensor(q @ self.voigt @ q.T)

    def orthotropy_angle(self) -> float | None:
        """Angle (rad, in [0, π/2)) of a material axis, or None for a solid without one.

        The solid is orthotropic if the second and fourth harmonics of Ĉ1111(ψ) are both even
        about some direction.
        """
        c = self.voigt
        second = complex(c[0, 0] - c[1, 1], 2 * (c[0, 2] + c[1, 2]))
        fourth = complex(c[0, 0] + c[1, 1] - 2 * c[0, 1] - 4 * c[2, 2], 4 * (c[0, 2] - c[1, 2]))
        tiny = 1e-9 * np.abs(c).max()
        if abs(second) < tiny:
            return float(np.angle(fourth) / 4 % (np.pi / 2)) if abs(fourth) > tiny else 0.0
        zeta = float(np.angle(second) / 2)
        if abs((fourth * np.exp(-4j * zeta)).imag) > 1e3 * tiny:
            return None
        return zeta % (np.pi / 2)


def stress_rotation(psi: float) -> Array:
    """Q_σ(ψ) of Eq. 43: stress components in a basis turned anticlockwise by ψ (rad)."""
    c, s = np.cos(psi), np.sin(psi)
    return np.array(
        [[c * c, s * s, 2 * c * s], [s * s, c * c, -2 * c * s], [-c * s, c * s, c * c - s * s]]
    )


@dataclass(frozen=True, eq=False)
class GradientTensor:
    """What a gradient in the plane meets: of a temperature, a potential, or a rotation.

    Parameters
    ----------
    matrix : array_like, shape (2, 2)
        Symmetric positive definite.

    Raises
    ------
    ValueError
        If the matrix is not 2×2, not finite, not symmetric or not positive definite.
    """

    physics: ClassVar[Physics]
    name: ClassVar[str]

    matrix: Array

    def __init__(self, matrix: ArrayLike) -> None:
        object.__setattr__(self, "matrix", _validated(matrix, 2, self.name))

    @classmethod
    def isotropic(cls, k: float) -> Self:
        """The same `k` in all directions."""
        return cls(np.diag([k, k]))

    @classmethod
    def orthotropic(cls, k1: float, k2: float, angle: float = 0.0) -> Self:
        """Principal values `k1`, `k2`, the first along `angle` (rad)."""
        return cls(np.diag([k1, k2])).rotated(angle)

    @property
    def compliance(self) -> Array:
        """The inverse, shape (2, 2): of a conductivity, the resistivity."""
        return np.asarray(np.linalg.inv(self.matrix), dtype=np.float64)

    def rotated(self, angle: float) -> Self:
        """The same solid turned anticlockwise by `angle` (rad)."""
        c, s = np.cos(angle), np.sin(angle)
        q = np.array([[c, -s], [s, c]])
        return type(self)(q @ self.matrix @ q.T)

    def principal(self) -> tuple[float, float, float]:
        """Largest and smallest value and the angle (rad) of the first (Eqs. 160–162).

        The printed tan⁻¹ of Eq. 162 gives the axis of the *smaller* one when D11 < D22 and
        divides by zero when they are equal; the two-argument form has neither fault.
        """
        d = self.matrix
        angle = 0.5 * float(np.arctan2(2 * d[0, 1], d[0, 0] - d[1, 1]))
        low, high = np.linalg.eigvalsh(d)
        return float(high), float(low), angle


class ConductivityTensor(GradientTensor):
    """Plane thermal conductivity (Eqs. 136–137), q = −D ∇T; `matrix` in W/(m K)."""

    physics: ClassVar[Physics] = HEAT
    name: ClassVar[str] = "the conductivity tensor"


class BendingTensor(GradientTensor):
    """Stiffness of a polar solid against curvature (Eq. 178), m = E ∇θ; `matrix` in N.

    Couple stresses (m31, m32) are couples per area, N/m; E_3131 and E_3232 stand on the diagonal.
    """

    physics: ClassVar[Physics] = ELASTICITY
    name: ClassVar[str] = "the bending stiffness"


class ElectricConductivityTensor(ConductivityTensor):
    """Plane electrical conductivity (Sect. 4.3.2), j = −σ ∇φ; the rest is as in heat conduction.

    Parameters
    ----------
    matrix : array_like, shape (2, 2)
        Symmetric positive definite, S/m.

    Examples
    --------
    >>> ElectricConductivityTensor.of_resistivities(100.0, 500.0).matrix.diagonal()
    array([0.01 , 0.002])
    """

    physics: ClassVar[Physics] = ELECTRICITY

    @classmethod
    def of_resistivities(cls, rho1: float, rho2: float, angle: float = 0.0) -> Self:
        """Principal resistivities `rho1`, `rho2`, Ω m, the first along `angle` (rad).

        Raises
        ------
        ValueError
            If one is not positive and finite.
        """
        if not all(np.isfinite(r) and r > 0.0 for r in (rho1, rho2)):
            raise ValueError(f"resistivities must be positive and finite, not {rho1} and {rho2}")
        return cls.orthotropic(1.0 / rho1, 1.0 / rho2, angle)


@dataclass(frozen=True, eq=False)
class PolarTensor(ElasticTensor):
    """Elastic solid that resists curvature, too (Eqs. 177–178): σ as before, m = E ∇θ.

    A micropolar (Cosserat) solid: where the rotation θ of its points is not that ω of the
    displacement, it stores W = 2 μ_c (ω − θ)² more. Bonds leave no choice of μ_c = C66 − C12.

    Parameters
    ----------
    voigt : array_like, shape (3, 3), or ElasticTensor
    bending : array_like, shape (2, 2)
        E_3131 and E_3232 on the diagonal, N; see `BendingTensor`.

    Raises
    ------
    ValueError
        If C66 ≤ C12, or a tensor is not positive definite.

    Examples
    --------
    >>> solid = PolarTensor(ElasticTensor.isotropic(E=2.4, nu=0.2), [[0.04, 0], [0, 0.04]])
    >>> round(solid.cosserat_modulus, 12), round(solid.coupling_number**2, 12)
    (0.5, 0.333333333333)
    """

    bending: BendingTensor

    def __init__(
        self, voigt: ArrayLike | ElasticTensor, bending: ArrayLike | BendingTensor | None = None
    ) -> None:
        if isinstance(voigt, ChiralTensor):
            raise ValueError("a polar solid cannot be chiral yet: no bonds with both are known")
        super().__init__(voigt.voigt if isinstance(voigt, ElasticTensor) else voigt)
        if bending is None:
            raise ValueError(
                "a polar solid needs its bending stiffness: PolarTensor(elastic tensor, bending)"
            )
        if not isinstance(bending, BendingTensor):
            bending = BendingTensor(bending)
        object.__setattr__(self, "bending", bending)
        if not self.cosserat_modulus > 1e-9 * np.abs(self.voigt).max():
            raise ValueError(
                f"a polar solid of bonds needs C66 > C12 (isotropic: ν < 1/3 in plane stress, "
                f"ν < 1/4 in plane strain): its Cosserat modulus μ_c = C66 − C12 = "
                f"{self.cosserat_modulus:.6g} Pa ties rotations to the displacement, and would "
                f"not hold them"
            )

    @property
    def cosserat_modulus(self) -> float:
        """μ_c = C66 − C12, Pa; Eringen's κ is twice that."""
        return float(self.voigt[2, 2] - self.voigt[0, 1])

    @property
    def coupling_number(self) -> float:
        """N = √(μ_c/(C66 + μ_c)), below √(2/3): couple-stress elasticity would be N = 1."""
        return float(np.sqrt(self.cosserat_modulus / (self.voigt[2, 2] + self.cosserat_modulus)))

    def rotated(self, angle: float) -> PolarTensor:
        """The same solid turned anticlockwise by `angle` (rad)."""
        return PolarTensor(super().rotated(angle), self.bending.rotated(angle))


@dataclass(frozen=True, eq=False)
class ChiralTensor(ElasticTensor):
    """Elastic solid whose points turn when it is strained: θ − ω = r·(ε11, ε22, 2ε12).

    Beside the displacement's own rotation ω, as the blocks of a tetrachiral lattice do in a mere
    dilation. Stresses are those of C: with φ = θ − ω free, the energy

        W = ½ ε·(C + 4 μ_c r rᵀ) ε − 4 μ_c φ r·ε + ½ 4 μ_c φ²

    is least at φ = r·ε, where it is ½ ε·C ε. Bonds with k_n and k_t alone make no such solid: the
    coupling of φ to a dilation ε = (1, 1, 0) is Σ w k_t v_γ·ε, and no bond is sheared then. With a
    third modulus, k_nt s γ, it is Σ w k_nt. The sums over bonds (`solver.material.calibration`)
    leave no choice of the Cosserat modulus μ_c.

    Parameters
    ----------
    voigt : array_like, shape (3, 3), or ElasticTensor
        C, with rotations free.
    turn : array_like, shape (3,)
        r, rad per unit strain; it turns with the solid as a stress does.

    Raises
    ------
    ValueError
        If C is not positive definite, r is not finite, or μ_c is not positive.

    Examples
    --------
    >>> solid = ChiralTensor(ElasticTensor.isotropic(E=2.4, nu=0.2), [0.5, 0.5, 0.0])
    >>> round(solid.cosserat_modulus, 12)  # half of C66 − C12
    0.25
    """

    turn: Array

    def __init__(self, voigt: ArrayLike | ElasticTensor, turn: ArrayLike | None = None) -> None:
        super().__init__(voigt.voigt if isinstance(voigt, ElasticTensor) else voigt)
        if isinstance(voigt, PolarTensor):
            raise ValueError("a polar solid cannot be chiral yet: no bonds with both are known")
        found = np.array(turn, dtype=np.float64) if turn is not None else np.empty(0)
        if found.shape != (3,) or not np.isfinite(found).all():
            raise ValueError(
                f"a chiral solid needs the three finite turns of its points under unit strains, "
                f"not {turn!r}"
            )
        object.__setattr__(self, "turn", found)
        if not self.cosserat_modulus > 1e-9 * np.abs(self.voigt).max():
            raise ValueError(
                f"no chiral solid of bonds: its Cosserat modulus, (C66 − C12)/(1 + 4 (r1 r2 − r3²))"
                f" = {self.voigt[2, 2] - self.voigt[0, 1]:.6g} Pa/{self._share:.6g}, must be "
                f"positive to hold the rotations of its points"
            )

    @property
    def _share(self) -> float:
        r1, r2, r3 = self.turn
        return float(1.0 + 4.0 * (r1 * r2 - r3 * r3))

    @property
    def cosserat_modulus(self) -> float:
        """μ_c = (C66 − C12)/(1 + 4 (r1 r2 − r3²)), Pa: sums over bonds make it that."""
        if not self._share > 0:
            return -np.inf
        return float(self.voigt[2, 2] - self.voigt[0, 1]) / self._share

    @property
    def coupling(self) -> Array:
        """4 μ_c r, shape (3,), Pa: stress per rotation, and couple per strain."""
        return np.asarray(4.0 * self.cosserat_modulus * self.turn)

    @property
    def unturned(self) -> Array:
        """C + 4 μ_c r rᵀ, shape (3, 3), Pa: where points turn with the displacement alone."""
        return np.asarray(self.voigt + np.outer(self.coupling, self.turn))

    def rotated(self, angle: float) -> ChiralTensor:
        """The same solid turned anticlockwise by `angle` (rad)."""
        return ChiralTensor(super().rotated(angle), stress_rotation(-angle) @ self.turn)


Material = ElasticTensor | ConductivityTensor
