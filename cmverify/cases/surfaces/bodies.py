"""What the cases of free surfaces share: treatments, point supports, edges, and their checks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from cmverify.case import Array, Check, Level, Measurement, Method, OrderBand
from cmverify.cases.common import warm
from cmverify.judge.norms import relative_l2, without_rigid_motion

if TYPE_CHECKING:
    from solver import Support

Treatment = Literal["none", "volume", "extrapolated"]
TREATMENTS: tuple[Treatment, ...] = ("none", "volume", "extrapolated")
#: Enough of them to fit an order: how an edge cuts the cells differs from one to the next.
LADDER = {
    Level.QUICK: (20,),
    Level.STANDARD: (20, 30, 40, 50, 70),
    Level.PAPER: (20, 30, 40, 50, 70, 100),
}
TOLERANCE = 1e-11


def nearest(x0: float, y0: float) -> Callable[[Array, Array], np.ndarray]:
    """A selection of the one particle that is nearest to a point."""

    def where(x: Array, y: Array) -> np.ndarray:
        chosen = np.zeros(len(x), dtype=bool)
        chosen[np.argmin(np.hypot(x - x0, y - y0))] = True
        return chosen

    return where


def zero(x: Array, y: Array) -> Array:
    """No displacement."""
    return np.zeros((*np.shape(x), 2))


def held(
    first: tuple[float, float],
    second: tuple[float, float],
    displacement: Callable[[Array, Array], Array] = zero,
) -> list[Support]:
    """Three components held at two particles, at exact values: rigid motion and nothing else.

    Loads in equilibrium leave these supports without reaction, so that they disturb nothing.
    The second lies to the right of the first.
    """
    from solver import Support

    def component(i: int) -> Callable[[Array, Array], Array]:
        return lambda x, y: displacement(x, y)[..., i]

    return [
        Support.where(nearest(*first), u1=component(0), u2=component(1)),
        Support.where(nearest(*second), u2=component(1)),
    ]


def at_points(
    points: Array, values: Array, targets: Array, spacing: float, cells: float = 3.2
) -> Array:
    """Values at points of the edge, by a quadratic least-squares fit of the particles near each.

    Parameters
    ----------
    points : (N, 2)
    values : (N,) or (N, c)
    targets : (k, 2)
    spacing : float
    cells : float
        Radius of the neighbourhood. Half of it lies in the body: some 16 particles for 6 terms.

    Returns
    -------
    ndarray, (k,) or (k, c)

    Raises
    ------
    ValueError
        If a neighbourhood holds fewer than eight particles.
    """
    from scipy.spatial import KDTree

    found = []
    for target, near in zip(
        targets, KDTree(points).query_ball_point(targets, cells * spacing), strict=True
    ):
        if len(near) < 8:
            raise ValueError(f"too few particles near ({target[0]:g}, {target[1]:g})")
        x, y = ((points[near] - target) / spacing).T
        system = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
        found.append(np.linalg.lstsq(system, values[near], rcond=None)[0][0])
    return np.array(found)


def displacement_errors(points: Array, computed: Array, exact: Array) -> dict[str, float]:
    """Relative L2 error and largest error over the largest displacement, rigid motion aside.

    Loads determine displacements up to a rigid motion; what the supports make of it depends on
    where they sit, so that its mean is taken from both fields.
    """
    computed, exact = (without_rigid_motion(points, u) for u in (computed, exact))
    largest = np.linalg.norm(computed - exact, axis=1).max() / np.linalg.norm(exact, axis=1).max()
    return {"displacement": relative_l2(computed, exact), "largest": float(largest)}


def symmetric(stress: Array) -> Array:
    """Stress (N, 3) as s11, s22, s12 of a recovered (N, 2, 2)."""
    shear = 0.5 * (stress[:, 0, 1] + stress[:, 1, 0])
    return np.stack([stress[:, 0, 0], stress[:, 1, 1], shear], axis=-1)


def methods(
    run: Callable[[Treatment, float, int], Measurement],
    ladder: Mapping[Level, tuple[int, ...]] = LADDER,
    m: float = 5,
    other: float | None = 3,
    conductive: bool = False,
) -> tuple[Method, ...]:
    """The three treatments at the case's m, and ``extrapolated`` at another m too."""
    settings = [(t, m, f"bond/{t}") for t in TREATMENTS]
    if other is not None:
        settings.append(("extrapolated", other, f"bond/extrapolated, m = {other:g}"))
    return tuple(
        Method(
            name,
            "bond",
            partial(run, treatment, cells),
            ladder,
            partial(warm.statics, treatment, conductive),
        )
        for treatment, cells, name in settings
    )


def converging(
    quantity: str,
    bounds: dict[int, float],
    least: float = 1.5,
    most: float = 2.6,
    floor: float = 1e-11,
    since: int = 0,
) -> Check:
    """The check of the extrapolated treatment: bounds, and an order fitted to the whole ladder.

    Bounds are what was measured with room for half as much again. The order asked for is 1.5,
    between the first order of an edge untreated and the second of the bulk (`homogeneous` says
    why); `least` is less where an oblique edge cuts the cells differently at every spacing, so that
    errors scatter about their trend. Spacings before `since` are left out of it. Below `floor` an
    error counts as none.
    """
    return Check(
        "bond/extrapolated",
        quantity,
        bounds,
        order=OrderBand(least, most, since, floor, fitted=True),
        source="exact field; measured with half as much again, order by theory",
    )


def statistics_of(solution: Any) -> dict[str, float | int | str]:
    """Columns of the method table, and what surfaces cost."""
    from cmverify.cases.common import adapters

    found = adapters.solver_statistics(solution.statistics)
    return {**found, "bond factors (bytes)": solution.discretisation.bonds.nbytes}
