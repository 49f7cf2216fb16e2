"""Every fault there is: of this folder's tables, and of cases that bring their own.

A module of `cmverify.faults` or of `cmverify.cases` takes part by defining `FAULTS`.
"""

from __future__ import annotations

import pkgutil
from functools import cache
from importlib import import_module

import cmverify.cases
import cmverify.faults
from cmverify.faults.fault import Fault


@cache
def all_faults() -> tuple[Fault, ...]:
    """Every fault, in the order of their tables.

    Raises
    ------
    ValueError
        If two share a name.
    """
    found: dict[str, Fault] = {}
    for package in (cmverify.faults, cmverify.cases):
        for module in sorted(pkgutil.iter_modules(package.__path__), key=lambda m: m.name):
            if module.name == "registry":
                continue
            name = f"{package.__name__}.{module.name}"
            for fault in getattr(import_module(name), "FAULTS", ()):
                if fault.name in found:
                    raise ValueError(f"two faults are called {fault.name!r}")
                found[fault.name] = fault
    return tuple(found.values())


def get(name: str) -> Fault:
    """The fault of that name; KeyError if there is none."""
    return {fault.name: fault for fault in all_faults()}[name]
