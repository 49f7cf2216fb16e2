"""Time, peak memory and error of the suite's timed cases.

All of them at the quick level's finest spacing; those of an analysis beyond statics (modes,
transients, waves) at the standard level's too, with what it spends in its own unit of work.
"""

from __future__ import annotations

import math

from cmverify.case import Level, Measurement
from cmverify.cases import registry
from cmverify.run.worker import measure, warm_up
from solver.analyses import analyses

#: Beside the method that a case features: what it is held against.
BESIDE = ("bond/lattice", "fem/P2")
#: What a measurement may say of its work: the first that it does say is tracked.
WORK = ("products a step", "iterations a step", "iterations")


def benchmarked(level: Level, tags: frozenset[str] | None = None) -> list[str]:
    """Names "case method" of what is benchmarked: of every timed case what it features, and more.

    Cases take part by being timed, and by one of `tags` where these are given; none is named here.
    """
    return [
        f"{case.name} {method.name}"
        for case in registry.all_cases()
        if case.timed and (tags is None or tags & set(case.tags))
        for method in case.methods
        if method.name in (case.featured, *BESIDE) and method.resolutions.get(level)
    ]


class Cases:
    """Any case and method: compiled in `setup`, so that no benchmark measures the compiler.

    An exception of the method fails the benchmark; so does a figure that is not a number.
    """

    level = Level.QUICK
    params = benchmarked(level)
    param_names = ("case and method",)
    timeout = 300.0
    warmup_time = 0.0

    def setup(self, name: str) -> None:
        """Look the case up and compile."""
        case, method = name.split(" ", 1)
        self.case = registry.get(case)
        self.method = self.case.method(method)
        self.resolution = self.method.resolutions[self.level][-1]
        warm_up(self.method)

    def time_case(self, name: str) -> None:
        """The whole measurement: set-up, solve, recovery, norms."""
        self.method.run(self.resolution)

    def peakmem_case(self, name: str) -> None:
        """Peak resident memory of the process."""
        self.method.run(self.resolution)

    def track_solve(self, name: str) -> float:
        """Set-up and solve alone, as the report plots them; the best of three."""
        return min(_finite(self._measure().total_seconds) for _ in range(3))

    def track_error(self, name: str) -> float:
        """The case's primary error."""
        return _finite(self._measure().quantities[self.case.primary])

    def _measure(self) -> Measurement:
        return measure(self.method, self.resolution)

    track_solve.unit = "seconds"  # type: ignore[attr-defined]
    track_error.unit = "relative error"  # type: ignore[attr-defined]


class Analyses(Cases):
    """The cases of modes, transients and waves at the standard level's finest spacing.

    They take part by a tag that is an analysis's name in the registry. ``fracture`` is a topic of
    static cases too; growth has benchmarks of its own (`bench_fracture`).
    """

    level = Level.STANDARD
    params = benchmarked(level, frozenset(analyses()) - {"fracture"})

    def track_work(self, name: str) -> float:
        """Block iterations of modes, Krylov iterations or products of a step in time."""
        statistics = self._measure().statistics
        said = [statistics[unit] for unit in WORK if unit in statistics]
        if not said:
            raise LookupError(f"{name} says nothing of its work: one of {', '.join(WORK)}")
        return _finite(float(said[0]))

    track_work.unit = "iterations or products"  # type: ignore[attr-defined]


def _finite(value: float) -> float:
    if not math.isfinite(value):
        raise ArithmeticError(f"the measured figure is {value}")
    return value
