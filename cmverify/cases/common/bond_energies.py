"""Verdicts reached another way than the solver's: from bond energies and linear programming.

Refusals are checked with these: whether a plane wave really has no positive energy, and whether
non-negative bond moduli really do not exist.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.case import Array

if TYPE_CHECKING:
    from solver.material import ElasticModuli, Family


def energy_of_wave(family: Family, moduli: ElasticModuli, k: Array) -> Array:
    """Hermitian energy of (u1, u2, θ) exp(i k·x), from each bond's stretch and shear.

    Twice the energy a volume; `k` in rad per cell. Without shear bonds the last row is zero.
    """
    step = np.exp(1j * (family.offsets @ k)) - 1.0
    length = family.length
    zero = np.zeros_like(step)
    stretch = np.stack(
        [step * family.normal[:, 0] / length, step * family.normal[:, 1] / length, zero]
    )
    shear = np.stack(
        [
            step * family.tangent[:, 0] / length,
            step * family.tangent[:, 1] / length,
            -0.5 * (2.0 + step),  # mean of both ends' rotations
        ]
    )
    weight = 0.5 * family.weight * family.cell_area * length
    axial = (weight * moduli.normal * stretch) @ stretch.conj().T
    return axial + (weight * moduli.shear * shear) @ shear.conj().T


def energy_of_strain(family: Family, moduli: ElasticModuli) -> Array:
    """Quadratic form of a homogeneous strain (ε11, ε22, 2 ε12) and rotation, (4, 4)."""
    (c, s), weight = family.normal.T, 0.5 * family.weight * family.cell_area * family.length
    zero, one = np.zeros_like(c), np.ones_like(c)
    stretch = np.array([c * c, s * s, c * s, zero])
    shear = np.array([-c * s, c * s, 0.5 * (c * c - s * s), -one])
    axial = (weight * moduli.normal * stretch) @ stretch.T
    return axial + (weight * moduli.shear * shear) @ shear.T


def is_unstable(family: Family, moduli: ElasticModuli, k: Array) -> bool:
    """Whether displacements of this wave lack positive energy once rotations have adjusted.

    The longest wave, k = 0, stands for homogeneous strains. By inertia: condensing a rotation of
    stiffness h leaves a positive block exactly if the whole has as many negative eigenvalues as
    h. A rotation without stiffness counts as unstable.
    """
    whole = energy_of_wave(family, moduli, k) if np.any(k) else energy_of_strain(family, moduli)
    scale = np.abs(whole).max()
    if not np.any(moduli.shear):
        return bool(np.linalg.eigvalsh(whole[:-1, :-1])[0] <= 1e-9 * scale)
    own = whole[-1, -1].real
    if abs(own) <= 1e-8 * scale:
        return True
    eigenvalues = np.linalg.eigvalsh(whole)
    return bool((eigenvalues < 1e-12 * scale).sum() != (1 if own < 0 else 0))


def rotation_changes_sign(family: Family, moduli: ElasticModuli, count: int = 24) -> bool:
    """Whether the rotation's own stiffness is positive for some waves and not for others."""
    edge = np.pi * np.arange(-count, count + 1) / count
    own = [
        energy_of_wave(family, moduli, np.array([a, b]))[2, 2].real
        for a in edge
        for b in edge[edge >= 0]
    ]
    return min(own) <= 1e-9 * max(map(abs, own)) and max(own) > 0


def non_negative_moduli_exist(family: Family, tensor: Array) -> bool:
    """Linear program: bond moduli ≥ 0 with the sums of this stiffness (3, 3) or conductivity."""
    from scipy.optimize import linprog

    angle = family.angle
    c, s = np.cos(angle), np.sin(angle)
    weight = 0.5 * family.weight * family.cell_area
    if tensor.shape == (2, 2):
        first, second = np.triu_indices(2)
        normals = np.array([c, s])
        rows, target = weight * normals[first] * normals[second], tensor[first, second]
    else:
        first, second = np.triu_indices(3)
        stretch, shear = (
            np.array([c * c, s * s, c * s]),
            np.array([-c * s, c * s, (c * c - s * s) / 2]),
        )
        weight = weight * family.length
        rows = np.hstack(
            [weight * stretch[first] * stretch[second], weight * shear[first] * shear[second]]
        )
        decoupled = np.hstack([np.zeros_like(shear), weight * shear])
        rows = np.vstack([rows, decoupled])
        target = np.concatenate([tensor[first, second], np.zeros(3)])
    size = np.abs(target).max()
    scale = np.abs(rows).max()
    program = linprog(
        np.zeros(rows.shape[1]), A_eq=rows / scale, b_eq=target / size, bounds=(0, None)
    )
    return bool(program.status == 0)


def named_wave(message: str) -> Array | None:
    """The wave vector (rad per cell) that a refusal names."""
    found = re.search(r"k Δx = \((-?[\d.]+), (-?[\d.]+)\)", message)
    return np.array([float(found[1]), float(found[2])]) if found else None


def named_remedy(message: str) -> dict[str, Any] | None:
    """Scene settings that a refusal recommends, None if it says that there are none."""
    import solver

    found = re.search(r"Use calibration='(\w+)'(?:, law=(\w+)\(\))?(?: at m = (\d+))? ", message)
    if not found:
        return None
    settings: dict[str, Any] = {"calibration": found[1]}
    if found[2]:
        settings["law"] = getattr(solver, found[2])()
    if found[3]:
        settings["m"] = int(found[3])
    return settings
