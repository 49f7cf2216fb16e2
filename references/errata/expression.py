"""Forms in code notation: reading them, and deciding whether two of them say the same.

The paper's formulas are kept as text such as ``"12*(C11 - C66)/(pi*h*delta**3)"``.  A text can be
shown, evaluated with symbols or with numbers, and changed by a test (`references.errata.mutation`)
to see that a proof notices.
"""

from __future__ import annotations

import ast
import zlib
from collections.abc import Mapping
from decimal import ROUND_DOWN, ROUND_HALF_UP, Decimal
from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from references.errata.algebra import COS, SIN

#: Relative agreement of two numbers of a proof that works with floats.
ROUNDING = 1e-9
# Cosine and sine of two angles, exactly.
_ANGLES = (
    (sp.Rational(5, 13), sp.Rational(12, 13)),
    (sp.Rational(-8, 17), sp.Rational(15, 17)),
)
# What a changed or damaged text may run into.
_CANNOT = (
    ArithmeticError,
    AttributeError,
    IndexError,
    NameError,
    TypeError,
    ValueError,
    sp.PolynomialError,
    sp.ShapeError,
)


class _ExactNumbers(ast.NodeTransformer):
    """Literals become sympy's, so that 1/3 is a third."""

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        if isinstance(node.value, bool) or not isinstance(node.value, int | float):
            return node
        kind = "Integer" if isinstance(node.value, int) else "Rational"
        value: Any = node.value if kind == "Integer" else str(node.value)
        return ast.Call(ast.Name(kind, ast.Load()), [ast.Constant(value)], [])


@cache
def _compiled(text: str, exact: bool) -> Any:
    tree = ast.parse(text, mode="eval")
    if exact:
        tree = ast.fix_missing_locations(_ExactNumbers().visit(tree))
    return compile(tree, f"<{text}>", "eval")


def evaluate(text: str, names: Mapping[str, Any], exact: bool = True) -> Any:
    """Value of a form.

    Parameters
    ----------
    text : str
    names : mapping
        What the names of the text stand for.
    exact : bool
        Whether literals are exact numbers; False where names are arrays.

    Raises
    ------
    AssertionError
        If the text cannot be evaluated with these names.
    """
    scope = {"__builtins__": {}, "Integer": sp.Integer, "Rational": sp.Rational, **names}
    try:
        with np.errstate(all="ignore"):
            return eval(_compiled(text, exact), scope)
    except _CANNOT as error:
        raise AssertionError(f"{text} cannot be evaluated: {error}") from None


def _flat(value: Any) -> list[Any]:
    if isinstance(value, sp.MatrixBase | sp.NDimArray):
        return list(value)
    if isinstance(value, list | tuple):
        return [part for item in value for part in _flat(item)]
    if isinstance(value, np.ndarray):
        return list(value.ravel())
    return [value]


def _shape(value: Any) -> tuple[int, ...]:
    if isinstance(value, sp.MatrixBase):
        return tuple(value.shape)
    return (len(_flat(value)),) if not isinstance(value, np.ndarray) else value.shape


def _drawn(name: str, k: int) -> Any:
    """A number between 1 and 3 that belongs to a name."""
    return 1 + sp.Rational(zlib.crc32(name.encode()) % 997 + 13 * k, 509)


def draws(symbols: set[Any]) -> list[dict[Any, Any]]:
    """Two rational points for these symbols; COS and SIN stay those of an angle."""
    points = []
    for k, (cosine, sine) in enumerate(_ANGLES):
        point: dict[Any, Any] = {name: _drawn(str(name), k) for name in symbols}
        point.update({COS: cosine, SIN: sine})
        points.append(point)
    return points


def at_a_point(value: Any) -> Any:
    """The same with ordinary numbers for symbols, or the value itself where it holds none."""
    if not isinstance(value, sp.Basic | sp.MatrixBase):
        return value
    if not value.free_symbols:
        return value if isinstance(value, sp.MatrixBase) else _number(value)
    put = value.xreplace(draws(value.free_symbols)[0])
    return put.evalf(17) if isinstance(put, sp.MatrixBase) else _number(put)


def _number(value: Any) -> Any:
    try:
        number = complex(value.evalf(17))
    except (TypeError, AttributeError):
        return value
    return number if number.imag else number.real


def surely_different(first: Any, second: Any) -> bool:
    """Whether two values at a point differ by more than rounding can."""
    if _shape(first) != _shape(second):
        return True
    pairs = [(complex(a), complex(b)) for a, b in zip(_flat(first), _flat(second), strict=True)]
    size = max(abs(part) for pair in pairs for part in pair)
    return max(abs(a - b) for a, b in pairs) > 1e-7 * size


def _is_zero(difference: Any) -> bool:
    """Whether an expression vanishes: quickly no at a point, and yes by algebra only."""
    expression = sp.sympify(difference)
    for point in draws(expression.free_symbols):
        try:
            if abs(complex(expression.xreplace(point).evalf(25))) > 1e-15:
                return False
        except TypeError:  # not a number at a point: left to the algebra
            break
    reduced = sp.expand(expression)
    if reduced == 0:
        return True
    numerator = sp.expand(sp.fraction(sp.together(reduced))[0])
    if numerator.has(SIN) and numerator.is_polynomial(SIN):
        numerator = sp.expand(sp.rem(numerator, SIN**2 + COS**2 - 1, SIN))
    return bool(numerator == 0 or sp.simplify(reduced) == 0)


def _numbers(values: list[Any]) -> bool:
    return all(isinstance(v, int | float | complex | np.number | bool) for v in values)


def same(first: Any, second: Any) -> bool:
    """Whether two values (numbers, arrays, expressions, matrices) are equal."""
    if isinstance(first, sp.MatrixBase) != isinstance(second, sp.MatrixBase):
        return False
    if _shape(first) != _shape(second):
        return False
    one, other = _flat(first), _flat(second)
    if _numbers(one) and _numbers(other):
        a, b = np.array(one, dtype=complex), np.array(other, dtype=complex)
        return bool(np.max(np.abs(a - b)) <= ROUNDING * max(np.max(np.abs(b)), 1e-300))
    return all(_is_zero(x - y) for x, y in zip(one, other, strict=True))


def agrees_in_digits(printed: Any, value: float, text: str, truncated: bool = False) -> bool:
    """Whether a number printed as `text` is `value` to the digits printed."""
    places = len(text.partition(".")[2])
    unit = Decimal(1).scaleb(-places)
    mode = ROUND_DOWN if truncated else ROUND_HALF_UP
    return Decimal(float(value)).quantize(unit, mode) == Decimal(str(float(printed))).quantize(unit)
