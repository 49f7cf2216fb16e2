"""Orders, Richardson and the grid convergence index on data of known order."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cmverify.judge.convergence import (
    fitted_order,
    grid_convergence_index,
    observed_orders,
    richardson,
)

orders = st.floats(0.3, 6.0)
steady = settings(deadline=None, derandomize=True, max_examples=30)


@steady
@given(orders, st.floats(1e-3, 1e3))
def test_observed_and_fitted_order_recover_a_power_law(order, constant):
    h = np.array([0.2, 0.1, 0.04])
    e = constant * h**order
    np.testing.assert_allclose(observed_orders(h, e), order, rtol=1e-9)
    fit = fitted_order(h, e)
    assert fit is not None
    assert fit.order == pytest.approx(order, rel=1e-9)
    assert fit.constant == pytest.approx(constant, rel=1e-8)
    assert fit.residual < 1e-12
    np.testing.assert_allclose(fit(h), e, rtol=1e-9)


def test_fit_ignores_errors_at_the_noise_floor_and_nan():
    h = [0.4, 0.2, 0.1, 0.05]
    fit = fitted_order(h, [1e-2, 2.5e-3, math.nan, 1e-15], floor=1e-13)
    assert fit is not None
    assert fit.order == pytest.approx(2.0)
    assert fitted_order(h, [1e-14] * 4, floor=1e-13) is None


def test_observed_order_of_a_vanishing_error_is_not_a_number():
    assert np.isnan(observed_orders([0.2, 0.1], [1e-3, 0.0])).all()


@steady
@given(orders, st.floats(-2.0, 2.0).filter(lambda c: abs(c) > 1e-2))
def test_richardson_finds_limit_and_order_for_unequal_ratios(order, constant):
    h = np.array([0.3, 0.2, 0.1])
    found = richardson(h, 5.0 + constant * h**order)
    assert found.order == pytest.approx(order, rel=1e-5)
    assert found.value == pytest.approx(5.0, rel=1e-6)
    assert found.error == pytest.approx(abs(constant) * 0.1**order / 5.0, rel=1e-3)


def test_richardson_refuses_what_does_not_converge():
    with pytest.raises(ValueError, match="monotonically"):
        richardson([0.4, 0.2, 0.1], [1.0, 2.0, 1.0])
    with pytest.raises(ValueError, match="three grids"):
        richardson([0.4, 0.2], [1.0, 2.0])


def test_grid_convergence_index_is_the_safety_factor_times_the_true_error():
    # f = 1 + h^2 on h = 0.1 and 0.2: the true relative error of the fine value is 0.01/1.01
    index = grid_convergence_index(1.01, 1.04, ratio=2.0, order=2.0)
    assert index == pytest.approx(1.25 * 0.01 / 1.01)
    with pytest.raises(ValueError, match="ratio"):
        grid_convergence_index(1.0, 1.1, ratio=1.0, order=2.0)


@pytest.mark.parametrize("h", [[0.1, 0.2], [0.2, 0.2], [0.2, -0.1], [0.2]])
def test_bad_grids_are_refused(h):
    with pytest.raises(ValueError, match=r"grid sizes|equal vectors"):
        observed_orders(h, [1.0, 2.0])
