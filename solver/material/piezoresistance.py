r"""Piezoresistance: bonds that conduct more, or less, when they are stretched (Sect. 5).

The paper says only that k_e may depend on "an elastic deformation measure" and that the fiber's
actual length "may be required". Here the measure is the bond's elastic stretch s, and what is
linear in it is said by the law:

    "conductivity"    k = k₀ (1 + a s)          "resistivity"    k = k₀ / (1 + a s)

With the ``actual`` length |ξ| (1 + S), S the total stretch (thermal expansion included), e =
−Δφ/(|ξ| (1 + S)), and the energy ½ Λ k e² of Eq. 119 is that of the undeformed length times
(1 + S)⁻². So a bond's modulus has the factor

    f = (1 + a s)^(±1) (1 + S)^(−2 or 0)  =  1 + b s + O(s²),   b = ±a − (2 or 0).

In a homogeneous strain s = n·ε·n, and what the bonds sum to (Eq. 148) becomes

    D_ij(ε) = ½ Σ α Λ Δv k₀ f n_i n_j  =  D_ij + b A_ijkl ε_kl + O(ε²),
    A_ijkl = ½ Σ α Λ Δv k₀ n_i n_j n_k n_l.

The second moments are those of the calibration, A_ijkk = D_ij; its five numbers are else left to
the lattice. For the continuum ½ ∫ Λ k₀ n n n n dA replaces the sum: an isotropic conductor σ has
A_ijkl = σ/4 (δ_ij δ_kl + δ_ik δ_jl + δ_il δ_jk), so that along a uniaxial strain ε the conductivity
changes by ¾ b ε and across it by ¼ b ε. A pair potential cannot part the two, as Cauchy's
relations bind elastic constants: A is symmetric in all its indices.

``moments="continuum"`` gives each bond direction its own b so that Σ k₀ b n n n n is the
continuum's times b, exactly, on any lattice: b_ψ = b h(ψ)·c with h = (1, cos 2ψ, sin 2ψ, cos 4ψ,
sin 4ψ), five coefficients for five moments, close to (1, 0, 0, 0, 0). The conductor without strain
stays as it was. ``moments="lattice"`` takes b itself, and errs as the lattice does (0.6 % along,
2 % across a uniaxial strain at m = 5).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from ..arrays import Array
from ..errors import CalibrationError, SceneError
from .calibration import quartic_moments, quartic_target
from .family import Family
from .laws import AngularLaw
from .moduli import ConductiveModuli, bond_weights
from .tensors import ConductivityTensor

Law = Literal["conductivity", "resistivity"]
Length = Literal["reference", "actual"]
Moments = Literal["continuum", "lattice"]

# Relative error of the fourth moments that is none.
_EXACT = 1e-10
# Directions that differ by less carry no moments of their own.
_RANK = 1e-8


@dataclass(frozen=True)
class Piezoresistance:
    """How the conductivity of a bond depends on its stretch.

    Parameters
    ----------
    gauge : float
        a of the bond, relative change of the quantity that the law names per stretch. An isotropic
        conductor's macroscopic gauge factors are ¾ and ¼ of it along and across the strain.
    law : {"conductivity", "resistivity"}
        Which of the two is linear in the stretch.
    length : {"reference", "actual"}
        Over which length the potential falls.
    moments : {"continuum", "lattice"}
        Whose fourth moments the change has.

    Raises
    ------
    SceneError
        If the gauge is not a finite number, or a word is unknown.
    """

    gauge: float
    law: Law = "conductivity"
    length: Length = "reference"
    moments: Moments = "continuum"

    def __post_init__(self) -> None:
        if not np.isfinite(self.gauge):
            raise SceneError(f"a gauge factor must be a finite number, not {self.gauge}")
        for name, known in (("law", Law), ("length", Length), ("moments", Moments)):
            if getattr(self, name) not in get_args(known):
                raise SceneError(
                    f"{name} of a piezoresistance must be one of {', '.join(get_args(known))}, "
                    f"not {getattr(self, name)!r}"
                )

    @property
    def _shorter(self) -> float:
        """What the actual length takes off b."""
        return 2.0 if self.length == "actual" else 0.0

    @property
    def slope(self) -> float:
        """b: relative change of a bond's modulus per stretch, to first order."""
        return (self.gauge if self.law == "conductivity" else -self.gauge) - self._shorter

    def gauges(
        self,
        family: Family,
        moduli: ConductiveModuli,
        material: ConductivityTensor,
        angular: AngularLaw | None = None,
    ) -> Array:
        """a of every bond of the family, shape (family size,).

        Raises
        ------
        CalibrationError
            If the family has too few directions for the continuum's moments.
        """
        if self.moments == "lattice":
            return np.full(family.size, float(self.gauge))
        psi = family.angle
        weight = bond_weights(family, material) * moduli.conductivity
        basis = np.array([np.ones_like(psi), np.cos(2 * psi), np.sin(2 * psi),
                          np.cos(4 * psi), np.sin(4 * psi)])  # fmt: skip
        system = (weight * quartic_moments(psi)) @ basis.T
        target = quartic_target(family, material, angular)
        size = np.linalg.norm(target)
        found = np.linalg.lstsq(system / size, target / size, rcond=_RANK)[0]
        if np.abs(system @ found - target).max() > _EXACT * size:
            raise CalibrationError(
                f"bonds of m = {family.m:g} run in too few directions for the continuum's fourth "
                f"moments: take a larger m, or moments='lattice'"
            )
        # Opposite bonds agree to the last bit.
        half = family.size // 2
        slope = self.slope * np.tile((found @ basis)[:half], 2) + self._shorter
        return np.asarray(slope if self.law == "conductivity" else -slope)

    def factor(self, gauge: Array | float, elastic: Array, total: Array) -> Array:
        """f of bonds, by their elastic and total stretch; shapes broadcast."""
        change = 1.0 + gauge * elastic
        found = change if self.law == "conductivity" else 1.0 / change
        return np.asarray(found / (1.0 + total) ** 2 if self.length == "actual" else found)

    def wrong(self, gauge: Array | float, elastic: Array, total: Array) -> Array:
        """Where the law has been left behind: what it names, or the length, is not positive."""
        gone = 1.0 + gauge * elastic <= 0.0
        if self.length == "actual":
            gone |= np.broadcast_to(1.0 + total <= 0.0, gone.shape)
        return np.asarray(gone)
