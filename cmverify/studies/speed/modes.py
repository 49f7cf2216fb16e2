"""Ten modes of a free plate by LOBPCG, beside shift and invert on the assembled matrix.

The matrix is given to the others, its assembly not counted. Rotations carry no mass; a shift below
zero keeps the matrix of a free body positive definite.
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from time import process_time
from typing import Any

import numpy as np
from scipy import sparse
from threadpoolctl import threadpool_limits

from cmverify.case import Array
from cmverify.cases.modes.tetrachiral import scene
from cmverify.studies.assembled import pencil, shift_invert, superlu
from cmverify.studies.speed.measure import Timing, pardiso
from solver import Discretisation, modes

COUNT = 10


def compare(resolution: int) -> list[Timing]:
    """The tetrachiral square at 25ℓ over the resolution, m = 5, bonds ended at the surface.

    Times are CPU seconds from a scene (ours) or a matrix (the others) to ten elastic modes.
    """
    body = scene(resolution, 5, "free", "extrapolated")
    # Compiles.
    modes.solve(scene(min(28, resolution), 5, "free", "extrapolated"), COUNT)
    begun = process_time()
    found = modes.solve(body, COUNT)
    ours = process_time() - begun
    discretisation = Discretisation.of(body, free=True)
    matrix, mass = pencil(discretisation)
    squares = found.frequencies**2 * float(body.density or 0.0)
    rows = [
        Timing(
            "ours, LOBPCG two-level",
            {
                "unknowns": matrix.shape[0],
                "cpu_seconds": ours,
                "residual": float(found.residuals.max()),
                "iterations": found.statistics["iterations"],
            },
        )
    ]
    shift = -0.5 * float(squares[0])
    solvers: dict[str, Any] = {"SciPy eigsh, SuperLU": superlu}
    if find_spec("sksparse") is not None:
        solvers["SciPy eigsh, CHOLMOD"] = _cholmod
    if find_spec("pypardiso") is not None:
        solvers["SciPy eigsh, PARDISO"] = pardiso
    for name, factorise in solvers.items():
        with threadpool_limits(limits=1):
            begun = process_time()
            values, vectors = shift_invert(matrix, mass, shift, factorise, COUNT + 3)
            spent = process_time() - begun
        rows.append(_row(name, spent, ours, values, vectors, matrix, mass, squares))
    if find_spec("slepc4py") is not None:
        begun = process_time()
        values = _slepc(matrix, mass, shift)
        spent = process_time() - begun
        rows.append(_row("SLEPc, Krylov–Schur", spent, ours, values, None, matrix, mass, squares))
    return rows


def _row(
    name: str,
    spent: float,
    ours: float,
    values: Array,
    vectors: Array | None,
    matrix: sparse.csr_array,
    mass: sparse.dia_array,
    squares: Array,
) -> Timing:
    elastic = np.sort(values)[3 : 3 + COUNT]
    # Copies of double modes that Lanczos loses shift all that follow.
    lost = int((np.abs(elastic / squares - 1) > 1e-6).sum())
    found: dict[str, Any] = {"cpu_seconds": spent, "slower": spent / ours, "amiss": lost}
    if vectors is not None:
        left = matrix @ vectors[:, 3:] - (mass @ vectors[:, 3:]) * values[3:]
        size = np.linalg.norm((mass @ vectors[:, 3:]) * values[3:], axis=0)
        found["residual"] = float((np.linalg.norm(left, axis=0) / size).max())
    return Timing(name, found)


def _cholmod(matrix: sparse.csc_array) -> Any:
    return import_module("sksparse.cholmod").cholesky(sparse.csc_matrix(matrix))


def _slepc(matrix: sparse.csr_array, mass: sparse.dia_array, shift: float) -> Array:
    petsc, slepc = import_module("petsc4py.PETSc"), import_module("slepc4py.SLEPc")

    def given(entries: sparse.csr_array) -> Any:
        return petsc.Mat().createAIJ(
            size=entries.shape, csr=(entries.indptr, entries.indices, entries.data)
        )

    solver = slepc.EPS().create()
    solver.setOperators(given(matrix), given(sparse.csr_array(mass)))
    solver.setProblemType(slepc.EPS.ProblemType.GHEP)
    solver.setDimensions(COUNT + 3)
    solver.setTarget(shift)
    solver.setWhichEigenpairs(slepc.EPS.Which.TARGET_MAGNITUDE)
    transform = solver.getST()
    transform.setType(slepc.ST.Type.SINVERT)
    transform.getKSP().getPC().setType(petsc.PC.Type.CHOLESKY)
    solver.setTolerances(1e-10)
    solver.solve()
    return np.array([solver.getEigenvalue(k).real for k in range(solver.getConverged())])
