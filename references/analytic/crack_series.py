"""The eigenfunctions of a crack tip in an anisotropic body, of which K is the first.

M. L. Williams, J. Appl. Mech. 24 (1957) 109, for isotropy; here in the Lekhnitskii formalism, with
the notation of `references.analytic.lekhnitskii`. The potentials A_k z_k^(n/2) leave both faces
free of traction if the sums of A_k and of mu_k A_k are real for odd n and imaginary for even n:
two fields for every n. n = 1 is the singular field of K_I and K_II, n = 0 are the translations,
n = 2 the stress along the crack and the rotation. The energy of n = -1 is unbounded at the tip:
it is what a tip that is not where it is thought to be leaves in the field around it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from references.analytic.lekhnitskii import RootPair, TipBasis
from references.analytic.voigt import Floats


def crack_tip_term(
    voigt: ArrayLike, x: ArrayLike, y: ArrayLike, n: int, *, face: str | None = None
) -> Floats:
    """Both displacement fields of order r^(n/2) around a crack on the negative x axis.

    Parameters
    ----------
    voigt : array_like, (3, 3)
        Stiffness, Pa.
    x, y : array_like
        Points relative to the tip, m.
    n : int
        Any integer; fields of negative n are unbounded at the tip.
    face : {"upper", "lower"}, optional
        See `references.analytic.lekhnitskii.crack_tip_displacement`.

    Returns
    -------
    ndarray, (2, ..., 2)
        First the field of the opening kind, then that of the sliding kind; for n = 1 the
        displacements of unit K_I and unit K_II.

    Raises
    ------
    ValueError
        If n is no integer, the tensor not positive definite, or a point is the tip and n < 0.
    """
    if n != int(n):
        raise ValueError(f"the order of a crack-tip term is an integer n of r^(n/2), not {n}")
    basis = TipBasis(voigt, x, y, face)
    if n < 0:
        basis.refuse_tip("displacement")
    power = _power(basis.root if n >= 0 else basis.inverse, abs(int(n)))
    turn = 1.0 if n % 2 else 1j
    power = RootPair(*(turn * part for part in power))
    fields = [
        np.stack([basis.field(f.times(power), *mode) for f in (basis.p, basis.q)], axis=-1)
        for mode in ((1.0, 0.0), (0.0, 1.0))
    ]
    return np.sqrt(2 / np.pi) * np.stack(fields)


def _power(base: RootPair, exponent: int) -> RootPair:
    one = np.ones_like(base.first)
    result = RootPair(one, one, 0 * one)
    for _ in range(exponent):
        result = result.times(base)
    return result
