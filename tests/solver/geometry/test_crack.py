"""Cracks as they are drawn."""

import numpy as np
import pytest

from solver import Crack


def test_crack_pieces():
    crack = Crack((0, 0), (1, 0), (1, 2))
    assert crack.segments == (((0.0, 0.0), (1.0, 0.0)), ((1.0, 0.0), (1.0, 2.0)))
    assert Crack((0, 0), (0, 0), (1, 0), (1, 0), (1, 2), (1, 2)) == crack


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ((), "two or more points"),
        (((0, 0),), "two or more points"),
        (((0, 0, 0), (1, 1, 1)), "two or more points"),
        (((0, 0), (0, 0)), "no length"),
        (((0, 0), (np.inf, 0)), "not finite"),
    ],
)
def test_bad_cracks(points, message):
    with pytest.raises(ValueError, match=message):
        Crack(*points)
