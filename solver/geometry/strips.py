"""What each particle carries of its body: its own cell, and its part of the strip at the edge.

Particles are cells, bodies are not: an edge cuts some cells that have a particle, and others that
have none. Everything that acts per area (body forces, sources, mass) counts the body, not its
cells. So every piece of a cell goes to the particle of that cell, if the piece holds its centre,
else to the nearest particle that sees it: to the nearest ones in equal parts where several are
equally near, so that mirror images stay alike. The sum is the area of the body exactly; what a
strip carries acts at most a cell from where it lies, an error of second order in the spacing,
where leaving the strip out is one of first order.
"""

from __future__ import annotations

import numpy as np
import shapely
from scipy.ndimage import binary_dilation
from scipy.spatial import KDTree

from ..arrays import Array, Mask
from ..errors import SceneError
from .lattice import Lattice
from .regions import Region

# Chords of curved edges, in cells: what they leave out of a disc of ten cells is 7e-6 of it.
_CHORD = 1.0 / 16.0
# Particles whose distances differ by less than this, in cells, are equally near.
_TIE = 1e-6
# Cells along a tile.
_TILE = 8
# Candidates for a piece.
_NEAREST = 6


def volumes(lattice: Lattice, within: Region | None = None) -> Array:
    """Area of the body that each particle stands for.

    Parameters
    ----------
    lattice : Lattice
    within : Region, optional
        Count only what lies in it.

    Returns
    -------
    ndarray, shape (N,), cells (Δx²)
        They add up to the area of the body (or of its part in the region) over Δx². One for every
        particle of a region that has no outline.
    """
    if within is not None and any(lattice.centred.shift):
        right, up = lattice.centred.shift
        within = within.moved((-right, -up), lattice.grid)
    lattice = lattice.centred
    spacing = lattice.spacing
    try:
        body = lattice.region.outline(_CHORD * spacing)
        part = body if within is None else body & within.outline(_CHORD * spacing)
    except SceneError:
        if within is None:
            return np.ones(lattice.count)
        return within.contains(*lattice.points.T).astype(np.float64)
    shapely.prepare(body)
    x, y = lattice.axes
    cut = _cut_cells(lattice, part)
    grid = np.zeros(lattice.shape)
    whole = lattice.mask & ~cut
    xx, yy = x[np.nonzero(whole)[1]], y[np.nonzero(whole)[0]]
    grid[whole] = True if within is None else shapely.contains_xy(part, xx, yy)
    rows, columns = np.nonzero(cut)
    half = 0.5 * spacing
    boxes = shapely.box(x[columns] - half, y[rows] - half, x[columns] + half, y[rows] + half)
    # Tile by tile: a curved edge has many vertices, and a cell meets few of them.
    tile, place = np.unique(np.stack([rows, columns]) // _TILE, axis=1, return_inverse=True)
    first = tile * _TILE
    low_x, low_y = x[first[1]] - half, y[first[0]] - half
    side = _TILE * spacing
    # Older GEOS leave flags of floating-point errors behind that mean nothing.
    with np.errstate(invalid="ignore"):
        tiles = shapely.intersection(shapely.box(low_x, low_y, low_x + side, low_y + side), part)
        cells = shapely.intersection(boxes, tiles[place.ravel()])
    pieces, cell = shapely.get_parts(cells, return_index=True)
    area = shapely.area(pieces) / spacing**2
    kept = area > 0
    pieces, cell, area = pieces[kept], cell[kept], area[kept]
    rows, columns = rows[cell], columns[cell]
    centre = shapely.points(x[columns], y[rows])
    own = lattice.mask[rows, columns] & (shapely.distance(pieces, centre) <= _TIE * spacing)
    np.add.at(grid, (rows[own], columns[own]), area[own])
    result = np.asarray(grid[lattice.mask])
    strips = shapely.get_coordinates(shapely.centroid(pieces[~own]))
    _to_nearest(lattice, body, strips, area[~own], result)
    return result


def _cut_cells(lattice: Lattice, part: shapely.Geometry) -> Mask:
    """Cells that the edge of `part` runs through or beside, shape `lattice.shape`."""
    spacing = lattice.spacing
    x, y = lattice.axes
    edge = shapely.segmentize(shapely.boundary(part), 0.5 * spacing)
    points = shapely.get_coordinates(edge)
    column = np.rint((points[:, 0] - x[0]) / spacing).astype(int)
    row = np.rint((points[:, 1] - y[0]) / spacing).astype(int)
    cut = np.zeros(lattice.shape, dtype=bool)
    inside = (row >= 0) & (row < cut.shape[0]) & (column >= 0) & (column < cut.shape[1])
    cut[row[inside], column[inside]] = True
    return np.asarray(binary_dilation(cut, np.ones((3, 3), dtype=bool)))


def _to_nearest(
    lattice: Lattice, body: shapely.Geometry, points: Array, area: Array, result: Array
) -> None:
    """Add areas at `points`, shape (n, 2), to the nearest particles that see them."""
    if not len(points):
        return
    count = min(_NEAREST, lattice.count)
    distance, near = KDTree(lattice.points).query(points, k=count)
    distance, near = distance.reshape(-1, count), near.reshape(-1, count)
    ends = np.stack([np.repeat(points[:, None], count, axis=1), lattice.points[near]], axis=2)
    seen = shapely.covers(body, shapely.linestrings(ends.reshape(-1, 2, 2))).reshape(near.shape)
    # Behind a bulge nobody may see it: then the nearest takes it.
    seen[~seen.any(axis=1)] = True
    distance = np.where(seen, distance, np.inf)
    first = distance <= distance.min(axis=1, keepdims=True) + _TIE * lattice.spacing
    share = first / first.sum(axis=1, keepdims=True)
    np.add.at(result, near, share * area[:, None])
