"""Krylov methods and the two-level preconditioner, for every analysis."""

from .bordered import Border, Bordered, BorderedInverse
from .coarse import Hats
from .condensed import Condensed
from .krylov import Task
from .two_level import BlockJacobi, TwoLevel

__all__ = [
    "BlockJacobi",
    "Border",
    "Bordered",
    "BorderedInverse",
    "Condensed",
    "Hats",
    "Task",
    "TwoLevel",
]
