"""Fracture: a crack that grows by a tenth of its disc under mode I."""

from __future__ import annotations

from time import perf_counter
from typing import Any


class Growth:
    """Seconds, solves, iterations and bonds a solve, the load held during avalanches."""

    params = (30, 60)
    param_names = ("a over spacing",)
    timeout = 300.0

    def setup_cache(self) -> dict[int, dict[str, float]]:
        """Grow each crack once, compiled, for all the figures."""
        found = {}
        for resolution in self.params:
            self._grow(resolution, 0.02)
            begun = perf_counter()
            run = self._grow(resolution)
            found[resolution] = {
                "seconds": perf_counter() - begun,
                "solves": float(len(run.steps)),
                "iterations": float(run.steps["iterations"].mean()),
                "bonds": len(run.broken_bonds) / len(run.steps),
            }
        return found

    def _grow(self, resolution: int, advance: float = 0.1) -> Any:
        from cmverify.studies.speed.scenes import crack_tip
        from solver import Programme, Toughness, fracture

        return fracture.grow(
            crack_tip(resolution),
            Toughness(1.0),
            Programme(overload=0.02),
            no_fail=[lambda x, y: x**2 + y**2 > (1 - 5.5 / resolution) ** 2],
            until=lambda run: run.advance >= advance,
        )

    def track_seconds(self, found: dict[int, dict[str, float]], resolution: int) -> float:
        """Seconds from the scene to the grown crack."""
        return found[resolution]["seconds"]

    def track_solves(self, found: dict[int, dict[str, float]], resolution: int) -> float:
        """Equilibria that were found."""
        return found[resolution]["solves"]

    def track_iterations_a_solve(
        self, found: dict[int, dict[str, float]], resolution: int
    ) -> float:
        """Conjugate-gradient iterations a solve, on average."""
        return found[resolution]["iterations"]

    def track_bonds_a_solve(self, found: dict[int, dict[str, float]], resolution: int) -> float:
        """Bonds broken a solve, on average."""
        return found[resolution]["bonds"]
