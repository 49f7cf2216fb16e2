"""A growing crack runs through the surface: edges part, and bonds that end there are cut.

Ended bonds have no strength of their own. They are cut by what the crack has opened: between two
neighbouring particles whose bond has broken lies a piece of the crack, the face that their cells
have in common. Pieces beside the surface go on to it. Where one meets an edge of the outline, the
edge is split (or its node doubled, if the crack runs through that), so that nothing on the outline
joins what the crack separates: as for cracks that were always there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from scipy.spatial import KDTree

from ..arrays import Array, Indices, Mask
from ..geometry import Lattice, Outline
from .bonds import Bonds
from .ended import EndedBonds

# Share of the spacing within which something touches a piece of crack.
_TOUCH = 1e-6
# Share of a bond at its end that does not count, so that ending beside a crack is no crossing.
_SHORT = 1e-3
# How far pieces beside the surface go on to it, in cells.
_ON = 1.5
# Least length of an edge that splitting makes, in cells: nearer to a node, that is doubled.
_LEAST = 0.1
# How far before its end a bond is asked on which side of the crack it is, in cells.
_BEFORE = 0.3
# Sine of the angle below which a piece runs along an edge and not through it.
_ALONG = 0.3


@dataclass(frozen=True)
class Pieces:
    """Straight pieces of crack, from `start` to `end`, both of shape (n, 2), m."""

    start: Array
    end: Array

    def __len__(self) -> int:
        return len(self.start)

    @classmethod
    def of(cls, bonds: Bonds, outline: Outline, offsets: Indices, origins: Indices) -> Pieces:
        """Faces that the cells of neighbours have in common whose bonds have broken.

        Led on to the surface where they lie beside it.

        Parameters
        ----------
        bonds : Bonds
            Of the sound body.
        outline : Outline
            As it is now.
        offsets, origins : ndarray of int, shape (n,)
            Half offset and particle of origin of each bond that has broken.
        """
        lattice, family = bonds.lattice, bonds.family
        step = family.offsets[offsets]
        near = np.abs(step).sum(axis=1) == 1
        step, origins = step[near], origins[near]
        h, points = lattice.spacing, lattice.points
        middle = points[origins] + 0.5 * h * step
        across = np.column_stack([-step[:, 1], step[:, 0]]).astype(np.float64)
        ends = []
        for side in (-1.0, 1.0):
            reach = np.full(len(origins), 0.5 * h)
            beside = _lacking(bonds, origins, step, side * across)
            if beside.any():
                bond = side * across[beside] * (_ON * h)
                hit, _, share = outline.first_hit(middle[beside], bond)
                far = np.where(hit >= 0, share * _ON * h, 0.0)
                reach[beside] = np.maximum(reach[beside], far)
            ends.append(middle + side * across * (reach * (1 + _TOUCH))[:, None])
        return cls(ends[0], ends[1])


def _lacking(bonds: Bonds, origins: Indices, step: Indices, across: Array) -> Mask:
    """Whether one of two neighbours lacks its own neighbour on one side."""
    lattice, family = bonds.lattice, bonds.family
    rows, columns = lattice.rows_columns
    aside = np.rint(across).astype(np.int64)
    index = {(int(dx), int(dy)): o for o, (dx, dy) in enumerate(family.offsets)}
    which = np.array([index[int(dx), int(dy)] for dx, dy in aside], dtype=np.int64)
    lacking = np.zeros(len(origins), dtype=bool)
    ends = lattice.number()[rows[origins] + step[:, 1], columns[origins] + step[:, 0]]
    for particles in (origins, ends):
        there = lattice.mask[rows[particles] + aside[:, 1], columns[particles] + aside[:, 0]]
        whole = bonds.strengths_of(particles)[which, np.arange(len(particles))] != 0
        lacking |= ~there | ~whole
    return lacking


def part(
    ended: EndedBonds, lattice: Lattice, pieces: Pieces, tips: Array
) -> tuple[EndedBonds, Indices] | None:
    """Ended bonds after new pieces of crack.

    Parameters
    ----------
    ended : EndedBonds
    lattice : Lattice
    pieces : Pieces
    tips : ndarray, shape (k, 2)
        Tips that the scene's cracks had: what grows on from one does not part its faces there.

    Returns
    -------
    (EndedBonds, ndarray of int) or None
        What is left, on an outline with more nodes and edges, and for each node of that outline
        the node that it was (−1 for a new one). None if nothing changes.
    """
    if not len(pieces):
        return None
    h = lattice.spacing
    lines = shapely.linestrings(np.stack([pieces.start, pieces.end], axis=1))
    tree = shapely.STRtree(lines)

    def crossed(start: Array, end: Array) -> Mask:
        paths = shapely.linestrings(np.stack([start, end + _SHORT * (start - end)], axis=1))
        hit = np.zeros(len(start), dtype=bool)
        hit[tree.query(paths, predicate="dwithin", distance=_TOUCH * h)[0]] = True
        return hit

    middle = 0.5 * (pieces.start + pieces.end)
    reach = float(ended.length.max()) + 2 * _ON * h
    distance, _ = KDTree(middle).query(lattice.points[ended.particle], distance_upper_bound=reach)
    near = np.nonzero(np.isfinite(distance))[0]
    kept = np.ones(len(ended), dtype=bool)
    kept[near] = ~crossed(
        lattice.points[ended.particle[near]], _on(ended.outline, ended.edge, ended.position)[near]
    )
    left = ended.kept(kept)
    chords = ended.chords
    if chords is not None and len(chords.offset):
        a, b = (_on(ended.outline, chords.edge[:, k], chords.position[:, k]) for k in (0, 1))
        whole = ~crossed(a, b)
        left = replace(left, chords=chords.kept(whole))
        kept = np.append(kept, whole)
    split = _splits(ended.outline, pieces, tree, tips, h)
    origin = np.arange(len(ended.outline.nodes))
    for edge, position, across in split:
        left, origin = _split(left, edge, position, across, origin, lattice)
    if not split and kept.all():
        return None
    # Chords between nodes at which no bond ends any more have gone with those.
    return left.between(left.chords), origin


def _on(outline: Outline, edge: Indices, position: Array) -> Array:
    first, last = outline.nodes[outline.edges[edge]].transpose(1, 0, 2)
    return np.asarray(first + position[:, None] * (last - first))


def _splits(
    outline: Outline, pieces: Pieces, tree: shapely.STRtree, tips: Array, h: float
) -> list[tuple[int, float, Array]]:
    """Edges that pieces run through, where and in which direction: one place on each edge."""
    ends = outline.nodes[outline.edges]
    edge, piece = tree.query(shapely.linestrings(ends), predicate="dwithin", distance=_TOUCH * h)
    a, along = ends[edge, 0], ends[edge, 1] - ends[edge, 0]
    start, across = pieces.start[piece], pieces.end[piece] - pieces.start[piece]
    cross = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
    sine = np.abs(cross) / (np.hypot(*along.T) * np.hypot(*across.T))
    through = sine > _ALONG
    if len(tips):
        own = (KDTree(tips).query(ends.reshape(-1, 2))[0] <= _TOUCH * h).reshape(-1, 2)
        through &= ~own.any(axis=1)[edge]
    found: list[tuple[int, float, Array]] = []
    away, length = start - a, outline.length
    for k in np.nonzero(through)[0]:
        where = (away[k, 0] * across[k, 1] - away[k, 1] * across[k, 0]) / cross[k]
        found.append((int(edge[k]), float(np.clip(where, 0.0, 1.0)), across[k]))
    # The last place on an edge first: what lies before it keeps the edge's number.
    found.sort(key=lambda item: (item[0], -item[1]))
    result: list[tuple[int, float, Array]] = []
    for item in found:
        last = result[-1] if result and result[-1][0] == item[0] else None
        if last is None or (last[1] - item[1]) * length[item[0]] > _LEAST * h:
            result.append(item)
    return [
        (number, where if k == 0 or result[k - 1][0] != number else where / result[k - 1][1], way)
        for k, (number, where, way) in enumerate(result)
    ]


def _split(
    ended: EndedBonds,
    edge: int,
    position: float,
    across: Array,
    origin: Indices,
    lattice: Lattice,
) -> tuple[EndedBonds, Indices]:
    """One edge in two with nodes of their own, or the node at one of its ends doubled."""
    outline, h = ended.outline, lattice.spacing
    a, b = outline.edges[edge]
    length = float(np.hypot(*(outline.nodes[b] - outline.nodes[a])))
    edges, face = outline.edges.copy(), outline.face
    count = len(outline.nodes)
    if min(position, 1 - position) * length < _LEAST * h:
        node = int(a if position < 0.5 else b)
        before, after = (np.nonzero(edges[:, side] == node)[0] for side in (1, 0))
        if len(before) != 1 or len(after) != 1:
            return ended, origin
        # The edge that starts there gets the copy.
        edges[after[0], 0] = count
        nodes = np.vstack([outline.nodes, outline.nodes[node]])
        joints = np.append(outline.joints, outline.joints[node])
        ended = replace(ended, outline=Outline(nodes, edges, face, outline.owned, joints))
        ended = _holding_on(ended, node, node, 0.0, 1)
        pair = int(before[0]), int(after[0])
        return _sided(ended, pair, across, lattice), np.append(origin, -1)
    place = (1 - position) * outline.nodes[a] + position * outline.nodes[b]
    nodes = np.vstack([outline.nodes, place, place])
    edges[edge] = a, count
    edges = np.vstack([edges, [count + 1, b]])
    owned = None if outline.owned is None else np.append(outline.owned, outline.owned[edge])
    joints = np.append(outline.joints, [False, False])
    more = Outline(nodes, edges, np.append(face, face[edge]), owned, joints)
    if ended.edge_factor is not None:
        both = np.vstack([ended.edge_factor, ended.edge_factor[edge]])
        ended = replace(ended, edge_factor=both)

    def moved(which: Indices, where: Array) -> tuple[Indices, Array]:
        mine, beyond = which == edge, (which == edge) & (where > position)
        where = np.where(mine & ~beyond, where / position, where)
        where = np.where(beyond, (where - position) / (1 - position), where)
        return np.where(beyond, len(more.edges) - 1, which), np.clip(where, 0.0, 1.0)

    new_edge, new_position = moved(ended.edge, ended.position)
    ended = replace(ended, outline=more, edge=new_edge, position=new_position)
    ended = _holding_on(ended, int(a), int(b), position, 2)
    if ended.chords is not None:
        new_edge, new_position = moved(ended.chords.edge, ended.chords.position)
        ended = replace(ended, chords=replace(ended.chords, edge=new_edge, position=new_position))
    pair = edge, len(more.edges) - 1
    return _sided(ended, pair, across, lattice), np.append(origin, [-1, -1])


def _holding_on(ended: EndedBonds, a: int, b: int, position: float, count: int) -> EndedBonds:
    """Prescribed nodes with `count` more between a and b: prescribed where both ends are."""
    if ended.held is None or ended.given is None:
        return ended
    held = (ended.held[:, a] & ended.held[:, b])[:, None].repeat(count, axis=1)
    given = (1 - position) * ended.given[:, a] + position * ended.given[:, b]
    given = given[:, None].repeat(count, axis=1)
    return ended.holding(
        np.hstack([ended.held, held]), np.hstack([ended.given, np.where(held, given, 0.0)])
    )


def _sided(ended: EndedBonds, pair: tuple[int, int], across: Array, lattice: Lattice) -> EndedBonds:
    """Bonds that end where the crack comes out belong to the side from which they come.

    `pair`: the edges before and after that point. A bond that ends just there is given to the
    right one; one that ends between that point and the node that was doubled in its stead goes.
    """
    outline, h = ended.outline, lattice.spacing
    before, after = pair
    place = outline.nodes[outline.edges[before, 1]]

    def side(points: Array) -> Mask:
        away = points - place
        return np.asarray(across[0] * away[:, 1] - across[1] * away[:, 0] > 0)

    size = outline.length[list(pair)]
    away = np.full(len(ended), np.inf)
    mine, other = ended.edge == before, ended.edge == after
    away[mine] = (1 - ended.position[mine]) * size[0]
    away[other] = ended.position[other] * size[1]
    here = np.nonzero(away <= _LEAST * h)[0]
    if not len(here):
        return ended
    # Seen from a little before its end, where the piece is the crack.
    end = _on(outline, ended.edge[here], ended.position[here])
    back = lattice.points[ended.particle[here]] - end
    back *= np.minimum(1.0, _BEFORE * h / np.maximum(np.hypot(*back.T), 1e-300))[:, None]
    first = side(outline.nodes[outline.edges[before, :1]])[0]
    wanted = np.where(side(end + back) == first, before, after)
    wrong = wanted != ended.edge[here]
    at = away[here] <= _TOUCH * h
    moved, gone = here[wrong & at], here[wrong & ~at]
    edge, position = ended.edge.copy(), ended.position.copy()
    edge[moved] = wanted[wrong & at]
    position[moved] = np.where(edge[moved] == before, 1.0, 0.0)
    ended = replace(ended, edge=edge, position=position)
    return ended.kept(~np.isin(np.arange(len(ended)), gone)) if len(gone) else ended
