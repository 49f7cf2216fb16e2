"""Computed modes beside reference modes: paired by shape, never by rank.

Modes of nearly the same frequency cross on coarse lattices, and the two of a double frequency are
any two of their plane. So reference modes of one frequency are taken together, and go with the
computed modes that lie in their space most (modal assurance criterion of subspaces).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cmverify.case import Array

# Relative distance below which reference frequencies count as one.
_SAME = 3e-4


@dataclass(frozen=True)
class Pairing:
    """Reference modes with the computed ones that belong to them.

    Attributes
    ----------
    errors : (count,) array
        Relative errors of the frequencies, sign kept, in the reference's order.
    mac : (count,) array
        1 for the same shape, 0 for an orthogonal one; of a multiple mode the least of its plane.
    order : (count,) array of int
        Rank of the computed mode of each reference mode, from 0.
    aligned : (count, N, 2) array
        Computed shapes, turned within multiple modes to meet the reference's.
    """

    errors: Array
    mac: Array
    order: np.ndarray
    aligned: Array


def clusters(frequencies: Array, same: float = _SAME) -> list[np.ndarray]:
    """Indices of ascending frequencies in groups of one value."""
    gaps = np.diff(frequencies) > same * frequencies[1:]
    return np.split(np.arange(len(frequencies)), np.nonzero(gaps)[0] + 1)


def pair(
    frequencies: Array, shapes: Array, mass: Array, reference: Array, expected: Array
) -> Pairing:
    """Pair computed with reference modes.

    Parameters
    ----------
    frequencies, shapes : (k,) and (k, N, 2) arrays
        Computed; some more than the reference's.
    mass : (N,) array
        Weights of the points.
    reference, expected : (count,) and (count, N, 2) arrays
        Reference modes; the last cluster must be whole.
    """
    size = np.sqrt(np.einsum("knd,n->k", expected**2, mass))
    own = np.sqrt(np.einsum("knd,n->k", shapes**2, mass))
    overlap = np.einsum("knd,lnd,n->kl", shapes, expected, mass) / np.outer(own, size)
    count = len(reference)
    errors, mac = np.empty(count), np.empty(count)
    order = np.empty(count, dtype=np.int64)
    aligned = np.empty(expected.shape)
    taken = np.zeros(len(frequencies), dtype=bool)
    for group in clusters(reference):
        share = np.where(taken, -1.0, (overlap[:, group] ** 2).sum(axis=1))
        chosen = np.sort(np.argsort(-share, kind="stable")[: len(group)])
        taken[chosen] = True
        block = overlap[np.ix_(chosen, group)]
        order[group] = chosen
        errors[group] = frequencies[chosen] / reference[group] - 1
        # Cosines of the angles between the two spaces.
        mac[group] = np.linalg.svd(block, compute_uv=False).min() ** 2
        turned = np.einsum("kl,knd->lnd", block, shapes[chosen])
        aligned[group] = size[group][:, None, None] * turned
    return Pairing(errors, mac, order, aligned)
