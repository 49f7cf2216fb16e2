"""The finite crack: what is prescribed is the closed form, and checks see one per cent."""

from functools import partial

import numpy as np
import pytest

from cmverify.cases import finite_crack
from cmverify.cases.finite_crack import Problem, measure, scene_of
from references.analytic.finite_crack import FiniteCrack


@pytest.mark.parametrize("angle", finite_crack.ANGLES.values())
def test_the_scene_is_turned_with_its_crack(angle):
    problem = Problem(angle)
    parts = scene_of(problem, "drawn", 12).discretise(constrained=True)
    held = parts.prescribed.all(axis=0)
    x, y = parts.lattice.points[held].T
    c, s = np.cos(angle), np.sin(angle)
    own = problem.field.displacement(c * x + s * y, c * y - s * x)
    wanted = np.stack([c * own[:, 0] - s * own[:, 1], s * own[:, 0] + c * own[:, 1]])
    np.testing.assert_allclose(parts.values[:2, held], wanted, atol=1e-12)
    assert isinstance(problem.field, FiniteCrack)


def test_one_per_cent_is_seen():
    good, bad = (partial(measure, Problem(scale=scale), "calibrated") for scale in (1.0, 1.01))
    bound = next(
        check.at_most[30]
        for check in finite_crack.BOUNDS
        if (check.method, check.quantity) == ("calibrated/along rows", "displacement")
    )
    assert good(30).quantities["displacement"] < bound < bad(30).quantities["displacement"]
