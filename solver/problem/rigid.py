"""Is every part of the body held? A rigid mode left free makes statics singular.

Parts are connected by bonds that carry something. Each must have its rigid motions (two
translations and a rotation; in conduction one constant) blocked by prescribed unknowns.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse
from scipy.sparse.csgraph import connected_components

from ..arrays import Array, Mask
from ..bonds import Bonds

# A motion counts as blocked if its square on the prescribed unknowns exceeds this share of the
# largest one's.
_RANK = 1e-12


def parts(bonds: Bonds) -> tuple[int, NDArray[np.int32]]:
    """Number of connected parts and the part of every particle, shape (N,)."""
    lattice = bonds.lattice
    if not len(bonds.special) or bonds.strengths.min() > 0:
        # Neighbours that the family joins directly; more bonds can only join more.
        nearest = np.zeros((3, 3))
        nearest[1, 1] = 1
        for dx, dy in bonds.family.offsets:
            if max(abs(dx), abs(dy)) == 1:
                nearest[1 + dy, 1 + dx] = 1
        _, count = ndimage.label(lattice.mask, structure=nearest)
        if count == 1:
            return 1, np.zeros(lattice.count, dtype=np.int32)
    numbers = lattice.number()
    rows, columns = lattice.rows_columns
    family = bonds.family
    # Nearest bonds first: they connect nearly everything, and most bodies need no more.
    order = np.argsort(family.length[: family.size // 2], kind="stable")
    starts: list[NDArray[np.int64]] = []
    ends: list[NDArray[np.int64]] = []
    count, labels = lattice.count, np.zeros(lattice.count, dtype=np.int32)
    for position, o in enumerate(order):
        dx, dy = family.offsets[o]
        here = np.nonzero(bonds.strength(int(o)) != 0)[0]
        starts.append(here)
        ends.append(numbers[rows[here] + dy, columns[here] + dx])
        if position in (3, len(order) - 1):
            i, j = np.concatenate(starts), np.concatenate(ends)
            graph = sparse.coo_array(
                (np.ones(len(i), dtype=np.int8), (i, j)), shape=(lattice.count, lattice.count)
            )
            count, labels = connected_components(graph, directed=False)
            if count == 1:
                break
    return count, labels


def unheld(bonds: Bonds, prescribed: Mask, elastic: bool) -> list[tuple[Mask, str]]:
    """Parts that can move rigidly (or float at any temperature).

    Parameters
    ----------
    bonds : Bonds
    prescribed : ndarray of bool, shape (components, N)
    elastic : bool

    Returns
    -------
    list of (members, shape (N,); sentence that names the free motions and where the part is)
    """
    count, labels = parts(bonds)
    points = bonds.lattice.points
    # Parts that are wholly prescribed (or already set aside) have no unknowns to be free.
    active = ~prescribed.all(axis=0)
    found: list[tuple[Mask, str]] = []
    for part in np.unique(labels[active]):
        members = labels == part
        held = prescribed[:, members]
        where = points[members].mean(axis=0)
        place = "the body" if count == 1 else f"the part about ({where[0]:.4g}, {where[1]:.4g})"
        size = f"{int(members.sum())} particles"
        if not elastic:
            if not held.any():
                found.append(
                    (
                        members,
                        f"no temperature is prescribed on {place} ({size}): its level is "
                        f"undetermined",
                    )
                )
            continue
        loose = _free_motions(points[members] - where, held)
        if loose:
            found.append(
                (
                    members,
                    f"a rigid motion of {place} ({size}) is left free ({loose}): statics "
                    f"has no unique solution",
                )
            )
    return found


def _free_motions(positions: Array, held: Mask) -> str:
    """Names of the rigid motions that the prescribed unknowns `held` (components, n) allow."""
    size = np.abs(positions).max(initial=0.0) or 1.0
    x, y = (positions / size).T
    motions = np.zeros((3, *held.shape))
    motions[0, 0] = motions[1, 1] = 1.0
    motions[2, 0], motions[2, 1] = -y, x
    if held.shape[0] == 3:
        motions[2, 2] = 1.0
    motions /= np.linalg.norm(motions.reshape(3, -1), axis=1)[:, None, None]
    seen = motions[:, held]
    squares, modes = np.linalg.eigh(np.einsum("ai,bi->ab", seen, seen))
    free = squares <= _RANK * max(squares.max(), 1e-300)
    loose = np.abs(modes[:, free]).max(axis=1, initial=0.0)
    names = ("translation along 1", "translation along 2", "rotation")
    return ", ".join(n for n, s in zip(names, loose, strict=True) if s > 1e-3)
