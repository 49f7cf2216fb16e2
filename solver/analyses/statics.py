"""Static and steady solutions: one linear solve by the method that the operator asks for."""

from __future__ import annotations

import sys
from time import perf_counter

import numpy as np
from scipy.sparse.linalg import LinearOperator

from .. import threads
from ..arrays import Array
from ..blas import one_thread
from ..errors import ConvergenceError
from ..linear import Bordered, Task, method
from ..problem import Description, Discretisation, cautions
from ..problem.bordering import border as border_of
from ..reactions import residual as residual_of
from ..solution import Solution, Statistics
from .registry import Analysis


def solve(
    discretisation: Discretisation,
    tolerance: float = 1e-10,
    max_iterations: int = 20_000,
    preconditioning: method.Preconditioner = "auto",
    previous: Solution | None = None,
) -> Solution:
    """Solve K x = b for the free unknowns.

    Parameters
    ----------
    discretisation : Discretisation
    tolerance : float
        Stop at |b − K x| ≤ tolerance |b|, checked with the operator, not the recurrence. Where
        rounding allows no such residual the solution is the best there is, and carries a warning.
    max_iterations : int
        Of the Krylov method, all restarts together.
    preconditioning : {"auto", "two-level", "block-jacobi"}
        ``auto`` takes two levels from 2,000 unknowns on.
    previous : Solution, optional
        Of the same body with other loads or fewer bonds: the solve starts from its fields, and
        its preconditioner is reused, brought up to date where bonds have changed.

    Returns
    -------
    Solution

    Raises
    ------
    ValueError
        If the tolerance is not in (0, 1).
    NegativeCurvatureError
        If a body taken to be positive is not.
    ConvergenceError
        If the tolerance is not reached.
    """
    if not 0 < tolerance < 1:
        raise ValueError(f"the tolerance must lie between 0 and 1, not {tolerance}")
    begun = perf_counter()
    operator, kind = discretisation.operator, discretisation.stability.kind
    with one_thread(), threads.suited(operator):
        rhs = discretisation.right_hand_side()
        start = _start(discretisation, previous)
        border = None if discretisation.constraints is None else border_of(discretisation)
        if border is not None:
            rhs = np.concatenate([rhs, border.force])
            start = np.concatenate([start, np.zeros(len(border.force))])
        x, iterations = np.zeros_like(rhs), 0
        inverse: LinearOperator | None = None
        if rhs.any():
            earlier = None if previous is None else previous.preconditioner
            inverse = method.preconditioner(operator, kind, preconditioning, earlier)
        ready = perf_counter()
        if inverse is not None:
            task = Task(rhs, start, tolerance, max_iterations)
            x, iterations = method.iterate(operator, kind, inverse, task, border)
        whole = operator if border is None else Bordered(operator, border)
        residual = method.relative_residual(whole, x, rhs)
    used = method.name(kind, inverse)
    if border is not None:
        discretisation = discretisation.moved(x[operator.shape[0] :])
    found = discretisation.field(x[: operator.shape[0]])
    warnings = discretisation.warnings + discretisation.overlaps(found)
    warnings += _points_held(discretisation, found)
    if tolerance < residual <= method.attainable(operator, x, rhs):
        stopped = (
            f"the residual stopped at {residual:.1e}, where {tolerance:.1e} was asked for: in a "
            f"body so slender, so loosely held or of solids so different rounding of the "
            f"displacements (or temperatures) allows no less"
        )
        warnings += cautions.told((stopped,))
    elif not residual <= tolerance:
        rounded = residual <= method.rounded(operator, x, rhs)
        why = ": its parts differ by too much for numbers of 16 digits" if rounded else ""
        raise ConvergenceError(
            f"{used} stopped at a relative residual of {residual:.2e} after {iterations} "
            f"iterations; {tolerance:.1e} was asked for{why}"
        )
    statistics = Statistics(
        particles=discretisation.lattice.count,
        unknowns=operator.shape[0]
        if operator.identity_rows is None
        else int((~operator.identity_rows).sum()),
        bonds=operator.directed_bonds,
        method=used,
        kind=discretisation.stability.kind,
        margin=discretisation.stability.margin,
        iterations=iterations,
        residual=residual,
        setup_seconds=discretisation.seconds + (ready - begun),
        solve_seconds=perf_counter() - ready,
        peak_memory=_peak_memory(),
        warnings=warnings,
    )
    return Solution(discretisation, found, statistics, inverse)


def _points_held(discretisation: Discretisation, found: Array) -> tuple[str, ...]:
    """What particles that are held by themselves carry, if they do."""
    lattice, turning = discretisation.lattice, discretisation.scene.physics.turning
    across = ~np.array(turning[: len(found)])
    held = (discretisation.prescribed & ~np.isnan(discretisation.values))[across].any(axis=0)
    single = cautions.alone(lattice, held)
    if not single.any():
        return ()
    exerted = residual_of(discretisation, found)[across]
    loads = [discretisation.load[across]]
    if discretisation.nodal_load is not None:
        loads.append(discretisation.nodal_load[across])
    return cautions.told(cautions.points_held(lattice, single, exerted, loads))


def _peak_memory() -> int:
    """Peak resident memory of this process in bytes; 0 where the system does not tell."""
    try:
        import resource
    except ImportError:  # not POSIX
        return 0
    # Kilobytes, but bytes on macOS.
    unit = 1 if sys.platform == "darwin" else 1024
    return int(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)


def _start(discretisation: Discretisation, previous: Solution | None) -> Array:
    """First guess of the active unknowns: those of an earlier solution, or zeros."""
    operator = discretisation.operator
    if previous is None or previous.unknowns.shape != discretisation.values.shape:
        return np.zeros(operator.shape[0])
    given = np.nan_to_num(previous.unknowns[:, operator.active])
    if operator.identity_rows is not None:
        values = discretisation.values[:, operator.active]
        given = np.where(operator.identity_rows, values, given)
    return given.ravel()


def run(scene: Description, tolerance: float = 1e-10, max_iterations: int = 20_000) -> Solution:
    """Discretise a scene and solve it; see `solve`."""
    return solve(Discretisation.of(scene, constrained=True), tolerance, max_iterations)


ANALYSIS = Analysis("solve", "Static equilibrium, or steady conduction.", run, stressed=True)
