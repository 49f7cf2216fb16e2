"""A region's edges as closed rings of straight pieces: what its outline and its bonds agree on."""

from __future__ import annotations

import numpy as np
import shapely

from ..arrays import Array
from .regions import Region

# Distance of nodes on a region's edges, in spacings: see `solver.geometry.outline`.
EDGE_STEP = 2.5
# Vertices of a curve nearer to each other than this share of the step become one.
CLOSE = 0.3
# Turn (rad) that makes a corner: corners stay.
SHARP = 0.6


def rings(region: Region, spacing: float) -> list[list[Array]]:
    """Edges of a region, one list a connected body: its outer ring, then its holes.

    The body is to the left, the last point unlike the first. Curves lose the vertices that are too
    close to tell apart; corners do not, however near: a thin slot stays one.

    Parameters
    ----------
    region : Region
    spacing : float
        Of the lattice, m.

    Raises
    ------
    NoOutlineError
        If the region has no outline.
    """
    step = EDGE_STEP * spacing
    found = []
    for polygon in shapely.get_parts(region.outline(step)):
        if shapely.get_dimensions(polygon) != 2 or shapely.is_empty(polygon):
            continue
        turned = shapely.geometry.polygon.orient(polygon, 1.0)
        fine = [shapely.get_coordinates(r)[:-1] for r in (turned.exterior, *turned.interiors)]
        coarse = fine if region.settled else [thinned(ring, CLOSE * step) for ring in fine]
        # Two curves nearer to each other than their chords to them keep all their vertices.
        simple = shapely.Polygon(coarse[0], coarse[1:]).is_valid
        outer, *holes = (_begun(ring, step) for ring in (coarse if simple else fine))
        found.append([outer, *sorted(holes, key=lambda ring: _key(ring, step))])
    return sorted(found, key=lambda rings: _key(rings[0], step))


def _rounded(ring: Array, step: float) -> Array:
    return np.rint(ring / step * 1e5)


def _begun(ring: Array, step: float) -> Array:
    """The ring from its lowest vertex on: where it begins must not depend on rounding."""
    return np.roll(ring, -np.lexsort(_rounded(ring, step).T)[0], axis=0)


def _key(ring: Array, step: float) -> tuple[float, float]:
    x, y = _rounded(ring[:1], step)[0]
    return float(y), float(x)


def thinned(ring: Array, least: float) -> Array:
    """A closed ring without the vertices of a curve nearer than `least` to the one before."""
    ahead = np.roll(ring, -1, axis=0) - ring
    size = np.hypot(*ahead.T)
    if size.min() >= least:
        return ring
    behind = np.roll(ahead, 1, axis=0)
    cross = behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0]
    turn = np.abs(np.arctan2(cross, np.einsum("ki,ki->k", behind, ahead)))
    kept, since, turned = [], np.inf, 0.0
    for place in range(len(ring)):
        turned += turn[place]
        # The ends of straight edges stay: a level edge must not tilt.
        if since >= least or turned > SHARP or size[place] >= least:
            kept.append(place)
            since, turned = 0.0, 0.0
        since += size[place]
    close = size[kept[-1]] < least and np.hypot(*(ring[kept[-1]] - ring[kept[0]])) < least
    if len(kept) > 3 and close and turn[kept[-1]] <= SHARP:
        kept.pop()
    return ring[kept] if len(kept) > 2 else ring
