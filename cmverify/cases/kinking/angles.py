"""Kink angles: what criteria predict, and how they are read from a crack that has grown."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from cmverify.case import Array
from cmverify.cases.common import materials
from cmverify.cases.kinking.problem import MATERIALS, REACH

if TYPE_CHECKING:
    from references.fem.kinks import KinkTable


@cache
def _table(material: str) -> KinkTable:
    from references.tables import stored_kinks

    return stored_kinks(MATERIALS[material])


@cache
def energy_angle(material: str, mixity: float) -> float:
    """Where the energy release rate of a short kink is largest (finite elements), degrees."""
    angle = np.radians(mixity)
    return float(np.degrees(_table(material).kink_angle(np.cos(angle), np.sin(angle))))


@cache
def hoop_angle(material: str, mixity: float) -> float:
    """Where the hoop stress intensity factor is largest (closed form), degrees."""
    from references.analytic.kinking import hoop_kink_angle

    angle = np.radians(mixity)
    voigt = materials.TENSORS[material]
    return float(np.degrees(hoop_kink_angle(voigt, np.cos(angle), np.sin(angle))))


def energy_release(material: str, mixity: float, degrees: Array) -> Array:
    """G(ω) of a short kink over its largest value."""
    angle = np.radians(mixity)
    rate = _table(material).energy_release_rate(np.cos(angle), np.sin(angle), np.radians(degrees))
    return rate / rate.max()


def largest_release(material: str, mixity: float) -> float:
    """G of the best short kink for K of size one, in units of (GPa √a)²/GPa."""
    angle = np.radians(mixity)
    best = np.radians(energy_angle(material, mixity))
    return float(_table(material).energy_release_rate(np.cos(angle), np.sin(angle), best))


def read_angle(marks: Array, outer: float = REACH, inner: float = 0.0) -> float:
    """Direction of the straight line through the marks of a kink, degrees.

    Total least squares through the marks at distances between `inner` and `outer` from the old
    tip. The line need not pass through the tip: where the kink leaves the old crack is uncertain
    by a cell or two, which would turn a short chord by many degrees.

    Parameters
    ----------
    marks : (k, 2) array
        Midpoints of broken short bonds in the crack's axes.

    Returns
    -------
    float
        NaN with fewer than three marks.
    """
    distance = np.linalg.norm(marks, axis=1)
    ahead = np.abs(np.arctan2(marks[:, 1], marks[:, 0])) < np.radians(150.0)
    chosen = marks[(distance >= inner) & (distance <= outer) & ahead]
    if len(chosen) < 3:
        return float("nan")
    middle = chosen.mean(axis=0)
    along = np.linalg.svd(chosen - middle)[2][0]
    along = along if along @ middle > 0 else -along
    return float(np.degrees(np.arctan2(along[1], along[0])))


def grown_path(path: Array, reach: float = REACH) -> Array:
    """The part of a crack's path from the old tip, the origin, to the circle of radius `reach`.

    Parameters
    ----------
    path : (k, 2) array
        In the crack's axes, from the old tip or from the mouth on.

    Raises
    ------
    ValueError
        If it does not pass the old tip, or ends before the circle.
    """
    away = np.linalg.norm(path, axis=1)
    start = int(away.argmin())
    if len(path) < 2 or away[start] > 0.2 * reach:
        raise ValueError("the path of a crack begins at its old tip, which is the origin")
    outside = np.flatnonzero(away[start:] >= reach)
    if not len(outside):
        raise ValueError(
            f"the path ends {away[-1]:.3g} from the old tip: it is judged to {reach:g}"
        )
    last = start + int(outside[0])
    inner, step = path[last - 1], path[last] - path[last - 1]
    # |inner + s step| = reach.
    a, b, c = step @ step, inner @ step, inner @ inner - reach**2
    share = (-b + np.sqrt(b * b - a * c)) / a
    return np.vstack([path[start:last], inner + share * step])


def path_angle(path: Array) -> float:
    """As `read_angle`, of a path that is a line instead of marks, degrees.

    Raises
    ------
    ValueError
        As `grown_path`.
    """
    from shapely import LineString, get_coordinates

    line = LineString(grown_path(path))
    return read_angle(
        get_coordinates(line.interpolate(np.linspace(0.0, 1.0, 200), normalized=True)), np.inf
    )


def straight(degrees: float, reach: float = REACH) -> Array:
    """The straight kink at an angle, (2, 2)."""
    angle = np.radians(degrees)
    return reach * np.array([[0.0, 0.0], [np.cos(angle), np.sin(angle)]])


def chord_angle(path: Array) -> float:
    """Direction from the old tip to the new one, degrees."""
    step = path[-1] - path[0]
    return float(np.degrees(np.arctan2(step[1], step[0])))
