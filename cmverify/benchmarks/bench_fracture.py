"""Fracture: a crack that grows by a tenth of its disc under mode I."""

from __future__ import annotations

from typing import Any


class Growth:
    """Seconds, solves, iterations and bonds a solve, the load held during avalanches."""

    params = (60, 120)
    param_names = ("a over spacing",)
    timeout = 300.0

    def setup(self, resolution: int) -> None:
        """Compile, and keep the scene."""
        from cmverify.speed.scenes import crack_tip

        self.scene = crack_tip(resolution)
        self._grow(resolution, 0.02)

    def _grow(self, resolution: int, advance: float = 0.1) -> Any:
        from solver import Programme, Toughness, fracture

        return fracture.grow(
            self.scene,
            Toughness(1.0),
            Programme(overload=0.02),
            no_fail=[lambda x, y: x**2 + y**2 > (1 - 5.5 / resolution) ** 2],
            until=lambda run: run.advance >= advance,
        )

    def time_growth(self, resolution: int) -> None:
        """Seconds from the scene to the grown crack."""
        self._grow(resolution)

    def track_solves(self, resolution: int) -> int:
        """Equilibria that were found."""
        return len(self._grow(resolution).steps)

    def track_iterations_a_solve(self, resolution: int) -> float:
        """Conjugate-gradient iterations a solve, on average."""
        return float(self._grow(resolution).steps["iterations"].mean())

    def track_bonds_a_solve(self, resolution: int) -> float:
        """Bonds broken a solve, on average."""
        run = self._grow(resolution)
        return len(run.broken_bonds) / len(run.steps)
