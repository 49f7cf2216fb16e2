"""Where a crack goes by the energy criterion: G over what the cut costs is largest.

One straight step after the other: of the directions in which the crack could take the next step,
it takes the one for which the energy release rate at the step's end, over the fracture energy of
a cut that way, is largest (finite elements on the whole body each time). The direction is known to
first order in the step's length.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
#: A body's G at the tip of a polyline, J/m² for the unit load: points (n, 2) → G.
Release = Callable[[Floats], float]
#: Fracture energy of cuts by their direction, rad from axis 1.
Cost = Callable[[float], float]


@dataclass(frozen=True)
class EnergyPath:
    """A path and what was found on the way.

    Attributes
    ----------
    points : (n + 1, 2) float array
        From the old tip, one step apart, m.
    directions : (n,) float array
        Of the steps, rad from axis 1.
    ratios : (n,) float array
        G over the fracture energy at the end of each step for the unit load.
    """

    points: Floats
    directions: Floats
    ratios: Floats


def largest(value: Callable[[float], float], angles: Sequence[float], width: float) -> float:
    """Angle at which a smooth positive function is largest.

    The largest of the values at `angles`; then the vertex of the parabola through the logarithms
    at it and `width` to both sides, moved on until it lies between them.

    Raises
    ------
    ValueError
        If there is no largest value within 20 such moves.
    """
    known: dict[int, float] = {}

    def at(cell: int, origin: float) -> float:
        if cell not in known:
            known[cell] = float(np.log(value(origin + cell * width)))
        return known[cell]

    origin = angles[int(np.argmax([value(a) for a in angles]))] if len(angles) > 1 else angles[0]
    middle = 0
    for _ in range(20):
        left, here, right = (at(middle + k, origin) for k in (-1, 0, 1))
        if here >= left and here >= right:
            bend = left - 2 * here + right
            vertex = 0.5 * (left - right) / bend if bend < 0 else 0.0
            return float(origin + (middle + vertex) * width)
        middle += 1 if right > left else -1
    raise ValueError("the ratio of G to the fracture energy has no largest value nearby")


def energy_path(
    tip: tuple[float, float],
    release: Release,
    cost: Cost,
    step: float,
    steps: int,
    first: Sequence[float],
    width: float = np.radians(8.0),
) -> EnergyPath:
    """Path of a crack from its tip by the energy criterion.

    Parameters
    ----------
    tip : pair of float
    release, cost : callable
    step : float
        Length of each straight piece, m.
    steps : int
    first : sequence of float
        Directions tried for the first step, rad; later ones begin at the last direction.
    width : float
        Distance of the angles that the parabola goes through, rad.
    """
    points, directions, ratios = [np.array(tip, dtype=float)], [], []
    tried = list(first)
    for _ in range(steps):

        def ratio(angle: float) -> float:
            ahead = points[-1] + step * np.array([np.cos(angle), np.sin(angle)])
            return release(np.vstack([*points, ahead])) / cost(angle)

        best = largest(ratio, tried, width)
        directions.append(best)
        ratios.append(ratio(best))
        points.append(points[-1] + step * np.array([np.cos(best), np.sin(best)]))
        tried = [best]
    return EnergyPath(np.array(points), np.array(directions), np.array(ratios))
