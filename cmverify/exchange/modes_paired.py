"""Modes of two computations that belong together, by their shapes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import linear_sum_assignment

if TYPE_CHECKING:
    from solver.arrays import Array, Mask

#: Frequencies that lie no farther than this from one (relative) are its group: their shapes may be
#: any mixture, whatever computes them. Farther ones are told apart, however many lie in between.
_GROUP = 0.01
#: A shape of which this share lies in another computation's group is the same one.
_ALIKE = 0.7


@dataclass(frozen=True, eq=False)
class Paired:
    """Another computation's modes, one for each of ours.

    Attributes
    ----------
    frequencies : (count,) array, rad/s
        NaN where none is alike.
    shapes : (count, N, 2) array
        Of the size and sign of ours; of a group, the mixture that is nearest to ours.
    share : (count,) array
        Of our shape that the other's group explains: the modal assurance criterion, summed.
    alike : (count,) bool array
    """

    frequencies: Array
    shapes: Array
    share: Array
    alike: Mask


def paired(own: Array, shapes: Array, frequencies: Array, others: Array, weight: Array) -> Paired:
    """Pair modes so that shapes agree best over all.

    Parameters
    ----------
    own : (count,) array
        Our frequencies, ascending.
    shapes : (count, N, 2) array
    frequencies : (more,) array
        The other's, ascending; some more than ours, so that groups at the end are whole.
    others : (more, N, 2) array
    weight : (N,) array
        Of the points, such as their masses.

    Returns
    -------
    Paired
    """
    root = np.sqrt(weight)[:, None]
    a = (shapes * root).reshape(len(shapes), -1)
    b = (others * root).reshape(len(others), -1)
    size = np.linalg.norm(a, axis=1)
    a = a / size[:, None]
    b = b / np.linalg.norm(b, axis=1)[:, None]
    near = (a @ b.T) ** 2
    group = np.abs(frequencies[:, None] - frequencies) <= _GROUP * frequencies[:, None]
    together = near @ group.T
    # Within a group any assignment is as good; the frequency decides.
    distance = np.abs(np.log(own[:, None] / frequencies))
    gain = together - 1e-3 * np.minimum(distance, 1.0)
    mine, theirs = linear_sum_assignment(-gain)
    found = np.full(len(own), np.nan)
    share, mixed = np.zeros(len(own)), np.full(shapes.shape, np.nan)
    for k, j in zip(mine, theirs, strict=True):
        share[k] = together[k, j]
        if share[k] < _ALIKE:
            continue
        found[k] = frequencies[j]
        basis = np.linalg.qr(b[group[j]].T)[0]
        part = basis @ (basis.T @ a[k])
        part *= size[k] / np.linalg.norm(part)
        with np.errstate(divide="ignore", invalid="ignore"):
            mixed[k] = np.where(root > 0, part.reshape(-1, 2) / root, 0.0)
    return Paired(found, mixed, np.minimum(share, 1.0), share >= _ALIKE)
