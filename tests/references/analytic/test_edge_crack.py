"""Bueckner's weight function against known factors, and stresses without resultants."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from references.analytic import edge_crack

few = settings(derandomize=True, deadline=None, max_examples=25)


@pytest.mark.parametrize(
    ("ratio", "tension", "bending"),
    # Tada, Paris and Irwin: their polynomials of tension and of bending, good to half a per cent.
    [(0.1, 1.1957, 1.0472), (0.2, 1.3667, 1.0553), (0.3, 1.6599, 1.1241), (0.5, 2.8246, 1.4972)],
)
def test_tension_and_bending(ratio, tension, bending):
    scale = np.sqrt(np.pi * ratio)
    found = edge_crack.intensity(lambda x: 1.0 + 0 * x, ratio, 1.0) / scale
    assert found == pytest.approx(tension, rel=1e-2)
    found = edge_crack.intensity(lambda x: 1.0 - 2 * x, ratio, 1.0) / scale
    assert found == pytest.approx(bending, rel=1.2e-2)


@few
@given(st.floats(0.02, 0.12), st.floats(0.5, 20.0))
def test_what_is_left_of_a_temperature_has_no_resultants(depth, width):
    """Neither force nor moment, and none at all of a linear temperature."""
    points, weight = np.polynomial.legendre.leggauss(400)
    x = 0.5 * width * (points + 1)

    def change(at):
        return edge_crack.quenched(at, width, depth * width) + 0.3 * at / width

    stress = edge_crack.thermal_stress(x, width, change, 2.0, 0.1)
    size = np.abs(stress).max()
    assert abs(weight @ stress) < 1e-9 * size
    assert abs(weight @ (points * stress)) < 1e-9 * size
    linear = edge_crack.thermal_stress(x, width, lambda at: 1.0 + 3.0 * at, 2.0, 0.1)
    assert np.abs(linear).max() < 1e-12 * width
    # The cold edge is pulled.
    assert edge_crack.thermal_stress(np.array([0.0]), width, change, 2.0, 0.1)[0] > 0


def test_cracks_that_are_too_long_are_refused():
    with pytest.raises(ValueError, match="0 < a"):
        edge_crack.intensity(lambda x: x, 0.6, 1.0)
