"""Concentrated loads: which particles, or nodes of the surface, carry what acts at a point.

A force at a point is shared out among the particles around it that see it (no edge and no crack
lies between), so that its resultant and its moment are exact: of all shares that do so those are
taken that are smallest when weighed by the square of the distance, twice. At a particle it is that
particle's alone, in the middle of four a quarter each; beyond the last row shares go on linearly.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from scipy.spatial import KDTree

from ..arrays import Array, Indices, Mask
from ..errors import NoOutlineError, SceneError
from .crack import Crack
from .crack_set import CrackSet
from .exact import CELL, Frame
from .inside import Body
from .lattice import Lattice
from .outline import Outline

# Cells within which particles carry a point, and those tried where too few see it.
_REACH, _FURTHER = 1.6, 3.0
# In a cusp, where particles may lie in a row.
_FURTHEST = 8.0
# Cells by which a point may lie off the body, or off the edge that it is meant for: chords of
# curved edges do.
_OFF = 0.1
# Cells within which an edge has a particle beside it.
_BESIDE = 1.25
# Distance (cells) that no longer counts: a point so near is at the particle.
_AT = 1e-3


def on_edges(outline: Outline, points: Array, spacing: float) -> tuple[Indices, Array]:
    """The region's edge that each point lies on, −1 for none, and where on it (0 to 1)."""
    own = np.nonzero(outline.face == 0)[0]
    ends = outline.nodes[outline.edges[own]]
    tree = shapely.STRtree(shapely.linestrings(ends))
    # With several at the same distance (a corner) the first one.
    found, distance = tree.query_nearest(
        shapely.points(points), return_distance=True, all_matches=True
    )
    edge = np.full(len(points), -1)
    for place, near, away in zip(found[0][::-1], found[1][::-1], distance[::-1], strict=True):
        edge[place] = own[near] if away <= _OFF * spacing else -1
    start, end = (outline.nodes[outline.edges[edge, k]] for k in (0, 1))
    along = end - start
    position = np.einsum("ki,ki->k", points - start, along) / np.einsum("ki,ki->k", along, along)
    return edge, np.clip(position, 0.0, 1.0)


def on_particles(
    lattice: Lattice, cracks: Sequence[Crack], points: Array
) -> tuple[Indices, Indices, Array]:
    """Shares of particles in what acts at points, all in the lattice's coordinates.

    Returns
    -------
    point, particle : ndarray of int, shape (n,)
    share : ndarray, shape (n,)
        Of each point they add up to 1, and their first moment is the point's.

    Raises
    ------
    SceneError
        If no particle sees a point.
    """
    spacing = lattice.spacing
    tree = KDTree(lattice.points)
    seen = _Sight(lattice, cracks)
    found: list[tuple[int, Indices, Array]] = []
    for place, point in enumerate(points):
        for reach in (_REACH, _FURTHER):
            near = np.array(sorted(tree.query_ball_point(point, reach * spacing)), dtype=np.int64)
            near = near[seen(point, lattice.points[near])]
            away = (lattice.points[near] - point) / spacing
            if _spans(away):
                break
        if not len(near):
            x, y = point + lattice.shift
            raise SceneError(
                f"a load acts at ({x:.6g}, {y:.6g}), where no particle sees it: outside of the "
                f"body, or on a crack (say which face by a place beside it)"
            )
        found.append((place, near, _shares(away)))
    return _listed(found)


def on_nearest(tree: KDTree, points: Array, spacing: float) -> tuple[Indices, Indices, Array]:
    """As `on_particles`, of points on edges: the nearest particle alone, if one is near.

    In a cusp none is: those about the nearest one then carry the moment, too.

    Parameters
    ----------
    tree : KDTree
        Of the particles that may carry something; `particle` counts in it.
    points : ndarray, shape (n, 2), m
    spacing : float
    """
    distance, nearest = tree.query(points)
    found: list[tuple[int, Indices, Array]] = []
    for place in np.nonzero(distance > _BESIDE * spacing)[0]:
        for reach in (_REACH, _FURTHER, _FURTHEST):
            about = tree.query_ball_point(tree.data[nearest[place]], reach * spacing)
            near = np.array(sorted(about), dtype=np.int64)
            away = (tree.data[near] - points[place]) / spacing
            if _spans(away):
                break
        found.append((int(place), near, _shares(away)))
    beside = np.nonzero(distance <= _BESIDE * spacing)[0]
    alone = beside, nearest[beside], np.ones(len(beside))
    if not found:
        return alone
    point, particle, share = (
        np.concatenate(pair) for pair in zip(alone, _listed(found), strict=True)
    )
    return point, particle, share


def _spans(away: Array) -> bool:
    """Whether places, (n, 2) in cells, do not all lie in a row."""
    return len(away) > 2 and np.linalg.matrix_rank(np.c_[np.ones(len(away)), away], 1e-6) == 3


def _shares(away: Array) -> Array:
    """Shares of particles at places, (n, 2), cells, from a point; see above."""
    moments = np.vstack([np.ones(len(away)), away.T])
    size = 1.0 / ((away**2).sum(axis=1) + _AT**2)
    # Few particles in a row have no moment across it: then the least squares of it.
    root = moments * size
    share = size * (np.linalg.pinv(root, rcond=1e-12) @ np.array([1.0, 0.0, 0.0]))
    return np.asarray(share / share.sum())


def _listed(found: list[tuple[int, Indices, Array]]) -> tuple[Indices, Indices, Array]:
    """Points, particles and shares of all of them one after the other."""
    point = np.concatenate([np.full(len(near), place) for place, near, _ in found])
    particle, share = (np.concatenate([item[k] for item in found]) for k in (1, 2))
    return point, particle, share


class _Sight:
    """Which particles see a point: neither an edge of the body nor a crack lies between.

    As for bonds: whatever parts those parts the particles that carry a load.
    """

    def __init__(self, lattice: Lattice, cracks: Sequence[Crack]) -> None:
        self.frame = Frame.of(lattice)
        self.body: Body | None
        try:
            self.body = Body.of(lattice)
            self.edges = self.body.critical(_FURTHER)
        except NoOutlineError:
            self.body = None
        self.cracks = CrackSet.joined(self.frame, cracks, self.body)

    def __call__(self, point: Array, particles: Array) -> Mask:
        start, ends = self.frame.units(point[None])[0], self.frame.units(particles)
        seen = ~self.cracks.between(start, ends)
        if self.body is None:
            return np.asarray(seen)
        within = self.body.drawn_in(start[None])[0]
        if np.hypot(*(within - start)) > _OFF * CELL:
            return np.zeros(len(particles), dtype=bool)
        return np.asarray(
            seen & ~self.body.left_between(within, self.body.drawn_in(ends), self.edges)
        )
