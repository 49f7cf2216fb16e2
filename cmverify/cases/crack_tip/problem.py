"""The crack tip in a fully anisotropic body (Sect. 2.3.1).

A disc of radius a with a slit from (-a, 0) to the centre. Displacement *and rotation* of the
asymptotic field are prescribed in a layer of 5.5 cells; faces of the slit are free: by
the volume method, as in the paper, unless a method's name has another treatment. Units: a = 1,
C = 1, stress intensity factor 1, so displacements are in K sqrt(a)/C and stresses in K/sqrt(a).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cmverify.case import Array
from cmverify.cases.common import adapters, materials
from cmverify.cases.common.scenes import cracked_disc
from cmverify.exchange.statement import Statement, Target, free_particles

if TYPE_CHECKING:
    from solver import Scene, Solution
    from solver.bonds import Surface
    from solver.material import Calibration
    from solver.problem.tips import Tip

#: C1111 = C, C2222 = 4C/5, C1122 = C/5, C1212 = C/3, C1112 = C/10, C2212 = C/6; order 11, 22, 12.
STIFFNESS = tuple(map(tuple, (materials.TENSORS["fully anisotropic"] / 100.0).tolist()))
HORIZON_CELLS = 5  # m


@dataclass(frozen=True)
class Problem:
    """Stress intensity factors of the field, and the stiffness that the solver is given.

    Tests perturb `voigt` and `scale` (of the reference); the closed form keeps the true ones.
    """

    KI: float
    KII: float
    voigt: tuple[tuple[float, ...], ...] = STIFFNESS
    scale: float = 1.0

    def displacement(self, x: Array, y: Array) -> Array:
        """(..., 2), in K sqrt(a)/C."""
        from references.analytic import lekhnitskii

        return lekhnitskii.crack_tip_displacement(STIFFNESS, x, y, self.KI, self.KII)

    def rotation(self, x: Array, y: Array) -> Array:
        """Half the curl, rad over K/(C sqrt(a))."""
        from references.analytic import lekhnitskii

        return lekhnitskii.crack_tip_rotation(STIFFNESS, x, y, self.KI, self.KII)

    def stress22(self, x: Array, y: Array) -> Array:
        """In K/sqrt(a)."""
        from references.analytic import lekhnitskii

        return lekhnitskii.crack_tip_stress(STIFFNESS, x, y, self.KI, self.KII)[..., 1]


def scene_of(
    problem: Problem, calibration: Calibration, surface: Surface, n: int, tip: Tip = "drawn"
) -> Scene:
    """The cracked disc at spacing a/n."""
    from solver import ElasticTensor, Support

    layer = Support.layer(
        cells=adapters.LAYER_CELLS,
        displacement=problem.displacement,
        rotation=problem.rotation,
    )
    return cracked_disc(
        ElasticTensor(problem.voigt),
        n,
        layer,
        m=HORIZON_CELLS,
        calibration=calibration,
        surface=surface,
        tip=tip,
    )


def solve(
    problem: Problem, calibration: Calibration, surface: Surface, n: int, tip: Tip = "drawn"
) -> Solution:
    """The bond solution at spacing a/n."""
    return scene_of(problem, calibration, surface, n, tip).solve(tolerance=1e-10)


def state(problem: Problem, n: int) -> Statement:
    """The cracked disc, and what is judged of an answer."""
    scene = scene_of(problem, "lattice", "volume", n)
    points = free_particles(scene)
    u, rotation = problem.displacement(*points.T), problem.rotation(*points.T)
    wanted = np.array([problem.KI, problem.KII])
    return Statement(
        scene,
        (
            Target("displacement", "displacement", "K√a/C", u, points=points, columns=("u1", "u2")),
            Target("rotation", "rotation", "K/(C√a)", rotation, points=points, needed=False),
            Target("K", "K", "K", wanted, needed=False),
        ),
        remarks=("Units: a = 1, C = 1, K = 1.",),
    )
