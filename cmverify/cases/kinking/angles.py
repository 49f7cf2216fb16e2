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


def chord_angle(path: Array) -> float:
    """Direction from the old tip to the new one, degrees."""
    step = path[-1] - path[0]
    return float(np.degrees(np.arctan2(step[1], step[0])))
