"""Sensing in bone: drawn cracks hold, a conductor turned wrongly is seen; a run is read."""

from dataclasses import replace

import numpy as np
import pytest

from cmverify.cases import sensing
from cmverify.cases.sensing import CASES, FAULTS, Conductor
from cmverify.faults.fault import applied
from cmverify.judge.verdict import judge

(CASE,) = CASES
DRAWN = "drawn, ζ = 0°"


def failed(method, outcome, n) -> set[str]:
    """Quantities whose bounds do not hold."""
    verdicts = judge(CASE, {method: {n: outcome}})
    return {v.quantity for v in verdicts if not v.passed and v.kind != "order"}


def test_drawn_cracks():
    assert not failed(DRAWN, sensing.slits(Conductor(), True, 2), 2)
    assert "drop" in failed(DRAWN, sensing.slits(Conductor(scale=1.15), True, 2), 2)


def test_slits_of_other_fibres_stand_for_none():
    assert sensing.reference(45.0)[1][0] != sensing.reference(0.0)[1][0]
    with pytest.raises(LookupError, match="60°"):
        sensing.reference(60.0)


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_faults_are_seen(fault):
    with applied({fault.target: fault.change}):
        assert failed(DRAWN, sensing.slits(Conductor(), True, 2), 2)


def test_a_run_is_read_and_drawn(monkeypatch):
    outcome = sensing.grown(Conductor(), 1)
    assert outcome.quantities["fallen"] < 1e-6
    assert 0 < outcome.quantities["cost"] < 1
    drop = outcome.lines[0].curves[0].computed
    assert drop[0] == pytest.approx(1.0)
    assert drop[-1] > 1.05
    assert np.nanmax(outcome.stages.stages[0].values) <= 1.0 + 1e-12
    assert any("paper 1.03" in name for name in outcome.statistics)
    assert outcome.stages.stages[0].at[1] == pytest.approx(1.0)
    assert sensing._stages(np.zeros((1, 2)), 1.0, [], 1.0) is None


def test_leads_and_probes_are_declared_in_the_body():
    scene = Conductor().scene(2)
    for place in (sensing.LEAD, sensing.PROBE):
        for upper in (True, False):
            x0, y0, x1, y1 = sensing.square(place, upper).bounds
            b0, c0, b1, c1 = scene.region.bounds
            assert b0 < x0 < x1 < b1
            assert c0 < y0 < y1 < c1
    assert replace(scene, loads=()).physics.name == "electrical conduction"
