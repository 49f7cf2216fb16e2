"""Speed of the bond solver beside what one would otherwise use, as ratios taken in one run.

Everything is measured on the crack-tip problem (Sect. 2.3.1): the product with the stiffness
against SciPy's sparse formats, the whole static solve against assembled alternatives, and the
solve's growth with the number of particles. Times of solvers are CPU seconds (all threads), so
that a threaded code gains nothing by being threaded.
"""

from __future__ import annotations

import resource
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from itertools import chain
from statistics import median
from time import perf_counter, process_time
from typing import Any, get_args

import numba
import numpy as np
from scipy import sparse
from threadpoolctl import threadpool_limits

from cmverify.case import Array
from cmverify.cases.crack_tip import STIFFNESS
from cmverify.studies.assembled import conjugate_gradients
from cmverify.studies.speed import peers
from cmverify.studies.speed.scenes import crack_tip, kernel_scenes, static_scenes
from references.analytic import lekhnitskii
from solver import Discretisation, Scene
from solver.analyses.statics import solve
from solver.bonds import Surface
from solver.linear import Task, TwoLevel, method
from solver.operators.assembled import to_csr


@dataclass(frozen=True)
class Timing:
    """One line of a comparison: what, and its measured values."""

    name: str
    values: dict[str, Any]

    def as_dict(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        return asdict(self)


def _timed(products: dict[str, Callable[[], Any]], rounds: int = 25) -> dict[str, float]:
    """Median seconds of a call of each, taken in turns: a drifting machine drifts for all."""
    for product in products.values():
        product()
    times: dict[str, list[float]] = {name: [] for name in products}
    for _ in range(rounds):
        for name, product in products.items():
            # The first call finds its data in memory, the others in the caches they leave.
            product()
            begun = perf_counter()
            for _ in range(3):
                product()
            times[name].append((perf_counter() - begun) / 3)
    return {name: median(samples) for name, samples in times.items()}


def _with_threads(count: int, product: Callable[[], Any]) -> Any:
    """Call `product` on that many threads."""
    numba.set_num_threads(count)
    return product()


def _sparse_formats(matrix: sparse.csr_array, components: int) -> dict[str, tuple[Any, int]]:
    """Product callables' matrices and their bytes: CSR, symmetric CSR, blocked."""

    def size(*matrices: Any) -> int:
        return sum(m.data.nbytes + m.indices.nbytes + m.indptr.nbytes for m in matrices)

    count = matrix.shape[0] // components
    order = np.arange(matrix.shape[0]).reshape(components, count).T.ravel()
    blocked = matrix[order][:, order].tobsr((components, components))
    upper = sparse.triu(matrix, format="csr")
    strict = sparse.triu(matrix, 1, format="csr").T  # a CSC view of the same numbers
    return {
        "SciPy CSR": (matrix.__matmul__, size(matrix)),
        "SciPy CSR, upper half": (lambda x: upper @ x + strict @ x, size(upper)),
        f"SciPy BSR {components}×{components}": (blocked.__matmul__, size(blocked)),
    }


def kernel(resolution: int = 120) -> list[Timing]:
    """Products on one thread (and on all), against SciPy's formats of the same matrix.

    Returns
    -------
    list of Timing
        Values: ``ms`` a product, ``bonds_per_s`` (directed), ``bytes`` that a product reads
        besides the fields, ``bytes_per_s``, ``slower`` (time over the matrix-free product's,
        one thread each), ``memory`` (bytes over the matrix-free operator's), ``error`` (largest
        difference of the products, relative).
    """
    rows = []
    threads = numba.get_num_threads()
    for kind, scene in kernel_scenes(resolution).items():
        operator = scene.discretise().operator
        x = np.random.default_rng(1).normal(size=operator.shape[0])
        exact, c = operator.matvec(x), operator.components
        formats = _sparse_formats(to_csr(operator), c)
        interleaved = x.reshape(c, -1).T.ravel()
        given = {name: interleaved if "BSR" in name else x for name in formats}
        own = partial(operator.matvec, x)
        several = f"matrix-free, {threads} threads"
        one = partial(_with_threads, 1, own)
        try:
            # Apart from the formats, which stream through the caches: their turns would be
            # measured, not the threads.
            pair = _timed({"matrix-free": one, several: partial(_with_threads, threads, own)})
            numba.set_num_threads(1)
            rest = {name: partial(f[0], given[name]) for name, f in formats.items()}
            seconds = _timed({"matrix-free": own, **rest})
        finally:
            numba.set_num_threads(threads)
        taken_and_base = {name: (t, pair["matrix-free"]) for name, t in pair.items()}
        taken_and_base |= {name: (seconds[name], seconds["matrix-free"]) for name in formats}
        sizes = {name: size for name, (_, size) in formats.items()}
        for name, (taken, base) in taken_and_base.items():
            size, error = sizes.get(name, operator.nbytes), 0.0
            if name in formats:
                y = formats[name][0](given[name])
                y = y.reshape(-1, c).T.ravel() if "BSR" in name else y
                error = float(np.abs(y - exact).max() / np.abs(exact).max())
            values = {
                "ms": 1e3 * taken,
                "bonds_per_s": operator.directed_bonds / taken,
                "bytes": size,
                "bytes_per_s": (size + 16 * x.size) / taken,
                "slower": taken / base,
                "memory": size / operator.nbytes,
                "error": error,
                "threads": threads if name == several else 1,
            }
            rows.append(Timing(f"{kind}: {name}", values))
    return rows


def preconditioner(resolution: int = 120, repeats: int = 5) -> list[Timing]:
    """Conjugate gradients with the V-cycle in either precision, on the crack tip.

    Returns
    -------
    list of Timing
        Values: ``v_cycle_ms``, ``solve_ms`` (CPU, set-up not counted), ``slower`` than single
        precision, ``iterations`` to residuals of 1e-8 and 1e-12.
    """
    problem = crack_tip(resolution).discretise()
    operator, rhs = problem.operator, problem.right_hand_side()
    methods = {
        name: TwoLevel(operator, precision=precision)
        for name, precision in (("single precision", np.float32), ("double", np.float64))
    }
    cycles: dict[str, list[float]] = {name: [] for name in methods}
    solves: dict[str, list[float]] = {name: [] for name in methods}
    counts: dict[str, list[int]] = {}
    with threadpool_limits(limits=1, user_api="blas"):
        for _ in range(repeats):
            for name, inverse in methods.items():
                begun = process_time()
                inverse.matvec(rhs)
                middle = process_time()
                tasks = [Task(rhs, np.zeros_like(rhs), tol, 200) for tol in (1e-8, 1e-12)]
                counts[name] = [
                    method.iterate(operator, "positive", inverse, task)[1] for task in tasks
                ]
                cycles[name].append(middle - begun)
                solves[name].append(process_time() - middle)
    base = median(solves["single precision"])
    return [
        Timing(
            name,
            {
                "v_cycle_ms": 1e3 * median(cycles[name]),
                "solve_ms": 1e3 * median(solves[name]),
                "slower": median(solves[name]) / base,
                "iterations": counts[name][0],
                "iterations to 1e-12": counts[name][1],
            },
        )
        for name in methods
    ]


def scenes(resolution: int = 60, tolerance: float = 1e-8) -> list[Timing]:
    """Iterations of the two-level method on bodies with holes, notches and curved cracks.

    Returns
    -------
    list of Timing
        Values: ``particles``, ``method``, ``iterations``, ``residual``, ``setup_s``, ``solve_s``.
    """
    rows = []
    for name, scene in static_scenes(resolution).items():
        found = scene.solve(tolerance, preconditioning="two-level").statistics
        rows.append(
            Timing(
                name,
                {
                    "particles": found.particles,
                    "method": found.method,
                    "iterations": found.iterations,
                    "residual": found.residual,
                    "setup_s": found.setup_seconds,
                    "solve_s": found.solve_seconds,
                },
            )
        )
    return rows


def surfaces(resolution: int = 60, tolerance: float = 1e-8) -> list[Timing]:
    """What the treatment of surfaces costs, beside none, on bodies with and without free surfaces.

    Returns
    -------
    list of Timing
        Values: ``iterations``, ``setup_s`` (preconditioner included), ``cpu_s``, ``product_ms``,
        ``bytes`` that a product reads, and their ratios to those of the scene without treatment.
    """
    every = static_scenes(resolution)
    chosen = [
        "crack tip",
        "plate, clamped and pulled",
        "plate with a hole",
        "notched plate with a hole",
        "edge crack",
        "curved crack",
        "heat, isotropic",
    ]
    rows = []
    for name in chosen:
        bare: dict[str, Any] = {}
        for treatment in get_args(Surface):
            scene = replace(every[name], surface=treatment)
            begun = process_time()
            found = scene.solve(tolerance, preconditioning="two-level")
            spent = process_time() - begun
            operator = found.discretisation.operator
            x = np.cos(1.7 * np.arange(operator.shape[0]))
            product = _timed({"product": partial(operator.matvec, x)}, rounds=7)["product"]
            values = {
                "iterations": found.statistics.iterations,
                "setup_s": found.statistics.setup_seconds,
                "cpu_s": spent,
                "product_ms": 1e3 * product,
                "bytes": operator.nbytes,
            }
            bare = bare or values
            ratios = {f"{key} ÷ none": value / bare[key] for key, value in values.items()}
            rows.append(Timing(f"{name}: {treatment}", values | ratios))
    return rows


def solvers(
    resolution: int = 120,
    tolerance: float = 1e-8,
    repeats: int = 3,
    scene: Scene | None = None,
) -> list[Timing]:
    """The whole static solve against assembled alternatives, to the same residual, in turns.

    Set-up and assembly are included, compilation is not. PARDISO (`pypardiso`, extra ``bench``)
    and algebraic multigrid (`peers`) appear where they are installed.

    Parameters
    ----------
    scene : Scene, optional
        Solved instead of the crack tip.

    Returns
    -------
    list of Timing
        Medians: ``cpu_s`` (all threads), ``wall_s``, ``slower`` (CPU seconds over the bond solver's
        of the same round), ``iterations``, ``residual``; of assembled matrices also the time that
        they took and the ratio without it.
    """
    scene = crack_tip(resolution) if scene is None else scene
    scene.solve(tolerance)
    problem = scene.discretise()
    rhs = problem.right_hand_side()
    rounds: dict[str, list[peers.Run]] = {}
    # One thread of BLAS: CPU seconds then hold no waiting for others.
    with threadpool_limits(limits=1, user_api="blas"):
        for _ in range(repeats):
            every = (
                _own(scene, tolerance),
                _scipy_cg(problem, tolerance),
                _pardiso(problem),
                peers.runs(problem, tolerance),
            )
            for run in chain.from_iterable(every):
                rounds.setdefault(run.name, []).append(run)
    base = next(iter(rounds.values()))
    rows = []
    for name, runs in rounds.items():
        values: dict[str, Any] = {
            "cpu_s": median(run.cpu for run in runs),
            "wall_s": median(run.wall for run in runs),
            "slower": median(run.cpu / own.cpu for run, own in zip(runs, base, strict=True)),
            "iterations": runs[-1].iterations,
            "residual": float(
                np.linalg.norm(rhs - problem.operator.matvec(runs[-1].x)) / np.linalg.norm(rhs)
            ),
        }
        if runs[-1].assembly:
            values["assembly_s"] = median(run.assembly for run in runs)
            values["matrix given ÷ ours"] = median(
                run.solving / own.cpu for run, own in zip(runs, base, strict=True)
            )
        rows.append(Timing(name, values))
    return rows


def heat(resolution: int = 120, tolerance: float = 1e-8, repeats: int = 3) -> list[Timing]:
    """`solvers` for an isotropic conductor, one unknown a particle."""
    return solvers(resolution, tolerance, repeats, static_scenes(resolution)["heat, isotropic"])


def _own(scene: Scene, tolerance: float) -> Iterator[peers.Run]:
    """The bond solver from the scene on, on one thread and on all."""
    threads = numba.get_num_threads()
    for count in dict.fromkeys((1, threads)):
        numba.set_num_threads(count)
        try:
            wall, cpu = perf_counter(), process_time()
            found = scene.solve(tolerance)
            spent, taken = process_time() - cpu, perf_counter() - wall
        finally:
            numba.set_num_threads(threads)
        name = f"bond solver, two-level CG, {count} thread{'s' * (count > 1)}"
        x = found.unknowns[:, found.discretisation.operator.active].ravel()
        yield peers.Run(name, x, found.statistics.iterations, 0.0, spent, taken)


def _scipy_cg(problem: Discretisation, tolerance: float) -> Iterator[peers.Run]:
    """SciPy CG with block Jacobi on the CSR matrix."""
    wall, cpu = perf_counter(), process_time()
    matrix = to_csr(problem.operator)
    assembled = process_time()
    x, iterations = conjugate_gradients(problem, matrix, tolerance, 5000)
    end = process_time()
    taken = perf_counter() - wall
    name = "SciPy CG, block Jacobi, CSR"
    yield peers.Run(name, x, iterations, assembled - cpu, end - assembled, taken)


def pardiso(matrix: sparse.sparray) -> Callable[[Array], Array]:
    """Factorise a positive definite matrix by MKL PARDISO; returns what solves with the factors.

    Its mode for such matrices (2) takes the upper triangle, and half the time of the general one.
    """
    solver = import_module("pypardiso").PyPardisoSolver(mtype=2)
    upper = sparse.csr_matrix(sparse.triu(matrix, format="csr"))
    solver.factorize(upper)
    return lambda right: np.asarray(solver.solve(upper, right))


def _pardiso(problem: Discretisation) -> Iterator[peers.Run]:
    """MKL PARDISO through pypardiso, where it is installed."""
    if find_spec("pypardiso") is None:
        return
    rhs = problem.right_hand_side()
    wall, cpu = perf_counter(), process_time()
    matrix = to_csr(problem.operator)
    assembled = process_time()
    x = pardiso(matrix)(rhs)
    end = process_time()
    taken = perf_counter() - wall
    yield peers.Run("MKL PARDISO", x, 0, assembled - cpu, end - assembled, taken)


def growth(resolutions: tuple[int, ...], tolerance: float = 1e-8) -> list[Timing]:
    """Set-up and solve as the lattice is refined, smallest first (peak memory only grows).

    Returns
    -------
    list of Timing
        Values: ``particles``, ``unknowns``, ``iterations``, ``setup_s``, ``solve_s``,
        ``us_per_particle``, ``peak_gb`` (of the process so far), ``error`` (relative L2 against
        the closed form).
    """
    rows = []
    crack_tip(resolutions[0]).solve(tolerance)
    for resolution in resolutions:
        scene = crack_tip(resolution)
        begun = perf_counter()
        solution = solve(scene.discretise(), tolerance, preconditioning="two-level")
        wall = perf_counter() - begun
        free = ~solution.prescribed
        x, y = solution.points[free].T
        exact = lekhnitskii.crack_tip_displacement(STIFFNESS, x, y, 1.0, 0.0)
        error = np.linalg.norm(solution.displacement[free] - exact) / np.linalg.norm(exact)
        statistics = solution.statistics
        rows.append(
            Timing(
                f"a/{resolution}",
                {
                    "particles": statistics.particles,
                    "unknowns": statistics.unknowns,
                    "iterations": statistics.iterations,
                    "residual": statistics.residual,
                    "setup_s": statistics.setup_seconds,
                    "solve_s": statistics.solve_seconds,
                    "us_per_particle": 1e6 * wall / statistics.particles,
                    "peak_gb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
                    "error": float(error),
                },
            )
        )
    return rows
