"""Modes of two computations that belong together, by their shapes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import linear_sum_assignment

if TYPE_CHECKING:
    from solver.arrays import Array, Mask

#: Frequencies that are nearer than this to each other (relative) are one group: their shapes may be
#: any mixture, whatever computes them.
_GROUP = 0.02
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
    group = np.concatenate([[0], np.cumsum(np.diff(frequencies) > _GROUP * frequencies[1:])])
    together = np.stack([near[:, group == g].sum(axis=1) for g in range(group[-1] + 1)], axis=1)
    # Within a group any assignment is as good; the frequency decides.
    distance = np.abs(np.log(own[:, None] / frequencies))
    gain = together[:, group] - 1e-3 * np.minimum(distance, 1.0)
    mine, theirs = linear_sum_assignment(-gain)
    found = np.full(len(own), np.nan)
    share, mixed = np.zeros(len(own)), np.full(shapes.shape, np.nan)
    for k, j in zip(mine, theirs, strict=True):
        share[k] = together[k, group[j]]
        if share[k] < _ALIKE:
            continue
        found[k] = frequencies[j]
        members = np.flatnonzero(group == group[j])
        basis = np.linalg.qr(b[members].T)[0]
        part = basis @ (basis.T @ a[k])
        part *= size[k] / np.linalg.norm(part)
        with np.errstate(divide="ignore", invalid="ignore"):
            mixed[k] = np.where(root > 0, part.reshape(-1, 2) / root, 0.0)
    return Paired(found, mixed, np.minimum(share, 1.0), share >= _ALIKE)
