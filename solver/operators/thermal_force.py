"""What temperatures do to bonds, and what straining bonds does to their temperature: G and Gᵀ.

A bond that would stretch by a_n T̄ and shear by a_t T̄ by itself (a_n = n·A·n, a_t = n·A·t, T̄ the
mean of its ends) exerts on its ends the forces G T of `solver.operators.eigenstrain`. The entropy
that it takes up is the same energy's derivative by the temperature: straining it draws

    T₀ ½ |ξ| α Λ Δv (k_n a_n ṡ + k_t a_t γ̇)

of heat from each of its ends: T₀ Gᵀ u̇ per volume, the adjoint and nothing else. In a homogeneous
strain that is T₀ β:ε̇ with β = C A, exactly, for any anisotropy.

Whole bonds only: bodies whose bonds end at their surface would need the temperatures of its nodes.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from ..bonds import Bonds
from ..errors import SceneError
from ..material import ExpansionTensor, Moduli


def thermal_force(bonds: Bonds, moduli: Moduli, expansion: ExpansionTensor) -> sparse.csr_array:
    """G: temperatures of the particles → their forces, per volume.

    Parameters
    ----------
    bonds : Bonds
    moduli : Moduli
        Of an elastic solid.
    expansion : ExpansionTensor
        In plane strain the plane's effective one.

    Returns
    -------
    sparse, shape (components·N, N), N/(m³ K)
        Rotations scaled by the spacing, as in the operator.

    Raises
    ------
    SceneError
        If bonds end at the surface.
    """
    if bonds.ended is not None:
        raise SceneError(
            "deformational heating is known to whole bonds only: use surface='volume' or 'none'"
        )
    lattice, family = bonds.lattice, bonds.family
    scales, arm = moduli.scales(family.spacing), 0.5 * family.length
    rows = moduli.end_rows(scales, family.normal.T, -1.0, arm) / family.length
    weight = family.weight * family.cell_area * moduli.pair_length(family) * moduli.stiffness
    free = np.einsum("avo,v->ao", moduli.homogeneous(family.normal.T), expansion.voigt)
    force = np.einsum("ao,aco,ao->co", weight, rows, free)
    number, (row, column) = lattice.number(), lattice.rows_columns
    values, starts, ends = [], [], []
    for o, (dx, dy) in enumerate(family.offsets):
        strength = bonds.strength(o)
        here = np.nonzero(strength)[0]
        there = number[row[here] + dy, column[here] + dx]
        for c in range(moduli.components):
            half = 0.5 * strength[here] * force[c, o]
            values += [half, half]
            starts += [c * lattice.count + here] * 2
            ends += [here, there]
    entries = np.concatenate(values), (np.concatenate(starts), np.concatenate(ends))
    shape = moduli.components * lattice.count, lattice.count
    return sparse.csr_array(sparse.coo_array(entries, shape=shape))
