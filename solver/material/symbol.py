"""The bulk symbol: a row of the bulk operator as waves see it.

For u = û exp(i k·x) a row of the bulk operator is a Hermitian matrix (from the bond energy,
φ = k·ξ, per unit volume, w = α Λ Δv):

    H_uu = Σ (w/|ξ|)(k_n n nᵀ + k_t t tᵀ)(1 − cos φ)
    H_uθ = i Σ (w/2) k_t t sin φ
    H_θθ = Σ (w/4) |ξ| k_t (1 + cos φ)

Statics and dynamics need the *condensed* symbol H_uu − H_uθ H_θθ⁻¹ H_uθᴴ to be positive at every
wave vector. Its margin is its smallest eigenvalue relative to that of the local solid, with the
nonlocal damping of short waves taken out: 1 in the long-wave limit, ≤ 0 where the solid fails.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from .family import Family
from .moduli import ConductiveModuli, ElasticModuli, Moduli, effective_tensor


def _half(family: Family) -> tuple[Array, Array, Array, Array]:
    """Offsets in cells, w, normals and tangents of half the bonds (sums are doubled)."""
    half = family.size // 2
    return (
        family.offsets[:half].astype(float),
        2 * family.weight[:half] * family.cell_area,
        family.normal[:half],
        family.tangent[:half],
    )


def symbol(family: Family, moduli: Moduli, k: Array) -> Array:
    """Hermitian symbol of one bulk row at wave vectors `k`.

    Parameters
    ----------
    family : Family
    moduli : ElasticModuli or ConductiveModuli
    k : ndarray, shape (..., 2)
        Wave vectors times the spacing, rad per cell.

    Returns
    -------
    ndarray
        Shape (..., 3, 3) complex (unknowns u1, u2, θ) in elasticity, (...,) real in conduction.
    """
    offsets, weight, normal, tangent = _half(family)
    half = len(weight)
    phase = np.asarray(k, dtype=np.float64) @ offsets.T
    lengths = family.length[:half]
    # 1 − cos φ by the half angle: no cancellation for long waves.
    lag = 2 * np.sin(0.5 * phase) ** 2
    if isinstance(moduli, ConductiveModuli):
        return lag @ (weight * moduli.conductivity[:half] / lengths**2)
    axial = weight * moduli.normal[:half] / lengths
    transverse = weight * moduli.shear[:half] / lengths
    block = np.einsum("o,oi,oj->oij", axial, normal, normal)
    block += np.einsum("o,oi,oj->oij", transverse, tangent, tangent)
    result = np.zeros((*phase.shape[:-1], 3, 3), dtype=np.complex128)
    result[..., :2, :2] = np.einsum("...o,oij->...ij", lag, block)
    coupling = np.sin(phase) @ (0.5 * (transverse * lengths)[:, None] * tangent)
    result[..., :2, 2] = 1j * coupling
    result[..., 2, :2] = -1j * coupling
    result[..., 2, 2] = (2.0 - lag) @ (0.25 * transverse * lengths**2)
    return result


def condensed_symbol(family: Family, moduli: ElasticModuli, k: Array) -> Array:
    """Symbol with rotations eliminated, shape (..., 2, 2), real symmetric.

    The coupling is purely imaginary, H_uθ = i c, so that the condensed block is
    H_uu − c cᵀ / H_θθ.
    """
    full = symbol(family, moduli, k)
    block = full[..., :2, :2].real
    if not moduli.has_shear:
        return block
    c, rotation = full[..., :2, 2].imag, full[..., 2, 2].real
    with np.errstate(divide="ignore", invalid="ignore"):
        return block - c[..., :, None] * c[..., None, :] / rotation[..., None, None]


def _smallest(block: Array) -> Array:
    """Smaller eigenvalue of symmetric 2×2 blocks; −inf where they are not finite."""
    a, b, c = block[..., 0, 0], block[..., 1, 1], block[..., 0, 1]
    with np.errstate(invalid="ignore"):
        value = 0.5 * (a + b) - np.hypot(0.5 * (a - b), c)
    return np.where(np.isfinite(value), value, -np.inf)


def margins(family: Family, moduli: Moduli, k: Array) -> Array:
    """Relative smallest eigenvalue of the condensed symbol at wave vectors `k` ≠ 0, (..., 2)."""
    k = np.asarray(k, dtype=np.float64)
    half = family.size // 2
    offsets, weight, _, _ = _half(family)
    tensor = effective_tensor(family, moduli)
    # Nonlocal Laplacian with the same weights and unit moduli: |k|² for long waves.
    wave = weight * (1.0 if isinstance(moduli, ConductiveModuli) else family.length[:half])
    lag = 2 * np.sin(0.5 * k @ offsets.T) ** 2
    laplacian = lag @ (wave * (family.spacing / family.length[:half]) ** 2) / (0.25 * wave.sum())
    direction = k / np.linalg.norm(k, axis=-1, keepdims=True)
    if isinstance(moduli, ConductiveModuli):
        local = np.einsum("...i,ij,...j->...", direction, tensor, direction)
        value = symbol(family, moduli, k)
    else:
        local = _smallest(acoustic_tensor(tensor, direction))
        value = _smallest(condensed_symbol(family, moduli, k))
    return value * family.spacing**2 / (laplacian * local)


def acoustic_tensor(voigt: Array, direction: Array) -> Array:
    """Γ_ik = C_ijkl n_j n_l for directions of shape (..., 2); result (..., 2, 2)."""
    n = np.asarray(direction)
    rows = np.zeros((*n.shape[:-1], 3, 2))
    rows[..., 0, 0], rows[..., 1, 1] = n[..., 0], n[..., 1]
    rows[..., 2, 0], rows[..., 2, 1] = n[..., 1], n[..., 0]
    return np.einsum("...ai,ab,...bj->...ij", rows, voigt, rows)


def brillouin_zone(count: int = 32) -> Array:
    """Half of the zone (the symbol of −k is the conjugate) on a grid without k = 0."""
    edge = np.pi * (np.arange(count) + 1) / count
    k1, k2 = np.meshgrid(np.concatenate([-edge[::-1], [0.0], edge]), np.r_[0.0, edge])
    k = np.column_stack([k1.ravel(), k2.ravel()])
    return k[np.linalg.norm(k, axis=1) > 0]
