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
from ..geometry.outline import INNER
from ..material.physics import Physics
from .constraints import Constraints

# A motion counts as blocked if its square on the prescribed unknowns exceeds this share of the
# largest one's.
_RANK = 1e-12
_ROUNDING = 1e-14


def parts(bonds: Bonds) -> tuple[int, NDArray[np.int32]]:
    """Number of connected parts and the part of every particle, shape (N,)."""
    lattice = bonds.lattice
    if _plainly_one(bonds):
        return 1, np.zeros(lattice.count, dtype=np.int32)
    numbers = lattice.number()
    rows, columns = lattice.rows_columns
    family = bonds.family
    # Nearest bonds first: they connect nearly everything, and most bodies need no more.
    order = np.argsort(family.length[: family.size // 2], kind="stable")
    starts: list[NDArray[np.int64]] = []
    ends: list[NDArray[np.int64]] = []
    total = lattice.count
    if bonds.phases is not None and bonds.ended is not None:
        # Phases are joined by the nodes of their interfaces.
        ended = bonds.ended
        inner = ended.outline.face[ended.edge] == INNER
        nodes = ended.outline.standing_for(ended.outline.edges[ended.edge[inner]])
        starts.append(np.repeat(ended.particle[inner], 2))
        ends.append(lattice.count + nodes.ravel())
        total += len(ended.outline.nodes)
    count, labels = lattice.count, np.zeros(lattice.count, dtype=np.int32)
    for position, o in enumerate(order):
        dx, dy = family.offsets[o]
        here = np.nonzero(bonds.strength(int(o)) != 0)[0]
        starts.append(here)
        ends.append(numbers[rows[here] + dy, columns[here] + dx])
        if position in (3, len(order) - 1):
            i, j = np.concatenate(starts), np.concatenate(ends)
            graph = sparse.coo_array((np.ones(len(i), dtype=np.int8), (i, j)), shape=(total, total))
            count, labels = connected_components(graph, directed=False)
            if total > lattice.count:
                # Nodes of no bond count for nothing.
                _, numbered = np.unique(labels[: lattice.count], return_inverse=True)
                labels = numbered.astype(np.int32)
                count = int(labels.max()) + 1
            if count == 1:
                break
    return count, labels


def _plainly_one(bonds: Bonds) -> bool:
    """Whether bonds to the nearest neighbours alone join all particles."""
    lattice, family, special = bonds.lattice, bonds.family, bonds.special
    sound = lattice.mask
    if len(special) and bonds.strengths.min() <= 0:
        sound = sound.copy()
        sound[tuple(axis[special] for axis in lattice.rows_columns)] = False
    else:
        special = special[:0]
    # Neighbours that the family joins directly; more bonds can only join more.
    near = np.nonzero(np.abs(family.offsets).max(axis=1) == 1)[0]
    nearest = np.zeros((3, 3))
    nearest[1, 1] = 1
    nearest[tuple(1 + family.offsets[near, ::-1].T)] = 1
    number, count = ndimage.label(sound, structure=nearest)
    if count != 1 or not len(special):
        return bool(count == 1)
    # Particles with bonds of their own one by one, the others as one.
    place = np.where(number > 0, len(special), -1)
    rows, columns = (axis[special] for axis in lattice.rows_columns)
    place[rows, columns] = np.arange(len(special))
    dx, dy = family.offsets[near].T[:, :, None]
    bond, start = np.nonzero(bonds.strengths[near] != 0)
    end = place[(rows + dy)[bond, start], (columns + dx)[bond, start]]
    graph = sparse.coo_array(
        (np.ones(len(start), np.int8), (start, end)), shape=(len(special) + 1,) * 2
    )
    return bool(connected_components(graph, directed=False)[0] == 1)


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
    nodes, at = _held_nodes(bonds, labels)
    slaves = np.zeros_like(prescribed) if constraints is None else constraints.slaves
    own = labels
    if constraints is not None:
        labels = constraints.joined(labels)
    # Parts that are wholly prescribed (or already set aside) have no unknowns to be free.
    active = ~(prescribed & ~slaves).all(axis=0)
    found: list[tuple[Mask, str]] = []
    for part in np.unique(labels[active]):
        members = labels == part
        where = points[members].mean(axis=0)
        x, y = where + bonds.lattice.shift
        place = "the body" if count == 1 else f"the part about ({x:.4g}, {y:.4g})"
        if constraints is None or not slaves[:, members].any():
            positions, held = points[members] - where, prescribed[:, members]
            if (at == part).any():
                there = _outline_nodes(bonds)[at == part] - where
                positions = np.concatenate([positions, there])
                held = np.concatenate([held, nodes[:, at == part]], axis=1)
            motions = free_motions(positions, held, physics)
        else:
            there = at == part if constraints is None else np.isin(at, own[members])
            motions = _constrained_motions(
                bonds, members, prescribed, physics, constraints, nodes * there
            )
        if motions:
            size = f"{place} ({int(members.sum())} particles)"
            found.append((members, physics.unheld.format(place=size, motions=motions)))
    return found


def _outline_nodes(bonds: Bonds) -> Array:
    """Nodes of the outline at which bonds end, shape (n, 2), m; none without such bonds."""
    return np.zeros((0, 2)) if bonds.ended is None else bonds.ended.outline.nodes


def _held_nodes(bonds: Bonds, labels: NDArray[np.int32]) -> tuple[Mask, NDArray[np.int64]]:
    """Prescribed components of the outline's nodes, (components, n), and each node's part.

    Nodes that no bond ends at belong to no part, −1.
    """
    ended = bonds.ended
    if ended is None or ended.held is None:
        return np.zeros((1, 0), dtype=bool), np.zeros(0, dtype=np.int64)
    at = np.full(len(ended.outline.nodes), -1, dtype=np.int64)
    for end in ended.outline.edges[ended.edge].T:
        at[end] = labels[ended.particle]
    return ended.held, at


def rigid_motions(bonds: Bonds, prescribed: Mask, physics: Physics) -> Array:
    """Motions without strain that no support blocks, of every part.

    Parameters
    ----------
    bonds : Bonds
    prescribed : ndarray of bool, shape (components, N)
    physics : Physics

    Returns
    -------
    ndarray, shape (r, components, N)
        Of size one (rotations times the spacing), zero where prescribed.
    """
    count, labels = parts(bonds)
    lattice, components = bonds.lattice, len(prescribed)
    nodes, at = _held_nodes(bonds, labels)
    found = []
    for part in range(count):
        members = labels == part
        if prescribed[:, members].all():
            continue
        centre = lattice.points[members].mean(axis=0)
        positions = lattice.points[members] - centre
        size = np.abs(positions).max(initial=0.0) or lattice.spacing
        scales = physics.scales(lattice.spacing / size, components)[:, None]
        own = physics.motions(positions / size)[:, :components] * scales
        # A point without a rotation that turns does not move.
        moving = own.any(axis=(1, 2))
        own = own[moving]
        seen = own[:, prescribed[:, members]]
        if (at == part).any():
            places = (_outline_nodes(bonds)[at == part] - centre) / size
            there = physics.motions(places)[moving, :components] * scales
            seen = np.concatenate([seen, there[:, nodes[:, at == part]]], axis=1)
        squares, mixes = np.linalg.eigh(np.einsum("ai,bi->ab", seen, seen))
        for mix in mixes[:, squares <= _RANK * max(squares.max(), len(positions))].T:
            motion = np.zeros((components, lattice.count))
            motion[:, members] = np.einsum("a,aci->ci", mix, own)
            motion[prescribed] = 0.0
            found.append(motion)
    return np.array(found).reshape(-1, components, lattice.count)


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
    size = np.linalg.norm(motions.reshape(len(motions), -1), axis=1)
    return _names(motions[:, held], size, physics)


def _names(seen: Array, size: Array, physics: Physics) -> str:
    """Names of the motions that leave nothing at what is held, `seen` (motions, held).

    `size` is the norm of each. One that moves nothing, as a point without a rotation that turns,
    is none.
    """
    moving = size > 0.0
    seen = seen[moving] / size[moving, None]
    names = [name for name, moves in zip(physics.motion_names, moving, strict=True) if moves]
    squares, modes = np.linalg.eigh(np.einsum("ai,bi->ab", seen, seen))
    # Motions have the norm 1: what projections leave of nothing is rounding.
    free = squares <= _RANK * max(squares.max(), _ROUNDING)
    loose = np.abs(modes[:, free]).max(axis=1, initial=0.0)
    return ", ".join(n for n, s in zip(names, loose, strict=True) if s > 1e-3)


def _constrained_motions(
    bonds: Bonds,
    members: Mask,
    prescribed: Mask,
    physics: Physics,
    constraints: Constraints,
    nodes: Mask,
) -> str:
    """As `free_motions`, of a part with particles whose unknowns follow from others.

    `nodes` are the prescribed components of the outline's nodes of this part, (components, n).
    """
    lattice, components = bonds.lattice, len(prescribed)
    where = lattice.points[members].mean(axis=0)
    motions = physics.motions(lattice.points - where)[:, :components]
    motions = motions * physics.scales(lattice.spacing, components)[:, None]
    motions[:, :, ~members] = 0.0
    size = np.linalg.norm(motions.reshape(len(motions), -1), axis=1)
    left = constraints.held(motions)
    free = prescribed & ~constraints.slaves
    seen = np.where(free, motions, left)[:, prescribed]
    if nodes.any():
        there = physics.motions(_outline_nodes(bonds) - where)[:, :components]
        there = there * physics.scales(lattice.spacing, components)[:, None]
        seen = np.concatenate([seen, there[:, nodes]], axis=1)
    return _names(seen, size, physics)
