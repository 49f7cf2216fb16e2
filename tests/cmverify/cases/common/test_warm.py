"""Warm-ups: small, once a process, and nothing is compiled after them."""

import sys

import numpy as np
import pytest

from cmverify.cases.common import warm
from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    Load,
    Scene,
    Support,
    disc,
    fracture,
    modes,
    rectangle,
    transient,
    waves,
)

BODY = rectangle(1.0, 1.0, angle=0.2) - rectangle(0.2, 0.1, (0.1, 0.2))


def compiled():
    """Signatures of every kernel of the solver."""
    return {
        f"{value.py_func.__module__}.{value.py_func.__name__}": tuple(map(str, value.signatures))
        for name, module in list(sys.modules.items())
        if name.split(".")[0] == "solver"
        for value in list(vars(module).values())
        if hasattr(value, "signatures") and hasattr(value, "py_func")
    }


def elastic(n, m=3, nu=0.3, **settings):
    return Scene(
        region=BODY,
        spacing=1 / n,
        m=m,
        material=ElasticTensor.isotropic(1.0, nu),
        cracks=[Crack((-1.0, -0.2), (-0.1, -0.22))],
        **settings,
    )


def held(**settings):
    pulled = Support.where(lambda x, y: y > 0.4, u2=1e-3)
    fixed = Support.where(lambda x, y: y < -0.4, displacement=0.0)
    return {"supports": [fixed, pulled], **settings}


def conductive(n, **settings):
    return Scene(
        region=BODY,
        spacing=1 / n,
        m=3,
        material=ConductivityTensor.isotropic(2.0),
        supports=[Support.where(lambda x, y: y > 0.4, temperature=1.0)],
        loads=[Load.flux((1.0, 0.0))],
        **settings,
    )


WORK = {
    "statics": (
        warm.statics,
        lambda: [
            elastic(n, nu=nu, **held(loads=[Load.stress((1.0, 0.0, 0.0))])).solve()
            for n in (12, 36)
            for nu in (0.3, 1 / 3)
        ],
    ),
    "extrapolated": (
        lambda: warm.statics("extrapolated"),
        lambda: elastic(12, m=2, **held(surface="extrapolated")).solve(),
    ),
    "conduction": (warm.conduction, lambda: [conductive(n).solve() for n in (12, 50)]),
    "growth": (
        warm.growth,
        lambda: fracture.grow(elastic(12, **held()), 1e-9, max_solves=5),
    ),
    "transient": (
        warm.conduction_in_time,
        lambda: transient.run(conductive(12, heat_capacity=1.0), 0.0, [0.01], tolerance=0.1),
    ),
    "modes": (
        warm.vibration,
        lambda: modes.solve(elastic(12, surface="extrapolated", density=1.0), 3),
    ),
    "waves": (
        warm.waves,
        lambda: waves.run(
            elastic(10, surface="extrapolated", density=1.0),
            lambda x, y: np.stack([x, y * y], -1),
            0.05,
        ),
    ),
}


@pytest.mark.parametrize("kind", WORK)
def test_nothing_is_compiled_after_the_warm_up(kind):
    first, then = WORK[kind]
    first()
    before = compiled()
    assert before
    then()
    assert compiled() == before


def test_a_body_with_a_round_hole_needs_nothing_else():
    warm.both()
    before = compiled()
    scene = Scene(
        region=disc(1.0) - disc(0.3, (0.2, 0.1)),
        spacing=0.1,
        material=ElasticTensor.isotropic(1.0, 0.2),
        supports=[Support.layer(cells=2, displacement=lambda x, y: np.stack([x, y], -1))],
    )
    scene.solve()
    assert compiled() == before
