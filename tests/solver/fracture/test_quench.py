"""Quenched bodies, as scene files ask for them."""

import numpy as np
import pytest

from solver import ConductivityTensor, Crack, ElasticTensor, Scene, SceneError, Support, rectangle
from solver.fracture.quench import run

#: The lower edge turns cold.
PLATE = Scene(
    rectangle(2.0, 1.2),
    0.1,
    ElasticTensor.isotropic(10.0, 0.2),
    [Support.where(lambda x, y: y > 0.5, u2=0.0, rotation=0.0),
     Support.where(lambda x, y: (y > 0.5) & (abs(x - 0.05) < 0.01), u1=0.0)],
    m=2,
    cracks=[Crack((-0.3, -0.7), (-0.3, -0.45)), Crack((0.4, -0.7), (0.4, -0.35))],
)  # fmt: skip
GIVEN = {
    "cooled": lambda x, y: y < -0.59,
    "change": -1.0,
    "times": [0.002, 0.01, 0.05],
    "conductivities": (2.0, 0.5),
    "heat_capacity": 0.5,
    "expansions": (1.0, 0.6),
}


def test_cracks_grow_from_the_cold_edge():
    told = []
    found = run(PLATE, **GIVEN, G1=0.05, no_fail=lambda x, y: y < -0.5, progress=told.append)
    h = found.growth.history
    assert h.dissipated[-1] > 0
    assert np.abs(h.imbalance).max() < 1e-6 * h.work.max()
    assert h["time"][-1] == 0.05
    assert told[-1] == 1.0
    assert found.growth.tip[1] > -0.3
    # κ = k22/c: an edge that is cold at once, while the other does not know of it.
    from scipy.special import erfc

    temperature = found.fields()["temperature"]
    depth = found.points[:, 1] + 0.6
    wanted = -erfc(depth / (2 * np.sqrt(0.5 / 0.5 * 0.05)))
    np.testing.assert_allclose(temperature, wanted, atol=0.02)
    assert {"history", "path", "heat"} == set(found.tables())
    assert found.summary()["heat balance"] < 1e-8


def test_what_makes_no_run_is_refused():
    warm = Scene(PLATE.region, 0.1, ConductivityTensor.isotropic(1.0), m=2)
    with pytest.raises(SceneError, match="cracks grow in an elastic body"):
        run(warm, **GIVEN, G1=1.0)
    for name, value, says in (
        ("change", 0.0, "changes the temperature"),
        ("conductivities", (1.0, 0.0), "must be positive"),
        ("conductivities", (np.inf, 1.0), "positive and finite"),
        ("expansions", (np.inf, 1.0), "expansion must be finite"),
        ("times", [0.0, 1.0], "must be after it"),
        ("cooled", lambda x, y: y < -9, "edge|surface|node"),
        ("times", [], "time"),
    ):
        with pytest.raises(SceneError, match=says):
            run(PLATE, **{**GIVEN, name: value}, G1=1.0)
    ended = Scene(**{**vars(PLATE), "surface": "extrapolated"})
    with pytest.raises(SceneError, match="end at the surface"):
        run(ended, **GIVEN, G1=1.0)
