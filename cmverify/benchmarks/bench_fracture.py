"""Fracture: a crack that grows by a tenth of its disc under mode I."""

from __future__ import annotations

from time import process_time
from typing import Any


def _grow(resolution: int, advance: float = 0.1) -> Any:
    from cmverify.studies.speed.scenes import crack_tip
    from solver import Programme, Toughness, fracture

    return fracture.grow(
        crack_tip(resolution),
        Toughness(1.0),
        Programme(overload=0.02),
        no_fail=[lambda x, y: x**2 + y**2 > (1 - 5.5 / resolution) ** 2],
        until=lambda run: run.advance >= advance,
    )


class Growth:
    """CPU seconds, solves, iterations and bonds a solve, the load held during avalanches."""

    params = (30, 60)
    param_names = ("a over spacing",)
    timeout = 300.0

    def setup_cache(self) -> dict[int, dict[str, float]]:
        """Grow each crack once, compiled, for all the figures."""
        found = {}
        for resolution in self.params:
            _grow(resolution, 0.02)
            begun = process_time()
            run = _grow(resolution)
            found[resolution] = {
                "seconds": process_time() - begun,
                "solves": float(len(run.steps)),
                "iterations": float(run.steps["iterations"].mean()),
                "bonds": len(run.broken_bonds) / len(run.steps),
            }
        return found

    def track_seconds(self, found: dict[int, dict[str, float]], resolution: int) -> float:
        """CPU seconds from the scene to the grown crack."""
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


class Solve:
    """What one equilibrium of a growing crack is made of, once its bonds are known."""

    params = (60, 120)
    param_names = ("a over spacing",)
    timeout = 300.0

    def setup(self, resolution: int) -> None:
        """A crack that has just begun to grow."""
        import numpy as np

        self.run = _grow(resolution, 0.01)
        self.body, bonds = self.run.body, self.run.bonds
        records = bonds.broken.records
        last = records["bond"][records["step"] == records["step"][-1]]
        self.ends = np.concatenate(bonds.ends(last)[1:])
        # Out of balance where bonds broke last.
        near = np.isin(self.body.operator.active, self.ends)
        self.left = np.tile(near, self.body.operator.components).astype(float)
        self.following = self.body.preconditioner.following(self.body.operator)
        for part in (self.time_cycle, self.time_following, self.time_guess, self.time_rebuilt):
            part(resolution)

    def time_cycle(self, resolution: int) -> None:
        """A V-cycle with close coarse nodes."""
        self.following.matvec(self.left)

    def time_following(self, resolution: int) -> None:
        """The smoother of the bonds as they are now, on the coarse grid that there is."""
        self.body.preconditioner.following(self.body.operator)

    def time_guess(self, resolution: int) -> None:
        """Particles around the broken bonds find their balance."""
        from solver.linear import nearby

        near = nearby.around(self.body.operator, self.ends)
        nearby.change(self.body.operator, self.body.preconditioner, near, self.left)

    def time_rebuilt(self, resolution: int) -> None:
        """The operator of the bonds that are left, from the one before."""
        known = self.body.operator
        type(known)(known.bonds, known.moduli, self.body.prescribed, known)
