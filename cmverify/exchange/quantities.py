"""What a lattice and finite elements both know of a scene, to be compared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from solver.arrays import Array, Mask

STRESSES = ("stress11", "stress22", "stress12")


@dataclass(frozen=True, eq=False)
class Quantity:
    """Something that both computations know.

    Attributes
    ----------
    name : str
    ours, fine, coarse : ndarray
        (N,), or (N, c), at the particles; (k,) numbers.
    free : (N,) bool array, optional
        Particles that are judged; None: numbers.
    level : bool
        Whether its zero is a choice, as of temperatures: it is judged less its mean.
    drawn : bool
        Whether it is a field to write.
    """

    name: str
    ours: Array
    fine: Array
    coarse: Array
    free: Mask | None = None
    level: bool = False
    drawn: bool = True


@dataclass(frozen=True)
class Told:
    """What an analysis tells: quantities, and remarks."""

    quantities: list[Quantity]
    notes: tuple[str, ...] = ()


def number(name: str, ours: float, fine: float, coarse: float) -> Quantity:
    return Quantity(name, np.array([ours]), np.array([fine]), np.array([coarse]))


def stresses(ours: dict[str, Array], fine: Any, coarse: Any, points: Array, free: Mask) -> Quantity:
    own = np.stack([ours[name] for name in STRESSES], axis=1)
    return Quantity("stress", own, fine.flux_at(points), coarse.flux_at(points), free)
