"""Work-precision data from synthetic measurements."""

import math

import pytest

from cmverify.judge.precision import Point, front, order_of, points, seconds_for
from tests.cmverify.toy_registry import toy, trapezium


def series(order=2.0, cost=3.0):
    return [Point("m", "bond", n, n, n**cost * 1e-6, n**-order) for n in (10, 20, 40)]


def test_points_come_from_the_primary_quantity():
    case = toy()
    found = points(case, {"bond/trapezium": {20: trapezium(20), 10: trapezium(10)}})
    assert [p.resolution for p in found] == [10, 20]
    assert found[0].seconds == pytest.approx(3e-3)
    assert order_of(case, found) == pytest.approx(2.0, abs=0.01)


def test_time_for_an_error_is_interpolated_and_never_extrapolated():
    data = series()
    # error = n^-2 and time = 1e-6 n^3 make time = 1e-6 error^-1.5
    assert seconds_for(data, 1.0 / 900.0) == pytest.approx(1e-6 * 30.0**3)
    assert seconds_for(data, 1.0) == data[0].seconds
    assert math.isnan(seconds_for(data, 1e-6))
    assert math.isnan(seconds_for([], 1e-3))


def test_the_front_drops_what_is_slower_and_worse():
    slow = Point("slow", "fem", 10, 10, 1.0, 0.5)
    assert slow not in front([*series(), slow])
    assert front(series()) == series()
