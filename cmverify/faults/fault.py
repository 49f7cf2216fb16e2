"""A fault: one function of the solver, the references or the judges, made wrong in this process.

The function is replaced wherever it is known by name, and put back afterwards; what is cached is
forgotten before and after. Compiled kernels are reached through the tables that feed them.
"""

from __future__ import annotations

import functools
import pkgutil
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from types import ModuleType
from typing import Any

PACKAGES = ("solver", "references", "cmverify")
#: What takes long, is not judged and does not depend on any fault: meshes, compilation.
KEPT = (
    "timed_mesh", "warm_up", "load_gmsh", "import_all", "all_cases", "all_faults",
)  # fmt: skip

Function = Callable[..., Any]
#: Tables and keys under which something is known, by its identity.
_Places = dict[int, list[tuple[dict[Any, Any], Any]]]


@dataclass(frozen=True)
class Fault:
    """A function made wrong.

    Attributes
    ----------
    name : str
        What is wrong, in a few words; unique.
    target : str
        Dotted name of a function, or of a method or property of a class.
    change : callable
        Takes the right function and returns the wrong one.
    kind : str
        What it is about: "moduli", "loads", "closed forms", …
    harmless : str
        Why no case needs to see it; empty if one has to.
    """

    name: str
    target: str
    change: Callable[[Function], Function]
    kind: str
    harmless: str = ""


@dataclass
class Calls:
    """How often each target was called."""

    of: dict[str, int] = field(default_factory=dict)


@functools.cache
def import_all() -> None:
    """Import every module that may hold a target by name, so that none is imported when wrong."""
    for package in PACKAGES:
        root = import_module(package)
        for found in pkgutil.walk_packages(root.__path__, f"{package}."):
            # Scripts run when imported; asv's and FEniCSx's modules need another interpreter.
            if not found.name.endswith("__main__") and ".fenicsx" not in found.name:
                import_module(found.name)


@contextmanager
def applied(faults: dict[str, Callable[[Function], Function] | None]) -> Iterator[Calls]:
    """Make targets wrong inside the block, and count their calls; None only counts.

    Raises
    ------
    LookupError
        If a target does not exist (any more).
    """
    import_all()
    calls = Calls()
    forget()
    known = _places()
    with ExitStack() as stack:
        for target, change in faults.items():
            stack.enter_context(_replaced(target, change, calls, known))
        try:
            yield calls
        finally:
            stack.close()
            forget()


def forget() -> None:
    """Empty every cache of the project's functions, but for what faults do not touch."""
    for module in _modules():
        for place in (module, *(v for v in vars(module).values() if isinstance(v, type))):
            for name, value in list(vars(place).items()):
                if hasattr(value, "cache_clear") and name not in KEPT:
                    value.cache_clear()


def find(target: str) -> tuple[Any, str]:
    """Owner (module or class) and attribute of a dotted name.

    Raises
    ------
    LookupError
        If there is no such thing.
    """
    parts = target.split(".")
    for cut in range(len(parts) - 1, 0, -1):
        try:
            owner: Any = import_module(".".join(parts[:cut]))
        except ModuleNotFoundError:
            continue
        for name in parts[cut:-1]:
            owner = getattr(owner, name, None)
        if owner is not None and parts[-1] in vars(owner):
            return owner, parts[-1]
        break
    raise LookupError(f"a fault has no target: {target} does not exist")


@contextmanager
def _replaced(
    target: str, change: Callable[[Function], Function] | None, calls: Calls, known: _Places
) -> Iterator[None]:
    owner, name = find(target)
    right = vars(owner)[name]
    calls.of[target] = 0

    def counted(function: Function) -> Function:
        wrong = change(function) if change else function

        @functools.wraps(function)
        def run(*args: Any, **kwargs: Any) -> Any:
            calls.of[target] += 1
            return wrong(*args, **kwargs)

        return run

    wrong: Any
    if isinstance(right, property):
        wrong = property(counted(right.fget))  # type: ignore[arg-type]
    elif isinstance(right, functools.cached_property):
        wrong = functools.cached_property(counted(right.func))
        wrong.__set_name__(owner, name)
    elif isinstance(right, classmethod | staticmethod):
        wrong = type(right)(counted(right.__func__))
    else:
        # A cached function is replaced by an uncached one.
        wrong = counted(getattr(right, "__wrapped__", right))
    if isinstance(owner, type):
        setattr(owner, name, wrong)
        try:
            yield
        finally:
            setattr(owner, name, right)
        return
    places = known.get(id(right), [])
    for table, key in places:
        table[key] = wrong
    try:
        yield
    finally:
        for table, key in places:
            table[key] = right


def _places() -> _Places:
    """Where every function is known by a name, in modules and in their tables, by its identity."""
    found: _Places = {}
    for module in _modules():
        names = vars(module)
        # Every module holds Python's own functions too.
        held = [v for k, v in names.items() if type(v) is dict and k != "__builtins__"]
        for table in (names, *held):
            for key, value in list(table.items()):
                if callable(value):
                    found.setdefault(id(value), []).append((table, key))
    return found


def _modules() -> list[ModuleType]:
    return [
        module
        for name, module in list(sys.modules.items())
        if name.split(".")[0] in PACKAGES and isinstance(module, ModuleType)
    ]
