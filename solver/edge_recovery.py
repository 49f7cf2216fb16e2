"""Strains and gradients on a body's edge.

Displacements of particles and of the surface's nodes err near an edge by what a cell makes
(`solver.bonds.ended`): about O(Δx), changing sign from cell to cell, so that differences between
neighbours do not converge. A polynomial fitted over a window that holds more and more cells, and
still shrinks, does: with a radius r the noise in the slope falls as (Δx/r)², the cubic's own error
as (r/L)³, L being the length over which the strain varies. r ∝ √(L Δx) serves both.
"""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import ArrayLike
from scipy.spatial import KDTree

from .arrays import Array, Mask
from .errors import SceneError
from .material.physics import ELASTICITY
from .state import State

# Radius of the window over √(L Δx), and its least in cells: at 1.0 and 1.6 the hoop strain round a
# hole errs by up to twice as much as `edge_gradient` says.
_WINDOW, _LEAST = 1.3, 3.2
# Points that a window holds, or it grows, by this factor, up to so many times its size.
_ENOUGH, _GROW, _MOST = 24, 1.2, 3.0
# Points for each coefficient of a polynomial, and the share of its largest singular value above
# which all of them are known.
_SURE, _KNOWN = 1.6, 1e-6
# How far (cells) a place is moved into the body before what it sees is asked.
_INWARD = 0.02
# Distance (cells) along the edge over which its curvature is read.
_BESIDE = 2.5


def edge_strain(solution: State, places: ArrayLike, window: float | None = None) -> Array:
    """Strain tensor at places on the body's edge, shape (k, 2, 2).

    The symmetric part of `edge_gradient`, which see. Along the edge with the unit tangent t it is
    stretched by t·ε·t. With temperatures that strain the body it is the total strain.

    Raises
    ------
    TypeError
        If the solution is not one of elasticity.
    SceneError, NoOutlineError
        As `edge_gradient`.

    Examples
    --------
    >>> import numpy as np
    >>> from solver import ElasticTensor, Load, Scene, Support, rectangle, recovery
    >>> def at(place):
    ...     return lambda x, y: np.hypot(x - place, y - 0.05) < 1e-6
    >>> solution = Scene(rectangle(2.0, 1.0), 0.1, ElasticTensor.isotropic(1.0, 0.2), m=3,
    ...     supports=[Support.where(at(0.05), displacement=0.0), Support.where(at(0.55), u2=0.0)],
    ...     loads=[Load.stress((1.0, 0.0, 0.0))], surface="extrapolated").solve()
    >>> recovery.edge_strain(solution, [(0.0, 0.5)]).round(3)[0].tolist()
    [[1.0, 0.0], [0.0, -0.2]]
    """
    if solution.physics is not ELASTICITY:
        raise TypeError(f"a strain is recovered from elasticity only, not {solution.physics.name}")
    gradient = edge_gradient(solution, places, window)
    return 0.5 * (gradient + gradient.transpose(0, 2, 1))


def edge_gradient(solution: State, places: ArrayLike, window: float | None = None) -> Array:
    """Gradient of the displacement, temperature or potential at places on the body's edge.

    The slope of a cubic fitted to the particles and the surface's nodes that the place sees within
    a window; exact for cubics. Places inside the body are as welcome. It takes ``extrapolated``
    surfaces: the other treatments give a body a skin a horizon deep that is softer or stiffer, and
    strains there err by as much as they are, several times as much where an edge is loaded.

    Parameters
    ----------
    solution : Solution, or the State of any analysis
    places : array_like, shape (k, 2), m
        On the edge or inside, no farther outside than a cell. Not on a crack: its faces differ.
    window : float, optional
        Radius of the window, m. By default 1.3 √(L Δx), and 3.2 Δx at least, L being the edge's
        radius of curvature there, at most half the body's shorter side: give one where strains
        vary over less than that. Windows of few particles grow.

    Returns
    -------
    ndarray, shape (k, components, 2)
        [p, i, j] = ∂u_i/∂x_j; one component in conduction.

    Raises
    ------
    SceneError
        If a place lies outside the body or on a crack, sees too few particles, or lies within a
        horizon of the edge with another treatment than ``extrapolated``; if the body has
        inclusions, or the window is no positive length.
    NoOutlineError
        If the body's region does not say where its edges run.

    Notes
    -----
    First order in Δx, or a little better: the hoop strain round a hole of 10, 20 and 40 cells a
    radius errs by 3.7, 1.7 and 0.6 % of its norm, by 4.5, 2.4 and 0.8 % of its peak (m = 5,
    ν = 0.2; 4.8, 2.2 and 0.9 % of its norm at m = 3). Bonds that a load has broken do not part the
    window. In corners even a homogeneous state is not exact: a free plate of 20 cells a side,
    pulled, errs by 2 % of its strain there.
    """
    wanted = np.asarray(places, dtype=np.float64)
    if wanted.ndim != 2 or wanted.shape[1] != 2 or not np.isfinite(wanted).all():
        raise SceneError(f"places are finite points (k, 2), not of the shape {wanted.shape}")
    if solution.discretisation.bonds.phases is not None:
        raise SceneError(
            "gradients on the edge are not known in a body with inclusions: the cubic that is "
            "fitted would not know their interfaces"
        )
    body = _View(solution)
    h = solution.spacing
    targets, inner = body.moved_in(wanted - body.shift)
    if window is None:
        radius = np.maximum(_WINDOW * np.sqrt(body.length(targets) * h), _LEAST * h)
    else:
        if not (np.isfinite(window) and window > 0):
            raise SceneError(f"a window needs a positive radius, not {window}")
        radius = np.full(len(targets), float(window))
    result = np.empty((len(targets), body.values.shape[1], 2))
    for k, target in enumerate(targets):
        r = float(radius[k])
        for size in r * _GROW ** np.arange(1 + int(np.log(_MOST) / np.log(_GROW))):
            near = body.seen(inner[k], target, size)
            if len(near) >= _ENOUGH:
                break
        slope = _slope((body.points[near] - target) / size, body.values[near])
        if slope is None:
            x, y = wanted[k]
            raise SceneError(
                f"({x:g}, {y:g}) sees {len(near)} particles and nodes within {size:g} m, in too "
                f"few rows for a gradient there: take a smaller spacing"
            )
        result[k] = slope / size
    return result


def _slope(at: Array, values: Array) -> Array | None:
    """Slope at the origin of the best polynomial that the points allow, (components, 2)."""
    x, y = at.T
    weight = np.maximum(1.0 - x * x - y * y, 0.0)[:, None]
    for degree in (3, 2, 1):
        terms = [x ** (k - i) * y**i for k in range(degree + 1) for i in range(k + 1)]
        if len(x) < _SURE * len(terms):
            continue
        system = np.stack(terms, axis=1)
        # Their mean aside: a body that has moved far loses no digits.
        middle = values.mean(axis=0)
        found, _, rank, _ = np.linalg.lstsq(
            weight * system, weight * (values - middle), rcond=_KNOWN
        )
        if rank == len(terms):
            return np.asarray(found[1:3].T)
    return None


class _View:
    """Where a solution is known, and what sees what, in the coordinates of the centred lattice."""

    def __init__(self, solution: State) -> None:
        bonds = solution.discretisation.bonds
        lattice = bonds.lattice
        self.spacing, self.shift = lattice.spacing, np.array(lattice.shift)
        surface = solution.scene.surface
        deep = solution.discretisation.family.horizon
        self.skin = None if surface == "extrapolated" else (surface, deep)
        x0, y0, x1, y1 = lattice.region.bounds
        self.half = 0.5 * min(x1 - x0, y1 - y0)
        self.shape = lattice.region.outline(0.25 * lattice.spacing)
        self.inset = self.shape.buffer(-_INWARD * lattice.spacing)
        shapely.prepare(self.shape)
        cracks = bonds.cracks.frame.metres(bonds.cracks.pieces.reshape(-1, 2)).reshape(-1, 2, 2)
        self.cracks = shapely.multilinestrings(shapely.linestrings(cracks)) if len(cracks) else None
        name = next(iter(solution.physics.fields))
        points, values = [lattice.points], [getattr(solution, name)]
        stand = [lattice.points]
        if bonds.ended is not None:
            at, found = solution.surface_points - self.shift, getattr(solution, f"surface_{name}")
            plain = self._plain(solution)
            points.append(at[plain])
            values.append(found[plain])
            stand.append(self._inner(at[plain]))
        #: Where each value is, and from where it is seen.
        self.points, self.values = np.concatenate(points), np.concatenate(values)
        self.values = self.values.reshape(len(self.points), -1)
        self.stand = np.concatenate(stand)
        sound = np.isfinite(self.values).all(axis=1)
        self.points, self.values, self.stand = (
            a[sound] for a in (self.points, self.values, self.stand)
        )
        self.tree = KDTree(self.points)

    @staticmethod
    def _plain(solution: State) -> Mask:
        """Which of the surface's nodes lie on edges of the region only."""
        surface = solution.discretisation.operator.ended_stiffness
        assert surface is not None
        outline = surface.ended.outline
        cracked = outline.joints.copy()
        cracked[outline.edges[outline.face > 0]] = True
        return np.asarray(~cracked[surface.nodes])

    def _inner(self, points: Array) -> Array:
        """The nearest points a little inside the body."""
        if self.inset.is_empty:
            return points
        lines = shapely.shortest_line(self.inset, shapely.points(points))
        return np.asarray(shapely.get_coordinates(lines).reshape(-1, 2, 2)[:, 0])

    def moved_in(self, places: Array) -> tuple[Array, Array]:
        """Places, and where they look from.

        Raises
        ------
        SceneError
            If one is outside the body, on a crack, or in the skin that a treatment makes.
        """
        points = shapely.points(places)
        off = shapely.distance(self.shape, points) > self.spacing
        if off.any():
            x, y = places[np.argmax(off)] + self.shift
            raise SceneError(f"({x:g}, {y:g}) lies outside the body: no strain there")
        if self.skin is not None:
            name, deep = self.skin
            off = shapely.distance(shapely.boundary(self.shape), points) < deep
            if off.any():
                x, y = places[np.argmax(off)] + self.shift
                raise SceneError(
                    f"({x:g}, {y:g}) lies within a horizon of the edge, where surface={name!r} "
                    f"strains a skin of its own: solve with surface='extrapolated'"
                )
        if self.cracks is not None:
            on = shapely.distance(self.cracks, points) <= _INWARD * self.spacing
            if on.any():
                x, y = places[np.argmax(on)] + self.shift
                raise SceneError(
                    f"({x:g}, {y:g}) lies on a crack, whose two faces strain differently: ask "
                    f"a little beside it"
                )
        return places, self._inner(places)

    def length(self, places: Array) -> Array:
        """Radius of curvature of the edge next to each place, at most half the body's width."""
        beside = _BESIDE * self.spacing
        rings = shapely.get_parts(shapely.boundary(self.shape))
        tree = shapely.STRtree(rings)
        ring = rings[tree.nearest(shapely.points(places))]
        total = shapely.length(ring)
        here = shapely.line_locate_point(ring, shapely.points(places))
        a, b, c = (
            shapely.get_coordinates(shapely.line_interpolate_point(ring, (here + step) % total))
            for step in (-beside, 0.0, beside)
        )
        one, two, across = b - a, c - b, c - a
        area = np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
        sides = np.hypot(*one.T) * np.hypot(*two.T) * np.hypot(*across.T)
        return np.asarray(sides / np.maximum(2.0 * area, sides / self.half))

    def seen(self, inner: Array, target: Array, radius: float) -> Array:
        """Numbers of the points within a radius of a target that its inner place sees."""
        near = np.array(self.tree.query_ball_point(target, radius), dtype=np.int64)
        lines = shapely.linestrings(
            np.stack([np.broadcast_to(inner, (len(near), 2)), self.stand[near]], axis=1)
        )
        free = shapely.covers(self.shape, lines)
        if self.cracks is not None:
            free &= ~shapely.intersects(self.cracks, lines)
        return np.asarray(near[free])
