"""What coupled fields cost, and that they cost nothing where nobody asks for them."""

from __future__ import annotations

from time import process_time
from typing import Any


class Uncoupled:
    """One physics alone, small enough that set-up counts: seconds, and what is stored."""

    params = ("elasticity", "conduction", "fracture")
    param_names = ("physics",)
    timeout = 120.0

    def setup(self, physics: str) -> None:
        """Compile, and keep the scene."""
        from cmverify.studies.speed.scenes import crack_tip, kernel_scenes

        name = "conductive, 1 unknown"
        self.scene = kernel_scenes(60)[name] if physics == "conduction" else crack_tip(60)
        self._run(physics)

    def _run(self, physics: str) -> Any:
        from solver import Programme, Toughness, fracture

        if physics != "fracture":
            return self.scene.solve(1e-8)
        return fracture.grow(
            self.scene,
            Toughness(1.0),
            Programme(overload=0.02),
            no_fail=[lambda x, y: x**2 + y**2 > (1 - 5.5 / 60) ** 2],
            max_solves=12,
        )

    def time_it(self, physics: str) -> None:
        """Seconds from the scene to its solution, or to twelve equilibria of its crack."""
        self._run(physics)

    def track_bytes(self, physics: str) -> int:
        """Memory of the bonds and of what a product reads."""
        return int(self.scene.discretise().operator.nbytes)

    track_bytes.unit = "bytes"  # type: ignore[attr-defined]


class Sensing:
    """A sensor beside the mechanics of a growing crack in bone."""

    timeout = 120.0

    def track_share(self) -> float:
        """CPU time of the readings over that of the mechanics; a fifth at most is asked."""
        from cmverify.cases.experiments.bone import Specimen
        from cmverify.cases.sensing import Conductor

        shares = []
        for _ in range(2):  # the first compiles
            sensor, spent = Conductor().sensor(2), [0.0]

            def read(run: Any, sensor: Any = sensor, spent: list[float] = spent) -> float:
                begun = process_time()
                drop = float(sensor(run))
                spent[0] += process_time() - begun
                return drop

            begun = process_time()
            Specimen().led(2, monitors={"drop": read})
            shares.append(spent[0] / (process_time() - begun - spent[0]))
        return shares[-1]


class Strained:
    """A strained conductor beside the plain one."""

    timeout = 120.0

    def track_ratio(self) -> float:
        """CPU time of scene and solution, strained over plain."""
        from solver import (
            ElasticTensor,
            ElectricConductivityTensor,
            Piezoresistance,
            Scene,
            Support,
            rectangle,
            strained,
        )

        def times(scene: Any) -> float:
            scene.solve(1e-8)
            begun = process_time()
            scene.solve(1e-8)
            return process_time() - begun

        square, held = rectangle(1.0, 1.0), {"displacement": lambda x, y: 1e-3 * _pair(x, y)}
        state = Scene(square, 0.01, ElasticTensor.isotropic(1.0, 0.2),
                      [Support.layer(3.5, **held)], m=3).solve(1e-8)  # fmt: skip
        plain = Scene(square, 0.01, ElectricConductivityTensor.isotropic(1.0),
                      [Support.layer(3.5, potential=lambda x, y: x)], m=3)  # fmt: skip
        return times(strained(plain, state, Piezoresistance(2.0))) / times(plain)


def _pair(x: Any, y: Any) -> Any:
    import numpy as np

    return np.stack([x, -y], axis=-1)
