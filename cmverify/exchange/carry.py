"""From the points of an answer to the points at which it is judged.

The rule, in this order:

1. A point of the answer within 1e-6 spacings is that point: its value is taken as it is.
2. Given triangles: linear in the triangle that holds the point. A point outside all of them (chords
   of a curved edge) is taken linearly from the nearest triangle, if it is not farther away than
   that is large.
3. Particles: a quadratic polynomial is fitted to the twelve nearest ones that no crack parts from
   the point, by least squares with weights 1/r²; a linear one where they do not decide a quadratic.

A point from which an answer's nearest value is more than two spacings of the answer away is
refused: nothing is made up. So are points that span a hundred times what the judged ones span (of
another unit), and two values at one place that differ (but for the faces of slits in meshes). In
time values are cubic splines between the answer's times.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.spatial import KDTree

from cmverify.exchange.answers import Answer, AnswerError
from cmverify.exchange.statement import Array, Target

SAME = 1e-6
NEAR, CANDIDATES, FAR = 12, 36, 2.0
#: Extents of an answer's points over those of the judged ones that are another unit's.
UNIT = 100.0
#: Values at one place that differ by this share of the largest are two.
TWO = 1e-6

Segments = Sequence[tuple[tuple[float, float], tuple[float, float]]]


def carry(answer: Answer, target: Target, spacing: float, cracks: Segments = ()) -> Array:
    """Values of a target of the answer at the target's points (and times).

    Raises
    ------
    AnswerError
        If the answer says nothing near a point, or its times do not cover the target's.
    """
    values = answer.values[target.key]
    if target.points is None:
        return values
    assert answer.points is not None
    if target.times is not None:
        assert answer.times is not None
        values = _in_time(answer, target, values)
        # Points first, (N, …): places are carried alike at all times.
        moved = np.moveaxis(values, 1, 0)
        return np.moveaxis(_at_points(answer, target.points, moved, spacing, cracks), 0, 1)
    return _at_points(answer, target.points, values, spacing, cracks)


def _in_time(answer: Answer, target: Target, values: Array) -> Array:
    times, wanted = answer.times, target.times
    assert times is not None
    assert wanted is not None
    slack = 1e-9 * (wanted[-1] - wanted[0])
    if times[0] > wanted[0] + slack or times[-1] < wanted[-1] - slack:
        raise AnswerError(
            f"{answer.name}: times from {times[0]:g} to {times[-1]:g} do not cover "
            f"{wanted[0]:g} to {wanted[-1]:g}"
        )
    if len(times) < 4:
        raise AnswerError(f"{answer.name}: four times at least are needed to interpolate")
    return np.asarray(CubicSpline(times, values, axis=0)(np.clip(wanted, times[0], times[-1])))


def _at_points(
    answer: Answer, wanted: Array, values: Array, spacing: float, cracks: Segments
) -> Array:
    points = answer.points
    assert points is not None
    flat = values.reshape(len(points), -1)
    tree = KDTree(points)
    distance, nearest = tree.query(wanted)
    # Doubled nodes of a slit lie at one place: an interpolation on triangles knows the side.
    known = distance <= SAME * spacing
    _refuse_other_units(answer, wanted)
    _refuse_two_values(answer, tree, flat, SAME * spacing, wanted[known], bool(len(cracks)))
    found = flat[nearest].astype(float)
    rest = np.flatnonzero(~known)
    if len(rest):
        if answer.triangles is not None:
            found[rest] = _on_triangles(answer, wanted[rest], flat)
        else:
            found[rest] = _by_fit(answer, tree, wanted[rest], flat, cracks)
    return found.reshape(len(wanted), *values.shape[1:])


def _refuse_other_units(answer: Answer, wanted: Array) -> None:
    assert answer.points is not None
    own, judged = (float(np.ptp(p, axis=0).max()) for p in (answer.points, wanted))
    if judged > 0 and own > UNIT * judged:
        raise AnswerError(
            f"{answer.name}: its points span {own:.3g} m where those that are judged span "
            f"{judged:.3g} m: are they in metres?"
        )


def _refuse_two_values(
    answer: Answer, tree: KDTree, values: Array, near: float, known: Array, cracked: bool
) -> None:
    """Refuse points given twice with values that differ, where they are taken as they are."""
    pairs = tree.query_pairs(near, output_type="ndarray")
    if answer.triangles is not None or cracked:
        # Nodes of both faces of a slit; where one of them is judged nobody knows which.
        beside = KDTree(known).query(tree.data[pairs[:, 0]])[0] if len(known) else np.zeros(0)
        pairs = pairs[beside <= 2 * near] if len(known) else pairs[:0]
    with np.errstate(invalid="ignore"):
        apart = np.abs(values[pairs[:, 0]] - values[pairs[:, 1]]).max(axis=1, initial=0.0)
        size = np.nanmax(np.abs(values), initial=0.0)
    if (wrong := np.flatnonzero(apart > TWO * size)).size:
        x, y = tree.data[pairs[wrong[0], 0]]
        raise AnswerError(f"{answer.name} has two values at ({x:g}, {y:g})")


def _on_triangles(answer: Answer, wanted: Array, values: Array) -> Array:
    points, triangles = answer.points, answer.triangles
    assert points is not None
    assert triangles is not None
    corners = points[triangles]
    area = _cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    triangles = triangles[area != 0.0]
    shapes = shapely.STRtree(shapely.polygons(points[triangles]))
    places = shapely.points(wanted)
    chosen = np.asarray(shapes.nearest(places))
    place, triangle = shapes.query(places, predicate="intersects")
    chosen[place] = triangle
    first, second, third = (points[triangles[chosen, k]] for k in range(3))
    a, b, offset = second - first, third - first, wanted - first
    s, t = _cross(offset, b) / _cross(a, b), _cross(a, offset) / _cross(a, b)
    weights = np.stack([1.0 - s - t, s, t], axis=-1)
    longest = np.hypot(*np.stack([a, b, b - a]).transpose(2, 0, 1)).max(axis=0)
    beyond = shapely.distance(shapes.geometries[chosen], places) > longest
    if beyond.any():
        raise _nothing_near(answer, wanted[beyond][0], int(beyond.sum()))
    return np.asarray(np.einsum("pk,pkc->pc", weights, values[triangles[chosen]]))


def _by_fit(answer: Answer, tree: KDTree, wanted: Array, values: Array, cracks: Segments) -> Array:
    points = answer.points
    assert points is not None
    apart = float(np.median(tree.query(points, 2)[0][:, 1])) if len(points) > 1 else 0.0
    count = min(CANDIDATES if cracks else NEAR, len(points))
    distances, neighbours = (np.reshape(a, (len(wanted), count)) for a in tree.query(wanted, count))
    far = distances[:, 0] > FAR * apart
    if far.any():
        raise _nothing_near(answer, wanted[far][0], int(far.sum()))
    found = np.empty((len(wanted), values.shape[1]))
    for k, place in enumerate(wanted):
        near = neighbours[k]
        if cracks:
            near = near[~_parted(place, points[near], cracks)][:NEAR]
        if len(near) < 3:
            raise _nothing_near(answer, place, 1)
        found[k] = _fitted(place, points[near], values[near])
    return found


def _fitted(place: Array, points: Array, values: Array) -> Array:
    """A polynomial's value at a place; quadratic if the points decide it."""
    away = points - place
    size = float(np.hypot(*away.T).max())
    x, y = away.T / size
    weight = 1.0 / (0.05 + np.hypot(x, y))
    terms = [np.ones_like(x), x, y, x * x, x * y, y * y]
    for count in (6, 3):
        system = np.stack(terms[:count], axis=1) * weight[:, None]
        if len(points) > count or count == 3:
            solution, _, rank, _ = np.linalg.lstsq(system, values * weight[:, None], rcond=1e-6)
            if rank == count:
                return np.asarray(solution[0])
    raise AnswerError(f"the points around ({place[0]:g}, {place[1]:g}) lie on a line")


def _parted(place: Array, others: Array, cracks: Segments) -> NDArray[np.bool_]:
    """Whether a crack lies between a place and each of the others, (k,)."""
    parted = np.zeros(len(others), dtype=bool)
    for start, end in cracks:
        p, q = np.asarray(start), np.asarray(end)
        along = q - p
        one = _cross(along, place - p)
        other = _cross(along, others - p)
        # Where the two lines meet along the crack.
        with np.errstate(divide="ignore", invalid="ignore"):
            share = one / (one - other)
            meet = place + share[:, None] * (others - place)
            at = (meet - p) @ along / (along @ along)
        # On the line itself counts as above it.
        sides = (one >= 0) != (other >= 0)
        parted |= sides & (at >= 0.0) & (at <= 1.0)
    return parted


def _cross(a: Array, b: Array) -> Any:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _nothing_near(answer: Answer, place: Array, count: int) -> AnswerError:
    return AnswerError(
        f"{answer.name} says nothing near ({place[0]:g}, {place[1]:g}) and at {count} of the "
        f"judged points in all"
    )
