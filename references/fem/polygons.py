"""Meshes of bodies of several solids, each drawn as polygons with holes."""

from collections.abc import Sequence
from dataclasses import replace
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from references.fem.mesh import Mesh, Segment, triangulate

#: An outer ring and the rings of its holes, (k, 2) arrays of corners in turn.
Polygon = tuple[ArrayLike, Sequence[ArrayLike]]


def polygons(
    parts: Sequence[Polygon],
    size: float,
    cracks: Sequence[Segment] = (),
    tip_size: float | None = None,
    growth: float = 0.15,
) -> Mesh:
    """Mesh polygons that touch along edges, across which the mesh is conforming.

    Parameters
    ----------
    parts : sequence of (ring, holes)
        Polygons that do not overlap.
    size : float
        Largest element size.
    cracks : sequence of ((x, y), (x, y))
        Slits with two faces (boundary ``crack``), within the body.
    tip_size, growth : float, optional
        Element size at crack tips inside, growing by ``growth`` per unit length.

    Raises
    ------
    ValueError
        If they overlap or are not simple.

    Returns
    -------
    Mesh
        Its boundary is called ``edge``: outer edges and holes.

    Examples
    --------
    >>> square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    >>> hole = [(0.4, 0.4), (0.6, 0.4), (0.6, 0.6), (0.4, 0.6)]
    >>> mesh = polygons([(square, [hole]), (hole, [])], 0.2)
    >>> bool(abs(mesh.area - 1) < 1e-12)
    True
    """
    rings = [np.asarray(ring, dtype=float) for ring, _ in parts]
    if not rings or any(len(ring) < 3 for ring in rings):
        raise ValueError("a polygon has three corners or more")
    every = np.concatenate(rings)
    # gmsh's tolerances are absolute: mesh about the origin at unit scale
    low, high = every.min(axis=0), every.max(axis=0)
    middle, scale = (low + high) / 2, float((high - low).max())

    def moved(ring: ArrayLike) -> NDArray[np.float64]:
        return (np.asarray(ring, dtype=float) - middle) / scale

    def draw(gmsh: ModuleType) -> list[int]:
        occ = gmsh.model.occ
        surfaces = []
        for ring, holes in parts:
            loops = [_loop(occ, moved(one)) for one in (ring, *holes)]
            surfaces.append((2, occ.addPlaneSurface(loops)))
        if len(surfaces) > 1:
            surfaces, _ = occ.fragment(surfaces[:1], surfaces[1:])
        return [tag for dimension, tag in surfaces if dimension == 2]

    def names(middles: NDArray[np.float64]) -> dict[str, NDArray[np.bool_]]:
        return {"edge": np.ones(len(middles), dtype=bool)}

    slits = [(_pair(moved(a)), _pair(moved(b))) for a, b in cracks]
    refine = [(end, tip_size / scale) for slit in slits for end in slit] if tip_size else []
    mesh = triangulate(draw, names, ("edge",), size / scale, slits, refine, growth).scaled(scale)
    drawn = sum(
        abs(_area(np.asarray(ring, float))) - sum(abs(_area(np.asarray(h, float))) for h in holes)
        for ring, holes in parts
    )
    if abs(mesh.area - drawn) > 1e-6 * drawn:
        raise ValueError(
            f"the polygons overlap or are not simple: they have an area of {drawn:.9g}, their mesh "
            f"has {mesh.area:.9g}"
        )
    return replace(mesh, points=mesh.points + middle, tips=mesh.tips + middle)


def _loop(occ: ModuleType, ring: NDArray[np.float64]) -> int:
    if _area(ring) < 0:  # OpenCASCADE takes a clockwise hole for another surface
        ring = ring[::-1]
    points = [occ.addPoint(x, y, 0) for x, y in ring.tolist()]
    lines = [occ.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    return int(occ.addCurveLoop(lines))


def _area(ring: NDArray[np.float64]) -> float:
    """Signed area, positive if the corners run anticlockwise."""
    x, y = ring.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def _pair(point: NDArray[np.float64]) -> tuple[float, float]:
    return float(point[0]), float(point[1])
