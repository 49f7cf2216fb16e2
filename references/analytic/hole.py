"""Elliptical and circular hole in an infinite anisotropic plate under remote stress.

S. G. Lekhnitskii, *Anisotropic Plates* (1968), ch. 6: outside an ellipse with semi-axes a (along
axis 1) and b (along axis 2) each z_k = x + mu_k y maps onto the outside of a unit circle,

    z_k = (a - i mu_k b)/2 zeta_k + (a + i mu_k b)/2 / zeta_k,

all zeta_k equal exp(i theta) on the edge, theta being the *eccentric* angle, and the disturbance
is A_k / zeta_k.  The public functions speak of the *polar* angle.  As for the crack tip, the
factor 1/(mu1 - mu2) is removed by divided differences, so isotropy is no special case.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from references.analytic.lekhnitskii import RootPair, characteristic_roots
from references.analytic.voigt import Floats, checked_points, checked_voigt


def eccentric_angle(angle: ArrayLike, radius_ratio: float = 1.0) -> Floats:
    """Eccentric angle of the point of an ellipse seen at a polar angle.

    Parameters
    ----------
    angle : array_like
        Polar angle, radians.
    radius_ratio : float
        b/a, the semi-axis along axis 2 over the one along axis 1.

    Raises
    ------
    ValueError
        If an angle is not finite or the ratio not positive and finite.
    """
    w = np.asarray(angle, dtype=float)
    if not np.all(np.isfinite(w)):
        raise ValueError("an angle is NaN or infinite")
    if not 0.0 < radius_ratio < np.inf:
        raise ValueError("the ratio of the hole's semi-axes must be positive and finite")
    return np.arctan2(np.sin(w), radius_ratio * np.cos(w))


def _remote(tension_angle: float) -> tuple[float, float, float]:
    c, s = np.cos(tension_angle), np.sin(tension_angle)
    return float(c * c), float(s * s), float(c * s)


class _Plate:
    """The two characteristic directions and the amplitudes for one hole and remote stress."""

    def __init__(
        self, voigt: ArrayLike, a: float, b: float, remote: tuple[float, float, float]
    ) -> None:
        if not (np.isfinite(a) and np.isfinite(b) and a > 0.0 and b > 0.0):
            raise ValueError("the semi-axes of the hole must be positive and finite")
        if not np.all(np.isfinite(remote)):
            raise ValueError("the remote stress is not finite")
        self.compliance = np.linalg.inv(checked_voigt(voigt))
        mu = characteristic_roots(voigt)
        self.a, self.b, self.remote = a, b, remote
        self.mu = RootPair(mu[0], mu[1], 1.0)
        s11, s22, s12 = remote
        # Sums of A_k and mu_k A_k that cancel the remote resultant on the edge.
        self.sum = 0.5 * complex(-s22 * a, s12 * b)
        self.moment = 0.5 * complex(s12 * a, -s11 * b)

    def combine(self, h: RootPair) -> Floats:
        """2 Re sum of A_k h(mu_k), by divided differences."""
        both = h.second - self.mu.second * h.difference
        return np.asarray(2 * np.real(self.sum * both + self.moment * h.difference))

    def stress(self, h: RootPair) -> Floats:
        """Remote stress plus the disturbance whose derivatives phi_k' are A_k h(mu_k)."""
        mu_h = self.mu.times(h)
        parts = [self.combine(self.mu.times(mu_h)), self.combine(h), -self.combine(mu_h)]
        return np.stack(parts, axis=-1) + np.asarray(self.remote)


def edge_hoop_stress(
    voigt: ArrayLike,
    angle: ArrayLike,
    radius_ratio: float = 1.0,
    *,
    tension_angle: float = 0.0,
) -> Floats:
    """Hoop stress on the edge of a hole under unit remote tension.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Positive definite stiffness, engineering shear.
    angle : array_like
        Polar angle of the point on the edge, radians (for a circle the two kinds agree).
    radius_ratio : float
        b/a: the hole's semi-axis along axis 2 over the one along axis 1; 1 is a circle.
    tension_angle : float
        Direction of the remote tension from axis 1, radians.

    Returns
    -------
    ndarray
        Stress along the edge over the remote stress, dimensionless.

    Raises
    ------
    ValueError
        If the tensor is not positive definite, the ratio not positive, an angle not finite.
    """
    w = np.asarray(angle, dtype=float)
    if not (np.all(np.isfinite(w)) and np.isfinite(tension_angle)):
        raise ValueError("an angle is NaN or infinite")
    plate = _Plate(voigt, 1.0, radius_ratio, _remote(tension_angle))
    theta = eccentric_angle(w, radius_ratio)
    along, across = plate.a * np.sin(theta), plate.b * np.cos(theta)
    mu = plate.mu
    first, second = 1 / (along - mu.first * across), 1 / (along - mu.second * across)
    phase = 1j * np.exp(-1j * theta)
    h = RootPair(phase * first, phase * second, phase * across * first * second)
    s11, s22, s12 = np.moveaxis(plate.stress(h), -1, 0)
    # Tangent (-a sin, b cos) of the ellipse.
    size = along**2 + across**2
    return (s11 * along**2 + s22 * across**2 - 2 * s12 * along * across) / size


def _mapping(plate: _Plate, x: ArrayLike, y: ArrayLike) -> tuple[RootPair, RootPair]:
    """1/zeta and sqrt(z^2 - a^2 - mu^2 b^2) at points outside the hole, as pairs."""
    xs, ys = checked_points(x, y)
    a, b = plate.a, plate.b
    if np.any((xs / a) ** 2 + (ys / b) ** 2 < 1 - 1e-12):
        raise ValueError("a point lies inside the hole")
    mu = np.array([plate.mu.first, plate.mu.second])
    z = xs + np.multiply.outer(mu, ys)
    column = mu.reshape(2, *([1] * xs.ndim))
    branch = a**2 + column**2 * b**2
    root = np.sqrt(z * z - branch)
    # The branch outside the unit circle: |z + root| is the larger of the two.
    root = np.where(np.abs(z + root) >= np.abs(z - root), root, -root)
    total = root[0] + root[1]
    safe = np.abs(total) > 0.1 * (np.abs(root[0]) + np.abs(root[1]))
    with np.errstate(divide="ignore", invalid="ignore"):
        stable = (ys * (z[0] + z[1]) - b * b * (mu[0] + mu[1])) / total
        direct = (root[0] - root[1]) / (mu[0] - mu[1])
    s = RootPair(root[0], root[1], np.where(safe, stable, direct))
    scale = RootPair(a - 1j * mu[0] * b, a - 1j * mu[1] * b, -1j * b)
    outer = RootPair(z[0] + root[0], z[1] + root[1], ys + s.difference)
    return scale.over(outer), s


def hole_stress(
    voigt: ArrayLike,
    x: ArrayLike,
    y: ArrayLike,
    a: float,
    b: float,
    remote: tuple[float, float, float] = (1.0, 0.0, 0.0),
) -> Floats:
    """Stress around an elliptical hole centred at the origin.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Stiffness, Pa.
    x, y : array_like
        Points on or outside the edge, m.
    a, b : float
        Semi-axes along axes 1 and 2, m.
    remote : (s11, s22, s12)
        Stress at infinity, Pa.

    Returns
    -------
    ndarray, (..., 3)
        s11, s22, s12, Pa.

    Raises
    ------
    ValueError
        If a point lies inside the hole, or the tensor or semi-axes are not admissible.
    """
    plate = _Plate(voigt, a, b, remote)
    inverse, root = _mapping(plate, x, y)
    minus = inverse.over(root)  # d(1/zeta)/dz = -1/(zeta root)
    return plate.stress(RootPair(-minus.first, -minus.second, -minus.difference))


def hole_displacement(
    voigt: ArrayLike,
    x: ArrayLike,
    y: ArrayLike,
    a: float,
    b: float,
    remote: tuple[float, float, float] = (1.0, 0.0, 0.0),
) -> Floats:
    """Displacement (..., 2) around an elliptical hole, without rigid motion; see `hole_stress`.

    The part of the remote strain is eps x, which has no rotation.
    """
    plate = _Plate(voigt, a, b, remote)
    inverse, _ = _mapping(plate, x, y)
    xs, ys = checked_points(x, y)
    s, mu = plate.compliance, plate.mu
    total, product = mu.first + mu.second, mu.first * mu.second

    def p(m: complex) -> complex:
        return s[0, 0] * m * m - s[0, 2] * m + s[0, 1]

    def q(m: complex) -> complex:
        return s[0, 1] * m + s[1, 1] / m - s[1, 2]

    first = RootPair(p(mu.first), p(mu.second), s[0, 0] * total - s[0, 2])
    second = RootPair(q(mu.first), q(mu.second), s[0, 1] - s[1, 1] / product)
    e11, e22, shear = s @ np.asarray(remote)
    u1 = plate.combine(first.times(inverse)) + e11 * xs + 0.5 * shear * ys
    u2 = plate.combine(second.times(inverse)) + e22 * ys + 0.5 * shear * xs
    return np.stack([u1, u2], axis=-1)
