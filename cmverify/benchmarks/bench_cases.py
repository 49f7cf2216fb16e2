"""Time, peak memory and error of the suite's timed cases at the quick level's finest spacing."""

from __future__ import annotations

import math

from cmverify.case import Level, Measurement
from cmverify.cases import registry
from cmverify.run.worker import measure, warm_up

#: Beside the method that a case features: what it is held against.
BESIDE = ("bond/lattice", "fem/P2")


def benchmarked() -> list[str]:
    """Names "case method" of what is benchmarked: of every timed case what it features, and more.

    Cases take part by being timed; none is named here.
    """
    return [
        f"{case.name} {method.name}"
        for case in registry.all_cases()
        if case.timed
        for method in case.methods
        if method.name in (case.featured, *BESIDE) and method.resolutions.get(Level.QUICK)
    ]


class Cases:
    """Any case and method: compiled in `setup`, so that no benchmark measures the compiler.

    An exception of the method fails the benchmark; so does a figure that is not a number.
    """

    params = benchmarked()
    param_names = ("case and method",)
    timeout = 300.0
    warmup_time = 0.0

    def setup(self, name: str) -> None:
        """Look the case up and compile."""
        case, method = name.split(" ", 1)
        self.case = registry.get(case)
        self.method = self.case.method(method)
        self.resolution = self.method.resolutions[Level.QUICK][-1]
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
    track_error.unit = "relative L2 error"  # type: ignore[attr-defined]


def _finite(value: float) -> float:
    if not math.isfinite(value):
        raise ArithmeticError(f"the measured figure is {value}")
    return value
