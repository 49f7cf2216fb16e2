"""The bulk symbol: which bond models are stable solids, and what sign their operator has.

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

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from ..errors import CalibrationError, InadmissibleMaterialError
from .calibration import (
    Calibration,
    ConductiveModuli,
    ElasticModuli,
    Moduli,
    calibrate,
    effective_tensor,
)
from .family import Family
from .laws import AngularLaw, TwoHarmonic, UniformShear
from .tensors import ConductivityTensor, ElasticTensor, Material

Array = NDArray[np.float64]
Sign = Literal["positive", "central", "indefinite", "inadmissible"]

# Rotation stiffness below this share of its largest possible value counts as none.
_SINGULAR = 1e-9
# Horizons tried, and grid of the zone, when looking for what would be stable instead.
_REMEDY_HORIZONS = range(2, 9)
_REMEDY_GRID = 16
# In order of preference: non-negative bonds keep damaged bodies stable too.
_ELASTIC_REMEDIES: tuple[tuple[Calibration, AngularLaw | None], ...] = (
    ("positive", None),
    ("positive", UniformShear()),
    ("lattice", None),
    ("lattice", UniformShear()),
    ("lattice", TwoHarmonic()),
)
_CONDUCTIVE_REMEDIES: tuple[tuple[Calibration, AngularLaw | None], ...] = (
    ("positive", None),
    ("lattice", None),
)


@dataclass(frozen=True)
class Stability:
    """What the bulk symbol says of a material on a family.

    Attributes
    ----------
    sign : {"positive", "central", "indefinite", "inadmissible"}
        Of the full operator: positive definite; positive with no shear stiffness (no rotations);
        indefinite with a positive condensed symbol; or unstable in bulk.
    margin : float
        Smallest relative eigenvalue of the condensed symbol over the Brillouin zone.
    wave_vector : tuple of float
        Where it is taken, (k1 Δx, k2 Δx).
    rotation_range : tuple of float
        Smallest and largest H_θθ over the zone, relative to Σ (w/2)|ξ||k_t|; zeros without shear.
    """

    sign: Sign
    margin: float
    wave_vector: tuple[float, float]
    rotation_range: tuple[float, float]


def _half(family: Family) -> tuple[Array, Array, Array, Array]:
    """Offsets in cells, w, normals and tangents of half the bonds (sums are doubled)."""
    half = family.size // 2
    return (
        family.offsets[:half].astype(float),
        2 * family.weight[:half] * family.cell,
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


def assess(family: Family, moduli: Moduli, count: int = 32) -> Stability:
    """Sign and margin of a bond model in bulk.

    Parameters
    ----------
    family : Family
    moduli : ElasticModuli or ConductiveModuli
    count : int
        Grid points along a half axis of the zone; the worst one is refined by a simplex search.

    Returns
    -------
    Stability
    """
    spectrum = np.linalg.eigvalsh(effective_tensor(family, moduli))
    if not spectrum[0] > _SINGULAR * np.abs(spectrum).max():
        # Longest waves: a homogeneous strain (or gradient) would release energy.
        worst_share = float(spectrum[0] / np.abs(spectrum).max())
        return Stability("inadmissible", min(worst_share, 0.0), (0.0, 0.0), (0.0, 0.0))
    k = brillouin_zone(count)
    low = high = 0.0
    if isinstance(moduli, ElasticModuli) and moduli.has_shear:
        rotation = symbol(family, moduli, k)[:, 2, 2].real
        scale = 0.5 * float(
            (family.weight * family.cell * family.length * np.abs(moduli.shear)).sum()
        )
        low, high = float(rotation.min()) / scale, float(rotation.max()) / scale
        if low <= _SINGULAR and high >= -_SINGULAR:
            # H_θθ changes sign: the condensed symbol has a pole somewhere.
            pole = k[np.argmin(np.abs(rotation))]
            return Stability("inadmissible", -np.inf, (float(pole[0]), float(pole[1])), (low, high))
    values = margins(family, moduli, k)
    worst = k[np.argmin(values)]
    margin = float(values.min())
    if margin > _SINGULAR:

        def in_zone(q: Array) -> float:
            # The margin compares with the solid along k itself: a search that strays out of the
            # zone would compare a long wave with the solid along a reciprocal lattice vector.
            q = (q + np.pi) % (2 * np.pi) - np.pi
            return float(margins(family, moduli, q)) if q @ q > 1e-6 else 1e300

        found = minimize(
            in_zone,
            worst,
            method="Nelder-Mead",
            options={"initial_simplex": worst + np.pi / count * np.array([[0, 0], [1, 0], [0, 1]])},
        )
        if found.fun < margin:
            margin, worst = float(found.fun), (found.x + np.pi) % (2 * np.pi) - np.pi
    sign: Sign = "positive"
    if margin <= _SINGULAR:
        sign = "inadmissible"
    elif high < 0:
        sign = "indefinite"
    elif isinstance(moduli, ElasticModuli) and not moduli.has_shear:
        sign = "central"
    return Stability(sign, margin, (float(worst[0]), float(worst[1])), (low, high))


def remedy(family: Family, material: Material) -> str:
    """What to use where a calibration is refused: a sentence for its error message.

    Every calibration and law is tried at the family's own m first, then at larger and at smaller
    ones. What is named has been found stable; that nothing is named means that all of it is
    unstable or does not exist.

    Parameters
    ----------
    family : Family
    material : ElasticTensor or ConductivityTensor
    """
    remedies, cause = _CONDUCTIVE_REMEDIES, ""
    if isinstance(material, ElasticTensor):
        remedies = _ELASTIC_REMEDIES
        if material.voigt[2, 2] < material.voigt[0, 1]:
            remedies = tuple(r for r in remedies if r[0] == "lattice")
            cause = (
                ": C66 < C12 asks for shear bonds that are negative on the mean, and here they "
                "outweigh the axial ones"
            )
    # Larger families first: what fails for want of directions or of area finds more there.
    larger = [m for m in _REMEDY_HORIZONS if m > family.m]
    smaller = [m for m in _REMEDY_HORIZONS if m < family.m]
    for m in (family.m, *larger, *reversed(smaller)):
        other = Family(m, family.spacing * family.m / m, family.area_rule, family.influence)
        for calibration, law in remedies:
            found = _trial(other, material, calibration, law)
            if found is None or found.sign == "inadmissible":
                continue
            named = "" if law is None else f", law={type(law).__name__}()"
            where = "" if m == family.m else f" at m = {m}"
            choice = f"calibration={calibration!r}{named}{where}"
            return f"Use {choice} (stable, margin {found.margin:.2g})."
    return (
        f"No calibration or law of this package is stable for it at any "
        f"m ≤ {_REMEDY_HORIZONS[-1]}{cause}. Use finite elements for this solid."
    )


def _trial(
    family: Family, material: Material, calibration: Calibration, law: AngularLaw | None
) -> Stability | None:
    """Stability of a calibration, None where it has no moduli."""
    try:
        moduli = calibrate(family, material, calibration, law, explain=False)
    except CalibrationError:
        return None
    coarse = assess(family, moduli, _REMEDY_GRID)
    return coarse if coarse.sign == "inadmissible" else assess(family, moduli)


def require_admissible(family: Family, moduli: Moduli) -> Stability:
    """`assess`, and refuse what is unstable in bulk.

    Raises
    ------
    InadmissibleMaterialError
        With the wave vector at which the condensed symbol is not positive, and with a
        calibration, law or m that is stable for the same tensor if there is one.
    """
    found = assess(family, moduli)
    if found.sign == "inadmissible":
        k1, k2 = found.wave_vector
        low, high = found.rotation_range
        if found.wave_vector == (0.0, 0.0):
            why = "a homogeneous strain releases energy (the sums over bonds are not positive)"
        elif low * high < 0:
            why = "the rotation stiffness of the bonds passes through zero"
        elif found.margin == -np.inf:
            why = "a pattern of rotations strains no shear bond (the rotation stiffness is zero)"
        else:
            why = f"the condensed symbol is not positive (relative value {found.margin:.3g})"
        raise InadmissibleMaterialError(
            f"this material is unstable in bulk at m = {family.m:g}: {why} at the wave vector "
            f"k Δx = ({k1:.4f}, {k2:.4f}). {_instead(family, moduli)}"
        )
    return found


def _instead(family: Family, moduli: Moduli) -> str:
    """`remedy` for the tensor that these moduli make."""
    tensor = effective_tensor(family, moduli)
    try:
        elastic = isinstance(moduli, ElasticModuli)
        material = ElasticTensor(tensor) if elastic else ConductivityTensor(tensor)
    except ValueError:
        return "The lattice sums make no positive-definite tensor: use calibration='lattice'."
    return remedy(family, material)
