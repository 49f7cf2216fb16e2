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


class BulkSymbol:
    """Symbol of a bond model: what does not depend on the wave is found once.

    With the phases ∓φ/2 at the two ends of a bond the share of every unknown in a strain is
    b e^{iφ/2} + a e^{−iφ/2} = (b + a) cos φ/2 + i (b − a) sin φ/2, a and b the rows of its ends:
    no cancellation for long waves.

    Parameters
    ----------
    family : Family
    moduli : Moduli
    """

    def __init__(self, family: Family, moduli: Moduli) -> None:
        self.family, self.moduli = family, moduli
        half, c = family.size // 2, moduli.components
        length = family.length[:half]
        self._offsets = family.offsets[:half].astype(float)
        # Sums run over half the bonds, each counted twice.
        weight = 2 * (family.weight * family.cell_area * moduli.pair_length(family))[:half]
        normal, arm = family.normal[:half].T, 0.5 * length
        first, last = (moduli.end_rows(np.ones(c), normal, end, arm) for end in (-1.0, 1.0))
        even, odd = first + last, last - first
        # Energy ½ per pair, and a pair has two ends.
        stiffness = 0.5 * weight * moduli.stiffness[:, :half] / length**2

        def products(one: Array, other: Array) -> Array:
            return np.einsum("an,abn,acn->nbc", stiffness, one, other).reshape(half, c * c)

        self._even, self._odd = products(even, even), products(odd, odd)
        self._mixed = products(even, odd) - products(odd, even)
        #: The tensor of long waves.
        self.tensor = effective_tensor(family, moduli)
        # Nonlocal Laplacian with the same weights and unit moduli: |k|² for long waves.
        self._laplacian = weight * (family.spacing / length) ** 2 / (0.25 * weight.sum())

    def __call__(self, k: Array) -> Array:
        """As `symbol`."""
        c = self.moduli.components
        phase = 0.5 * np.asarray(k, dtype=np.float64) @ self._offsets.T
        sine, cosine = np.sin(phase), np.cos(phase)
        real = sine**2 @ self._odd + cosine**2 @ self._even
        imaginary = (sine * cosine) @ self._mixed
        return (real + 1j * imaginary).reshape(*phase.shape[:-1], c, c)

    def condensed(self, k: Array) -> Array:
        """As `condensed_symbol`."""
        full = self(k)
        if not self.moduli.turns:
            return full.real
        block = full[..., :-1, :-1].real
        c, rotation = full[..., :-1, -1].imag, full[..., -1, -1].real
        with np.errstate(divide="ignore", invalid="ignore"):
            return block - c[..., :, None] * c[..., None, :] / rotation[..., None, None]

    def margins(self, k: Array) -> Array:
        """Relative smallest eigenvalue of the condensed symbol at wave vectors `k` ≠ 0, (..., 2).

        Relative to the local solid's and to the nonlocal Laplacian.
        """
        k = np.asarray(k, dtype=np.float64)
        laplacian = 2 * np.sin(0.5 * k @ self._offsets.T) ** 2 @ self._laplacian
        rows = self.moduli.wave_rows(k / np.linalg.norm(k, axis=-1, keepdims=True))
        local = _smallest(rows.swapaxes(-1, -2) @ self.tensor @ rows)
        return _smallest(self.condensed(k)) * self.family.spacing**2 / (laplacian * local)


def symbol(family: Family, moduli: Moduli, k: Array) -> Array:
    """Hermitian symbol of one bulk row at wave vectors `k`.

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
    return BulkSymbol(family, moduli)(k)


def condensed_symbol(family: Family, moduli: Moduli, k: Array) -> Array:
    """Symbol with rotations eliminated, real symmetric, shape (..., 2, 2), or (..., 1, 1).

    The coupling is purely imaginary, H_uθ = i c, so that the condensed block is
    H_uu − c cᵀ / H_θθ.
    """
    return BulkSymbol(family, moduli).condensed(k)


def margins(family: Family, moduli: Moduli, k: Array) -> Array:
    """`BulkSymbol.margins` of a bond model, shape (...,)."""
    return BulkSymbol(family, moduli).margins(k)


def _smallest(block: Array) -> Array:
    """Smallest eigenvalue of symmetric 1×1 or 2×2 blocks; −inf where they are not finite."""
    if block.shape[-1] == 1:
        value = block[..., 0, 0]
    else:
        a, b, c = block[..., 0, 0], block[..., 1, 1], block[..., 0, 1]
        with np.errstate(invalid="ignore"):
            value = 0.5 * (a + b) - np.hypot(0.5 * (a - b), c)
    return np.where(np.isfinite(value), value, -np.inf)


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
