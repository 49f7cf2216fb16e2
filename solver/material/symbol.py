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
from .moduli import Moduli, effective_tensor, wave_strains


def _half(family: Family) -> tuple[Array, Array]:
    """Offsets in cells and α Λ Δv of half the bonds, twice: sums over them count both halves."""
    half = family.size // 2
    return family.offsets[:half].astype(float), 2 * family.weight[:half] * family.cell_area


def symbol(family: Family, moduli: Moduli, k: Array) -> Array:
    """Hermitian symbol of one bulk row at wave vectors `k`.

    With the phases ∓φ/2 at the two ends of a bond the share of every unknown in a strain is
    (b e^{iφ/2} + a e^{−iφ/2}), a and b the rows of its ends: no cancellation for long waves.

    Parameters
    ----------
    family : Family
    moduli : Moduli
    k : ndarray, shape (..., 2)
        Wave vectors times the spacing, rad per cell.

    Returns
    -------
    ndarray, shape (..., components, components), complex
        Unknowns u1, u2, θ (rad), or T.
    """
    offsets, weight = _half(family)
    half = len(weight)
    length = family.length[:half]
    normal, arm = family.normal[:half].T, 0.5 * length
    phase = 0.5 * np.asarray(k, dtype=np.float64) @ offsets.T
    plain = np.ones(moduli.components)
    first, last = (moduli.end_rows(plain, normal, end, arm) for end in (-1.0, 1.0))
    even, odd = 0.5 * (first + last), 0.5 * (last - first)
    rows = 2 * (
        np.cos(phase)[..., None, None, :] * even + 1j * np.sin(phase)[..., None, None, :] * odd
    )
    stiffness = weight * moduli.pair_length(family)[:half] * moduli.stiffness[:, :half] / length**2
    # Energy ½ per pair, and a pair has two ends.
    return 0.5 * np.einsum("an,...abn,...acn->...bc", stiffness, rows.conj(), rows, optimize=True)


def condensed_symbol(family: Family, moduli: Moduli, k: Array) -> Array:
    """Symbol with rotations eliminated, real symmetric, shape (..., 2, 2), or (..., 1, 1).

    The coupling is purely imaginary, H_uθ = i c, so that the condensed block is
    H_uu − c cᵀ / H_θθ.
    """
    full = symbol(family, moduli, k)
    if not moduli.turns:
        return full.real
    block = full[..., :-1, :-1].real
    c, rotation = full[..., :-1, -1].imag, full[..., -1, -1].real
    with np.errstate(divide="ignore", invalid="ignore"):
        return block - c[..., :, None] * c[..., None, :] / rotation[..., None, None]


def _smallest(block: Array) -> Array:
    """Smallest eigenvalue of symmetric 1×1 or 2×2 blocks; −inf where they are not finite."""
    a, b, c = block[..., 0, 0], block[..., -1, -1], block[..., 0, -1]
    if block.shape[-1] == 1:
        c = np.zeros_like(c)
    with np.errstate(invalid="ignore"):
        value = 0.5 * (a + b) - np.hypot(0.5 * (a - b), c)
    return np.where(np.isfinite(value), value, -np.inf)


def margins(family: Family, moduli: Moduli, k: Array) -> Array:
    """Relative smallest eigenvalue of the condensed symbol at wave vectors `k` ≠ 0, (..., 2)."""
    k = np.asarray(k, dtype=np.float64)
    half = family.size // 2
    offsets, weight = _half(family)
    # Nonlocal Laplacian with the same weights and unit moduli: |k|² for long waves.
    wave = weight * moduli.pair_length(family)[:half]
    lag = 2 * np.sin(0.5 * k @ offsets.T) ** 2
    laplacian = lag @ (wave * (family.spacing / family.length[:half]) ** 2) / (0.25 * wave.sum())
    direction = k / np.linalg.norm(k, axis=-1, keepdims=True)
    rows = moduli.wave_rows(direction)
    tensor = effective_tensor(family, moduli)
    local = _smallest(np.einsum("...ai,ab,...bj->...ij", rows, tensor, rows))
    value = _smallest(condensed_symbol(family, moduli, k))
    return value * family.spacing**2 / (laplacian * local)


def acoustic_tensor(voigt: Array, direction: Array) -> Array:
    """Γ_ik = C_ijkl n_j n_l for directions of shape (..., 2); result (..., 2, 2)."""
    rows = wave_strains(direction)
    return np.einsum("...ai,ab,...bj->...ij", rows, voigt, rows)


def brillouin_zone(count: int = 32) -> Array:
    """Half of the zone (the symbol of −k is the conjugate) on a grid without k = 0."""
    edge = np.pi * (np.arange(count) + 1) / count
    k1, k2 = np.meshgrid(np.concatenate([-edge[::-1], [0.0], edge]), np.r_[0.0, edge])
    k = np.column_stack([k1.ravel(), k2.ravel()])
    return k[np.linalg.norm(k, axis=1) > 0]
