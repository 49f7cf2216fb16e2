"""The small algebra that the proofs share: bond angles, turned tensors, moments of the circle."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import sympy as sp

# Cosine and sine of the bond angle psi, as plain symbols: the laws are polynomials in them.
COS, SIN = sp.symbols("c s", real=True)
THICKNESS, HORIZON = sp.symbols("h delta", positive=True)

_FUNCTIONS = ("sqrt", "pi", "sin", "cos", "acos", "atan", "exp", "I", "Matrix", "diff", "diag")


def names(symbols: str = "", **more: Any) -> dict[str, Any]:
    """What the names of a form mean: c, s, h, delta, sympy's functions, real symbols, and more."""
    known: dict[str, Any] = {name: getattr(sp, name) for name in _FUNCTIONS}
    known.update(c=COS, s=SIN, h=THICKNESS, delta=HORIZON)
    known.update({name: sp.Symbol(name, real=True) for name in symbols.split()})
    known.update(more)
    return known


def circle_integral(polynomial: Any) -> Any:
    """Integral over psi from 0 to 2 pi of a polynomial in COS and SIN, exactly.

    The moment of cos^a sin^b is 2 pi (a-1)!! (b-1)!! / (a+b)!! if both are even, else zero.
    """
    total = sp.Integer(0)
    for (a, b), coefficient in sp.Poly(sp.expand(polynomial), COS, SIN).terms():
        if a % 2 == 0 and b % 2 == 0:
            moment = sp.factorial2(a - 1) * sp.factorial2(b - 1) / sp.factorial2(a + b)
            total += coefficient * 2 * sp.pi * moment
    return sp.expand(total)


def half_circle_integral(polynomial: Any) -> Any:
    """Integral from -pi/2 to pi/2 of a polynomial in COS and SIN, by beta functions."""
    total = sp.Integer(0)
    for (a, b), coefficient in sp.Poly(sp.expand(polynomial), COS, SIN).terms():
        if b % 2 == 0:
            p, q = sp.Rational(a + 1, 2), sp.Rational(b + 1, 2)
            total += coefficient * sp.gamma(p) * sp.gamma(q) / sp.gamma(p + q)
    return sp.expand(total)


def stiffness_symbols() -> sp.Matrix:
    """The symmetric Voigt matrix of Eq. 41 with symbols C11 ... C66 (engineering shear)."""
    c11, c22, c12, c66, c16, c26 = sp.symbols("C11 C22 C12 C66 C16 C26", real=True)
    return sp.Matrix([[c11, c12, c16], [c12, c22, c26], [c16, c26, c66]])


def turned(stiffness: sp.Matrix) -> sp.Matrix:
    """Components C_ijkl in axes turned by psi, from the definition with four direction cosines."""
    frame = sp.Matrix([[COS, SIN], [-SIN, COS]])
    pairs = [(0, 0), (1, 1), (0, 1)]
    place = {(0, 0): 0, (1, 1): 1, (0, 1): 2, (1, 0): 2}

    def component(row: int, column: int) -> Any:
        (i, j), (k, m) = pairs[row], pairs[column]
        return sp.expand(
            sum(
                frame[i, a]
                * frame[j, b]
                * frame[k, c]
                * frame[m, d]
                * stiffness[place[a, b], place[c, d]]
                for a in range(2)
                for b in range(2)
                for c in range(2)
                for d in range(2)
            )
        )

    return sp.Matrix(3, 3, component)


def family(m: int) -> tuple[np.ndarray, np.ndarray]:
    """Offsets (n, 2) in cells and area fractions clip(m + 1/2 - r, 0, 1) of a family."""
    span = range(-m - 1, m + 2)
    offsets, fractions = [], []
    for i in span:
        for j in span:
            alpha = min(1.0, max(0.0, m + 0.5 - math.hypot(i, j)))
            if (i, j) != (0, 0) and alpha > 0.0:
                offsets.append((i, j))
                fractions.append(alpha)
    return np.array(offsets, dtype=float), np.array(fractions)


def particles_in_disc(cells: int, shift: tuple[float, float] = (0.5, 0.5)) -> int:
    """Grid points inside a disc of radius `cells`; by default at half-integer multiples."""
    span = np.arange(-cells - 2, cells + 2)
    x, y = span + shift[0], span + shift[1]
    return int(np.count_nonzero(x[:, None] ** 2 + y[None, :] ** 2 < cells**2))
