"""Exact polynomial displacement fields in equilibrium, of any degree, for any plane tensor.

With Q = C_i1k1, R = C_i1k2, T = C_i2k2 a displacement u is in equilibrium without body force if

    Q u,11 + (R + R^T) u,12 + T u,22 = 0.

On homogeneous polynomials of degree n this is a linear map from 2 (n + 1) coefficients to
2 (n - 1); T is positive definite, so the map has full rank and its null space holds four fields
for every n >= 1.  They are what a patch test prescribes: a method that is exact on them is exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from references.analytic.voigt import Floats, checked_points, checked_voigt, strain_of_gradient


@dataclass(frozen=True, eq=False)
class PolynomialDisplacement:
    """u_k = sum over i, j of coefficients[k, i, j] x^i y^j, in equilibrium or not.

    Attributes
    ----------
    voigt : (3, 3)
        Stiffness, Pa.
    coefficients : (2, n, n)
        Metres over the matching power of metres.
    """

    voigt: Floats = field(repr=False)
    coefficients: Floats

    def __post_init__(self) -> None:
        c = np.asarray(self.coefficients, dtype=float)
        if c.ndim != 3 or c.shape[0] != 2 or not np.all(np.isfinite(c)):
            raise ValueError("a polynomial displacement has finite coefficients (2, i, j)")
        object.__setattr__(self, "voigt", checked_voigt(self.voigt))
        object.__setattr__(self, "coefficients", c)

    def _derivative(self, i: int, j: int, x: ArrayLike, y: ArrayLike) -> Floats:
        xs, ys = checked_points(x, y)
        polynomial = np.polynomial.polynomial
        c = polynomial.polyder(polynomial.polyder(self.coefficients, i, axis=1), j, axis=2)
        return np.stack([np.asarray(polynomial.polyval2d(xs, ys, ck)) for ck in c], axis=-1)

    def displacement(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Displacement (..., 2), m."""
        return self._derivative(0, 0, x, y)

    def gradient(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Displacement gradient u_i,j, (..., 2, 2)."""
        return np.stack([self._derivative(1, 0, x, y), self._derivative(0, 1, x, y)], axis=-1)

    def rotation(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Macrorotation (u2,1 - u1,2)/2, radians, positive anticlockwise."""
        g = self.gradient(x, y)
        return 0.5 * (g[..., 1, 0] - g[..., 0, 1])

    def strain(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Voigt strain (..., 3): e11, e22, 2 e12."""
        return strain_of_gradient(self.gradient(x, y))

    def stress(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Stress (..., 3): s11, s22, s12, Pa."""
        return self.strain(x, y) @ self.voigt

    def body_force(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Body force -div(stress) that the field needs, (..., 2), N/m^3; zero in equilibrium."""
        q, r, t = acoustic_blocks(self.voigt)
        second = [self._derivative(i, j, x, y) for i, j in ((2, 0), (1, 1), (0, 2))]
        return -(second[0] @ q.T + second[1] @ (r + r.T).T + second[2] @ t.T)


def acoustic_blocks(voigt: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Q = C_i1k1, R = C_i1k2 and T = C_i2k2 of a stiffness, each (2, 2)."""
    c = checked_voigt(voigt)
    index = np.array([[0, 2], [2, 1]])  # Voigt index of the pair (i, j)
    q = c[np.ix_(index[:, 0], index[:, 0])]
    r = c[np.ix_(index[:, 0], index[:, 1])]
    t = c[np.ix_(index[:, 1], index[:, 1])]
    return q, r, t


def equilibrium_polynomials(voigt: ArrayLike, degree: int) -> tuple[PolynomialDisplacement, ...]:
    """All homogeneous polynomial displacements of one degree that need no body force.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Positive definite stiffness, Pa.
    degree : int
        At least 0.

    Returns
    -------
    tuple of PolynomialDisplacement
        Four fields (two for degree 0, the translations).  They begin with x^n e1, x^n e2,
        x^(n-1) y e1 and x^(n-1) y e2 and are scaled to a largest coefficient of one, so that the
        same tensor gives the same fields everywhere.

    Raises
    ------
    ValueError
        If the tensor is not positive definite or the degree negative.
    """
    if degree < 0:
        raise ValueError("the degree of a displacement field is at least 0")
    c = checked_voigt(voigt)
    n = degree
    free = 2 if n == 0 else 4
    operator = np.zeros((2 * max(n - 1, 0), 2 * (n + 1)))
    q, r, t = acoustic_blocks(c)
    for j in range(n - 1):  # the equation that multiplies x^(n-2-j) y^j
        rows = slice(2 * j, 2 * j + 2)
        operator[rows, 2 * j : 2 * j + 2] = (n - j) * (n - j - 1) * q
        operator[rows, 2 * j + 2 : 2 * j + 4] = (n - j - 1) * (j + 1) * (r + r.T)
        operator[rows, 2 * j + 4 : 2 * j + 6] = (j + 2) * (j + 1) * t
    if operator.size:
        # The orthonormal null space is the stable part; solving for its first four coefficients
        # only chooses a basis in it.
        basis = np.linalg.svd(operator)[2][-free:].T
        basis = basis @ np.linalg.inv(basis[:free])
    else:
        basis = np.eye(2 * (n + 1))
    fields = []
    for column in basis.T:
        coefficients = np.zeros((2, n + 1, n + 1))
        for j in range(n + 1):
            coefficients[:, n - j, j] = column[2 * j : 2 * j + 2]
        fields.append(PolynomialDisplacement(c, coefficients / np.abs(coefficients).max()))
    return tuple(fields)


def combine(
    fields: Sequence[PolynomialDisplacement], weights: Sequence[float]
) -> PolynomialDisplacement:
    """The weighted sum of fields of one tensor, of any degrees.

    Raises
    ------
    ValueError
        If there is no field, the numbers differ, a weight is not finite, or the fields belong to
        different tensors.
    """
    if not fields or len(fields) != len(weights):
        raise ValueError("one weight for each of at least one field is needed")
    if not np.all(np.isfinite(weights)):
        raise ValueError("a weight is not finite")
    voigt = fields[0].voigt
    if any(not np.array_equal(f.voigt, voigt) for f in fields):
        raise ValueError("fields of different tensors do not add up to an equilibrium field")
    size = max(f.coefficients.shape[1] for f in fields)
    total = np.zeros((2, size, size))
    for one, weight in zip(fields, weights, strict=True):
        m = one.coefficients.shape[1]
        total[:, :m, :m] += weight * one.coefficients
    return PolynomialDisplacement(voigt, total)
