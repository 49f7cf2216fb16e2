"""Finite elements of a strained conductor: exact in uniform strain, plain without a gauge."""

import numpy as np
import pytest

from references.analytic.piezoresistive import strained_conductivity
from references.fem.elasticity import solve_elasticity
from references.fem.mesh import rectangle
from references.fem.piezoresistive import strained_conduction

VOIGT = np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]]) / 0.91
BONE = np.array([[2.0, 0.5], [0.5, 1.0]])
INFLOW = {"left": 1.0, "right": -1.0}


def pulled(strain):
    exx, eyy, gxy = strain

    def u(x, y):
        return np.stack([exx * x + gxy / 2 * y, gxy / 2 * x + eyy * y], axis=-1)

    return solve_elasticity(rectangle(2.0, 1.0, 0.3), VOIGT, u)


def test_a_uniform_strain_leaves_a_uniform_conductor():
    strain = np.array([2e-2, -1e-2, 0.0])
    for resistive in (False, True):

        def of(e, r=resistive):
            return strained_conductivity(np.eye(2), e, 3.0, resistive=r)

        found = strained_conduction(pulled(strain), of, INFLOW)
        left, right = found.at([[-0.6, 0.1], [0.6, 0.1]])
        assert left - right == pytest.approx(1.2 / of(strain)[0, 0], rel=1e-9)


def test_without_a_gauge_it_is_the_plain_conductor():
    plain = strained_conduction(
        pulled((1e-2, 0.0, 1e-2)), lambda e: strained_conductivity(BONE, e, 0.0), INFLOW
    )
    same = strained_conduction(
        pulled((0.0, 0.0, 0.0)), lambda e: strained_conductivity(BONE, e, 5.0), INFLOW
    )
    assert np.abs(plain.values - same.values).max() < 1e-10


def test_what_cannot_be_is_refused():
    state = pulled((1e-2, 0.0, 0.0))
    with pytest.raises(ValueError, match="do not cancel"):
        strained_conduction(state, lambda e: strained_conductivity(BONE, e, 1.0), {"left": 1.0})
    with pytest.raises(ValueError, match="not positive definite"):
        strained_conduction(state, lambda e: strained_conductivity(BONE, e, -300.0), INFLOW)
