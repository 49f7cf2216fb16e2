"""The finite crack: what is prescribed is the closed form, and checks see one per cent."""

from functools import partial

import numpy as np
import pytest

from cmverify.cases import finite_crack
from cmverify.cases.common import sif
from cmverify.cases.finite_crack import STIFFNESS, Problem, measure, scene_of
from references.analytic.finite_crack import FiniteCrack
from references.fem import cracked_plates
from solver import Crack, ElasticTensor, Load, Scene, Support, rectangle


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


SLOPE = finite_crack.ANGLES["27°"]
TIP = 0.5 * np.array([np.cos(SLOPE), np.sin(SLOPE)])


@pytest.mark.parametrize(
    ("ends", "angle", "reference"),
    [
        (
            (-TIP, TIP),
            SLOPE,
            lambda: cracked_plates.centre_crack(STIFFNESS, 2, 2, 0.5, SLOPE, elements=10),
        ),
        (
            (np.array([-1.1, 0.0]), np.array([-0.09, 0.0])),
            0.0,
            lambda: cracked_plates.edge_crack(STIFFNESS, 2, 2, 0.91, elements=10),
        ),
    ],
    ids=["tilted", "edge"],
)
def test_intensities_of_both_modes_are_those_of_finite_elements(ends, angle, reference):
    """Plates pulled from edge to edge: mixed modes and a stress along the crack, no field given."""
    n = 40
    found, tip = {}, (float(ends[1][0]), float(ends[1][1]))
    for kind in ("drawn", "calibrated"):
        scene = Scene(
            rectangle(2.0, 2.0), 1 / n, ElasticTensor(STIFFNESS), m=3, surface="extrapolated",
            tip=kind, cracks=[Crack(tuple(map(float, ends[0])), tip)],
            loads=[Load.traction((0.0, s), (-s, s), (s, s)) for s in (1.0, -1.0)],
            supports=[
                Support.where(lambda x, y: np.hypot(x - 0.9125, y + 0.9125) < 0.5 / n,
                              displacement=(0.0, 0.0)),
                Support.where(lambda x, y: np.hypot(x - 0.9125, y - 0.9125) < 0.5 / n, u1=0.0),
            ],
        )  # fmt: skip
        solution = scene.solve(1e-9)
        assert not solution.discretisation.tips_left
        series = sif.tip_series(solution, tip, angle, 0.3, orders=range(7))
        found[kind] = np.array([series.KI, series.KII])
    exact = reference()
    wanted = np.array([exact.KI, exact.KII])
    off = {kind: np.hypot(*(k - wanted)) / np.hypot(*wanted) for kind, k in found.items()}
    assert off["calibrated"] < 7e-4
    assert off["drawn"] > 5 * off["calibrated"]
