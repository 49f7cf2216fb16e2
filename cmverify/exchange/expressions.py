"""Formulas of x and y (and t) in scene files, evaluated on arrays without running arbitrary code.

A formula is checked when it is read: names, number of arguments, whether it is a value or a
condition, and its constant parts, which must be finite real numbers. What depends on x, y or t is
checked where it is evaluated: a value that is not finite is refused with the point, unless it
lies in the branch of a ``where`` that is not taken there.
"""

from __future__ import annotations

import ast
import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

_OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.true_divide,
    ast.Pow: np.power,
    ast.USub: np.negative,
    ast.UAdd: np.positive,
}
_COMPARISONS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
}
_ARGUMENTS = {
    1: ("sin", "cos", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "arctan", "abs", "sign"),
    2: ("hypot", "arctan2", "minimum", "maximum"),
    3: ("where",),
}
_FUNCTIONS: dict[str, tuple[Callable[..., Any], int]] = {
    name: (getattr(np, name), count) for count, names in _ARGUMENTS.items() for name in names
}
_CONSTANTS = {"pi": np.pi, "e": np.e}
# Longer or deeper formulas are nobody's, and would exhaust Python's stack.
_LONGEST, _NODES, _DEEPEST = 2_000, 400, 60
_AND = "write (x < 1) * (y < 2) for 'and', (x < 1) + (y < 2) for 'or'"


def names() -> tuple[str, ...]:
    """Constants and functions that a formula may use."""
    return (*_CONSTANTS, *_FUNCTIONS)


class FormulaError(ValueError):
    """A text that is no formula, or a formula without a value where one is needed."""


@dataclass(frozen=True)
class Formula:
    """A function of x and y (in metres) given as text, such as ``"x**3/5 - x**2*y"``.

    Attributes
    ----------
    text : str
    time : bool
        Whether it may depend on the time t (in seconds) as well.

    Raises
    ------
    FormulaError
        At construction, if the text is no formula of x, y, pi, e and the known functions; when
        called, if it has no finite value at one of the points.
    """

    text: str
    time: bool = False

    def __post_init__(self) -> None:
        if len(self.text) > _LONGEST:
            raise FormulaError(f"a formula of {len(self.text)} characters; {_LONGEST} at most")
        try:
            with warnings.catch_warnings(action="ignore"):
                tree = ast.parse(self.text.strip(), mode="eval").body
        except SyntaxError as error:
            raise FormulaError(f"{self.text!r} is not a formula: {error.msg}") from None
        except (ValueError, MemoryError, RecursionError) as error:
            raise FormulaError(f"{self.text!r} is not a formula: {error}") from None
        _measure(tree, self.text)
        object.__setattr__(self, "_tree", tree)
        object.__setattr__(self, "_condition", self._check(tree) == "condition")

    @property
    def condition(self) -> bool:
        """Whether it says yes or no, such as ``"x < 1"``, instead of giving a value."""
        return bool(self._condition)  # type: ignore[attr-defined]

    @property
    def timed(self) -> bool:
        """Whether it depends on t."""
        return self._names(self._tree) >= {"t"}  # type: ignore[attr-defined]

    def __call__(self, x: np.ndarray, y: np.ndarray, t: float = 0.0) -> np.ndarray:
        """Values at points, broadcast to their shape."""
        names = {}
        for name, given in (("x", x), ("y", y), ("t", t)):
            names[name] = np.array(given, dtype=np.float64)
            names[name].setflags(write=False)
        with np.errstate(all="ignore"):
            value = self._evaluate(self._tree, names, True)  # type: ignore[attr-defined]
        return np.broadcast_to(value, np.shape(x)).copy()

    # ---- checked once -------------------------------------------------------------------

    def _check(self, node: ast.AST) -> str:
        """Value or condition? Refuses what no formula holds, and constants without a value."""
        kind = self._kind(node)
        if not self._names(node) and not isinstance(node, ast.Constant | ast.Name):
            with np.errstate(all="ignore"):
                self._evaluate(node, {}, True)
        return kind

    def _kind(self, node: ast.AST) -> str:
        if isinstance(node, ast.Constant):
            if isinstance(node.value, bool) or not isinstance(node.value, int | float):
                raise self._not_allowed(node)
            if not abs(node.value) <= sys.float_info.max:
                raise FormulaError(f"{self.text!r}: a number is too large")
            return "value"
        if isinstance(node, ast.Name):
            if node.id in {"x", "y", *_CONSTANTS} or (self.time and node.id == "t"):
                return "value"
            if node.id == "t":
                raise FormulaError(
                    f"{self.text!r} depends on the time t: only values of supports and loads may"
                )
            raise FormulaError(
                f"{self.text!r} uses the unknown name {node.id!r}; it may use x and y, "
                f"{'t, ' if self.time else ''}{', '.join(_CONSTANTS)}, {', '.join(_FUNCTIONS)}"
            )
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            kinds = {self._check(node.left), self._check(node.right)}
            if kinds == {"condition"} and not isinstance(node.op, ast.Add | ast.Mult):
                raise FormulaError(f"{self.text!r} calculates with conditions: {_AND}")
            return "condition" if kinds == {"condition"} else "value"
        if isinstance(node, ast.UnaryOp) and type(node.op) in _OPERATORS:
            return self._value(node.operand)
        if isinstance(node, ast.Compare):
            if len(node.ops) > 1:
                raise FormulaError(f"{self.text!r} compares more than two values at once: {_AND}")
            if type(node.ops[0]) in _COMPARISONS:
                self._value(node.left)
                self._value(node.comparators[0])
                return "condition"
            raise FormulaError(f"{self.text!r} compares with something else than <, <=, > and >=")
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            return self._call(node, node.func.id)
        raise self._not_allowed(node)

    @staticmethod
    def _names(node: ast.AST) -> set[str]:
        """What a node depends on, of x, y and t."""
        return {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and n.id in "xyt"}

    def _value(self, node: ast.AST) -> str:
        if self._check(node) != "value":
            raise FormulaError(f"{self.text!r} calculates with the condition {_source(node)}")
        return "value"

    def _call(self, node: ast.Call, name: str) -> str:
        if name not in _FUNCTIONS:
            raise FormulaError(
                f"{self.text!r} uses the unknown name {name!r}; functions are "
                f"{', '.join(_FUNCTIONS)}"
            )
        count = _FUNCTIONS[name][1]
        if node.keywords or len(node.args) != count:
            given = len(node.args) + len(node.keywords)
            wanted = f"{count} argument" + "s" * (count > 1)
            raise FormulaError(f"{self.text!r}: {name} takes {wanted}, not {given}")
        if name != "where":
            for argument in node.args:
                self._value(argument)
            return "value"
        if self._check(node.args[0]) != "condition":
            raise FormulaError(f"{self.text!r}: the first argument of where is a condition")
        kinds = {self._check(branch) for branch in node.args[1:]}
        if len(kinds) > 1:
            raise FormulaError(f"{self.text!r}: where chooses between a condition and a value")
        return kinds.pop()

    def _not_allowed(self, node: ast.AST) -> FormulaError:
        hint = ""
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitXor):
            hint = ": write x**2 for a power"
        elif isinstance(node, ast.BoolOp) or (
            isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitAnd | ast.BitOr)
        ):
            hint = f": {_AND}"
        elif isinstance(node, ast.IfExp):
            hint = ": write where(condition, x, y)"
        elif isinstance(node, ast.Constant) and isinstance(node.value, complex):
            hint = ": numbers are real"
        return FormulaError(f"{self.text!r}: {_source(node)} is not allowed in a formula{hint}")

    # ---- evaluated ----------------------------------------------------------------------

    def _evaluate(self, node: ast.AST, names: dict[str, np.ndarray], strict: bool) -> Any:
        """Value of a node; with `strict` it is refused where it is not finite."""
        if isinstance(node, ast.Constant):
            return np.float64(node.value)  # type: ignore[arg-type]
        if isinstance(node, ast.Name):
            return names[node.id] if node.id in names else np.float64(_CONSTANTS[node.id])
        if isinstance(node, ast.BinOp):
            parts = [self._evaluate(part, names, strict) for part in (node.left, node.right)]
            value = _OPERATORS[type(node.op)](*parts)
        elif isinstance(node, ast.UnaryOp):
            value = _OPERATORS[type(node.op)](self._evaluate(node.operand, names, strict))
        elif isinstance(node, ast.Compare):
            parts = [
                self._evaluate(part, names, strict) for part in (node.left, node.comparators[0])
            ]
            for part in parts:
                # Comparing it would say no, in a branch that is taken as well.
                if np.isnan(part).any():
                    self._finite(node, np.where(np.isnan(part), np.nan, 0.0), names)
            value = _COMPARISONS[type(node.ops[0])](*parts)
        else:
            assert isinstance(node, ast.Call)
            assert isinstance(node.func, ast.Name)
            name = node.func.id
            chooses = name == "where"
            # What is not finite in a branch does not matter where the other one is taken.
            parts = [
                self._evaluate(part, names, strict and not (chooses and k))
                for k, part in enumerate(node.args)
            ]
            value = _FUNCTIONS[name][0](*parts)
        if strict:
            self._finite(node, value, names)
        return value

    def _finite(self, node: ast.AST, value: Any, names: dict[str, np.ndarray]) -> None:
        bad = ~np.isfinite(value)
        if not bad.any():
            return
        what = f"{_source(node)} in {self.text!r} has no finite real value"
        at = []
        if np.ndim(bad) and names:
            first = np.unravel_index(np.argmax(bad), np.shape(bad))
            x, y = (float(names[name][first]) for name in ("x", "y"))
            at.append(f"x = ({x:g}, {y:g})")
        if names and self.timed:
            at.append(f"t = {float(names['t']):g} s")
        if at:
            what += f" at {', '.join(at)}"
        raise FormulaError(what)


def _measure(tree: ast.AST, text: str) -> None:
    """Refuse trees that are too large or too deep to be walked by recursion."""
    level, count = [tree], 0
    for _ in range(_DEEPEST):
        count += len(level)
        level = [child for node in level for child in ast.iter_child_nodes(node)]
        if not level:
            break
    if level or count > _NODES:
        raise FormulaError(f"the formula {text[:40]!r}… is too long or too deeply nested")


def _source(node: ast.AST) -> str:
    text = ast.unparse(node)
    return repr(text if len(text) <= 60 else text[:60] + "…")
