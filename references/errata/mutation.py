"""Small changes of a form: a sign, a factor, a constant, an index.

A proof that still holds after such a change has not read the form.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

_SWAPS = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
_COMPARE = {ast.GtE: ast.Lt, ast.Lt: ast.GtE, ast.Gt: ast.LtE, ast.LtE: ast.Gt}
_TIES = {ast.GtE: ast.Gt, ast.Gt: ast.GtE, ast.Lt: ast.LtE, ast.LtE: ast.Lt}
_EQUAL = {ast.Eq: ast.NotEq, ast.NotEq: ast.Eq}
_TWINS = {"sin": "cos", "cos": "sin", "c": "s", "s": "c"}
_STEM = re.compile(r"[A-Za-z_]+?(?=\d|p?$|q?$)")


def mutants(text: str, digits: bool = False) -> list[str]:
    """Texts that differ from `text` by one small change, without repetition.

    Parameters
    ----------
    text : str
    digits : bool
        A number whose last printed digit counts.
    """
    if digits:
        places = len(text.partition(".")[2])
        unit = 10.0**-places
        return [f"{float(text) + step * unit:.{places}f}" for step in (-1, 1, 10)]
    tree = ast.parse(text, mode="eval")
    original = ast.unparse(tree)
    found: dict[str, None] = {}
    for changed in _changes(tree):
        new = ast.unparse(ast.fix_missing_locations(changed))
        if new != original:
            found[new] = None
    if not isinstance(tree.body, ast.Tuple | ast.List | ast.Lambda | ast.IfExp):
        found[f"-({original})"] = None
        found[f"2*({original})"] = None
    return list(found)


def _changes(tree: ast.Expression) -> Iterator[ast.AST]:
    """The tree with one node replaced at a time; it is put right again after each."""
    nodes = list(ast.walk(tree))
    called = {id(n.func) for n in nodes if isinstance(n, ast.Call)}
    loaded = sorted({n.id for n in nodes if isinstance(n, ast.Name) and id(n) not in called})
    for parent in nodes:
        for name, value in ast.iter_fields(parent):
            for place, node in enumerate(value) if isinstance(value, list) else [(None, value)]:
                for new in _replacements(node, loaded):
                    _put(parent, name, place, new)
                    yield tree
                    _put(parent, name, place, node)


def _put(parent: ast.AST, name: str, place: int | None, node: object) -> None:
    if place is None:
        setattr(parent, name, node)
    else:
        getattr(parent, name)[place] = node


def _replacements(node: object, loaded: list[str]) -> Iterator[ast.AST]:
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        yield ast.Constant(node.value + 1)
    elif isinstance(node, ast.BinOp):
        if type(node.op) in _SWAPS:
            yield ast.BinOp(node.left, _SWAPS[type(node.op)](), node.right)
        if isinstance(node.op, ast.Mult | ast.Div | ast.MatMult):
            yield node.left
            if not isinstance(node.op, ast.Div):
                yield node.right
        if isinstance(node.op, ast.Add | ast.Sub):
            yield ast.BinOp(node.left, node.op, ast.BinOp(ast.Constant(2), ast.Mult(), node.right))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield node.operand
    elif isinstance(node, ast.Compare):
        for table in (_COMPARE, _TIES, _EQUAL):
            if type(node.ops[0]) in table:
                yield ast.Compare(node.left, [table[type(node.ops[0])]()], node.comparators)
    elif isinstance(node, ast.IfExp):
        yield ast.IfExp(node.test, node.orelse, node.body)
    elif isinstance(node, ast.BoolOp):
        yield from node.values
    elif isinstance(node, ast.Name):
        for other in _siblings(node.id, loaded):
            yield ast.Name(other, ast.Load())


def _siblings(name: str, loaded: list[str]) -> list[str]:
    """Names that a slip of an index or of a prime would give."""
    if name in _TWINS:
        return [_TWINS[name]]
    stem = _STEM.match(name)
    if stem is None:
        return []
    return [
        other
        for other in loaded
        if other != name and (match := _STEM.match(other)) and match.group() == stem.group()
    ]
