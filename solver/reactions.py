"""What supports exert: force and moment on some particles, from the bonds that hold them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import threads
from .arrays import Array
from .errors import SceneError
from .geometry import Point, Where, select
from .operators import BondOperator
from .problem import Discretisation
from .state import State


@dataclass(frozen=True)
class Reaction:
    """Force and moment that supports exert on some particles, per unit thickness.

    With a thickness in N and N m.

    Attributes
    ----------
    force : ndarray, shape (2,), N/m
    moment : float, N
        About `about`, couples on the particles included.
    about : ndarray, shape (2,), m
    """

    force: Array
    moment: float
    about: Array


def residual(parts: Discretisation, unknowns: Array) -> Array:
    """K u − f on every particle, shape (components, N), per volume: what must hold it there.

    Zero on free unknowns of an equilibrium, but for the solver's tolerance, and on parts set
    aside.
    """
    aside = np.isnan(unknowns).all(axis=0)
    opened = np.zeros_like(parts.prescribed)
    opened[:, aside] = True
    operator = BondOperator(parts.bonds, parts.moduli, opened)
    operator.calibrate_tips(parts.operator.tips)
    given = np.nan_to_num(unknowns)
    found = np.zeros_like(parts.load)
    with threads.suited(operator):
        rows = operator.product(given[:, operator.active]) - parts.load[:, operator.active]
    if operator.ended_stiffness is not None and parts.nodal_load is not None:
        condensed = operator.ended_stiffness.condensed_load(parts.nodal_load, parts.edge_values)
        operator.add_at_surface(rows, condensed)
    found[:, operator.active] = rows
    return found


def reaction(state: State, where: Where, about: Point | None = None) -> Reaction:
    """Force and moment that supports exert on the particles in `where`.

    Parameters
    ----------
    state : State
        Of an elastic body, a `Solution` for instance.
    where : Region or callable
        All particles of the support; others are at equilibrium and add next to nothing.
    about : point, optional
        By default the mean of the particles.

    Raises
    ------
    SceneError
        If no particle is there, or the body is not elastic.

    Examples
    --------
    >>> from solver import ElasticTensor, Scene, Support, rectangle
    >>> held = Support.where(lambda x, y: y < -3, displacement=(0, 0), rotation=0)
    >>> pin = Support.pin(lambda x, y: y > 3, u2=0.01)
    >>> solution = Scene(
    ...     rectangle(8, 8), 1.0, ElasticTensor.isotropic(1.0, 0.2), m=2, supports=[held, pin]
    ... ).solve()
    >>> up = reaction(solution, lambda x, y: y > 3)
    >>> down = reaction(solution, lambda x, y: y < -3)
    >>> bool(abs(up.force + down.force).max() < 1e-9), bool(abs(up.moment) < 1e-9)
    (True, True)
    """
    parts = state.discretisation
    if parts.scene.physics.name != "elasticity":
        raise SceneError("reactions are forces: the body must be elastic")
    chosen = select(parts.lattice, where)
    if not chosen.any():
        raise SceneError("no particle is where a reaction is asked for")
    rows = residual(parts, state.unknowns)[:, chosen] * parts.family.cell_area
    points = parts.lattice.points[chosen]
    centre = points.mean(axis=0) if about is None else np.asarray(about, dtype=np.float64)
    x, y = (points - centre).T
    moment = float((x * rows[1] - y * rows[0]).sum())
    if len(rows) > 2:
        # Rotations are scaled by the spacing, so are couples.
        moment += float(rows[2].sum()) * parts.lattice.spacing
    return Reaction(rows[:2].sum(axis=1), moment, centre)


def supply(state: State, where: Where) -> float:
    """Heat or current that prescribed values feed into the body, W or A per m of thickness.

    Parameters
    ----------
    state : State
        Of a conducting body, a `Solution` for instance.
    where : Region or callable
        All particles of the support or lead; what a load feeds in there does not count.

    Raises
    ------
    SceneError
        If no particle is there, or the body does not conduct.
    """
    parts = state.discretisation
    physics = parts.scene.physics
    if len(physics.unknowns) != 1:
        raise SceneError(f"{physics.adjective} body conducts nothing that could be supplied")
    chosen = select(parts.lattice, where)
    if not chosen.any():
        raise SceneError("no particle is where a supply is asked for")
    return float(residual(parts, state.unknowns)[0, chosen].sum() * parts.family.cell_area)
