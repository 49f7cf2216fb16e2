"""Entries of the bond blocks: what one bond adds to the rows of its ends.

With the rows a and b of a bond's ends (`solver.material.strains`), the energy
½ L k ε² α Λ Δv_p Δv_q, ε = a·u_p + b·u_q, adds per volume of a particle w L k aᵀa to K_pp and
w L k aᵀb to K_pq, w = α Λ Δv (Eqs. 19–20).
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..material import Family, Moduli

#: Entries of a symmetric block in the kernels' order: 11, 12, 22, 1θ, 2θ, θθ.
ENTRIES = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))


def entries(components: int) -> list[tuple[int, int]]:
    """Rows and columns of the entries of a block, in the kernels' order."""
    return [(a, b) for a, b in ENTRIES if b < components]


def bond_blocks(family: Family, moduli: Moduli) -> tuple[Array, Array]:
    """K_pp and K_pq of whole bonds, each of shape (family size, components, components).

    Rotations are scaled by the spacing.
    """
    scales, arm = moduli.scales(family.spacing), 0.5 * family.length
    here, there = (moduli.end_rows(scales, family.normal.T, end, arm) for end in (-1.0, 1.0))
    weight = family.weight * family.cell_area * moduli.pair_length(family) / family.length**2
    stiffness = weight * moduli.stiffness
    # Products of rows first: a bond and its opposite then agree to the last bit.
    own, coupling = (
        np.einsum("an,abcn->nbc", stiffness, here[:, :, None] * end[:, None])
        for end in (here, there)
    )
    return own, coupling


def offset_blocks(family: Family, moduli: Moduli, coupling: bool = False) -> Array:
    """Entries of K_pp of all offsets, shape (family size, 6, 3 or 1).

    Elasticity: A11, A12, A22, t̂1, t̂2, c, the first three only where no bond resists shear;
    conduction: w k/|ξ|². With `coupling` those of K_pq = [[−A, t̂], [−t̂ᵀ, c]]: the same, but for
    bending of polar solids, which adds w k_b/|ξ| to the one c and takes it from the other.
    """
    own, between = bond_blocks(family, moduli)
    block = own
    if coupling:
        turning = np.array(moduli.physics.turning[: moduli.components])
        block = np.where(turning[:, None] | turning, between, -between)
    return np.column_stack([block[:, a, b] for a, b in entries(moduli.components)])


def each_offset_blocks(family: Family, moduli: Moduli, coupling: bool = False) -> Array:
    """`offset_blocks` of every phase, shape (phases, family size, 6, 3 or 1)."""
    return np.stack([offset_blocks(family, own, coupling) for own in moduli.each])
