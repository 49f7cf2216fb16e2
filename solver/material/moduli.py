"""Moduli of the bonds of a family, and the tensor that their sums make.

Moduli know what kind of bond they belong to: its strains, how many unknowns its ends have, and
the energy of a pair,

    ½ L Σ_a k_a ε_a² α Λ Δv_p Δv_q,      L = |ξ| in elasticity (Eq. 4), 1 in conduction (Eq. 112).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Self

import numpy as np

from ..arrays import Array, Indices
from .family import Family
from .physics import Physics
from .strains import elongations, end_rows, homogeneous_shear, homogeneous_stretch
from .tensors import (
    BendingTensor,
    ConductivityTensor,
    ElasticTensor,
    ElectricConductivityTensor,
    GradientTensor,
    Material,
)

#: Products of pairs of entries in the order 11, 22, 12, 66, 16, 26 and 11, 22, 12.
PAIRS3 = ([0, 1, 0, 2, 0, 1], [0, 1, 1, 2, 2, 2])
PAIRS2 = ([0, 1, 0], [0, 1, 1])


class Moduli(ABC):
    """Stiffnesses of the bonds of a family, and what kind of bonds they are."""

    #: The macroscopic tensor that such bonds make.
    tensor: ClassVar[type[Material | GradientTensor]]

    @property
    def physics(self) -> Physics:
        """What these bonds are about."""
        return self.tensor.physics

    @property
    @abstractmethod
    def strains(self) -> tuple[str, ...]:
        """Names of the strains that store energy, see `solver.material.strains`."""

    @property
    @abstractmethod
    def stiffness(self) -> Array:
        """k_a of every strain and bond, shape (strains, family size)."""

    @property
    @abstractmethod
    def components(self) -> int:
        """Unknowns of a particle."""

    @abstractmethod
    def homogeneous(self, normal: Array) -> Array:
        """Each strain for the unit values of a homogeneous strain (Voigt) or gradient.

        `normal` has shape (2, n), the result (strains, 3 or 2, n).
        """

    @abstractmethod
    def wave_rows(self, direction: Array) -> Array:
        """Strain (Voigt) or gradient of a wave a exp(i k·x) per i|k| a, (..., 3 or 2, a's)."""

    @abstractmethod
    def uniaxial(self, along: Array) -> Array:
        """Unit stress (σ11, σ22, σ12) or flux along unit vectors (e, 2), shape (e, 3 or 2)."""

    @property
    def each(self) -> tuple[Moduli, ...]:
        """Moduli of every solid that the body consists of; see `solver.material.mixture`."""
        return (self,)

    def of_offset(self, o: int) -> Array:
        """k_a of the bonds of one offset, shape (strains, N), or (strains, 1) if all are alike."""
        return self.stiffness[:, o, None]

    def of_bonds(self, offset: Indices, phase: Indices | None) -> Array:
        """k_a of bonds with these offsets in these phases, shape (strains, k)."""
        return self.stiffness[:, offset]

    @property
    def turns(self) -> bool:
        """Whether particles have a rotation that some bond resists."""
        return any(self.physics.turning[: self.components])

    @property
    def central(self) -> bool:
        """Whether the solid lacks unknowns that its physics knows: no bond resists them."""
        return self.components < len(self.physics.unknowns)

    @property
    def non_negative(self) -> bool:
        """Whether no bond has a negative modulus."""
        return bool(self.stiffness.min() >= 0)

    @abstractmethod
    def absolute(self) -> Moduli:
        """The same with every negative modulus turned positive."""

    def scaled(self, factor: Array) -> Self:
        """The same with a factor on all moduli of each bond, shape (family size,)."""
        given: Any = self
        moduli = {item.name: factor * getattr(self, item.name) for item in fields(given)}
        return type(self)(**moduli)

    def pair_length(self, family: Family) -> Array:
        """L of the pair's energy, shape (family size,), m or 1."""
        return pair_length(family, self.physics)

    def scales(self, spacing: float) -> Array:
        """What each unknown is multiplied by to enter the equations, shape (components,)."""
        return self.physics.scales(spacing, self.components)

    def end_rows(self, scales: Array, normal: Array, end: float, arm: Array) -> Array:
        """`solver.material.strains.end_rows` of these bonds."""
        return end_rows(self.strains, scales, normal, end, arm)


@dataclass(frozen=True, eq=False)
class ElasticModuli(Moduli):
    """k_n and k_t of every bond of the family, shapes (n,), N/m⁵ per unit thickness."""

    tensor: ClassVar[type[Material | GradientTensor]] = ElasticTensor

    normal: Array
    shear: Array

    @property
    def has_shear(self) -> bool:
        """Whether any bond resists shear; if none does, rotations have no stiffness."""
        return bool(np.any(self.shear != 0.0))

    @property
    def strains(self) -> tuple[str, ...]:
        return ("s", "γ") if self.has_shear else ("s",)

    @property
    def stiffness(self) -> Array:
        return np.stack([self.normal, self.shear][: len(self.strains)])

    @property
    def components(self) -> int:
        return 3 if self.has_shear else 2

    def homogeneous(self, normal: Array) -> Array:
        rows = homogeneous_stretch(normal), homogeneous_shear(normal)
        return np.stack(rows[: len(self.strains)])

    def wave_rows(self, direction: Array) -> Array:
        return wave_strains(direction)

    def uniaxial(self, along: Array) -> Array:
        a, b = along.T
        return np.column_stack([a * a, b * b, a * b])

    def absolute(self) -> ElasticModuli:
        return ElasticModuli(np.abs(self.normal), np.abs(self.shear))


@dataclass(frozen=True, eq=False)
class PolarModuli(ElasticModuli):
    """The same and k_b of every bond (Eq. 177), shape (n,), N/m³ per unit thickness."""

    bending: Array

    @property
    def strains(self) -> tuple[str, ...]:
        return "s", "γ", "χ"

    @property
    def stiffness(self) -> Array:
        return np.stack([self.normal, self.shear, self.bending])

    @property
    def components(self) -> int:
        return 3

    @property
    def curvature(self) -> CurvatureModuli:
        """The same bonds as far as they resist curvature."""
        return CurvatureModuli(self.bending)

    def homogeneous(self, normal: Array) -> Array:
        straight = np.zeros((1, 3, normal.shape[1]))
        both = homogeneous_stretch(normal), homogeneous_shear(normal)
        return np.concatenate([np.stack(both), straight])

    def absolute(self) -> PolarModuli:
        return PolarModuli(np.abs(self.normal), np.abs(self.shear), np.abs(self.bending))


@dataclass(frozen=True, eq=False)
class ChiralModuli(ElasticModuli):
    """The same and k_nt of every bond, shape (n,): ½ |ξ| (k_n s² + 2 k_nt s γ + k_t γ²).

    As a sum of squares (k_n − k_nt) s² + (k_t − k_nt) γ² + k_nt (s + γ)²: blocks, kernels and
    surfaces know it without a word more. Single terms may be negative where the whole is not: a
    bond stores energy in every state if k_n ≥ 0, k_t ≥ 0 and k_nt² ≤ k_n k_t.
    """

    cross: Array

    @property
    def strains(self) -> tuple[str, ...]:
        return "s", "γ", "s+γ"

    @property
    def stiffness(self) -> Array:
        return np.stack([self.normal - self.cross, self.shear - self.cross, self.cross])

    @property
    def components(self) -> int:
        return 3

    @property
    def non_negative(self) -> bool:
        least = min(self.normal.min(), self.shear.min())
        return bool(least >= 0 and (self.cross**2 <= self.normal * self.shear).all())

    def homogeneous(self, normal: Array) -> Array:
        stretch, shear = homogeneous_stretch(normal), homogeneous_shear(normal)
        return np.stack([stretch, shear, stretch + shear])

    def absolute(self) -> ChiralModuli:
        pairs = np.array([[self.normal, self.cross], [self.cross, self.shear]])
        values, vectors = np.linalg.eigh(np.moveaxis(pairs, 2, 0))
        found = np.einsum("nia,na,nja->ijn", vectors, np.abs(values), vectors)
        return ChiralModuli(found[0, 0], found[1, 1], found[0, 1])


@dataclass(frozen=True, eq=False)
class ConductiveModuli(Moduli):
    """k of every bond of the family, shape (n,), W/(m K) per m² and unit thickness."""

    tensor: ClassVar[type[Material | GradientTensor]] = ConductivityTensor

    conductivity: Array

    @property
    def strains(self) -> tuple[str, ...]:
        return ("g",)

    @property
    def stiffness(self) -> Array:
        return self.conductivity[None]

    @property
    def components(self) -> int:
        return 1

    def homogeneous(self, normal: Array) -> Array:
        return normal[None]

    def wave_rows(self, direction: Array) -> Array:
        return np.asarray(direction)[..., None]

    def uniaxial(self, along: Array) -> Array:
        return along

    def absolute(self) -> ConductiveModuli:
        return type(self)(np.abs(self.conductivity))


class ElectricModuli(ConductiveModuli):
    """The same of current: k of every bond, shape (n,), S/m per m² and unit thickness."""

    tensor: ClassVar[type[Material | GradientTensor]] = ElectricConductivityTensor


class CurvatureModuli(ConductiveModuli):
    """k_b of bonds that resist curvature, as conduction of a rotation: a pair carries |ξ|."""

    tensor: ClassVar[type[Material | GradientTensor]] = BendingTensor


def pair_length(family: Family, physics: Physics) -> Array:
    """L of the energy of a pair, shape (family size,), m or 1."""
    return family.length if physics.energy_by_length else np.ones(family.size)


def bond_weights(family: Family, material: Material | GradientTensor) -> Array:
    """½ α Λ L Δv of each bond, shape (n,)."""
    return 0.5 * family.weight * family.cell_area * pair_length(family, material.physics)


def wave_strains(direction: Array) -> Array:
    """(ε11, ε22, 2ε12) of a wave a exp(i k·x) per i|k| a, directions (..., 2): (..., 3, 2)."""
    n = np.asarray(direction)
    rows = np.zeros((*n.shape[:-1], 3, 2))
    rows[..., 0, 0], rows[..., 1, 1] = n[..., 0], n[..., 1]
    rows[..., 2, 0], rows[..., 2, 1] = n[..., 1], n[..., 0]
    return rows


def stretch_rows(psi: Array) -> tuple[Array, Array]:
    """v_s and v_γ at angles ψ, each of shape (3, n)."""
    normal = np.array([np.cos(psi), np.sin(psi)])
    return homogeneous_stretch(normal), homogeneous_shear(normal)


def elastic_moments(psi: Array) -> tuple[Array, Array]:
    """Products v vᵀ in the order 11, 22, 12, 66, 16, 26 for k_n and for k_t, each (6, n)."""
    stretch, shear = stretch_rows(psi)
    a, b = PAIRS3
    return stretch[a] * stretch[b], shear[a] * shear[b]


def conductive_moments(psi: Array) -> Array:
    """Products n nᵀ in the order 11, 22, 12, shape (3, n)."""
    n = np.array([np.cos(psi), np.sin(psi)])
    a, b = PAIRS2
    return n[a] * n[b]


def effective_tensor(family: Family, moduli: Moduli) -> Array:
    """The tensor that the lattice sums make: C with rotations condensed (3×3), or D (2×2)."""
    weight = 0.5 * family.weight * family.cell_area * moduli.pair_length(family)
    stiffness = weight * moduli.stiffness
    rows = moduli.homogeneous(family.normal.T)
    tensor = np.einsum("an,ain,ajn->ij", stiffness, rows, rows)
    if moduli.turns:
        # A uniform rotation shears every bond by −θ.
        still = np.zeros((moduli.components, family.size))
        turned = elongations(moduli.strains, family.normal.T, still, np.ones(family.size))
        resistance = float(np.einsum("an,an,an->", stiffness, turned, turned))
        coupling = np.einsum("an,ain,an->i", stiffness, rows, turned)
        if abs(resistance) > 0 and np.abs(coupling).max() > 0:
            tensor = tensor - np.outer(coupling, coupling) / resistance
    return tensor
