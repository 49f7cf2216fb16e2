"""Values of supports and loads: every kind, and clear refusals."""

import numpy as np
import pytest

from solver import SceneError
from solver.problem.values import evaluate


@pytest.mark.parametrize(
    ("value", "components", "message"),
    [
        (np.ones(3), 1, "needs one value a particle for 5 particles"),
        (np.ones((5, 3)), 2, "needs 2 values a particle for 5 particles"),
        (lambda x, y: np.stack([x, y]), 2, "needs 2 values"),
        (np.nan, 1, "is not finite at x = "),
        (lambda x, y: np.where(x > 2.5, np.inf, 0.0), 1, r"is not finite at x = \(3, "),
        (["a"] * 5, 1, "needs one value"),
        (lambda x, y: None, 1, "needs one value|not finite"),
        (1j, 1, "needs one value"),
    ],
)
def test_values_that_do_not_fit(value, components, message):
    points = np.column_stack([np.arange(5.0), np.zeros(5)])
    with pytest.raises(SceneError, match=message):
        evaluate(value, points, components, "a thing")
