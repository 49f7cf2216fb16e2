"""Influence functions: their moments in closed form."""

import numpy as np
import pytest

from solver import Influence
from solver.material import CONSTANT
from solver.material.influence import CONICAL, GAUSSIAN, influence


@pytest.mark.parametrize(
    ("function", "elastic", "conductive"),
    [
        # ∫ρ²Λ of Eq. 56 and ∫ρΛ of Eq. 146: Eqs. 57 and 147; 1/3 − 1/4 and 1/2 − 1/3.
        (CONSTANT, 1 / 3, 1 / 2),
        (CONICAL, 1 / 12, 1 / 6),
    ],
)
def test_constants_in_closed_form(function, elastic, conductive):
    assert function.moment(2) == pytest.approx(elastic, rel=1e-13)
    assert function.moment(1) == pytest.approx(conductive, rel=1e-13)


def test_gaussian_moment():
    # ∫₀¹ ρ exp(−4ρ²) dρ = (1 − e⁻⁴)/8.
    assert GAUSSIAN.moment(1) == pytest.approx((1 - np.exp(-4)) / 8, rel=1e-12)


def test_any_function_will_do_and_is_clipped_at_zero():
    parabola = Influence("parabola", lambda r: 1 - r * r)
    assert parabola.moment(2) == pytest.approx(1 / 3 - 1 / 5)
    np.testing.assert_array_equal(parabola(np.array([0.0, 1.0, 1.1])), [1.0, 0.0, 0.0])
    assert influence(parabola) is parabola


def test_names():
    assert influence("conical") is CONICAL
    with pytest.raises(ValueError, match=r"unknown influence.*constant"):
        influence("cone")
