"""The same lattice by the usual way: the operator as a sparse matrix, and SciPy's solvers.

What bonds say is not changed, so that errors are those of the bond solver; only the cost differs.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, cg, eigsh, splu

from cmverify.case import Array, Case, Measurement, Method
from cmverify.cases.common.adapters import stopwatch
from solver import Discretisation
from solver.operators.assembled import to_csr
from solver.operators.mass import inertia
from solver.state import State

if TYPE_CHECKING:
    from cmverify.exchange.statement import Pose

RESIDUAL = 1e-10
#: Fields of a static solution that targets are judged by.
FIELDS = ("displacement", "temperature", "potential")
#: Of modes.
FREQUENCIES = "frequencies"


def method(case: Case, pose: Pose) -> Method | None:
    """The posed problem on the assembled matrix; None if it is none of statics or free modes."""
    own = case.method(pose.method)
    target = pose.state(own.coarsest).targets[0]
    if own.kind != "bond" or target.times is not None:
        return None
    if target.key == FREQUENCIES:
        run = partial(_vibration, case, pose)
    elif target.key in FIELDS and target.points is not None:
        run = partial(_statics, case, pose)
    else:
        return None
    name = f"{own.name}, assembled"
    return Method(name, "bond", run, own.resolutions, own.warm_up, own.problem)


def _statics(case: Case, pose: Pose, n: int) -> Measurement:
    """CG with block Jacobi on the CSR matrix.

    Raises
    ------
    ValueError
        If the matrix is not positive.
    """
    statement = pose.state(n)
    target, seconds = statement.targets[0], dict[str, float]()
    with stopwatch(seconds, "setup"):
        problem = statement.scene.discretise()
        if problem.stability.kind != "positive":
            raise ValueError(f"the matrix is {problem.stability.kind}: no conjugate gradients")
        matrix = to_csr(problem.operator)
    with stopwatch(seconds, "solve"):
        x, iterations = conjugate_gradients(problem, matrix, RESIDUAL)
    state = State(problem, problem.field(x))
    found = state.values[:2].T if target.reference.ndim == 2 else state.values[0]
    return Measurement(
        matrix.shape[0],
        {case.primary: target.error(at(state.points, target.points, problem.scene.spacing, found))},
        seconds,
        {"method": "CG, block Jacobi, CSR", "iterations": iterations},
    )


def at(points: Array, wanted: Array | None, spacing: float, values: Array) -> Array:
    """Values at the particles of these places.

    Raises
    ------
    ValueError
        If there is none at one of them.
    """
    known = {tuple(key): i for i, key in enumerate(np.rint(points / spacing * 8).astype(int))}
    assert wanted is not None
    try:
        return values[[known[tuple(k)] for k in np.rint(wanted / spacing * 8).astype(int)]]
    except KeyError:
        raise ValueError("the changed scene has other particles than the posed one") from None


def conjugate_gradients(
    problem: Discretisation, matrix: sparse.csr_array, tolerance: float, most: int = 20_000
) -> tuple[Array, int]:
    """SciPy's conjugate gradients with block Jacobi; the solution and the iterations."""
    inverse = np.linalg.inv(problem.operator.block_diagonal)
    c, count = problem.operator.components, [0]
    jacobi = LinearOperator(
        matrix.shape,
        matvec=lambda r: np.einsum("pij,jp->ip", inverse, r.reshape(c, -1)).ravel(),
        dtype=np.float64,
    )

    def step(_: Array) -> None:
        count[0] += 1

    rhs = problem.right_hand_side()
    x, _ = cg(matrix, rhs, rtol=tolerance, maxiter=most, M=jacobi, callback=step)
    return x, count[0]


def _vibration(case: Case, pose: Pose, n: int) -> Measurement:
    """Lanczos on the shifted matrix's factors."""
    statement = pose.state(n)
    target, seconds = statement.targets[0], dict[str, float]()
    wanted, density = len(target.reference), float(statement.scene.density)
    with stopwatch(seconds, "setup"):
        matrix, mass = pencil(Discretisation.of(statement.scene, free=True))
    with stopwatch(seconds, "solve"):
        shift = -0.5 * density * float(target.reference[0]) ** 2
        values, _ = shift_invert(matrix, mass, shift, superlu, wanted + 3)
    frequencies = np.sqrt(values[3:] / density)
    return Measurement(
        matrix.shape[0],
        {case.primary: target.error(frequencies)},
        seconds,
        {"method": "shift and invert, SuperLU"},
    )


def pencil(problem: Discretisation) -> tuple[sparse.csr_array, sparse.dia_array]:
    """Stiffness and volumes as matrices; rotations have none."""
    operator = problem.operator
    weights = inertia(problem.volumes, operator.active, problem.scene.physics, operator.components)
    return to_csr(operator), sparse.diags_array(weights.ravel())


def shift_invert(
    matrix: sparse.csr_array,
    mass: sparse.dia_array,
    shift: float,
    factorise: Callable[[sparse.csc_array], Any],
    count: int,
) -> tuple[Array, Array]:
    """The `count` least eigenvalues, ascending, and their vectors, by SciPy's Lanczos."""
    solve = factorise((matrix - shift * mass).tocsc())
    inverse = LinearOperator(matrix.shape, matvec=solve, dtype=np.float64)
    start = np.random.default_rng(0).standard_normal(matrix.shape[0])
    values, vectors = eigsh(matrix, count, M=mass, sigma=shift, OPinv=inverse, v0=start, tol=1e-10)
    order = np.argsort(values)
    return values[order], vectors[:, order]


def superlu(matrix: sparse.csc_array) -> Any:
    """What solves with SuperLU's factors of a symmetric matrix."""
    return splu(
        matrix,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    ).solve
