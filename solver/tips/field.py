"""The two singular fields of a crack tip in an anisotropic solid.

Lekhnitskii's potentials A_k √z_k, z_k = x + μ_k y, with both faces free of traction (G. C. Sih,
P. C. Paris, G. R. Irwin, Int. J. Fract. Mech. 1, 1965). Every field is Re[K_I (h₂ − μ₂ h[μ₁, μ₂])
− K_II h[μ₁, μ₂]] with the divided difference h[μ₁, μ₂] of a function of the root. It is expanded
by hand,

    √z₁ − √z₂ = (μ₁ − μ₂) y / (√z₁ + √z₂),

and stays what it is where the roots coincide, as those of an isotropic solid do. Fields are
wanted up to a factor only: K and the stiffness have no units here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array


@dataclass(frozen=True)
class TipField:
    """Displacement and rotation of both modes around the tip of a straight crack.

    Parameters
    ----------
    stiffness : ndarray, shape (3, 3)
        Voigt, engineering shear, in the reference axes.
    direction : ndarray, shape (2,)
        Unit vector in which the crack would advance along itself.
    """

    stiffness: Array
    direction: Array

    def __call__(self, away: Array) -> tuple[Array, Array]:
        """Fields at points relative to the tip, shape (n, 2).

        Returns
        -------
        displacement : ndarray, shape (2, 2, n)
            Mode, component in the reference axes.
        rotation : ndarray, shape (2, n)
            Half the curl; in radians over a length.
        """
        c, s = self.direction
        turn = np.array([[c, s], [-s, c]])
        compliance = _turned(np.asarray(np.linalg.inv(self.stiffness), dtype=np.float64), c, s)
        s11, s12, s16 = compliance[0]
        s22, s26, s66 = compliance[1, 1], compliance[1, 2], compliance[2, 2]
        roots = np.roots([s11, -2 * s16, 2 * s12 + s66, -2 * s26, s22])
        one, two = roots[np.argsort(roots.imag)][2:]
        x, y = turn @ np.asarray(away).T
        # By parts: y = −0.0 is the lower face.
        first, second = (np.sqrt(_complex(x + mu.real * y, mu.imag * y)) for mu in (one, two))
        # u₁ takes p √z, u₂ q √z; each as value at the second root and divided difference.
        p = s11 * two**2 - s16 * two + s12, s11 * (one + two) - s16
        q = s12 * two + s22 / two - s26, s12 - s22 / (one * two)
        root = second, first, y / (first + second)
        inverse = 1 / second, 1 / first, -y / (first * second * (first + second))
        local = np.stack([_modes(*_times(part, root), two) for part in (p, q)], axis=1)
        displacement = 2.0 * np.einsum("ji,mjn->min", turn, local)
        along = _modes(*_times(q, inverse), two)
        across = _modes(*_times((two * p[0], p[0] + one * p[1]), inverse), two)
        return displacement, 0.5 * (along - across)


def _complex(real: Array, imaginary: Array) -> np.ndarray:
    found = np.empty(real.shape, dtype=complex)
    found.real, found.imag = real, imaginary
    return found


def _times(
    factor: tuple[complex, complex], values: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Value at the second root and divided difference of a product (Leibniz' rule)."""
    second, first, difference = values
    return factor[0] * second, factor[1] * first + factor[0] * difference


def _modes(second: np.ndarray, difference: np.ndarray, two: complex) -> Array:
    """Both modes of a field, shape (2, n)."""
    return np.real(np.stack([second - two * difference, -difference]))


def _turned(compliance: Array, c: float, s: float) -> Array:
    """Compliance in axes turned anticlockwise by the angle of cosine c and sine s."""
    # Stresses of the reference axes from those of the turned ones, (11, 22, 12).
    stress = np.array(
        [[c * c, s * s, -2 * s * c], [s * s, c * c, 2 * s * c], [s * c, -s * c, c * c - s * s]]
    )
    return stress.T @ compliance @ stress
