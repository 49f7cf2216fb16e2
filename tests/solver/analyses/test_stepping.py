"""Verlet's stable step and the body's largest frequency, against polynomials and dense matrices."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import ElasticTensor, Scene, Support, rectangle
from solver.analyses import stepping
from solver.linear.rotations import MasslessRotations
from solver.operators.assembled import to_csr
from solver.problem import Discretisation
from tests.solver.bodies import exact


@exact
@given(
    st.floats(0.1, 1e4), st.floats(0.0, 2.0), st.floats(0.0, 2.0), st.sampled_from([0.999, 1.001])
)
def test_the_stable_step_is_where_the_polynomial_leaves_the_circle(omega, alpha, beta, share):
    """z² − (1 + E − √E (a + b)) z + E − √E b, its roots within the circle or not."""
    beta = beta / omega
    step = share * stepping.stable_step(omega, 0.0, beta)
    decay = np.exp(-0.0 * step)
    a, b = (omega * step) ** 2, beta * omega**2 * step
    roots = np.roots([1.0, -(1 + decay - np.sqrt(decay) * (a + b)), decay - np.sqrt(decay) * b])
    assert (np.abs(roots).max() > 1 + 1e-7) == (share > 1)
    # Damping with the mass only helps.
    decay = np.exp(-alpha * step)
    roots = np.roots([1.0, -(1 + decay - np.sqrt(decay) * (a + b)), decay - np.sqrt(decay) * b])
    if share < 1:
        assert np.abs(roots).max() < 1 + 1e-7


@pytest.mark.parametrize("surface", ["volume", "extrapolated"])
@pytest.mark.parametrize("nu", [0.2, 0.4])
def test_the_largest_frequency_of_a_body(surface, nu):
    scene = Scene(
        region=rectangle(1.0, 0.8, angle=0.3),
        spacing=0.1,
        m=2,
        material=ElasticTensor.isotropic(1.0, nu),
        density=2.0,
        surface=surface,
        supports=[Support.where(lambda x, y: x < -0.3, u1=0.0)],
    )
    body = Discretisation.of(scene, free=True)
    operator = body.operator
    count = len(operator.active)
    whole = to_csr(operator).toarray()
    condensed = whole[: 2 * count, : 2 * count] - whole[: 2 * count, 2 * count :] @ np.linalg.solve(
        whole[2 * count :, 2 * count :], whole[2 * count :, : 2 * count]
    )
    mass = np.tile(2.0 * body.volumes[operator.active], (2, 1))
    inverse = np.where(operator.identity_rows[:2], 0.0, 1.0 / mass)
    root = np.sqrt(inverse.ravel())
    wanted = np.sqrt(np.linalg.eigvalsh(root[:, None] * condensed * root)[-1])
    internal = MasslessRotations(
        operator, body.stability.kind, 1e-8, np.zeros(count, dtype=np.int64)
    )
    found = stepping.largest_frequency(internal, inverse)
    assert wanted <= found < 1.004 * wanted
