"""Find cases by name or tag. A module of this package takes part by defining `CASES`."""

from __future__ import annotations

import difflib
import pkgutil
from collections.abc import Sequence
from functools import cache
from importlib import import_module

import cmverify.cases
from cmverify.case import Case


@cache
def all_cases() -> tuple[Case, ...]:
    """Every declared case, by name.

    Raises
    ------
    ValueError
        If two cases share a name.
    """
    found: dict[str, Case] = {}
    for module in sorted(pkgutil.iter_modules(cmverify.cases.__path__), key=lambda m: m.name):
        if module.name == "registry":
            continue
        for case in getattr(import_module(f"cmverify.cases.{module.name}"), "CASES", ()):
            if case.name in found:
                raise ValueError(f"two cases are called {case.name!r}")
            found[case.name] = case
    return tuple(found.values())


def get(name: str) -> Case:
    """The case of that name; ValueError with the nearest names if there is none."""
    return select([name])[0]


def select(names: Sequence[str]) -> tuple[Case, ...]:
    """Cases by name or tag, each once, in the registry's order; all of them for no names.

    Raises
    ------
    ValueError
        If a name is neither a case nor a tag; the nearest ones are suggested.
    """
    cases = all_cases()
    known = {case.name for case in cases} | {tag for case in cases for tag in case.tags}
    for name in names:
        if name not in known:
            near = difflib.get_close_matches(name, sorted(known), n=3, cutoff=0.4)
            hint = f"; did you mean {', '.join(near)}?" if near else ""
            raise ValueError(f"no case or tag is called {name!r}{hint}")
    wanted = set(names)
    return tuple(c for c in cases if not wanted or c.name in wanted or wanted & set(c.tags))
