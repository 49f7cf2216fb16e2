"""A description says what is wrong with it, and knows its family."""

import pytest

from solver import ConductivityTensor, Crack, ElasticTensor, Load, SceneError, rectangle
from solver.problem.description import Description

SOLID = ElasticTensor.isotropic(1.0, 0.2)
CONDUCTOR = ConductivityTensor.isotropic(1.0)


def describe(**changes) -> Description:
    settings = {"region": rectangle(1.0, 1.0), "spacing": 0.1, "material": SOLID, **changes}
    return Description(**settings)


def test_what_it_knows():
    assert describe().physics.name == "elasticity"
    assert describe(material=CONDUCTOR).physics.name == "heat conduction"
    family = describe(m=3).family()
    assert (family.m, family.spacing) == (3, 0.1)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"surface": "shiny"}, "surface treatment"),
        ({"loose": "keep"}, "loose must be"),
        ({"region": "square"}, "region must be a Region"),
        ({"material": 3.0}, "material must be"),
        ({"cracks": Crack((0.0, 0.0), (0.1, 0.0))}, "cracks must be a list"),
        ({"supports": [Load.source(1.0)]}, "supports must be a list of Support"),
        ({"spacing": "fine"}, "spacing must be a number"),
        ({"m": True}, "m must be a number"),
        ({"loads": [Load.source(1.0)]}, "a source does not act on an elastic body"),
        (
            {"material": CONDUCTOR, "loads": [Load.body_force((1.0, 0.0))]},
            "a force does not act on a conductive body",
        ),
    ],
)
def test_contradictions_are_named(changes, message):
    with pytest.raises((SceneError, ValueError), match=message):
        describe(**changes)
