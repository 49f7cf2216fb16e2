"""Gauss and Legendre's rule, made once for each number of points."""

from __future__ import annotations

from functools import cache

import numpy as np

from references.analytic.voigt import Floats


@cache
def gauss(points: int) -> tuple[Floats, Floats]:
    """Abscissae on (−1, 1) and weights, arrays of this many points that are only read.

    Examples
    --------
    >>> x, weight = gauss(2)
    >>> float((weight * x**2).sum().round(12))
    0.666666666667
    """
    rule = np.polynomial.legendre.leggauss(points)
    for array in rule:
        array.flags.writeable = False
    return rule
