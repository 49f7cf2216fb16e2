"""What a process compiles or loads before anything is timed: each kind of work once, on little.

Kernels do not depend on the material, the calibration or m, so that one small body a kind of work
serves every case. Two sizes where the solver takes two ways: below 2,000 unknowns it factorises.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from solver import Scene
    from solver.bonds import Surface


def _square(n: int, conductive: bool, surface: Surface, nu: float = 0.2, **settings: Any) -> Scene:
    """A unit square, held by a linear field in its outer layer, with a hole and an edge crack."""
    from solver import ConductivityTensor, Crack, ElasticTensor, Scene, Support, disc, rectangle

    data: dict[str, Any] = (
        {"temperature": lambda x, y: x}
        if conductive
        else {"displacement": lambda x, y: np.stack([0.0 * x, y], -1)}
    )
    return Scene(
        region=rectangle(1.0, 1.0) - disc(0.1, (0.25, 0.25)),
        spacing=1.0 / n,
        m=2,
        material=ConductivityTensor.isotropic(1.0)
        if conductive
        else ElasticTensor.isotropic(1.0, nu),
        surface=surface,
        cracks=[Crack((-0.75, 0.01 / n), (0.0, 0.01 / n))],
        supports=[Support.layer(cells=1, **data)],
        **settings,
    )


@cache
def statics(surface: Surface = "volume", conductive: bool = False) -> None:
    """Products, factorisation and preconditioner, with rotations and without."""
    for n in (8, 48 if conductive else 30):
        _square(n, conductive, surface).solve(tolerance=1e-2)
    if not conductive:
        for n in (8, 36):
            _square(n, conductive, surface, nu=1 / 3).solve(tolerance=1e-2)


@cache
def growth(surface: Surface = "volume") -> None:
    """A crack that grows by a few bonds."""
    from solver import fracture

    statics(surface)
    fracture.grow(_square(12, False, surface), 1.0, max_solves=3)


@cache
def conduction_in_time() -> None:
    """A few steps of a transient, each way of solving."""
    from solver import transient

    for surface in ("volume", "extrapolated"):
        statics(surface, conductive=True)
    scene = _square(12, True, "extrapolated", heat_capacity=1.0)
    transient.run(scene, lambda x, y: x, [0.1, 1.0], tolerance=1e-1)


@cache
def vibration(surface: Surface = "extrapolated") -> None:
    """Modes of a small body, and all that larger ones share with statics."""
    from solver import modes

    statics(surface)
    modes.solve(_square(10, False, surface, density=1.0), 4)


@cache
def waves(surface: Surface = "extrapolated") -> None:
    """A few steps of a wave."""
    from solver import waves as dynamics

    dynamics.run(
        _square(8, False, surface, density=1.0), lambda x, y: np.stack([x * x, y], -1), 0.05
    )


@cache
def conduction() -> None:
    """Products, factorisation and preconditioner of heat and current."""
    statics(conductive=True)


@cache
def both() -> None:
    """Statics and conduction."""
    statics()
    conduction()
