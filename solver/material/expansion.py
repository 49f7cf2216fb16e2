"""Thermal expansion of the solid in the plane (Eq. 176 completed): ε = A T without stress."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from .tensors import Plane


@dataclass(frozen=True, eq=False)
class ExpansionTensor:
    """Coefficients of thermal expansion in the plane, ε = A T for a change of temperature T.

    In plane strain, where the third strain is held at zero, A is what the plane does then: the
    strain in the plane without stress in it. σ33 = −E3 A33 T pushes it apart,

        A_eff = A_αβ + ν_3α A33 on the diagonal,   ν_3α = ν_α3 E3/E_α;

    for an isotropic solid (1 + ν) α.

    Parameters
    ----------
    matrix : array_like, shape (2, 2)
        Symmetric, 1/K; tensor components (A12 is half an engineering shear). Of either sign.

    Raises
    ------
    ValueError
        If the matrix is not 2×2, not finite or not symmetric.

    Examples
    --------
    >>> ExpansionTensor.isotropic(1e-5, nu=0.25, plane="strain").voigt
    array([1.25e-05, 1.25e-05, 0.00e+00])
    """

    matrix: Array

    def __init__(self, matrix: ArrayLike) -> None:
        array = np.array(matrix, dtype=np.float64)
        if array.shape != (2, 2) or not np.all(np.isfinite(array)):
            raise ValueError(f"the expansion tensor must be 2×2 and finite, not {matrix!r}")
        if np.abs(array - array.T).max() > 1e-10 * np.abs(array).max():
            raise ValueError(f"the expansion tensor must be symmetric:\n{array}")
        array = 0.5 * (array + array.T)
        array.setflags(write=False)
        object.__setattr__(self, "matrix", array)

    @classmethod
    def isotropic(
        cls, alpha: float, plane: Plane = "stress", nu: float | None = None
    ) -> ExpansionTensor:
        """The same `alpha` (1/K) in all three directions; plane strain needs Poisson's ratio."""
        if plane == "stress":
            return cls(np.diag([alpha, alpha]))
        if nu is None:
            raise ValueError("thermal expansion in plane strain needs Poisson's ratio nu")
        return cls.orthotropic(alpha, alpha, plane, alpha, nu, nu)

    @classmethod
    def orthotropic(
        cls,
        alpha1: float,
        alpha2: float,
        plane: Plane = "stress",
        alpha3: float | None = None,
        nu31: float | None = None,
        nu32: float | None = None,
    ) -> ExpansionTensor:
        """Principal coefficients `alpha1`, `alpha2`, 1/K, along the reference axes.

        Parameters
        ----------
        plane : {"stress", "strain"}
        alpha3, nu31, nu32 : float, optional
            Plane strain only: expansion along the third axis, and contraction along 1 and 2
            under tension along 3 (ν31 = ν13 E3/E1).
        """
        if plane == "strain":
            if alpha3 is None or nu31 is None or nu32 is None:
                raise ValueError("thermal expansion in plane strain needs alpha3, nu31 and nu32")
            return cls(np.diag([alpha1 + nu31 * alpha3, alpha2 + nu32 * alpha3]))
        if plane != "stress":
            raise ValueError(f"plane must be 'stress' or 'strain', not {plane!r}")
        return cls(np.diag([alpha1, alpha2]))

    @property
    def voigt(self) -> Array:
        """A11, A22 and 2 A12, shape (3,)."""
        a = self.matrix
        return np.array([a[0, 0], a[1, 1], 2 * a[0, 1]])

    def rotated(self, angle: float) -> ExpansionTensor:
        """The same solid turned anticlockwise by `angle` (rad)."""
        c, s = np.cos(angle), np.sin(angle)
        q = np.array([[c, -s], [s, c]])
        return ExpansionTensor(q @ self.matrix @ q.T)
