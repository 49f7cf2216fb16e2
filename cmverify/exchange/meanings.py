"""What keywords mean, as their functions' docstrings say it (numpydoc)."""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Callable
from typing import Any


def meanings(function: Callable[..., Any]) -> dict[str, str]:
    """First sentences about each keyword of a function.

    A function that only hands its keywords on to the ``run`` or ``solve`` of its module says
    nothing itself: theirs is read then.
    """
    module = sys.modules[function.__module__]
    others = [getattr(module, name, None) for name in ("solve", "run")]
    found: dict[str, str] = {}
    for one in (*others, function):
        if callable(one) and one.__module__ == function.__module__:
            found |= _parameters(inspect.getdoc(one) or "")
    return found


def _parameters(text: str) -> dict[str, str]:
    """Names and meanings of the section ``Parameters``.

    Examples
    --------
    >>> _parameters("A.\\n\\nParameters\\n----------\\na, b : float, m\\n    Long.\\n    Longer.")
    {'a': 'Long. Longer. (m)', 'b': 'Long. Longer. (m)'}
    """
    section = re.search(r"^Parameters\n-+\n(.*?)(?=\n\w+\n-+\n|\Z)", text, re.DOTALL | re.MULTILINE)
    found: dict[str, str] = {}
    for entry in re.split(r"\n(?=\S)", section[1]) if section else []:
        head, *rest = entry.split("\n")
        names, _, kind = head.partition(" : ")
        said = " ".join(line.strip() for line in rest if line.strip())
        one = kind.removesuffix(", optional").count(", ") == 1
        unit = one and re.search(r", ((?:[A-ZΩ]|m|s|rad)[\w/()³² ]{0,9})(?:, optional)?$", kind)
        if unit and unit[1] not in said:
            said = f"{said} ({unit[1]})" if said else unit[1]
        found |= {name.strip(): said for name in names.split(",")}
    return found
