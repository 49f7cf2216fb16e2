"""A flat table asks for the same run as the objects do."""

import numpy as np
import pytest

from solver import Crack, ElasticTensor, Programme, Scene, Support, Toughness, fracture, rectangle
from solver.analyses import analyses
from solver.errors import SceneError


@pytest.fixture
def strip():
    held = Support.where(
        lambda x, y: abs(y) > 5.5,
        rotation=0.0,
        displacement=lambda x, y: np.stack([0 * y, np.sign(y)], axis=-1),
    )
    return Scene(
        rectangle(24, 14),
        1.0,
        ElasticTensor.isotropic(1.0, 0.2),
        m=2,
        supports=[held],
        cracks=[Crack((-13, 0), (0, 0))],
    )


def test_the_same_run(strip):
    wanted = fracture.grow(
        strip, Toughness(2.0, 1.0, axis=np.pi / 2), Programme(), until=lambda run: run.advance >= 2
    )
    told: list[float] = []
    found = analyses()["fracture"].run(
        strip, G1=2.0, G2=1.0, axis_degrees=90.0, advance=2.0, progress=told.append
    )
    assert told == sorted(told)
    assert 0.2 < max(share for share in told if share < 1) < told[-1] == 1.0
    np.testing.assert_array_equal(found.breaks, wanted.breaks)
    assert {"damage", "loose", "displacement"} <= set(found.fields())
    assert set(found.tables()) == {"history", "path"}
    assert found.summary()["bonds broken"] == len(wanted.breaks)


def test_a_run_without_an_end_is_refused(strip):
    with pytest.raises(SceneError, match="no end"):
        analyses()["fracture"].run(strip, G1=1.0)
