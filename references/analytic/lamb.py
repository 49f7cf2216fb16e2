"""Lamb's problem in the plane: a pulse of pressure on the edge of an elastic half-plane.

H. Lamb, Phil. Trans. R. Soc. A 203 (1904) 1; in closed form by L. Cagniard's method as in
J. D. Achenbach, *Wave Propagation in Elastic Solids*, 1973, ch. 7. With slownesses a = 1/c_P and
b = 1/c_S, a line load Q δ(t) that pushes at x = 0 moves the edge at x into the body by

    w = Q b²/(π μ |x|) Im F(t/|x| + i0),
    F(p) = √(a² − p²) / [(b² − 2p²)² + 4p² √(a² − p²) √(b² − p²)].

F has Rayleigh's pole on the real axis. A source that varies analytically needs no care about
it: F is analytic in the upper half-plane, where the convolution is taken instead.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import simpson
from scipy.optimize import brentq

from references.analytic.quadrature import gauss
from references.analytic.voigt import Floats

# Points of the quadrature along the path in complex time, and of Gauss's rule over the strip.
_PATH, _STRIP = 4001, 12


def ricker(frequency: float, delay: float) -> Callable[[Floats], Floats]:
    """(1 − 2 s) exp(−s), s = π² f² (t − delay)²: Ricker's wavelet, for complex times too."""

    def wavelet(t: Floats) -> Floats:
        s = (np.pi * frequency * (t - delay)) ** 2
        found: Floats = (1.0 - 2.0 * s) * np.exp(-s)
        return found

    return wavelet


def rayleigh_speed(c_p: float, c_s: float) -> float:
    """Speed of Rayleigh's wave: (2 − q)² = 4 √(1 − q) √(1 − q c_S²/c_P²) with q = c²/c_S²."""
    ratio = (c_s / c_p) ** 2

    def determinant(q: float) -> float:
        return float((2 - q) ** 2 - 4 * np.sqrt((1 - q) * (1 - q * ratio)))

    return float(c_s * np.sqrt(brentq(determinant, 1e-6, 1 - 1e-12)))


def impulse(p: Floats, a: float, b: float) -> Floats:
    """F(p) on the sheet of the upper half-plane; see the module."""
    slow, fast = np.sqrt(a * a - p * p + 0j), np.sqrt(b * b - p * p + 0j)
    found: Floats = slow / ((b * b - 2 * p * p) ** 2 + 4 * p * p * slow * fast)
    return found


def edge_displacement(
    x: float,
    times: ArrayLike,
    source: Callable[[Floats], Floats],
    scale: float,
    lame: tuple[float, float],
    density: float,
    half_width: float = 0.0,
) -> Floats:
    """Displacement of the edge into the body under a pressure pulse.

    Parameters
    ----------
    x : float, m
        Distance from the middle of the load, more than its half width.
    times : array_like, (k,), s
    source : callable
        The load's time function, analytic (it is asked for complex times); nothing before t = 0.
    scale : float, s
        A time over which the source varies by its own order.
    lame : (λ, μ), Pa
    density : float, kg/m³
    half_width : float, m
        Pressure of one over this far to each side; 0 for a line load of one.

    Returns
    -------
    ndarray, (k,), m for a pressure of 1 Pa (a line load of 1 N/m)

    Raises
    ------
    ValueError
        For points under the load, or moduli that are no solid's.
    """
    lam, mu = lame
    if not (mu > 0 and lam + 2 * mu > 0 and density > 0 and scale > 0):
        raise ValueError("the moduli, the density and the time scale must be positive")
    if not abs(x) > half_width >= 0:
        raise ValueError("the point must lie beside the load, not under it")
    a, b = np.sqrt(density / (lam + 2 * mu)), np.sqrt(density / mu)
    t = np.atleast_1d(np.asarray(times, dtype=float))
    if half_width > 0:
        nodes, weights = gauss(_STRIP)
        distances, weights = abs(x) - half_width * nodes, half_width * weights
    else:
        distances, weights = np.array([abs(x)]), np.ones(1)
    found = np.zeros(t.shape)
    # Up from the real axis before the first wave arrives, and along it at a height of `rise`.
    rise = 0.25 * scale
    s = np.linspace(0.0, max(float(t.max()), 0.0) + 6 * scale, _PATH)
    for distance, weight in zip(distances, weights, strict=True):
        bend = min(rise, 0.5 * a * distance)
        path = s + 1j * rise * (1.0 - np.exp(-((s / bend) ** 2)))
        slope = 1.0 + 1j * rise * 2.0 * s / bend**2 * np.exp(-((s / bend) ** 2))
        kernel = impulse(path / distance, a, b) * slope * b * b / (np.pi * mu * distance)
        values = kernel * source(t[:, None] - path)
        found += weight * simpson(values.imag, x=s, axis=1)
    return found
