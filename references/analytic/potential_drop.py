"""Electric potential about an edge crack in a strip, isotropic and orthotropic.

H. H. Johnson, *Mater. Res. Stand.* 5 (1965) 442-445: a strip 0 <= x <= W carries a current along
y; an edge crack of length a lies on y = 0 and both edges are insulated.  The map
t = cosh(pi (y - i x)/(2 W)) opens the strip, and

    phi = Re arccosh[ t / cos(pi a/(2 W)) ]

vanishes on the ligament, has no normal derivative on the crack and the edges, and tends to a
uniform current.  A centre crack 2a in a plate 2W is the same by symmetry.

A conductivity diag(kx, ky) becomes isotropic in x/sqrt(kx), y/sqrt(ky): the crack ratio a/W stays,
heights over the width are multiplied by sqrt(kx/ky).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from references.analytic.voigt import Floats, checked_points


def _height_factor(kx: float, ky: float) -> float:
    if not (np.isfinite(kx) and np.isfinite(ky) and kx > 0.0 and ky > 0.0):
        raise ValueError("the conductivities kx and ky must be positive and finite")
    factor = float(np.sqrt(kx) / np.sqrt(ky))
    if not 0.0 < factor < np.inf:
        raise ValueError("the ratio of the conductivities is beyond floating point")
    return factor


# beyond this height arccosh(cosh v / cos c) = v - log cos c, to rounding: exp(-2 v) is below it
_TALL = 20.0


def _log_cosh(v: Floats) -> Floats:
    """log cosh v for v >= 0, however large."""
    return np.asarray(v + np.log1p(np.exp(-2 * v)) - np.log(2.0))


def _arccosh_ratio(height: Floats, crack: Floats) -> Floats:
    """arccosh(cosh(height) / cos(crack)), where both are small and where the height is large.

    cosh(v) - 1 = [sinh^2(height/2) + sin^2(crack/2)] 2 / cos(crack) is free of cancellation; it
    would overflow at heights above 1400, where arccosh(w) = log(2 w).
    """
    low = np.minimum(height, _TALL)
    excess = 2 * (np.sinh(low / 2) ** 2 + np.sin(crack / 2) ** 2) / np.cos(crack)
    tall = _log_cosh(height) + np.log(2.0) - np.log(np.cos(crack))
    return np.where(height > _TALL, tall, 2 * np.arcsinh(np.sqrt(excess / 2)))


def johnson(
    crack_ratio: ArrayLike, probe_ratio: ArrayLike, kx: float = 1.0, ky: float = 1.0
) -> Floats:
    """Potential drop across an edge crack over that of the uncracked strip.

    Parameters
    ----------
    crack_ratio : array_like
        a/W, in [0, 1).
    probe_ratio : array_like
        y/W: height of each probe above (and below) the crack plane over the width, positive;
        the probes stand at the cracked edge (on the centre line of a centre-cracked plate).
    kx, ky : float
        Conductivity along the crack and along the current, S/m.

    Returns
    -------
    ndarray
        V(a)/V(0), dimensionless, 1 without a crack.

    Raises
    ------
    ValueError
        If the crack does not end inside the strip, a probe is on the crack plane, or a
        conductivity is not positive.
    """
    factor = _height_factor(kx, ky)
    crack, probe = np.asarray(crack_ratio, dtype=float), np.asarray(probe_ratio, dtype=float)
    if not np.all((crack >= 0.0) & (crack < 1.0)):
        raise ValueError("the crack ratio a/W must lie in [0, 1)")
    if not np.all(np.isfinite(probe) & (probe > 0.0)):
        raise ValueError("the probe ratio y/W must be positive: both probes on one spot read zero")
    height = np.asarray(np.pi / 2 * probe * factor)
    return _arccosh_ratio(height, np.asarray(np.pi / 2 * crack)) / height


def crack_ratio_of(
    potential_ratio: ArrayLike, probe_ratio: ArrayLike, kx: float = 1.0, ky: float = 1.0
) -> Floats:
    """Crack ratio a/W of a measured V(a)/V(0): the inverse of `johnson`.

    Raises
    ------
    ValueError
        If a ratio is below one (a crack cannot lower the drop) or a probe is misplaced.
    """
    factor = _height_factor(kx, ky)
    ratio, probe = np.asarray(potential_ratio, dtype=float), np.asarray(probe_ratio, dtype=float)
    if not np.all(np.isfinite(ratio) & (ratio >= 1.0)):
        raise ValueError("a potential ratio V(a)/V(0) is at least one")
    if not np.all(np.isfinite(probe) & (probe > 0.0)):
        raise ValueError("the probe ratio y/W must be positive")
    height = np.asarray(np.pi / 2 * probe * factor)
    cosine = np.exp(_log_cosh(height) - _log_cosh(ratio * height))
    return 2 / np.pi * np.arccos(np.clip(cosine, -1.0, 1.0))


def strip_potential(
    x: ArrayLike, y: ArrayLike, crack: float, width: float, kx: float = 1.0, ky: float = 1.0
) -> Floats:
    """Potential in the cracked strip, zero on the ligament, with dphi/dy -> 1 far away.

    Parameters
    ----------
    x, y : array_like
        Points of the half strip 0 <= x <= width, y >= 0, m; below the crack plane the potential
        is the negative of that above.
    crack, width : float
        a and W, m.
    kx, ky : float
        Conductivities along x and y.

    Returns
    -------
    ndarray
        V, for a unit remote field of 1 V/m.

    Raises
    ------
    ValueError
        If a point lies outside the half strip or the crack does not end inside the strip.
    """
    factor = _height_factor(kx, ky)
    if not (np.isfinite(width) and width > 0.0 and 0.0 <= crack < width):
        raise ValueError("the crack must end inside the strip: 0 <= a < W")
    xs, ys = checked_points(x, y)
    if np.any((xs < 0.0) | (xs > width) | (ys < 0.0)):
        raise ValueError("a point lies outside the half strip 0 <= x <= W, y >= 0")
    u, v = np.pi * xs / (2 * width), np.pi * ys * factor / (2 * width)
    low, cosine = np.minimum(v, _TALL), np.cos(np.pi * crack / (2 * width))
    t = np.cosh(low) * np.cos(u) - 1j * np.sinh(low) * np.sin(u)
    # far above the crack the field is uniform again, V = v - log cos c
    potential = np.where(v > _TALL, v - np.log(cosine), np.real(np.arccosh(t / cosine)))
    return potential * 2 * width / (np.pi * factor)
