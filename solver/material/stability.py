"""Which bond models are stable solids, and what sign their operator has, from the bulk symbol."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from scipy.optimize import minimize

from ..arrays import Array
from .family import Family
from .moduli import Moduli
from .symbol import BulkSymbol, brillouin_zone, symbol

Kind = Literal["positive", "central", "indefinite", "inadmissible"]

# Rotation stiffness below this share of its largest possible value counts as none.
_SINGULAR = 1e-9


@dataclass(frozen=True)
class Stability:
    """What the bulk symbol says of a material on a family.

    Attributes
    ----------
    kind : {"positive", "central", "indefinite", "inadmissible"}
        Of the full operator: positive definite; positive with no shear stiffness (no rotations);
        indefinite with a positive condensed symbol; or unstable in bulk.
    margin : float
        Smallest relative eigenvalue of the condensed symbol over the Brillouin zone.
    wave_vector : tuple of float
        Where it is taken, (k1 Δx, k2 Δx).
    rotation_range : tuple of float
        Smallest and largest H_θθ over the zone, relative to Σ (w/2)|ξ||k_t|; zeros without shear.
    """

    kind: Kind
    margin: float
    wave_vector: tuple[float, float]
    rotation_range: tuple[float, float]


def assess(family: Family, moduli: Moduli, count: int = 32) -> Stability:
    """Kind and margin of a bond model in bulk.

    Parameters
    ----------
    family : Family
    moduli : Moduli
    count : int
        Grid points along a half axis of the zone; the worst one is refined by a simplex search.

    Returns
    -------
    Stability
        Kept for the next bodies of the same solid: a study has many.
    """
    return _assessed(_Solid(family, moduli), count)


class _Solid:
    """Moduli on a family, equal to others by their numbers."""

    def __init__(self, family: Family, moduli: Moduli) -> None:
        self.family, self.moduli = family, moduli
        given: Any = moduli
        numbers = (np.asarray(getattr(given, item.name)).tobytes() for item in fields(given))
        self._key = (family, type(moduli), *numbers)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Solid) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)


@lru_cache(maxsize=256)
def _assessed(solid: _Solid, count: int) -> Stability:
    family, moduli = solid.family, solid.moduli
    bulk = BulkSymbol(family, moduli)
    spectrum = np.linalg.eigvalsh(bulk.tensor)
    if not spectrum[0] > _SINGULAR * np.abs(spectrum).max():
        # Longest waves: a homogeneous strain (or gradient) would release energy.
        worst_share = float(spectrum[0] / np.abs(spectrum).max())
        return Stability("inadmissible", min(worst_share, 0.0), (0.0, 0.0), (0.0, 0.0))
    k = brillouin_zone(count)
    low = high = 0.0
    if moduli.turns:
        rotation = bulk(k)[:, -1, -1].real
        # Its largest possible value: that of bonds of the same size and one sign, k = 0.
        scale = float(symbol(family, moduli.absolute(), np.zeros(2))[-1, -1].real)
        low, high = float(rotation.min()) / scale, float(rotation.max()) / scale
        if low <= _SINGULAR and high >= -_SINGULAR:
            # H_θθ changes sign: the condensed symbol has a pole somewhere.
            pole = k[np.argmin(np.abs(rotation))]
            return Stability("inadmissible", -np.inf, (float(pole[0]), float(pole[1])), (low, high))
    values = bulk.margins(k)
    worst = k[np.argmin(values)]
    margin = float(values.min())
    if margin > _SINGULAR:

        def in_zone(q: Array) -> float:
            # The margin compares with the solid along k itself: a search that strays out of the
            # zone would compare a long wave with the solid along a reciprocal lattice vector.
            q = (q + np.pi) % (2 * np.pi) - np.pi
            return float(bulk.margins(q)) if q @ q > 1e-6 else 1e300

        found = minimize(
            in_zone,
            worst,
            method="Nelder-Mead",
            options={"initial_simplex": worst + np.pi / count * np.array([[0, 0], [1, 0], [0, 1]])},
        )
        if found.fun < margin:
            margin, worst = float(found.fun), (found.x + np.pi) % (2 * np.pi) - np.pi
    kind: Kind = "positive"
    if margin <= _SINGULAR:
        kind = "inadmissible"
    elif high < 0:
        kind = "indefinite"
    elif moduli.central:
        kind = "central"
    return Stability(kind, margin, (float(worst[0]), float(worst[1])), (low, high))
