"""Fracture with a sensor, as scene files ask for it."""

import numpy as np
import pytest

from solver import ConductivityTensor, Crack, ElasticTensor, Scene, SceneError, Support, rectangle
from solver.fracture.sensed import run

PLATE = Scene(
    rectangle(2.0, 1.2),
    0.1,
    ElasticTensor.isotropic(10.0, 0.2),
    [
        Support.where(lambda x, y: x < -0.75, u2=lambda x, y: np.sign(y)),
        Support.where(lambda x, y: x > 0.75, displacement=0.0, rotation=0.0),
    ],
    m=2,
    cracks=[Crack((-2.0, 0.0), (-0.3, 0.0))],
)
LEADS = {
    "resistivities": (2.0, 5.0),
    "lead_plus": lambda x, y: (x < -0.75) & (y > 0.35),
    "lead_minus": lambda x, y: (x < -0.75) & (y < -0.35),
    "probe_plus": lambda x, y: (x < -0.75) & (y > 0) & (y < 0.2),
    "probe_minus": lambda x, y: (x < -0.75) & (y < 0) & (y > -0.2),
}


def test_the_drop_grows_with_the_crack():
    told = []
    found = run(PLATE, **LEADS, G1=1.0, control="following", advance=0.2, progress=told.append)
    growth, drop = found.growth, found.drop
    assert growth.advance >= 0.2
    assert told[-1] == 1.0
    # Without a bond less no potential changes, with a bond less the resistance is no smaller.
    assert (np.diff(drop) >= -1e-8 * drop[0]).all()
    assert drop[-1] > 1.02 * drop[0]
    assert found.summary()["relative drop"] == pytest.approx(drop[-1] / drop[0])
    fields = found.fields()
    assert {"damage", "potential", "current_density", "stress11"} < set(fields)
    # The drop is what the potential's field says, and resistivities are proportional to it.
    x, y = found.points.T
    mean = [fields["potential"][LEADS[name](x, y)].mean() for name in ("probe_plus", "probe_minus")]
    assert mean[0] - mean[1] == pytest.approx(drop[-1], rel=1e-9)
    assert found.tables()["history"].columns[-1] == "drop"
    twice = {**LEADS, "resistivities": (4.0, 10.0)}
    again = run(PLATE, **twice, G1=1.0, levels=[0.0], max_solves=1)
    assert again.drop[0] == pytest.approx(2 * drop[0], rel=1e-7)


def test_what_makes_no_run_is_refused():
    with pytest.raises(SceneError, match="has no end"):
        run(PLATE, **LEADS, G1=1.0)
    warm = Scene(PLATE.region, 0.1, ConductivityTensor.isotropic(1.0), m=2)
    with pytest.raises(SceneError, match="cracks grow in an elastic body"):
        run(warm, **LEADS, G1=1.0, stop=1.0)
    outside = {**LEADS, "probe_plus": lambda x, y: x > 5}
    with pytest.raises(SceneError, match="probe"):
        run(PLATE, **outside, G1=1.0, stop=1.0)
