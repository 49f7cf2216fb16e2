"""Sensing in bone: drawn cracks hold, a conductor turned wrongly is seen; a run is read."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cmverify.cases import sensing
from cmverify.cases.sensing import CASES, FAULTS, Conductor
from cmverify.faults.fault import applied
from cmverify.judge.verdict import judge
from solver import Crack

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
    assert 0 < outcome.quantities["along path"] < 0.1
    drop = outcome.lines[0].curves[0].computed
    assert drop[0] == pytest.approx(1.0)
    assert drop[-1] > 1.05
    assert np.nanmax(outcome.stages.stages[0].values) <= 1.0 + 1e-12
    assert any("paper 1.03" in name for name in outcome.statistics)
    assert outcome.stages.stages[0].at[1] == pytest.approx(1.0)
    assert sensing._stages(np.zeros((1, 2)), 1.0, [], 1.0) is None


@pytest.mark.parametrize("surface", ["none", "volume"])
def test_a_crack_cut_bond_by_bond_is_taken_apart(monkeypatch, surface):
    """Cut like a drawn one it is that one, but for treated faces; what is whole conducts."""
    conductor = Conductor(surface=surface)
    sensor, path = conductor.sensor(1), np.array([[sensing.TIP, 0.0], [sensing.TIP + 4e-3, 0.0]])
    drawn = [*sensor.scene.cracks, Crack(*map(tuple, path))]
    before, after = (
        np.array([bonds.strength(o) > 0 for o in range(len(bonds.family.offsets) // 2)])
        for bonds in (
            replace(sensor.scene, cracks=cracks).discretise(sharp_tips=False).bonds
            for cracks in (sensor.scene.cracks, drawn)
        )
    )
    gone = np.flatnonzero(before & ~after)
    for left in (0, 5):
        broken = np.zeros(before.size, dtype=bool)
        broken[gone[left:]] = True
        run = SimpleNamespace(broken=broken.reshape(before.shape), path=path)
        monkeypatch.setattr(sensing, "bridging", lambda run, left=left: gone[:left])
        found = sensing.taken_apart(sensor, run)
        assert (found["whole across"] < -1e-4) == (left > 0)
        assert found["whole across"] <= 1e-8
        if surface == "none":
            assert abs(found["bare faces"]) < 1e-7
        else:
            assert found["bare faces"] > 1e-3
        both = (1 + found["whole across"]) * (1 + found["bare faces"]) - 1
        assert found["beside drawn"] == pytest.approx(abs(both), abs=1e-12)


def test_leads_and_probes_are_declared_in_the_body():
    scene = Conductor().scene(2)
    for place in (sensing.LEAD, sensing.PROBE):
        for upper in (True, False):
            x0, y0, x1, y1 = sensing.square(place, upper).bounds
            b0, c0, b1, c1 = scene.region.bounds
            assert b0 < x0 < x1 < b1
            assert c0 < y0 < y1 < c1
    assert replace(scene, loads=()).physics.name == "electrical conduction"
