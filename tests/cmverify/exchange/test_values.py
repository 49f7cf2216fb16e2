"""Values in scene files: constant, over the plane, and in time."""

import numpy as np
import pytest

from cmverify.exchange.values import InTime, components, scalar, scalar_in_time
from solver.problem.values import at_time, in_time

X, Y = np.array([0.5, 2.0]), np.array([1.0, -1.0])


def test_only_what_depends_on_time_is_a_function_of_time():
    assert scalar_in_time(2) == 2.0
    assert not in_time(scalar_in_time("x + y"))
    assert not in_time(components(2, time=True)(["x", 1]))
    value, pair = scalar_in_time("x*t"), components(2, time=True)(["x", "y*t"])
    assert isinstance(value, InTime)
    assert in_time(value)
    assert in_time(pair)
    np.testing.assert_allclose(at_time(value, 3.0)(X, Y), 3 * X)
    np.testing.assert_allclose(at_time(pair, 3.0)(X, Y), np.column_stack([X, 3 * Y]))
    assert pair.texts == ["y*t"]


def test_time_is_refused_elsewhere():
    for check in (scalar, components(1)):
        with pytest.raises(ValueError, match="depends on the time t"):
            check("t" if check is scalar else ["t"])
