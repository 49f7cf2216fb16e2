"""Exact temperature fields of an anisotropic plane conductor.

With the conductivity D (2x2, symmetric, positive definite) a steady field obeys
div(D grad T) + w = 0, where w is the heat source per volume.  Any function of x + lam y with

    D22 lam^2 + 2 D12 lam + D11 = 0

is harmonic in that sense (H. S. Carslaw and J. C. Jaeger, *Conduction of Heat in Solids*, 2nd ed.
1959, 1.17-1.20): powers give the polynomials of every degree, exponentials the fields that no
polynomial represents.  The instantaneous source is theirs too (10.2, after scaling the axes).

Every field here is a frozen object with `value`, `gradient`, `flux` and `source`.  Lengths in m,
temperatures in K, conductivities in W/(m K), fluxes in W/m^2, sources in W/m^3.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from references.analytic.voigt import Floats, checked_points

# Eq. 168 of the paper, W/(m K).
DISC_CONDUCTIVITY = ((5.0, 2.0), (2.0, 1.0))


def checked_conductivity(conductivity: ArrayLike) -> Floats:
    """The tensor as a float array, once it is known to be symmetric positive definite.

    Raises
    ------
    ValueError
        If it is not 2x2, finite, symmetric and positive definite: heat would flow uphill.
    """
    tensor = np.asarray(conductivity, dtype=float)
    if tensor.shape != (2, 2):
        raise ValueError(f"a conductivity tensor is a 2x2 matrix, not an array {tensor.shape}")
    if not np.all(np.isfinite(tensor)):
        raise ValueError("the conductivity tensor holds NaN or infinite entries")
    if abs(tensor[0, 1] - tensor[1, 0]) > 1e-12 * np.max(np.abs(tensor)):
        raise ValueError("the conductivity tensor is not symmetric")
    determinant = tensor[0, 0] * tensor[1, 1] - tensor[0, 1] * tensor[1, 0]
    if tensor[0, 0] <= 0.0 or determinant <= 1e-14 * tensor[0, 0] * abs(tensor[1, 1]):
        raise ValueError("the conductivity tensor is not positive definite")
    return tensor


def harmonic_direction(conductivity: ArrayLike) -> complex:
    """The lam with a positive imaginary part for which every f(x + lam y) conducts without source.

    Parameters
    ----------
    conductivity : array_like, (2, 2)

    Returns
    -------
    complex
        (-D12 + i sqrt(det D)) / D22; for Eq. 168 it is -2 + i.
    """
    d = checked_conductivity(conductivity)
    root = np.sqrt(d[0, 0] * d[1, 1] - d[0, 1] ** 2)
    return complex(-d[0, 1], root) / complex(d[1, 1])


@dataclass(frozen=True, eq=False)
class SteadyField(ABC):
    """A temperature field with its gradient, flux and the heat source that keeps it steady."""

    conductivity: Floats = field(repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "conductivity", checked_conductivity(self.conductivity))

    @abstractmethod
    def value(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Temperature at the points, K."""

    @abstractmethod
    def gradient(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Temperature gradient, (..., 2), K/m."""

    @abstractmethod
    def hessian(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Second derivatives T,11, T,22, T,12 of the temperature, (..., 3), K/m^2."""

    def flux(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Heat flux -D grad T (Eqs. 136, 171), (..., 2), W/m^2."""
        return -self.gradient(x, y) @ self.conductivity

    def source(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Heat source w = -div(D grad T) that the field needs, W/m^3."""
        d, h = self.conductivity, self.hessian(x, y)
        return -(d[0, 0] * h[..., 0] + d[1, 1] * h[..., 1] + 2 * d[0, 1] * h[..., 2])


@dataclass(frozen=True, eq=False)
class Polynomial(SteadyField):
    """T = sum over i, j of coefficients[i, j] x^i y^j, harmonic or not."""

    coefficients: Floats

    def __post_init__(self) -> None:
        super().__post_init__()
        c = np.atleast_2d(np.asarray(self.coefficients, dtype=float))
        if c.ndim != 2 or not np.all(np.isfinite(c)):
            raise ValueError("a polynomial's coefficients are a finite array (i, j)")
        object.__setattr__(self, "coefficients", c)

    def _derivative(self, i: int, j: int, x: ArrayLike, y: ArrayLike) -> Floats:
        xs, ys = checked_points(x, y)
        polynomial = np.polynomial.polynomial
        c = polynomial.polyder(polynomial.polyder(self.coefficients, i, axis=0), j, axis=1)
        return np.asarray(polynomial.polyval2d(xs, ys, c), dtype=float)

    def value(self, x: ArrayLike, y: ArrayLike) -> Floats:
        return self._derivative(0, 0, x, y)

    def gradient(self, x: ArrayLike, y: ArrayLike) -> Floats:
        parts = [self._derivative(1, 0, x, y), self._derivative(0, 1, x, y)]
        return np.stack(parts, axis=-1)

    def hessian(self, x: ArrayLike, y: ArrayLike) -> Floats:
        orders = [(2, 0), (0, 2), (1, 1)]
        return np.stack([self._derivative(i, j, x, y) for i, j in orders], axis=-1)


@dataclass(frozen=True, eq=False)
class Exponential(SteadyField):
    """T = Re[amplitude exp(a x + b y)] with complex a, b; harmonic if b = lam a.

    A plane wave of another direction (b != lam a) needs the source that `source` returns.
    """

    a: complex
    b: complex
    amplitude: complex = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not np.all(np.isfinite([self.a, self.b, self.amplitude])):
            raise ValueError("an exponential field has finite rates and a finite amplitude")

    def _wave(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.complex128]:
        xs, ys = checked_points(x, y)
        return self.amplitude * np.exp(self.a * xs + self.b * ys)

    def value(self, x: ArrayLike, y: ArrayLike) -> Floats:
        return np.real(self._wave(x, y))

    def gradient(self, x: ArrayLike, y: ArrayLike) -> Floats:
        wave = self._wave(x, y)
        return np.real(np.stack([self.a * wave, self.b * wave], axis=-1))

    def hessian(self, x: ArrayLike, y: ArrayLike) -> Floats:
        wave = self._wave(x, y)
        return np.real(
            np.stack([self.a**2 * wave, self.b**2 * wave, self.a * self.b * wave], axis=-1)
        )


@dataclass(frozen=True, eq=False)
class PointSource(SteadyField):
    """A steady line source of `power` (W per m of thickness) at `position` in an infinite body.

    T = -power / (4 pi sqrt(det D)) log(r . D^-1 r), defined up to a constant.
    """

    power: float = 1.0
    position: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not np.all(np.isfinite([self.power, *self.position])):
            raise ValueError("a point source has a finite power and position")

    def _offset(self, x: ArrayLike, y: ArrayLike) -> tuple[Floats, Floats]:
        xs, ys = checked_points(x, y)
        r = np.stack([xs - self.position[0], ys - self.position[1]], axis=-1)
        rho = r @ np.linalg.inv(self.conductivity)
        if np.any(np.all(r == 0.0, axis=-1)):
            raise ValueError("the temperature is unbounded at the point source")
        return rho, np.sum(r * rho, axis=-1)

    @property
    def _strength(self) -> float:
        return float(-self.power / (4 * np.pi * np.sqrt(np.linalg.det(self.conductivity))))

    def value(self, x: ArrayLike, y: ArrayLike) -> Floats:
        return self._strength * np.log(self._offset(x, y)[1])

    def gradient(self, x: ArrayLike, y: ArrayLike) -> Floats:
        rho, square = self._offset(x, y)
        return self._strength * 2 * rho / square[..., None]

    def hessian(self, x: ArrayLike, y: ArrayLike) -> Floats:
        rho, square = self._offset(x, y)
        inverse = np.linalg.inv(self.conductivity)
        parts = [
            2 * inverse[i, j] / square - 4 * rho[..., i] * rho[..., j] / square**2
            for i, j in ((0, 0), (1, 1), (0, 1))
        ]
        return self._strength * np.stack(parts, axis=-1)


@dataclass(frozen=True, eq=False)
class InstantaneousSource:
    """Heat released at one point and time zero in an infinite conductor.

    T = heat / (4 pi t sqrt(det D)) exp(-capacity r . D^-1 r / (4 t)), the solution of
    capacity dT/dt = div(D grad T) that carries `heat` at every time.

    Attributes
    ----------
    conductivity : (2, 2), W/(m K)
    heat : float
        J per m of thickness.
    capacity : float
        Heat capacity per volume, rho c, J/(m^3 K).
    position : (float, float)
        m.
    """

    conductivity: Floats = field(repr=False)
    heat: float = 1.0
    capacity: float = 1.0
    position: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "conductivity", checked_conductivity(self.conductivity))
        if not 0.0 < self.capacity < np.inf:
            raise ValueError("the heat capacity per volume must be positive and finite")
        if not np.all(np.isfinite([self.heat, *self.position])):
            raise ValueError("an instantaneous source has a finite heat and position")

    def _state(self, x: ArrayLike, y: ArrayLike, t: float) -> tuple[Floats, Floats, Floats]:
        if not (np.isfinite(t) and t > 0.0):
            raise ValueError("the instantaneous source is defined for times t > 0 only")
        xs, ys = checked_points(x, y)
        r = np.stack([xs - self.position[0], ys - self.position[1]], axis=-1)
        rho = r @ np.linalg.inv(self.conductivity)
        square = np.sum(r * rho, axis=-1)
        peak = self.heat / (4 * np.pi * t * np.sqrt(np.linalg.det(self.conductivity)))
        return rho, square, peak * np.exp(-self.capacity * square / (4 * t))

    def value(self, x: ArrayLike, y: ArrayLike, t: float) -> Floats:
        """Temperature rise at time t (s), K."""
        return self._state(x, y, t)[2]

    def gradient(self, x: ArrayLike, y: ArrayLike, t: float) -> Floats:
        """Temperature gradient, (..., 2), K/m."""
        rho, _, value = self._state(x, y, t)
        return -self.capacity / (2 * t) * rho * value[..., None]

    def flux(self, x: ArrayLike, y: ArrayLike, t: float) -> Floats:
        """Heat flux -D grad T, (..., 2), W/m^2."""
        return -self.gradient(x, y, t) @ self.conductivity

    def source(self, x: ArrayLike, y: ArrayLike, t: float) -> Floats:
        """Heat source at times t > 0: none."""
        return np.zeros_like(self._state(x, y, t)[2])

    def rate(self, x: ArrayLike, y: ArrayLike, t: float) -> Floats:
        """dT/dt at the points, K/s."""
        _, square, value = self._state(x, y, t)
        return value * (self.capacity * square / (4 * t * t) - 1 / t)


def harmonic_polynomials(conductivity: ArrayLike, degree: int) -> tuple[Polynomial, ...]:
    """The homogeneous polynomials of one degree that conduct without a source.

    Parameters
    ----------
    conductivity : array_like, (2, 2)
    degree : int
        At least 0.

    Returns
    -------
    tuple of Polynomial
        Real and imaginary part of (x + lam y)^degree: two fields, one for degree 0.
    """
    if degree < 0:
        raise ValueError("the degree of a polynomial is at least 0")
    d = checked_conductivity(conductivity)
    lam = harmonic_direction(d)
    # Pascal's rule on complex coefficients: row j holds y^j x^(degree - j).
    row = np.array([1.0 + 0.0j])
    for _ in range(degree):
        row = np.append(row, 0.0) + lam * np.insert(row, 0, 0.0)
    coefficients = np.zeros((degree + 1, degree + 1), dtype=complex)
    for j, c in enumerate(row):
        coefficients[degree - j, j] = c
    real = Polynomial(d, coefficients.real)
    return (real,) if degree == 0 else (real, Polynomial(d, coefficients.imag))


def harmonic_exponential(
    conductivity: ArrayLike, rate: complex = 1.0, amplitude: complex = 1.0
) -> Exponential:
    """T = Re[amplitude exp(rate (x + lam y))], source-free for any complex rate (1/m)."""
    lam = harmonic_direction(conductivity)
    return Exponential(checked_conductivity(conductivity), rate, rate * lam, amplitude)


def _disc_cubic(last: float) -> Polynomial:
    c = np.zeros((4, 4))
    c[3, 0], c[2, 1], c[1, 2], c[0, 3] = 1 / 5, -1.0, 1.0, last
    return Polynomial(np.array(DISC_CONDUCTIVITY), c)


def disc_cubic() -> Polynomial:
    """The cubic of Eq. 169 as it must read: x^3/5 - x^2 y + x y^2 + y^3/3, without a source."""
    return _disc_cubic(1 / 3)


def disc_cubic_printed() -> Polynomial:
    """Eq. 169 as printed, with y^3/5: div(D grad T) = -0.8 y, so it needs the source 0.8 y."""
    return _disc_cubic(1 / 5)


def disc_exponential() -> Exponential:
    """exp(x - 2 y) cos y, source-free in the conductivity of Eq. 168."""
    return harmonic_exponential(np.array(DISC_CONDUCTIVITY))
