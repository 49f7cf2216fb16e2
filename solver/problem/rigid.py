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
from ..material.physics import Physics
from .constraints import Constraints

# A motion counts as blocked if its square on the prescribed unknowns exceeds this share of the
# largest one's.
_RANK = 1e-12
_ROUNDING = 1e-14


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


def unheld(
    bonds: Bonds, prescribed: Mask, physics: Physics, constraints: Constraints | None = None
) -> list[tuple[Mask, str]]:
    """Parts that can move without straining a bond: rigidly, or floating at any level.

    Parameters
    ----------
    bonds : Bonds
    prescribed : ndarray of bool, shape (components, N)
    physics : Physics
    constraints : Constraints, optional
        Its slaves are among the prescribed; they hold what the masters cannot follow.

    Returns
    -------
    list of (members, shape (N,); sentence that names the free motions and where the part is)
    """
    count, labels = parts(bonds)
    points = bonds.lattice.points
    slaves = np.zeros_like(prescribed) if constraints is None else constraints.slaves
    if constraints is not None:
        labels = constraints.joined(labels)
    # Parts that are wholly prescribed (or already set aside) have no unknowns to be free.
    active = ~(prescribed & ~slaves).all(axis=0)
    found: list[tuple[Mask, str]] = []
    for part in np.unique(labels[active]):
        members = labels == part
        where = points[members].mean(axis=0)
        place = "the body" if count == 1 else f"the part about ({where[0]:.4g}, {where[1]:.4g})"
        if constraints is None or not slaves[:, members].any():
            motions = free_motions(points[members] - where, prescribed[:, members], physics)
        else:
            motions = _constrained_motions(bonds, members, prescribed, physics, constraints)
        if motions:
            size = f"{place} ({int(members.sum())} particles)"
            found.append((members, physics.unheld.format(place=size, motions=motions)))
    return found


def free_motions(positions: Array, held: Mask, physics: Physics) -> str:
    """Names of the motions without strain that the prescribed unknowns allow; empty if none.

    Parameters
    ----------
    positions : ndarray, shape (n, 2)
    held : ndarray of bool, shape (components, n)
    physics : Physics
    """
    size = np.abs(positions).max(initial=0.0) or 1.0
    motions = physics.motions(positions / size)[:, : len(held)]
    motions /= np.linalg.norm(motions.reshape(len(motions), -1), axis=1)[:, None, None]
    return _names(motions[:, held], physics)


def _names(seen: Array, physics: Physics) -> str:
    """Names of the motions that leave nothing at what is held, `seen` (motions, held)."""
    squares, modes = np.linalg.eigh(np.einsum("ai,bi->ab", seen, seen))
    # Motions have the norm 1: what projections leave of nothing is rounding.
    free = squares <= _RANK * max(squares.max(), _ROUNDING)
    loose = np.abs(modes[:, free]).max(axis=1, initial=0.0)
    return ", ".join(n for n, s in zip(physics.motion_names, loose, strict=True) if s > 1e-3)


def _constrained_motions(
    bonds: Bonds, members: Mask, prescribed: Mask, physics: Physics, constraints: Constraints
) -> str:
    """As `free_motions`, of a part with particles whose unknowns follow from others."""
    lattice, components = bonds.lattice, len(prescribed)
    where = lattice.points[members].mean(axis=0)
    motions = physics.motions(lattice.points - where)[:, :components]
    motions = motions * physics.scales(lattice.spacing, components)[:, None]
    motions[:, :, ~members] = 0.0
    motions /= np.linalg.norm(motions.reshape(len(motions), -1), axis=1)[:, None, None]
    left = constraints.held(motions)
    free = prescribed & ~constraints.slaves
    seen = np.where(free, motions, left)[:, prescribed]
    return _names(seen, physics)
