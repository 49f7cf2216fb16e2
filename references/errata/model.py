"""What an erratum is, and the small algebra that the proofs share.

Proofs raise `AssertionError` through the functions below rather than by `assert`, so that they
prove something under `python -O` too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any, Literal

import sympy as sp

# Cosine and sine of the bond angle psi, as plain symbols: the laws are polynomials in them.
COS, SIN = sp.symbols("c s", real=True)
THICKNESS, HORIZON = sp.symbols("h delta", positive=True)


@dataclass(frozen=True)
class Entry:
    """One printed equation, what it should say, and a proof.

    Attributes
    ----------
    number : str
        The equation's number in the paper, a range such as "43-45", or for an unnumbered
        statement the section ("Sect. 2.3.1").
    title : str
        What the equation is about.
    printed, derived : str
        The formula as the paper has it and as it follows from the paper's own definitions.
    verdict : {"confirmed", "wrong"}
    shows : str
        Where a wrong formula shows, with numbers; for a confirmed one what was checked.
    prove : callable
        Runs the proof; raises AssertionError if the verdict does not follow.
    """

    number: str
    title: str
    printed: str
    derived: str
    verdict: Literal["confirmed", "wrong"]
    shows: str
    prove: Callable[[], None] = field(repr=False, compare=False)

    def covers(self, number: str) -> bool:
        """Whether `number` is this entry's own or falls into its range of equations."""
        if number == self.number:
            return True
        low, _, high = self.number.partition("-")
        if not (low.isdigit() and high.isdigit() and number.isdigit()):
            return False
        return int(low) <= int(number) <= int(high)


def require(condition: object, what: str) -> None:
    """Raise AssertionError with `what` unless the condition holds."""
    if not condition:
        raise AssertionError(what)


def vanishes(expression: Any, what: str) -> None:
    """Raise AssertionError unless the sympy expression (or every entry of a matrix) is zero."""
    entries: Iterable[Any] = expression if isinstance(expression, sp.MatrixBase) else [expression]
    for entry in entries:
        reduced = sp.expand(entry)
        if reduced != 0:
            reduced = sp.simplify(reduced.subs(SIN**2, 1 - COS**2))
        require(reduced == 0, f"{what}: {reduced} is not zero")


def differs(expression: Any, what: str) -> None:
    """Raise AssertionError unless the expression is non-zero at a generic rational point."""
    entries: Iterable[Any] = expression if isinstance(expression, sp.MatrixBase) else [expression]
    for entry in entries:
        expr = sp.sympify(entry)
        names = sorted(expr.free_symbols, key=str)
        point = {name: sp.Rational(3 + 7 * k, 5 + 4 * k) for k, name in enumerate(names)}
        if abs(complex(expr.subs(point).evalf(30))) > 1e-12:
            return
    raise AssertionError(f"{what}: the printed form does not differ from the derived one")


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
