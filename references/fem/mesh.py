"""Triangular gmsh meshes as plain arrays: discs, rectangles, holes, and cracks as real slits."""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from references.fem.gmsh_session import (
    MeshingUnavailableError,
    load_gmsh,
    missing_libraries,
    session,
)
from references.fem.slit import boundary_edges, split_along

__all__ = [
    "Mesh",
    "MeshingUnavailableError",
    "Segment",
    "crack_tip_disc",
    "disc",
    "load_gmsh",
    "missing_libraries",
    "rectangle",
]


@dataclass(frozen=True)
class Mesh:
    """Straight-edged triangles.

    A curved boundary is replaced by chords between nodes *on* the curve. The quadratic elements'
    mid-side nodes therefore lie on the chords, and Dirichlet data are taken at the nodes' actual
    positions: the discrete domain is a polygon in which the exact field still holds, so that
    what is measured is the error of the field and not that of the geometry.

    Attributes
    ----------
    points : (N, 2) float array
        Nodes; the two faces of a crack have nodes of their own and share its tips.
    triangles : (M, 3) int array
        Counter-clockwise.
    boundaries : dict of str to (k, 2) int array
        Named sets of boundary edges as pairs of nodes.
    outer : tuple of str
        Names that make up the outer edge; holes and crack faces are the others.
    size : float
        The largest element size that was asked for.
    tips : (k, 2) float array
        Crack tips inside the body.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    boundaries: Mapping[str, NDArray[np.int64]]
    outer: tuple[str, ...]
    size: float
    tips: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))

    def nodes(self, name: str) -> NDArray[np.int64]:
        """Sorted vertices of a named boundary."""
        if name not in self.boundaries:
            raise ValueError(
                f"the mesh has no boundary {name!r}, only {', '.join(self.boundaries)}"
            )
        return np.unique(self.boundaries[name])

    @property
    def area(self) -> float:
        """Area of the polygon."""
        a, b, c = (self.points[self.triangles[:, i]] for i in range(3))
        return float(0.5 * np.sum(_cross(b - a, c - a)))

    def scaled(self, factor: float) -> "Mesh":
        """The same mesh, ``factor`` times larger."""
        return replace(
            self, points=self.points * factor, size=self.size * factor, tips=self.tips * factor
        )

    def refined(self) -> "Mesh":
        """Each triangle cut in four; the nodes there were keep their numbers.

        New nodes lie on the chords: the body is the same polygon.
        """
        number = len(self.points)
        sides = np.sort(self.triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2)
        edges, middle = np.unique(sides, axis=0, return_inverse=True)
        a, b, c = self.triangles.T
        ab, bc, ca = number + middle.reshape(-1, 3).T
        corners = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        keys = edges @ [number, 1]

        def halves(boundary: NDArray[np.int64]) -> NDArray[np.int64]:
            between = number + np.searchsorted(keys, np.sort(boundary, axis=1) @ [number, 1])
            first, last = boundary.T
            return np.concatenate(
                [np.stack([first, between], axis=1), np.stack([between, last], axis=1)]
            )

        return replace(
            self,
            points=np.concatenate([self.points, self.points[edges].mean(axis=1)]),
            triangles=np.concatenate([np.stack(corner, axis=1) for corner in corners]),
            boundaries={name: halves(pairs) for name, pairs in self.boundaries.items()},
            size=self.size / 2,
        )

    @property
    def sha256(self) -> str:
        """Hash of nodes and triangles: the same mesh, bit for bit."""
        digest = hashlib.sha256(np.ascontiguousarray(self.points).tobytes())
        digest.update(np.ascontiguousarray(self.triangles, dtype=np.int64).tobytes())
        return digest.hexdigest()


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


Segment = tuple[tuple[float, float], tuple[float, float]]


def triangulate(
    draw: Callable[[ModuleType], int | list[int]],
    name_edges: Callable[[NDArray[np.float64]], dict[str, NDArray[np.bool_]]],
    outer: tuple[str, ...],
    size: float,
    cracks: Sequence[Segment],
    refine: Sequence[tuple[tuple[float, float], float]],
    growth: float,
) -> Mesh:
    """Mesh what ``draw`` makes, split it along the cracks and name its edges.

    ``refine`` lists points with the element size there; away from them it grows by ``growth``
    per unit length.
    """
    if not np.isfinite(size) or size <= 0:
        raise ValueError(f"the element size must be positive, not {size}")
    for start, end in cracks:
        if not np.isfinite([start, end]).all() or np.hypot(*np.subtract(end, start)) == 0:
            raise ValueError(f"a crack needs two different finite ends, not {start} and {end}")
    if any(h <= 0 for _, h in refine):
        raise ValueError("the element size at a crack tip or hole must be positive")
    options = {
        "Mesh.MeshSizeMax": size,
        "Mesh.MeshSizeExtendFromBoundary": 0,
        "Mesh.MeshSizeFromPoints": 0,
        "Mesh.Algorithm": 6,
        "Mesh.RandomSeed": 1,
    }
    with session(options) as gmsh:
        occ = gmsh.model.occ
        drawn = draw(gmsh)
        surfaces = [(2, tag) for tag in (drawn if isinstance(drawn, list) else [drawn])]
        lines: list[tuple[int, int]] = []
        for start, end in cracks:
            ends = [occ.addPoint(*start, 0), occ.addPoint(*end, 0)]
            lines.append((1, occ.addLine(*ends)))
        mapped: list[list[tuple[int, int]]] = []
        if lines:
            _, mapped = occ.fragment(surfaces, lines)
        occ.synchronize()
        fields = [gmsh.model.mesh.field.add("MathEval")]
        gmsh.model.mesh.field.setString(fields[0], "F", repr(float(size)))
        for (x, y), h in refine:
            fields.append(gmsh.model.mesh.field.add("MathEval"))
            radius = f"sqrt((x-({x!r}))^2+(y-({y!r}))^2)"
            gmsh.model.mesh.field.setString(fields[-1], "F", f"{h!r}+{growth!r}*{radius}")
        background = gmsh.model.mesh.field.add("Min")
        gmsh.model.mesh.field.setNumbers(background, "FieldsList", fields)
        gmsh.model.mesh.field.setAsBackgroundMesh(background)
        gmsh.model.mesh.generate(2)
        tags, flat, _ = gmsh.model.mesh.getNodes()
        _, connectivity = gmsh.model.mesh.getElementsByType(2)
        crack_tags = [
            gmsh.model.mesh.getElementsByType(1, tag)[1]
            for pieces in mapped[len(surfaces) :]
            for dimension, tag in pieces
            if dimension == 1
        ]
    number = np.full(int(tags.max()) + 1, -1, dtype=np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    points = flat.reshape(-1, 3)[:, :2].copy()
    triangles = number[connectivity.astype(np.int64)].reshape(-1, 3)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    clockwise = _cross(b - a, c - a) < 0
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    crack_edges = (
        number[np.concatenate(crack_tags).astype(np.int64)].reshape(-1, 2)
        if crack_tags
        else np.zeros((0, 2), dtype=np.int64)
    )
    # keep only nodes of triangles (the ends of a crack may be isolated points)
    used, inverse = np.unique(triangles, return_inverse=True)
    renumber = np.full(len(points), -1, dtype=np.int64)
    renumber[used] = np.arange(len(used))
    points, triangles = points[used], inverse.reshape(-1, 3)
    crack_edges = renumber[crack_edges]
    tips = np.zeros((0, 2))
    if len(crack_edges):
        points, triangles, tip_nodes = split_along(points, triangles, crack_edges)
        tips = points[tip_nodes]
    edges = boundary_edges(triangles)
    crack = np.zeros(len(edges), dtype=bool)
    for start, end in cracks:
        crack |= _on_segment(points[edges], start, end, 1e-9 * size)
    free = edges[~crack]
    names = name_edges(points[free].mean(axis=1))
    boundaries = {name: free[mask] for name, mask in names.items()}
    if cracks:
        boundaries["crack"] = edges[crack]
    return Mesh(points, triangles, boundaries, outer, float(size), tips)


def _on_segment(
    edges: NDArray[np.float64], start: ArrayLike, end: ArrayLike, tolerance: float
) -> NDArray[np.bool_]:
    """Which edges (k, 2 ends, 2) lie on a segment."""
    start, direction = np.asarray(start, float), np.subtract(end, start).astype(float)
    length = np.hypot(*direction)
    relative = edges - start
    across = np.abs(_cross(np.broadcast_to(direction, relative.shape), relative)) / length
    along = relative @ direction / length
    inside = (along >= -tolerance) & (along <= length + tolerance)
    return np.asarray(((across <= tolerance) & inside).all(axis=1))


def _shrunk(cracks: Sequence[Segment], scale: float) -> list[Segment]:
    return [((a / scale, b / scale), (c / scale, d / scale)) for (a, b), (c, d) in cracks]


def disc(
    size: float,
    radius: float = 1.0,
    cracks: Sequence[Segment] = (),
    tip_size: float | None = None,
    growth: float = 0.15,
) -> Mesh:
    """A disc about the origin, with straight cracks if asked for.

    Parameters
    ----------
    size : float
        Largest element size.
    radius : float
        Of the disc; its boundary is called ``circle``.
    cracks : sequence of ((x, y), (x, y))
        Slits with two faces (boundary ``crack``); an end on the circle opens there.
    tip_size : float, optional
        Element size at the tips inside; away from them it grows by ``growth`` per unit length.

    Returns
    -------
    Mesh

    Examples
    --------
    >>> mesh = disc(0.2)
    >>> bool(abs(mesh.area - 3.14159) < 0.03)
    True
    """
    if radius <= 0:
        raise ValueError(f"the disc's radius must be positive, not {radius}")
    if radius != 1:
        # gmsh's tolerances are absolute: mesh at unit scale, so that size does not matter
        scaled_cracks, scaled_tip = _shrunk(cracks, radius), tip_size and tip_size / radius
        return disc(size / radius, 1.0, scaled_cracks, scaled_tip, growth).scaled(radius)

    def draw(gmsh: ModuleType) -> int:
        return int(gmsh.model.occ.addDisk(0, 0, 0, 1, 1))

    def names(middle: NDArray[np.float64]) -> dict[str, NDArray[np.bool_]]:
        return {"circle": np.ones(len(middle), dtype=bool)}

    ends = [p for crack in cracks for p in crack]
    if any(np.hypot(*p) > 1 + 1e-12 for p in ends):
        raise ValueError("a crack ends outside the disc")
    inner = [p for p in ends if np.hypot(*p) < 1 - 1e-9]
    refine = [(p, float(tip_size)) for p in inner] if tip_size else []
    return triangulate(draw, names, ("circle",), size, cracks, refine, growth)


def crack_tip_disc(
    size: float, radius: float = 1.0, tip_size: float | None = None, growth: float = 0.15
) -> Mesh:
    """Disc with a slit from (-radius, 0) to its centre, as in the crack-tip problem (Sect. 2.3.1).

    The faces are traction-free boundaries called ``crack``.
    """
    return disc(size, radius, [((-radius, 0.0), (0.0, 0.0))], tip_size, growth)


def rectangle(
    width: float,
    height: float,
    size: float,
    holes: Sequence[tuple[float, float, float]] = (),
    cracks: Sequence[Segment] = (),
    tip_size: float | None = None,
    hole_size: float | None = None,
    growth: float = 0.15,
) -> Mesh:
    """A rectangle about the origin, with round holes and straight cracks if asked for.

    Parameters
    ----------
    width, height, size : float
        Sides and largest element size.
    holes : sequence of (x, y, radius)
        Boundaries ``hole0``, ``hole1``, …
    cracks : sequence of ((x, y), (x, y))
        As in :func:`disc`; the outer edges are ``left``, ``right``, ``bottom``, ``top``.
    tip_size, hole_size, growth : float, optional
        Element size at crack tips and on the holes' edges, growing by ``growth`` per unit length.

    Raises
    ------
    ValueError
        If a side is not positive, or a hole or crack leaves the rectangle.
    """
    if width <= 0 or height <= 0:
        raise ValueError("the rectangle's sides must be positive")
    scale = max(width, height)
    if scale != 1:
        return rectangle(
            width / scale,
            height / scale,
            size / scale,
            [(x / scale, y / scale, r / scale) for x, y, r in holes],
            _shrunk(cracks, scale),
            tip_size and tip_size / scale,
            hole_size and hole_size / scale,
            growth,
        ).scaled(scale)
    half = np.array([width, height]) / 2
    for x, y, r in holes:
        if r <= 0 or abs(x) + r >= half[0] or abs(y) + r >= half[1]:
            raise ValueError(f"the hole at ({x}, {y}) of radius {r} does not lie in the rectangle")
    for end in (p for crack in cracks for p in crack):
        if np.any(np.abs(end) > half * (1 + 1e-12)):
            raise ValueError(f"the crack end {end} lies outside the rectangle")

    def draw(gmsh: ModuleType) -> int:
        occ = gmsh.model.occ
        body = occ.addRectangle(-half[0], -half[1], 0, width, height)
        if holes:
            discs = [(2, occ.addDisk(x, y, 0, r, r)) for x, y, r in holes]
            (_, body), *_ = occ.cut([(2, body)], discs)[0]
        return int(body)

    def names(middle: NDArray[np.float64]) -> dict[str, NDArray[np.bool_]]:
        x, y = middle.T
        near = 1e-9
        found = {
            "left": np.abs(x + half[0]) < near,
            "right": np.abs(x - half[0]) < near,
            "bottom": np.abs(y + half[1]) < near,
            "top": np.abs(y - half[1]) < near,
        }
        rest = ~np.logical_or.reduce(list(found.values()))
        for i, (hx, hy, r) in enumerate(holes):
            found[f"hole{i}"] = rest & (np.hypot(x - hx, y - hy) < r * (1 + 1e-9))
        return found

    refine: list[tuple[tuple[float, float], float]] = []
    if tip_size:
        ends = [p for crack in cracks for p in crack]
        refine += [(p, float(tip_size)) for p in ends if np.all(np.abs(p) < half * (1 - 1e-9))]
    if hole_size:
        for x, y, r in holes:
            around = np.linspace(0, 2 * np.pi, 48, endpoint=False)
            refine += [
                ((float(x + r * np.cos(t)), float(y + r * np.sin(t))), float(hole_size))
                for t in around
            ]
    outer = ("left", "right", "bottom", "top")
    return triangulate(draw, names, outer, size, cracks, refine, growth)
