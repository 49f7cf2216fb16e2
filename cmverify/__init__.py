"""The harness: cases, runs, reports, benchmarks.

``from cmverify import Scene, …`` is the safe spelling of ``from solver import Scene, …``: a folder
or another package of the name ``solver`` does not come in between. Nothing is imported until a
name is used.
"""

# ruff: noqa: F405
from __future__ import annotations

import sys
from importlib.util import spec_from_file_location
from os.path import abspath, dirname, isfile, join
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType

    from solver import *  # noqa: F403

#: Packages of this distribution beside this one.
SIBLINGS = ("solver", "references")
_HOME = dirname(dirname(abspath(__file__)))

__all__ = [
    "CalibrationError",
    "ChiralTensor",
    "ConductivityTensor",
    "ConvergenceError",
    "Cosine",
    "Crack",
    "Discretisation",
    "ElasticTensor",
    "ElectricConductivityTensor",
    "ExpansionTensor",
    "Family",
    "Fourfold",
    "InadmissibleMaterialError",
    "Inclusion",
    "Influence",
    "Load",
    "MechanismError",
    "NegativeCurvatureError",
    "Piezoresistance",
    "PolarTensor",
    "Programme",
    "Region",
    "Scene",
    "SceneError",
    "Solution",
    "Statistics",
    "Support",
    "Toughness",
    "ToughnessError",
    "TwoHarmonic",
    "UniformShear",
    "disc",
    "fracture",
    "modes",
    "polygon",
    "recovery",
    "rectangle",
    "strained",
    "thermoelastic",
    "transient",
    "waves",
]


class _Siblings:
    """Finds this distribution's other packages where this one lies, whatever else has their names.

    With the folder of a script first on the path, as Python has it, a user's folder or file
    ``solver`` would be imported in the middle of this program.
    """

    @staticmethod
    def find_spec(
        fullname: str,
        path: Sequence[str] | None = None,
        target: ModuleType | None = None,
    ) -> ModuleSpec | None:
        if fullname not in SIBLINGS:
            return None
        folder = join(_HOME, fullname)
        origin = join(folder, "__init__.py")
        if not isfile(origin):
            return None
        return spec_from_file_location(fullname, origin, submodule_search_locations=[folder])


sys.meta_path[:0] = [_Siblings]


def foreign(name: str = "solver") -> str | None:
    """Where a module of this name came from that was imported before and is not this program's."""
    module = sys.modules.get(name)
    if module is None:
        return None
    origin = getattr(module, "__file__", None)
    if origin is not None and dirname(abspath(origin)) == join(_HOME, name):
        return None
    return origin or str(next(iter(getattr(module, "__path__", [])), "?"))


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    other = foreign()
    if other is not None:
        raise ImportError(
            f"another package called solver was imported before, from {other}: import cmverify "
            f"first, or rename that one"
        )
    import solver

    return getattr(solver, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
