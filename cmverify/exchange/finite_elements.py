"""A scene file's scene as finite elements see it: mesh, solids, supports and loads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cmverify.exchange import shapes
from cmverify.exchange.values import InTime

if TYPE_CHECKING:
    from cmverify.exchange.request import Request
    from references.fem.body import Acting, Body, Held, InSolid
    from solver.arrays import Array


@dataclass(frozen=True, eq=False)
class Mirror:
    """A request's scene as finite elements of a size: what all analyses take.

    Attributes
    ----------
    request : Request
    size : float, m
    mesh : references.fem.mesh.Mesh
    solid : (M,) int array
        Of each triangle: the scene's own, then its inclusions'.
    outline : shapely geometry
        The body's edge.
    """

    request: Request
    size: float
    mesh: Any
    solid: NDArray[np.int64]
    outline: Any
    _bodies: dict[int, Body] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, request: Request, size: float) -> Mirror:
        """Mesh the scene.

        Raises
        ------
        ValueError, RuntimeError
            If there is no such mesh.
        """
        from references.fem.polygons import polygons

        scene = request.scene
        body, solids = _shapes(request, size)
        parts = [
            (shapely.get_coordinates(part.exterior)[:-1],
             [shapely.get_coordinates(hole)[:-1] for hole in part.interiors])
            for solid in solids for part in shapely.get_parts(solid) if part.area > 0
        ]  # fmt: skip
        cracks = [
            segment
            for crack in scene.cracks
            for segment in _within(shapely.LineString(crack.points), body)
        ]
        mesh = polygons(parts, size, cracks, tip_size=0.1 * size if cracks else None)
        solid = np.zeros(len(mesh.triangles), dtype=np.int64)
        x, y = mesh.points[mesh.triangles].mean(axis=1).T
        for k, inclusion in enumerate(scene.inclusions, start=1):
            solid[inclusion.region.contains(x, y)] = k
        return cls(request, size, mesh, solid, shapely.boundary(body))

    def body(self, components: int) -> Body:
        """Its elements, for an unknown of one component or two."""
        from references.fem.body import Body

        if components not in self._bodies:
            self._bodies[components] = Body(
                self.mesh, components, self.solid, _thickness(self.request)
            )
        return self._bodies[components]

    @property
    def unknowns(self) -> int:
        """Of all elements that were asked for, those that are held included."""
        return sum(len(body.nodes) * k for k, body in self._bodies.items())

    def moduli(self) -> InSolid:
        """Of the scene's solids: stiffness or conductivity."""
        from references.fem.body import of_solids

        scene = self.request.scene
        materials = [scene.material, *(inclusion.material for inclusion in scene.inclusions)]
        name = "voigt" if hasattr(scene.material, "voigt") else "matrix"
        return of_solids(np.stack([getattr(material, name) for material in materials]))

    def stored(self, name: str) -> list[float]:
        """Density or heat capacity of each solid; the scene's own where an inclusion says none."""
        scene = self.request.scene
        each = [getattr(inclusion, name) for inclusion in scene.inclusions]
        own = getattr(scene, name)
        return [own, *(own if one is None else one for one in each)]

    def held(self, time: float = 0.0) -> Held:
        """What the supports prescribe at a time."""
        return _held(self.request, self.outline, time)

    def supported(self, components: int, time: float) -> Array:
        """What is prescribed at a time, of all unknowns."""
        return self.body(components).held(self.held(time))

    def loaded(self, components: int, time: float) -> Array:
        """Right-hand side of the loads at a time."""
        return self.body(components).load(self.acting(time))

    def acting(self, time: float = 0.0) -> Acting:
        """What the loads do at a time, and strains without stress."""
        return _acting(self.request, time)


def within(places: Sequence[tuple[Any, float]]) -> Held:
    """Values at the nodes in regions or where conditions are true, one after the other.

    Raises
    ------
    ValueError
        If one holds no node.
    """

    def held(nodes: Array, _: Any) -> Array:
        values = np.full((len(nodes), 1), np.nan)
        for place, value in places:
            chosen = _where(place, *nodes.T)
            if not chosen.any():
                raise ValueError("an electrode or a sink holds no node: it is too small for it")
            values[chosen] = value
        return values

    return held


def _shapes(request: Request, size: float) -> tuple[Any, list[Any]]:
    """The body, and what of it each solid takes, the scene's own first; later ones win."""
    scene = request.scene
    body = scene.region.outline(0.5 * size)
    left, solids = body, []
    for inclusion in reversed(scene.inclusions):
        own = inclusion.region.outline(0.5 * size)
        solids.append(shapely.intersection(left, own))
        left = shapely.difference(left, own)
    return body, [left, *reversed(solids)]


def _within(line: Any, body: Any) -> list[Any]:
    found = []
    for piece in shapely.get_parts(shapely.intersection(line, body)):
        points = shapely.get_coordinates(piece)
        if isinstance(piece, shapely.LineString) and piece.length > 0:
            found += [(tuple(a), tuple(b)) for a, b in pairwise(points.tolist())]
    return found


def given(value: Any, x: Array, y: Array, components: int, time: float = 0.0) -> Array:
    """A number, list or formula at a time as (components, *x.shape)."""
    if isinstance(value, InTime):
        found = np.asarray(value(x.ravel(), y.ravel(), time), dtype=float)
    elif callable(value):
        found = np.asarray(value(x.ravel(), y.ravel()), dtype=float)
    else:
        found = np.broadcast_to(np.asarray(value, dtype=float), (x.size, components))
    return np.moveaxis(found.reshape(*x.shape, components), -1, 0)


def _where(condition: Any, x: Array, y: Array) -> Array:
    if condition is None:
        return np.ones(x.shape, dtype=bool)
    if hasattr(condition, "contains"):
        inside: Array = condition.contains(x.ravel(), y.ravel())
        return inside.reshape(x.shape)
    return np.asarray(condition(x.ravel(), y.ravel()), dtype=bool).reshape(x.shape)


def _place(request: Request, table: Any) -> Any:
    """Where a support or a lead is."""
    return shapes.place(table, request.source.path.parent, request.scene.spacing)


def _acts(number: int, condition: Any, x: Array, y: Array) -> Array:
    """Where a load acts; what no point of the mesh feels is another scene."""
    found = _where(condition, x, y)
    if not found.any():
        raise ValueError(f"load #{number} acts where the mesh has no point: it is too small for it")
    return found


def _held(request: Request, edge: Any, time: float) -> Held:
    physics, spacing = request.scene.physics, request.scene.spacing
    components = 2 if len(physics.unknowns) > 1 else 1

    def held(nodes: Array, on_edge: Any) -> Array:
        values = np.full((len(nodes), components), np.nan)
        x, y = nodes.T
        for number, table in enumerate(request.file.support, start=1):
            if table.layer_cells is not None:
                depth = shapely.distance(edge, shapely.points(x, y))
                chosen = depth <= table.layer_cells * spacing * (1 + 1e-9)
            else:
                chosen = _where(_place(request, table), x, y)
            if table.kind == "edge":
                chosen &= on_edge
            if not chosen.any():
                raise ValueError(f"support #{number} holds no node: it is too small for the mesh")
            for name, value in table.values.items():
                if name == "rotation":
                    continue
                first = {"u2": 1}.get(name, 0)
                width = 2 if name == "displacement" else 1
                own = given(value, x[chosen], y[chosen], width, time)
                values[chosen, first : first + width] = own.T
        return values

    return held


def _thickness(request: Request) -> InSolid | None:
    scene = request.scene
    each = [inclusion.thickness for inclusion in scene.inclusions]
    if scene.thickness is None and all(one is None for one in each):
        return None

    def thickness(x: Array, y: Array, solid: Any) -> Array:
        own = 1.0 if scene.thickness is None else scene.thickness
        found = given(own, x, y, 1)[0].copy()
        for k, one in enumerate(each, start=1):
            if one is not None:
                found[solid == k] = one
        return found

    return thickness


def _acting(request: Request, time: float) -> Acting:
    """What acts, and strains without stress."""
    from references.fem.body import Acting

    scene = request.scene
    components = 2 if len(scene.physics.unknowns) > 1 else 1
    tolerance = 1e-6 * scene.spacing
    volume: list[Any] = []
    spread: list[Any] = []
    edges: list[Any] = []
    places: list[Any] = []
    strains: list[Any] = []
    tables = zip(request.file.load, scene.loads, strict=True)
    for n, (table, load) in enumerate(tables, start=1):
        if table.kind in ("body_force", "source", "current"):
            volume.append(
                lambda x, y, t=table, n=n: (
                    given(t.value, x, y, components, time) * _acts(n, t.where, x, y)
                )
            )
        elif table.kind == "lead":
            place = _place(request, table)
            spread.append((lambda x, y, p=place, n=n: _acts(n, p, x, y), table.value))
        elif table.kind == "stress":
            edges.append(lambda x, y, n1, n2, t=table, n=n: _pull(n, t, x, y, n1, n2, time))
        elif table.kind == "flux":
            edges.append(
                lambda x, y, n1, n2, t=table, n=n: (
                    -(given(t.value, x, y, 2, time) * (n1, n2)).sum(axis=0)[None]
                    * _acts(n, t.where, x, y)
                )
            )
        elif table.kind == "traction":
            edges.append(
                lambda x, y, n1, n2, t=table, n=n: (
                    given(t.value, x, y, 2, time)
                    * _acts(n, lambda x, y, t=t: _along(t, x, y, tolerance), x, y)
                )
            )
        elif table.kind in ("point", "line"):
            then = load.at(time).points
            assert then is not None
            at, force = then(scene.spacing)
            places.append((at, force * _thick_at(request, at)))
        else:
            strains.append(table)

    def strain(x: Array, y: Array, solid: Any) -> Array:
        from solver import ExpansionTensor

        total = np.zeros((3, *x.shape))
        for table in strains:
            change = given(table.value, x, y, 1)[0]
            own = np.asarray(ExpansionTensor(table.expansion).voigt)
            voigts = [own] + [
                own if one.expansion is None else np.asarray(one.expansion.voigt)
                for one in scene.inclusions
            ]
            total += np.moveaxis(np.stack(voigts)[solid], -1, 0) * change
        return total

    return Acting(volume, spread, edges, places, strain if strains else None)


def _thick_at(request: Request, at: Array) -> Array:
    function = _thickness(request)
    if function is None:
        return np.ones((len(at), 1))
    solid = np.zeros(len(at), dtype=np.int64)
    for k, inclusion in enumerate(request.scene.inclusions, start=1):
        solid[inclusion.region.contains(*at.T)] = k
    x, y = at.T
    return np.asarray(function(x, y, solid))[:, None]


def _pull(number: int, table: Any, x: Array, y: Array, n1: Array, n2: Array, time: float) -> Array:
    s11, s22, s12 = given(table.value, x, y, 3, time)
    return np.stack([s11 * n1 + s12 * n2, s12 * n1 + s22 * n2]) * _acts(number, table.where, x, y)


def _along(table: Any, x: Array, y: Array, tolerance: float) -> Array:
    """Whether points lie on the straight line of a traction."""
    start, end = np.array(table.start), np.array(table.end)
    length = float(np.hypot(*(end - start)))
    along = ((x - start[0]) * (end - start)[0] + (y - start[1]) * (end - start)[1]) / length
    across = ((x - start[0]) * (end - start)[1] - (y - start[1]) * (end - start)[0]) / length
    on = (np.abs(across) <= tolerance) & (along >= -tolerance) & (along <= length + tolerance)
    return np.asarray(on)
