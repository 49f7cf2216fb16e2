"""What is read from the path that anybody's program gives of an experiment's crack."""

from __future__ import annotations

import numpy as np

from cmverify.case import Array

#: For the remarks of a problem.
PATH = (
    "Judged by the crack's path, (k, 2) in m, from its old tip on (in a table columns x and y and "
    "no others), or by the numbers that are read from it."
)


def from_tip(path: Array, tip: tuple[float, float], size: float) -> Array:
    """A path from the point on that is nearest to a tip, less the tip.

    Raises
    ------
    ValueError
        If the path does not pass the tip within `size`, m, or ends there.
    """
    away = np.hypot(*(path - tip).T)
    start = int(away.argmin())
    if away[start] > size or start == len(path) - 1:
        raise ValueError(
            f"the path of this crack begins at its old tip ({tip[0]:.6g}, {tip[1]:.6g}) m"
        )
    return np.asarray(path[start:] - tip)


def straying(path: Array, tip: tuple[float, float], size: float, width: float) -> Array:
    """How far a crack along axis 1 leaves its line, over a width, (1,)."""
    return np.array([np.abs(from_tip(path, tip, size)[:, 1]).max() / width])


def outside(
    path: Array, tip: tuple[float, float], size: float, reach: float, least: float, most: float
) -> Array:
    """Degrees by which a crack's first part leaves a sector of directions, (1,).

    Raises
    ------
    ValueError
        If the path is shorter than `reach`.
    """
    from cmverify.cases.kinking.angles import grown_path

    x, y = grown_path(from_tip(path, tip, size), reach)[-1]
    direction = float(np.degrees(np.arctan2(y, x)))
    return np.array([max(0.0, direction - most, least - direction)])


def short(path: Array, tip: tuple[float, float], unit: float) -> Array:
    """By how much two cracks, each half a turn's image of the other, do not pass, over c, (1,)."""
    end = from_tip(path, tip, 0.25 * unit)[-1] + tip
    return np.array([max(0.0, -2 * end[0] / unit)])


def from_the_flank(
    path: Array, tip: tuple[float, float], unit: float, outer: float, horizon: float
) -> Array:
    """Distance of a crack's end from the other, its image under half a turn, in horizons, (1,)."""
    grown = from_tip(path, tip, 0.25 * unit) + tip
    notch = np.column_stack([np.linspace(-tip[0], outer, 200), np.full(200, -tip[1])])
    other = np.vstack([-grown, notch])
    return np.array([np.hypot(*(other - grown[-1]).T).min() / horizon])
