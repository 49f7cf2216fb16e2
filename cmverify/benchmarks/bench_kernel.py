"""The matrix-free product: seconds, and directed bonds a second."""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from solver import Scene

#: Most particles of the bulk; one unknown; beyond the caches; special particles only.
SCENES = ["crack tip a/120", "conduction a/120", "crack tip a/480", "special particles a/120"]


def _scene(name: str) -> Scene:
    """Scenes of the suite at 45,244 particles or more, with data that cost nothing to evaluate."""
    from cmverify.cases import crack_tip, disc
    from cmverify.cases.common.scenes import cracked_disc
    from solver import ConductivityTensor, Cosine, ElasticTensor, Scene, Support
    from solver import disc as disc_region

    resolution = int(name.rpartition("/")[2])
    region, spacing = disc_region(1.0), 1.0 / resolution
    if not name.startswith("conduction"):
        held = Support.layer(cells=5.5, displacement=(0.0, 0.0), rotation=0.0)
        scene = cracked_disc(ElasticTensor(crack_tip.STIFFNESS), resolution, held, m=5)
        # Every bond has a factor of its own, as beside edges and cracks.
        return replace(scene, factors=_sound) if name.startswith("special") else scene
    held = Support.layer(cells=5.5, temperature=0.0)
    conductor = ConductivityTensor(disc.CONDUCTIVITY)
    law = Cosine(disc.EXPONENT)
    return Scene(region, spacing, conductor, [held], m=5, calibration="positive", law=law)


def _sound(bonds: Any, moduli: Any) -> Any:
    from solver.bonds.factors import Factors

    return Factors(bonds.strengths_of(np.arange(bonds.lattice.count)))


class Product:
    """One product with the stiffness of all free particles."""

    params = SCENES
    param_names = ("scene",)
    timeout = 120.0

    def setup(self, scene: str) -> None:
        """Build the operator and compile its kernel."""
        built = _scene(scene).discretise()
        self.operator = built.operator
        self.bonds = built.operator.directed_bonds
        self.x = np.random.default_rng(1).normal(size=self.operator.shape[0])
        self.operator @ self.x

    def time_product(self, scene: str) -> None:
        """Seconds a product."""
        self.operator @ self.x

    def peakmem_product(self, scene: str) -> None:
        """Peak resident memory with nothing but the operator and two vectors."""
        self.operator @ self.x

    def track_bonds_per_second(self, scene: str) -> float:
        """Directed bonds a second, the best of several batches."""
        best = np.inf
        for _ in range(7):
            start = perf_counter()
            for _ in range(5):
                y = self.operator @ self.x
            best = min(best, (perf_counter() - start) / 5)
        if not np.all(np.isfinite(y)):
            raise ArithmeticError("the product is not finite")
        return self.bonds / best

    track_bonds_per_second.unit = "directed bonds/s"  # type: ignore[attr-defined]
