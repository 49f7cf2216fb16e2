"""Entries of the bond blocks: what one bond adds to the rows of its ends."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..bonds import Bonds
from ..material import ConductiveModuli, Moduli


def offset_blocks(bonds: Bonds, moduli: Moduli) -> Array:
    """Entries of the bond blocks of all offsets, shape (family size, 6, 3 or 1).

    Elasticity: A11, A12, A22, t̂1, t̂2, c (rotation scaled by the spacing), the first three only
    where no bond resists shear. Conduction: w k/|ξ|².
    """
    family = bonds.family
    weight = family.weight * family.cell_area
    if isinstance(moduli, ConductiveModuli):
        return (weight * moduli.conductivity / family.length**2)[:, None]
    n, t = family.normal, family.tangent
    axial = weight * moduli.normal / family.length
    transverse = weight * moduli.shear / family.length
    block = [
        axial * n[:, a] * n[:, b] + transverse * t[:, a] * t[:, b]
        for a, b in ((0, 0), (0, 1), (1, 1))
    ]
    if not moduli.has_shear:
        return np.column_stack(block)
    cells = family.length / family.spacing
    half = 0.5 * transverse * cells
    return np.column_stack([*block, half * t[:, 0], half * t[:, 1], 0.5 * half * cells])
