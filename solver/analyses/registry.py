"""The analyses that there are: scene files, the command line, asv and the report walk this.

A module of `solver.analyses` or `solver.fracture` takes part by defining ``ANALYSIS``. Its `run` is
a function of a scene and of keywords; the keywords' names, annotations and defaults are what a
scene file's table may say (``[modes]`` with ``count = 10``), so that nothing is declared twice. Two
keywords are not the user's: a run that takes `progress` tells it the share that is done, one that
takes `monitors` serves other analyses by them.
"""

from __future__ import annotations

import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from inspect import Parameter, signature

from ..result import Result

# Keywords of `run` that no scene file gives.
_OURS = ("progress", "monitors")
_ROOMS = ("solver.analyses", "solver.fracture")


@dataclass(frozen=True)
class Analysis:
    """Something that can be done with a scene.

    Attributes
    ----------
    name : str
        Its table in scene files.
    says : str
        In a sentence.
    run : callable
        (scene, **options) → Result.
    timed : bool
        Whether supports and loads may depend on time.
    stressed : bool
        Whether its result has the stress of an elastic state (`Result.stressed`).
    """

    name: str
    says: str
    run: Callable[..., Result]
    timed: bool = False
    stressed: bool = False

    @property
    def options(self) -> dict[str, Parameter]:
        """Keywords of `run` after the scene, with annotations (evaluated) and defaults."""
        return {k: v for k, v in self._keywords.items() if k not in _OURS}

    @property
    def reports(self) -> bool:
        """Whether `run` tells how far it has come, 0 to 1, to a keyword `progress`."""
        return "progress" in self._keywords

    @property
    def _keywords(self) -> dict[str, Parameter]:
        return dict(list(signature(self.run, eval_str=True).parameters.items())[1:])


@cache
def analyses() -> dict[str, Analysis]:
    """All analyses by name, the static one first.

    Raises
    ------
    ValueError
        If two share a name.
    """
    found: dict[str, Analysis] = {}
    for room in _ROOMS:
        for module in sorted(pkgutil.iter_modules(import_module(room).__path__)):
            one = getattr(import_module(f"{room}.{module.name}"), "ANALYSIS", None)
            if one is None:
                continue
            if one.name in found:
                raise ValueError(f"two analyses are called {one.name!r}")
            found[one.name] = one
    return dict(sorted(found.items(), key=lambda item: (item[0] != "solve", item[0])))
