"""Deformational heating: thermodynamics, and the strip's loss by numerical solution."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import sparse
from scipy.sparse.linalg import spsolve

from references.analytic.thermoelastic import (
    adiabatic_change,
    adiabatic_voigt,
    bending_loss,
    relaxation,
)

VOIGT = np.array([[5.0, 1.0, 0.3], [1.0, 4.0, -0.2], [0.3, -0.2, 2.5]])
EXPANSION = np.array([0.1, -0.2, 0.3])


@given(st.tuples(*[st.floats(-1, 1)] * 3))
def test_no_entropy_is_made(strain):
    """beta.eps + c T/T0 = 0, and the stiffness is what stress C eps - beta T then is."""
    T = adiabatic_change(VOIGT, EXPANSION, strain, 300.0, 2.0)
    beta = VOIGT @ EXPANSION
    assert beta @ strain + 2.0 * T / 300.0 == pytest.approx(0.0, abs=1e-12)
    stress = VOIGT @ strain - beta * T
    np.testing.assert_allclose(
        adiabatic_voigt(VOIGT, EXPANSION, 300.0, 2.0) @ strain, stress, atol=1e-10
    )


@pytest.mark.parametrize("frequency", [0.03, 0.3, 1.0, 10.0, 100.0])
def test_the_loss_of_a_bent_strip(frequency):
    """Finite volumes across the strip."""
    E, nu, alpha, T0, c, k, h = 2.0, 0.25, 1e-3, 300.0, 0.7, 0.05, 0.4
    delta, more = relaxation(E, nu, alpha, T0, c)
    n = 2000
    y = (np.arange(n) + 0.5) * h / n - h / 2
    links = np.full(n - 1, k / (h / n) ** 2, dtype=complex)
    flow = sparse.diags_array(
        [-links, np.r_[0, links] + np.r_[links, 0], -links], offsets=[-1, 0, 1]
    )
    matrix = sparse.csc_array(flow + 1j * frequency * more * sparse.eye_array(n))
    T = spsolve(matrix, -1j * frequency * E * alpha * T0 * y)
    moment = E * ((y - alpha * T) * y).sum() * h / n
    found = bending_loss(E, nu, alpha, T0, c, k, h, frequency)
    # To first order in Delta.
    assert moment.imag / (E * h**3 / 12) == pytest.approx(float(found), rel=2e-5)
    tau = h**2 * more / (np.pi**2 * k)
    zener = delta * frequency * tau / (1 + (frequency * tau) ** 2)
    if frequency * tau < 3:
        assert float(found) == pytest.approx(zener, rel=0.05)
