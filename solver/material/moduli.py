"""Moduli of the bonds of a family, and the tensor that their sums make."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .family import Family
from .tensors import ElasticTensor, Material

PAIRS3 = ([0, 1, 0, 2, 0, 1], [0, 1, 1, 2, 2, 2])


PAIRS2 = ([0, 1, 0], [0, 1, 1])


@dataclass(frozen=True, eq=False)
class ElasticModuli:
    """k_n and k_t of every bond of the family, shapes (n,), N/m⁵ per unit thickness."""

    normal: Array
    shear: Array

    @property
    def has_shear(self) -> bool:
        """Whether any bond resists shear; if none does, rotations have no stiffness."""
        return bool(np.any(self.shear != 0.0))

    @property
    def non_negative(self) -> bool:
        """Whether no bond has a negative modulus."""
        return bool(self.normal.min() >= 0 and self.shear.min() >= 0)


@dataclass(frozen=True, eq=False)
class ConductiveModuli:
    """k of every bond of the family, shape (n,), W/(m K) per m² and unit thickness."""

    conductivity: Array

    @property
    def non_negative(self) -> bool:
        """Whether no bond has a negative modulus."""
        return bool(self.conductivity.min() >= 0)


Moduli = ElasticModuli | ConductiveModuli


def stretch_rows(psi: Array) -> tuple[Array, Array]:
    """v_s and v_γ at angles ψ, each of shape (3, n)."""
    c, s = np.cos(psi), np.sin(psi)
    return np.array([c * c, s * s, c * s]), np.array([-c * s, c * s, 0.5 * (c * c - s * s)])


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


def bond_weights(family: Family, material: Material) -> Array:
    """½ α Λ |ξ| Δv (elasticity) or ½ α Λ Δv (conduction) of each bond, shape (n,)."""
    weight = 0.5 * family.weight * family.cell_area
    return weight * family.length if isinstance(material, ElasticTensor) else weight


def effective_tensor(family: Family, moduli: Moduli) -> Array:
    """The tensor that the lattice sums make: C with rotations condensed (3×3), or D (2×2)."""
    if isinstance(moduli, ConductiveModuli):
        weight = 0.5 * family.weight * family.cell_area * moduli.conductivity
        return np.einsum("o,oi,oj->ij", weight, family.normal, family.normal)
    weight = 0.5 * family.weight * family.cell_area * family.length
    stretch, shear = stretch_rows(family.angle)
    axial, transverse = weight * moduli.normal, weight * moduli.shear
    tensor = (axial * stretch) @ stretch.T + (transverse * shear) @ shear.T
    stiffness = transverse.sum()
    coupling = shear @ transverse
    if abs(stiffness) > 0 and np.abs(coupling).max() > 0:
        tensor = tensor - np.outer(coupling, coupling) / stiffness
    return tensor
