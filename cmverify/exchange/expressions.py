"""Formulas of x and y in scene files, evaluated on arrays without running arbitrary code."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

_OPERATORS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    name: getattr(np, name)
    for name in (
        "sin", "cos", "tan", "exp", "log", "sqrt", "sinh", "cosh", "tanh", "hypot", "arctan2",
        "arctan", "abs", "where", "sign", "minimum", "maximum",
    )
}  # fmt: skip
_COMPARISONS: dict[type[ast.AST], Callable[..., Any]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
_CONSTANTS = {"pi": np.pi, "e": np.e}


@dataclass(frozen=True)
class Formula:
    """A function of x and y (in metres) given as text, such as ``"x**3/5 - x**2*y"``.

    Raises
    ------
    ValueError
        At construction, if the text is no formula of x, y, pi, e and the known functions.
    """

    text: str

    def __post_init__(self) -> None:
        try:
            tree = ast.parse(self.text.strip(), mode="eval").body
        except SyntaxError as error:
            raise ValueError(f"{self.text!r} is not a formula: {error.msg}") from error
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and node.id not in {"x", "y", *_CONSTANTS, *_FUNCTIONS}:
                raise ValueError(
                    f"{self.text!r} uses the unknown name {node.id!r}; it may use x "
                    f"and y, {', '.join(_CONSTANTS)}, {', '.join(_FUNCTIONS)}"
                )
        self._evaluate(tree, {"x": np.ones(1), "y": np.ones(1)})

    def __call__(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Values at points, broadcast to their shape."""
        tree = ast.parse(self.text.strip(), mode="eval").body
        with np.errstate(divide="ignore", invalid="ignore"):
            value = self._evaluate(tree, {"x": np.asarray(x), "y": np.asarray(y)})
        return np.broadcast_to(value, np.shape(x)).copy()

    def _evaluate(self, node: ast.AST, names: dict[str, np.ndarray]) -> Any:
        if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            return float(node.value)
        if isinstance(node, ast.Name) and node.id in names:
            return names[node.id]
        if isinstance(node, ast.Name) and node.id in _CONSTANTS:
            return _CONSTANTS[node.id]
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            left, right = self._evaluate(node.left, names), self._evaluate(node.right, names)
            return _OPERATORS[type(node.op)](left, right)
        if isinstance(node, ast.UnaryOp) and type(node.op) in _OPERATORS:
            return _OPERATORS[type(node.op)](self._evaluate(node.operand, names))
        if isinstance(node, ast.Compare) and len(node.ops) == 1:
            compare = _COMPARISONS.get(type(node.ops[0]))
            if compare is not None:
                left = self._evaluate(node.left, names)
                return compare(left, self._evaluate(node.comparators[0], names))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
            function = _FUNCTIONS.get(node.func.id)
            if function is not None:
                try:
                    return function(*(self._evaluate(a, names) for a in node.args))
                except (TypeError, ValueError) as error:
                    raise ValueError(f"{self.text!r}: {node.func.id}: {error}") from error
        raise ValueError(f"{self.text!r}: {ast.unparse(node)!r} is not allowed in a formula")
