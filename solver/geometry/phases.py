"""Bodies of several phases: which particles belong to which, and the interfaces between them.

A body with inclusions is several bodies that fit into each other: the parts of its region that
inclusions take, and what they leave. Each has its own outline, and bonds that leave their phase end
there, as at a surface. What makes one body of them is that **nodes of an interface are shared**:
both phases end at the same nodes, which are in equilibrium under what both exert. So displacement
(temperature) is continuous across an interface and traction (flux) balanced, and a state that is
homogeneous in each phase and fulfils both is exact, whatever the moduli on both sides: every
particle has the whole family of its own phase.

Later inclusions win where they overlap. A particle on an interface belongs to the inclusion (the
rule of `solver.geometry.regions`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from ..arrays import Array, Indices
from ..errors import SceneError
from .crack import Crack
from .crack_set import CrackSet
from .exact import Frame
from .inside import Body
from .lattice import Lattice
from .outline import INNER, Outline
from .regions import Difference, Intersection, Point, Region
from .rings import EDGE_STEP, rings

# Cells within which corners and edges of two phases are one.
_SAME = 1e-6
# Cells that a crack keeps away from interfaces.
_CLEAR = 1.0


@dataclass(frozen=True)
class Phase(Region):
    """The part of a body that one solid takes.

    Attributes
    ----------
    region : Region
        Which points belong to it.
    shape : shapely.Geometry
        Its polygons, with the vertices of all its neighbours.
    step : float, m
        Length of the chords of curves in it.
    """

    region: Region
    shape: shapely.Geometry
    step: float
    settled = True

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        x0, y0, x1, y1 = self.shape.bounds
        return float(x0), float(y0), float(x1), float(y1)

    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        return self.region.contains(x, y)

    def outline(self, step: float) -> shapely.Geometry:
        return self.shape if step == self.step else self.region.outline(step)

    def edge_distance(self, x: Array, y: Array) -> Array:
        return np.asarray(shapely.distance(shapely.boundary(self.shape), shapely.points(x, y)))


class Phases:
    """The phases of a body.

    Parameters
    ----------
    lattice : Lattice
        Centred.
    inclusions : sequence of Region
        In its coordinates.

    Attributes
    ----------
    of : ndarray of int, shape (N,)
        Phase of each particle: 0 outside of all inclusions, k in the k-th.
    regions : tuple of Phase
    lattices : tuple of Lattice
        The same grid with the particles of one phase.

    Raises
    ------
    SceneError
        If a phase holds no particle.
    """

    def __init__(self, lattice: Lattice, inclusions: Sequence[Region]) -> None:
        self.lattice = lattice
        body = lattice.region
        self.of = np.zeros(lattice.count, dtype=np.int64)
        for k, inclusion in enumerate(inclusions):
            self.of[inclusion.contains(*lattice.points.T)] = k + 1
        for k in range(len(inclusions) + 1):
            if not (self.of == k).any():
                which = "the body beside its inclusions" if k == 0 else f"inclusion {k}"
                raise SceneError(
                    f"{which} holds no particle: it lies outside of the body, under others, or is "
                    f"thinner than the spacing {lattice.spacing:g} m"
                )
        rules: list[Region] = [body, *(Intersection(body, inclusion) for inclusion in inclusions)]
        for k, rule in enumerate(rules):
            for later in inclusions[k:]:
                rule = Difference(rule, later)
            rules[k] = rule
        step = EDGE_STEP * lattice.spacing
        shapes = _fitted([_polygons(r, lattice.spacing) for r in (body, *inclusions)],
                         _SAME * lattice.spacing)  # fmt: skip
        self.regions = tuple(
            Phase(rule, shape, step) for rule, shape in zip(rules, shapes, strict=True)
        )
        self.lattices = tuple(
            _part(lattice, region, self.of == k) for k, region in enumerate(self.regions)
        )

    def __len__(self) -> int:
        return len(self.regions)

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """The polygon of every phase."""
        return tuple(Body.of(lattice) for lattice in self.lattices)

    def outline(self, cracks: Sequence[Crack] = (), sharp_tips: bool = True) -> Outline:
        """The outlines of all phases as one, with the nodes of interfaces shared.

        Parameters
        ----------
        cracks : sequence of Crack
            In the lattice's coordinates.
        sharp_tips : bool
            See `Outline.of`.

        Raises
        ------
        SceneError
            If a crack comes near an interface.
        """
        spacing, frame = self.lattice.spacing, Frame.of(self.lattice)
        pieces = []
        for region, body in zip(self.regions, self.bodies, strict=True):
            mine = [c for c in cracks if shapely.LineString(c.points).intersects(region.shape)]
            known = CrackSet.joined(frame, mine, body)
            pieces.append(Outline.of(region, known, spacing, sharp_tips))
        joined = _joined(pieces, _SAME * spacing)
        self._keep_clear(joined, cracks)
        return joined

    def _keep_clear(self, outline: Outline, cracks: Sequence[Crack]) -> None:
        inner = shapely.linestrings(outline.nodes[outline.edges[outline.face == INNER]])
        for crack in cracks:
            line = shapely.LineString(crack.points)
            if shapely.distance(line, inner).min(initial=np.inf) < _CLEAR * self.lattice.spacing:
                raise SceneError(
                    f"the crack through {crack.drawn} comes within a cell of an interface between "
                    f"two materials: cracks along, across or up to interfaces are not known"
                )


def _polygons(region: Region, spacing: float) -> shapely.Geometry:
    found = [shapely.Polygon(outer, holes) for outer, *holes in rings(region, spacing)]
    return shapely.multipolygons(found)


def _fitted(shapes: list[shapely.Geometry], same: float) -> list[shapely.Geometry]:
    """Polygons of the phases from those of the body and its inclusions, all corners in common."""
    body, *inclusions = shapes
    # What was drawn along an edge lies on it.
    for k, shape in enumerate(inclusions):
        for other in (body, *inclusions[:k]):
            shape = shapely.snap(shape, other, same)
        inclusions[k] = shape
        body = shapely.snap(body, shape, same)
    # Older GEOS leave flags of floating-point errors behind that mean nothing.
    with np.errstate(invalid="ignore"):
        found = [body, *(shapely.intersection(shape, body) for shape in inclusions)]
    for k in range(len(found)):
        for later in inclusions[k:]:
            found[k] = shapely.difference(found[k], later)
    found = [_solid(shape, same) for shape in found]
    corners = shapely.multipoints(np.concatenate([shapely.get_coordinates(s) for s in found]))
    return [shapely.snap(shape, corners, same) for shape in found]


def _solid(shape: shapely.Geometry, same: float) -> shapely.Geometry:
    """What of an overlay has an area that is no rounding."""
    parts = [p for p in shapely.get_parts(shape) if shapely.get_dimensions(p) == 2]
    kept = [p for p in parts if p.area > same * p.length]
    return shapely.multipolygons(kept)


def _part(lattice: Lattice, region: Region, mine: NDArray[np.bool_]) -> Lattice:
    """The same grid with some of its particles."""
    mask = np.zeros(lattice.shape, dtype=bool)
    mask[lattice.mask] = mine
    part = Lattice.__new__(Lattice)
    part.__dict__.update(
        region=region,
        spacing=lattice.spacing,
        pad=lattice.pad,
        phase=lattice.phase,
        shift=lattice.shift,
        origin=lattice.origin,
        _box=lattice._box,
        mask=mask,
    )
    part.__dict__["centred"] = part
    return part


def _joined(pieces: Sequence[Outline], same: float) -> Outline:
    """Several outlines as one; where two run along each other their nodes are shared."""
    first = np.cumsum([0, *(len(piece.nodes) for piece in pieces)])
    nodes = np.concatenate([piece.nodes for piece in pieces])
    edges = np.concatenate([piece.edges + n for piece, n in zip(pieces, first[:-1], strict=True)])
    face = np.concatenate([piece.face for piece in pieces])
    owned = np.concatenate([np.ones(0, bool) if p.owned is None else p.owned for p in pieces])
    phase = np.repeat(np.arange(len(pieces)), [len(piece.edges) for piece in pieces])
    outer = np.nonzero(face == 0)[0]
    place = _clusters(nodes, np.unique(edges[outer]), same)
    # An edge that another phase has the other way round.
    count = len(nodes)
    there = place[edges[outer, 0]] * count + place[edges[outer, 1]]
    back = place[edges[outer, 1]] * count + place[edges[outer, 0]]
    inner = outer[np.isin(there, back)]
    face[inner] = INNER
    shared = _clusters(nodes, np.unique(edges[inner]), same)
    joints = np.concatenate([piece.joints for piece in pieces])
    starts = tuple(int(n) for n in np.cumsum([0, *(len(piece.edges) for piece in pieces)])[:-1])
    return Outline(nodes, edges, face, owned, joints, phase, shared, tuple(pieces), starts)


def _clusters(nodes: Array, which: Indices, same: float) -> Indices:
    """For each node the first of those at its place, among `which`; itself for others."""
    found = np.arange(len(nodes))
    if not len(which):
        return found
    pairs = KDTree(nodes[which]).query_pairs(same, output_type="ndarray")
    ones = np.ones(len(pairs), dtype=np.int8)
    graph = sparse.coo_array((ones, pairs.T), shape=(len(which), len(which)))
    _, label = connected_components(graph, directed=False)
    lowest = np.full(label.max() + 1, len(nodes))
    np.minimum.at(lowest, label, which)
    found[which] = lowest[label]
    return found


def moved(regions: Sequence[Region], by: Point, grid: float) -> list[Region]:
    """Regions `by` further, see `Region.moved`."""
    return [region if by == (0.0, 0.0) else region.moved(by, grid) for region in regions]
