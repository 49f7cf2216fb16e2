"""Stress intensity factors of a bond solution: interaction integral, and fit of the tip's series.

The integral weighs displacement gradients in a ring around the tip; the fit takes displacements
themselves and finds the coefficients of the crack's eigenfunctions, rigid motion and the stress
along the crack among them. They err differently, so that each checks the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from cmverify.case import Array

if TYPE_CHECKING:
    from solver import Solution

#: r^(-1/2) … r^4: enough for a ring that reaches to the specimen's edge. The first is what a tip
#: leaves that is not where the crack ends (see `TipSeries.shift`).
ORDERS = (-1, 0, 1, 2, 3, 4, 5, 6, 7, 8)


@dataclass(frozen=True)
class TipSeries:
    """A fitted crack-tip series.

    Attributes
    ----------
    KI, KII : float
        Pa √m, in the crack's own axes.
    shift : float
        How far ahead of the crack's end (m) the tip seems to be that makes the fitted field,
        from the terms r^(-1/2); NaN if these were not fitted.
    residual : float
        Relative L2 misfit of the displacement.
    """

    KI: float
    KII: float
    shift: float
    residual: float


def interaction_integral(
    solution: Solution, tip: tuple[float, float], angle: float, radius: float, inner: float = 0.4
) -> tuple[float, float]:
    """K_I and K_II of a bond solution by the interaction integral over a ring of particles.

    Gradients are differences between next neighbours that no crack separates, stress is the
    tensor times them: sums over whole families would lack at the faces what those cut off.

    Parameters
    ----------
    solution : Solution
        Of an elastic scene.
    tip : pair of float
    angle : float
        Direction in which the crack would advance along itself, rad from axis 1.
    radius : float
        Outer radius of the ring; the crack must be straight inside it and free of traction.
    inner : float
        Inner radius over the outer one.

    Returns
    -------
    KI, KII : float
        Pa √m, in the crack's own axes.

    Raises
    ------
    ValueError
        If the ring is thinner than three cells, reaches nearer to the tip than a horizon, or
        leaves the body.
    """
    from references.analytic.interaction import intensities
    from solver import ElasticTensor

    scene = solution.scene
    if not isinstance(scene.material, ElasticTensor):
        raise ValueError("stress intensity factors belong to elastic solutions")
    if not 0.0 < inner < 1.0:
        raise ValueError("the ring's inner radius must be a fraction of the outer one")
    points, ring = _ring(solution, tip, inner * radius, radius)
    gradient = local_gradient(solution)[ring]
    return intensities(
        scene.material.voigt,
        points[ring],
        gradient,
        scene.spacing**2,
        angle,
        inner * radius,
        radius,
    )


def tip_series(
    solution: Solution,
    tip: tuple[float, float],
    angle: float,
    radius: float,
    inner: float = 0.4,
    orders: Sequence[int] = ORDERS,
) -> TipSeries:
    """K_I and K_II from a least-squares fit of crack eigenfunctions to the displacements.

    Parameters and errors as in `interaction_integral`; `orders` are the integers n of the terms
    r^(n/2), 1 among them.
    """
    from solver import ElasticTensor

    scene = solution.scene
    if not isinstance(scene.material, ElasticTensor):
        raise ValueError("stress intensity factors belong to elastic solutions")
    points, ring = _ring(solution, tip, inner * radius, radius)
    return fit_series(
        scene.material.voigt, points[ring], solution.displacement[ring], angle, orders
    )


def fit_series(
    voigt: ArrayLike,
    points: Array,
    displacement: Array,
    angle: float = 0.0,
    orders: Sequence[int] = ORDERS,
) -> TipSeries:
    """Fit the series to displacements (N, 2) at points (N, 2) about the tip.

    Points on the very line of the crack have no side and are left out.

    Raises
    ------
    ValueError
        If n = 1 is not among the orders, or there are too few points for so many terms.
    """
    from references.analytic.crack_series import crack_tip_term
    from references.analytic.voigt import turned_axes

    if 1 not in orders:
        raise ValueError("the series of a crack tip without the term of order 1 has no K")
    own = turned_axes(voigt, angle)
    scale = float(np.abs(own).max())
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    size = float(np.hypot(*points.T).max())
    # Unit stiffness and unit size: no term drowns in another's magnitude.
    local, u = points @ turn.T / size, displacement @ turn.T
    sided = (np.abs(local[:, 1]) > 1e-9) | (local[:, 0] > 0)
    local, u = local[sided], u[sided]
    if 2 * len(local) < 8 * len(orders):
        raise ValueError(f"{len(local)} points are too few to fit {len(orders)} crack-tip terms")
    columns = [
        term.ravel()
        for n in orders
        for term in crack_tip_term(own / scale, local[:, 0], local[:, 1], n)
    ]
    system = np.stack(columns, axis=1)
    norms = np.linalg.norm(system, axis=0)
    found = np.linalg.lstsq(system / norms, u.ravel(), rcond=None)[0] / norms
    misfit = np.linalg.norm(system @ found - u.ravel()) / np.linalg.norm(u)
    pairs = {n: found[2 * i : 2 * i + 2] for i, n in enumerate(orders)}
    k = pairs[1] * scale / np.sqrt(size)
    # K √(r) moved ahead by s is K √r − s/2 K r^(-1/2) along the crack's axis, for both modes.
    shift = np.nan
    if -1 in pairs:
        shift = float(-2.0 * size * (pairs[-1] @ pairs[1]) / (pairs[1] @ pairs[1]))
    return TipSeries(float(k[0]), float(k[1]), shift, float(misfit))


def local_gradient(solution: Solution) -> Array:
    """∂u_i/∂x_j from neighbours within two cells, (N, 2, 2).

    Central differences, one-sided ones of second order beside a face or an edge; NaN where a
    particle has no intact bond along an axis.
    """
    gradient = np.empty((solution.discretisation.lattice.count, 2, 2))
    for axis, unit in enumerate(((1, 0), (0, 1))):
        ahead, far_ahead = (_step(solution, unit, k) for k in (1, 2))
        behind, far_behind = (_step(solution, unit, -k) for k in (1, 2))
        choices = (
            0.5 * (ahead - behind),
            2.0 * ahead - 0.5 * far_ahead,
            0.5 * far_behind - 2.0 * behind,
            ahead,
            -behind,
        )
        slope = choices[0]
        for other in choices[1:]:
            slope = np.where(np.isnan(slope), other, slope)
        gradient[:, :, axis] = slope.T / solution.spacing
    return gradient


def _step(solution: Solution, unit: tuple[int, int], cells: int) -> Array:
    """u there less u here, (2, N), NaN where that bond is missing, cut or broken."""
    parts = solution.discretisation
    offsets = parts.family.offsets
    found = np.flatnonzero(np.all(offsets == np.multiply(unit, cells), axis=1))
    values = solution.displacement.T
    if not len(found):
        return np.full_like(values, np.nan)
    rows, columns = parts.lattice.rows_columns
    there = parts.lattice.to_grid(np.nan_to_num(values, nan=0.0))
    difference = there[:, rows + cells * unit[1], columns + cells * unit[0]] - values
    difference[:, parts.bonds.strength(int(found[0])) == 0.0] = np.nan
    return np.asarray(difference)


def _ring(
    solution: Solution, tip: tuple[float, float], inner: float, outer: float
) -> tuple[Array, np.ndarray]:
    """Points relative to the tip, and which of them lie in the ring; ValueError if it is bad."""
    if not (np.isfinite([*tip, inner, outer]).all() and 0.0 < inner < outer):
        raise ValueError("an integration ring needs a finite tip and 0 < inner < outer radius")
    spacing = solution.spacing
    horizon = solution.scene.m * spacing
    if outer - inner < 3 * spacing or inner < horizon:
        raise ValueError(
            f"the ring from {inner:g} to {outer:g} m must be at least three cells wide and stay a "
            f"horizon ({horizon:g} m) away from the tip: refine the lattice or widen the ring"
        )
    points = solution.points - np.asarray(tip, dtype=float)
    ring = (r := np.hypot(*points.T)) > inner
    ring &= r < outer
    area = np.pi * (outer**2 - inner**2)
    # Whole cells miss or exceed the ring's area by a small part of its two rims.
    rims = 2 * np.pi * (outer + inner) * spacing
    if (
        abs(ring.sum() * spacing**2 - area) > 0.25 * rims
        or not np.isfinite(solution.displacement[ring]).all()
    ):
        raise ValueError(
            f"the ring of radius {outer:g} m about ({tip[0]:g}, {tip[1]:g}) leaves the body, or "
            f"holds parts that were set aside"
        )
    return points, ring
