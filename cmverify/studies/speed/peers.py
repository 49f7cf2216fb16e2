"""Algebraic multigrid with rigid modes, the strongest that others have for such matrices.

Both are optional: PETSc through petsc4py (it comes with FEniCSx) and pyamg (extra ``bench``). They
get the assembled matrix, unknowns particle by particle, and the body's rigid motions, from which
smoothed aggregation makes its coarse functions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from time import perf_counter, process_time

import numpy as np
from scipy import sparse

from cmverify.case import Array
from solver import Discretisation
from solver.operators import BondOperator
from solver.operators.assembled import to_csr

#: Solves to a residual; returns the solution and the iterations.
Solver = Callable[[sparse.csr_array, int, Array, Array, float], tuple[Array, int]]
_MOST = 2000


@dataclass(frozen=True, eq=False)
class Run:
    """What a solver took for one system.

    Attributes
    ----------
    name : str
    x : ndarray
        The solution, component by component as the operator has it.
    iterations : int
    assembly, solving, wall : float
        CPU seconds of the matrix and of all that follows, wall seconds of both.
    """

    name: str
    x: Array
    iterations: int
    assembly: float
    solving: float
    wall: float

    @property
    def cpu(self) -> float:
        """CPU seconds of all."""
        return self.assembly + self.solving


def runs(problem: Discretisation, tolerance: float) -> Iterator[Run]:
    """One run of every peer that is installed, each assembling its own matrix."""
    operator, rhs = problem.operator, problem.right_hand_side()
    c = operator.components
    order = np.arange(operator.shape[0]).reshape(c, -1).T.ravel()
    for name, (modules, solve) in PEERS.items():
        try:
            for needed in modules:
                import_module(needed)
        except ImportError:
            continue
        wall, cpu = perf_counter(), process_time()
        matrix = to_csr(operator)[order][:, order]
        assembled = process_time()
        found, iterations = solve(matrix, c, rigid_modes(operator), rhs[order], tolerance)
        x = np.empty_like(found)
        x[order] = found
        end = process_time()
        yield Run(name, x, iterations, assembled - cpu, end - assembled, perf_counter() - wall)


def rigid_modes(operator: BondOperator) -> Array:
    """Motions that strain no bond, particle by particle, shape (unknowns, modes)."""
    x, y = operator.bonds.lattice.points[operator.active].T
    c = operator.components
    if c == 1:
        return np.ones((len(x), 1))
    modes = np.zeros((len(x), c, 3))
    modes[:, 0, 0] = modes[:, 1, 1] = 1.0
    modes[:, 0, 2], modes[:, 1, 2] = -y, x
    if c == 3:
        # The operator's third unknown is the rotation times the spacing.
        modes[:, 2, 2] = operator.bonds.family.spacing
    return modes.reshape(-1, 3)


def _gamg(
    matrix: sparse.csr_array, components: int, modes: Array, rhs: Array, tolerance: float
) -> tuple[Array, int]:
    """PETSc's conjugate gradients with GAMG, smoothed aggregation of its own settings."""
    petsc = import_module("petsc4py.PETSc")
    shape, index = matrix.shape, petsc.IntType
    given = matrix.indptr.astype(index), matrix.indices.astype(index), matrix.data
    whole = petsc.Mat().createAIJ(shape, bsize=components, csr=given)
    whole.setOption(petsc.Mat.Option.SPD, True)
    # PETSc wants them orthonormal.
    vectors = [petsc.Vec().createWithArray(mode.copy()) for mode in np.linalg.qr(modes)[0].T]
    whole.setNearNullSpace(petsc.NullSpace().create(vectors=vectors))
    krylov = petsc.KSP().create()
    krylov.setOperators(whole)
    krylov.setType("cg")
    krylov.setNormType(petsc.KSP.NormType.UNPRECONDITIONED)
    krylov.getPC().setType("gamg")
    krylov.setTolerances(rtol=tolerance, max_it=_MOST)
    right = petsc.Vec().createWithArray(rhs.copy())
    x = petsc.Vec().createWithArray(np.zeros(shape[0]))
    krylov.solve(right, x)
    return x.getArray().copy(), int(krylov.getIterationNumber())


def _aggregation(
    matrix: sparse.csr_array, components: int, modes: Array, rhs: Array, tolerance: float
) -> tuple[Array, int]:
    """pyamg's smoothed aggregation as preconditioner of its conjugate gradients."""
    pyamg = import_module("pyamg")
    # It knows SciPy's matrices, not its arrays.
    blocks = sparse.bsr_matrix(matrix.tobsr((components, components)))
    levels = pyamg.smoothed_aggregation_solver(blocks, B=modes, symmetry="symmetric")
    residuals: list[float] = []
    x = levels.solve(rhs, tol=tolerance, accel="cg", maxiter=_MOST, residuals=residuals)
    return np.asarray(x), len(residuals) - 1


#: Name, modules to import and function of each.
PEERS: dict[str, tuple[tuple[str, ...], Solver]] = {
    # The first brings the MPI that PETSc was built for.
    "PETSc CG, GAMG with rigid modes": (("mpi4py.MPI", "petsc4py.PETSc"), _gamg),
    "pyamg CG, smoothed aggregation with rigid modes": (("pyamg",), _aggregation),
}
