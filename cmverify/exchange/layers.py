"""From a slab of layers to a plane: the mean over its thickness, refused where layers disagree.

Other programs solve plane problems in slabs: layers of particles or nodes above each other. What is
judged is the mean over them, place by place. If it is a plane problem, all layers say the same; by
how much they differ is told, and more than 1 % of the largest value is no plane problem's answer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from cmverify.exchange.statement import Array

#: Of the extent: what counts as one place.
SAME = 1e-6
#: Of the largest value: how far layers may be from their mean.
APART = 0.01


class LayerError(ValueError):
    """Points in space that are no layers of a slab, or values that differ over its thickness."""


@dataclass(frozen=True)
class Layers:
    """Points above each other.

    Attributes
    ----------
    points : (P, 2) array
        In the plane, in the order of the lowest layer.
    members : (L, P) int array
        Which of all points stand there, by layers.
    """

    points: Array
    members: NDArray[np.int64]

    @property
    def place(self) -> NDArray[np.int64]:
        """Number of the place in the plane of each of all points, (N,)."""
        found = np.empty(self.members.size, dtype=np.int64)
        found[self.members] = np.arange(len(self.points))
        return found

    def mean(self, values: Array) -> tuple[Array, float]:
        """Values (N, ...) as means (P, ...), and how far a layer is from them at most.

        The second is a share of the largest value, 0 where all vanish.
        """
        each = values[self.members]
        mean = each.mean(axis=0)
        largest = np.abs(values).max(initial=0.0)
        off = np.abs(each - mean).max(initial=0.0)
        return mean, float(off / largest) if largest > 0 else 0.0


def layers_of(points: Array) -> Layers | None:
    """The layers of points in space, (N, 3); None if they lie in a plane of one height.

    Raises
    ------
    LayerError
        If the points of different heights do not stand above each other, or two are at one place.
    """
    height = points[:, 2]
    tolerance = SAME * max(float(np.ptp(points[:, :2], axis=0).max()), float(np.ptp(height)))
    if np.ptp(height) <= tolerance:
        return None
    order = np.argsort(height, kind="stable")
    cuts = np.flatnonzero(np.diff(height[order]) > tolerance) + 1
    parts = [np.sort(part) for part in np.split(order, cuts)]
    if any(len(part) != len(parts[0]) for part in parts):
        raise LayerError(
            f"its points have {len(parts)} heights z and do not stand above each other: give "
            f"those of one plane"
        )
    base = points[parts[0], :2]
    members = np.empty((len(parts), len(base)), dtype=np.int64)
    tree = KDTree(base)
    for row, part in zip(members, parts, strict=True):
        distance, place = tree.query(points[part, :2])
        if distance.max() > tolerance or len(np.unique(place)) != len(base):
            raise LayerError(
                f"the points of its {len(parts)} layers z do not stand above each other, one at a "
                f"place: give those of one plane"
            )
        row[place] = part
    return Layers(base, members)
