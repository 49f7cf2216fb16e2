"""The static solve: seconds, iterations and peak memory of the two-level method."""

from __future__ import annotations

import os
import subprocess
import sys
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np

from cmverify.studies.speed import peers

# CPU seconds of a first solve in a process, its import left out.
_FIRST_USE = """
from time import process_time
from solver import ElasticTensor, Scene, Support, rectangle
ready = process_time()
held = Support.layer(cells=3.5, displacement=(0.01, 0.0))
Scene(rectangle(2.0, 1.0), 0.05, ElasticTensor.isotropic(10.0, 0.25), [held], m=3).solve()
print(process_time() - ready)
"""


class FirstUse:
    """A plate of 40 by 20 cells in a process of its own, with kernels on disk or without."""

    params = ("none", "kept")
    param_names = ("kernels",)
    timeout = 300.0

    def track_cpu_seconds(self, kernels: str) -> float:
        """CPU seconds from the scene to the solution, kernels compiled or found."""
        with TemporaryDirectory() as folder:
            for _ in range(1 if kernels == "none" else 2):
                done = subprocess.run(
                    [sys.executable, "-c", _FIRST_USE],
                    env=os.environ | {"NUMBA_CACHE_DIR": folder},
                    capture_output=True,
                    text=True,
                    check=True,
                )
        return float(done.stdout)

    track_cpu_seconds.unit = "s"  # type: ignore[attr-defined]


class CrackTip:
    """Crack tip, mode I, to 1e-8; the set-up of the preconditioner is part of it."""

    params = (60, 120)
    param_names = ("a over spacing",)
    timeout = 120.0

    def setup(self, resolution: int) -> None:
        """Compile, and keep the scene."""
        from cmverify.studies.speed.scenes import crack_tip

        self.scene = crack_tip(resolution)
        self.scene.solve(1e-8)

    def time_solve(self, resolution: int) -> None:
        """Seconds from the scene to the solution."""
        self.scene.solve(1e-8)

    def peakmem_solve(self, resolution: int) -> None:
        """Peak resident memory."""
        self.scene.solve(1e-8)

    def track_iterations(self, resolution: int) -> int:
        """Conjugate-gradient iterations."""
        return self.scene.solve(1e-8).statistics.iterations

    def track_products_a_solve(self, resolution: int) -> float:
        """CPU seconds of a solve over those of one product: what the method costs."""
        operator = self.scene.discretise().operator
        x = operator.matvec(operator.block_diagonal[:, 0, :].T.ravel())
        begun = process_time()
        for _ in range(20):
            operator.matvec(x)
        product = (process_time() - begun) / 20
        begun = process_time()
        self.scene.solve(1e-8)
        return (process_time() - begun) / product

    track_iterations.unit = "iterations"  # type: ignore[attr-defined]
    track_products_a_solve.unit = "products"  # type: ignore[attr-defined]


class StrongAnisotropy:
    """Conductors of ratio 100 and 1000 and a turned ply: coarse grids along the strong axis."""

    params = (
        ["carbon/epoxy at 30°, hole", "heat, ratio 1000", "heat, ratio 100 at π/8"],
        [60, 120],
    )
    param_names = ("scene", "a over spacing")
    timeout = 120.0

    def setup(self, name: str, resolution: int) -> None:
        """Compile, and keep the scene."""
        from cmverify.studies.speed.scenes import static_scenes

        self.problem = static_scenes(resolution)[name].discretise()
        self.track_iterations(name, resolution)

    def time_solve(self, name: str, resolution: int) -> None:
        """Seconds, set-up of the preconditioner included."""
        self.track_iterations(name, resolution)

    def track_iterations(self, name: str, resolution: int) -> int:
        """Conjugate-gradient iterations to 1e-8, the same at any size."""
        from solver.analyses.statics import solve

        return solve(self.problem, 1e-8, preconditioning="two-level").statistics.iterations

    track_iterations.unit = "iterations"  # type: ignore[attr-defined]


class SmallProblem:
    """Heat on a body too small for a second thread."""

    params = (1, 2)
    param_names = ("threads at hand",)

    def setup(self, threads: int) -> None:
        """Compile, and keep the problem; skipped where there are fewer threads."""
        import numba

        from cmverify.studies.speed.scenes import static_scenes

        if threads > numba.get_num_threads():
            raise NotImplementedError
        self.problem = static_scenes(100)["heat, isotropic"].discretise()
        self.track_cpu_seconds(threads)

    def track_cpu_seconds(self, threads: int) -> float:
        """CPU seconds of all threads for a solve."""
        import numba

        from solver.analyses.statics import solve

        before = numba.get_num_threads()
        numba.set_num_threads(threads)
        try:
            begun = process_time()
            solve(self.problem, 1e-8)
            return process_time() - begun
        finally:
            numba.set_num_threads(before)

    track_cpu_seconds.unit = "s"  # type: ignore[attr-defined]


class CalibratedTip:
    """Crack tip, mode I, with a calibrated tip at half the resolution; and the calibration."""

    params = (30, 60)
    param_names = ("a over spacing",)
    timeout = 120.0

    def setup(self, resolution: int) -> None:
        """Compile, calibrate, and keep the scene."""
        from dataclasses import replace

        from cmverify.studies.speed.scenes import crack_tip

        self.scene = replace(crack_tip(resolution), surface="extrapolated", tip="calibrated")
        self.scene.solve(1e-8)

    def time_solve(self, resolution: int) -> None:
        """Seconds from the scene to the solution, the calibration known."""
        self.scene.solve(1e-8)

    def time_calibration(self, resolution: int) -> None:
        """Seconds of the same with the calibration."""
        from solver.tips import calibration

        calibration._calibrated.cache_clear()
        self.scene.solve(1e-8)


class Scale:
    """What a particle costs as the lattice grows."""

    params = (120, 480)
    param_names = ("a over spacing",)
    timeout = 300.0

    def setup(self, resolution: int) -> None:
        """Compile, and keep the scene."""
        from cmverify.studies.speed.scenes import crack_tip

        crack_tip(30).solve(1e-8)
        self.scene = crack_tip(resolution)

    def track_cost(self, resolution: int) -> float:
        """CPU time a particle, set-up and solve."""
        begun = process_time()
        found = self.scene.solve(1e-8)
        return 1e6 * (process_time() - begun) / found.statistics.particles

    def peakmem_solve(self, resolution: int) -> None:
        """Peak resident memory."""
        self.scene.solve(1e-8)

    track_cost.unit = "µs"  # type: ignore[attr-defined]


class LinearAlgebra:
    """Building a body with bonds that end at the surface, while BLAS has threads at hand."""

    timeout = 120.0

    def track_ratio(self) -> float:
        """CPU seconds with all of them over those with one: more only where a part escapes."""
        from dataclasses import replace

        from threadpoolctl import threadpool_limits

        from cmverify.studies.speed.scenes import static_scenes

        plate = replace(static_scenes(120)["plate with a hole"], surface="extrapolated")
        spent = []
        for limit in (1, 1, None):  # the first compiles
            with threadpool_limits(limits=limit, user_api="blas"):
                begun = process_time()
                plate.discretise()
                spent.append(process_time() - begun)
        return spent[2] / spent[1]


class Peers:
    """What others take over what we take, where they are installed."""

    params = (
        ["crack tip", "heat"],
        ["SciPy CG, block Jacobi, CSR", "MKL PARDISO", *peers.PEERS],
    )
    param_names = ("scene", "solver")
    timeout = 600.0

    def setup_cache(self) -> dict[str, dict[str, float]]:
        """All of them in one run."""
        from cmverify.studies.speed import measure

        found = {"crack tip": measure.solvers(60, repeats=1), "heat": measure.heat(60, repeats=1)}
        return {
            scene: {row.name: float(row.values["slower"]) for row in rows}
            for scene, rows in found.items()
        }

    def setup(self, found: dict[str, dict[str, float]], scene: str, solver: str) -> None:
        """Skipped where a solver is not installed."""
        if solver not in found[scene]:
            raise NotImplementedError

    def track_ratio(self, found: dict[str, dict[str, float]], scene: str, solver: str) -> float:
        """CPU seconds over the bond solver's, assembly included."""
        return found[scene][solver]


class VCycle:
    """One application of the two-level preconditioner, in single and in double precision."""

    params = ([60, 120], ["float32", "float64"])
    param_names = ("a over spacing", "precision")
    timeout = 120.0

    def setup(self, resolution: int, precision: str) -> None:
        """Build the preconditioner of the crack tip and compile."""
        from cmverify.studies.speed.scenes import crack_tip
        from solver.linear import TwoLevel

        operator = crack_tip(resolution).discretise().operator
        self.inverse = TwoLevel(operator, precision=getattr(np, precision))
        self.residual = np.random.default_rng(1).normal(size=operator.shape[0])
        self.inverse.matvec(self.residual)

    def time_v_cycle(self, resolution: int, precision: str) -> None:
        """Seconds."""
        self.inverse.matvec(self.residual)


# Not SetUp: asv takes a name that reads like setup for the module's own.
class Preparation:
    """The coarse matrix of the crack tip, and all before the iterations of a plate with a hole."""

    params = (50, 100, 200, 400)
    param_names = ("a over spacing",)
    timeout = 120.0

    def setup(self, resolution: int) -> None:
        """Compile, and keep scenes and hats."""
        from dataclasses import replace

        from cmverify.studies.speed.scenes import crack_tip, static_scenes
        from solver.linear import Hats

        self.hats = Hats(crack_tip(resolution).discretise().operator, 8)
        plate = static_scenes(resolution)["plate with a hole"]
        self.plates = {
            surface: replace(plate, surface=surface) for surface in ("volume", "extrapolated")
        }
        for plate in self.plates.values():
            plate.solve(1e-8)
        self.hats.galerkin()

    def time_galerkin(self, resolution: int) -> None:
        """Seconds of the coarse matrix."""
        self.hats.galerkin()

    def track_setup_over_solve(self, resolution: int) -> float:
        """CPU seconds before the iterations over those of them to 1e-10; the larger of both."""
        from solver.analyses.statics import solve
        from solver.linear import Task, TwoLevel, method

        ratios = []
        for plate in self.plates.values():
            solve(plate.discretise(constrained=True), 1e-10)
            begun = process_time()
            problem = plate.discretise(constrained=True)
            rhs, inverse = problem.right_hand_side(), TwoLevel(problem.operator)
            ready = process_time()
            task = Task(rhs, np.zeros_like(rhs), 1e-10, 1000)
            method.iterate(problem.operator, problem.stability.kind, inverse, task)
            ratios.append((ready - begun) / (process_time() - ready))
        return max(ratios)

    def track_extrapolated_over_volume(self, resolution: int) -> float:
        """CPU seconds with bonds that end at the surface over those with volume factors."""
        spent = {}
        for surface, plate in self.plates.items():
            begun = process_time()
            plate.solve(1e-8)
            spent[surface] = process_time() - begun
        return spent["extrapolated"] / spent["volume"]
