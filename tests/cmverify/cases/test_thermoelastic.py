"""Thermal cases: they hold, and each kind of check sees one per cent, or a fault of the solver."""

import pytest

from cmverify.cases import thermoelastic
from cmverify.cases.thermoelastic import CASES, CELLS, FAULTS
from cmverify.faults.fault import applied
from cmverify.judge.verdict import judge

EXPANSION, DISC = CASES


def failed(case, outcome, n: int) -> set[str]:
    """Quantities whose bounds do not hold."""
    (method,) = case.methods
    verdicts = judge(case, {method.name: {n: outcome}})
    return {v.quantity for v in verdicts if not v.passed and v.kind != "order"}


def test_expansion_and_clamped_bodies():
    assert failed(EXPANSION, thermoelastic.expansion(1.01, CELLS), CELLS) == {"clamped"}


@pytest.mark.parametrize(("scale", "seen"), [(1.0, False), (1.01, True)])
def test_the_heated_disc(scale, seen):
    found = failed(DISC, thermoelastic.heated(scale, 20), 20)
    assert ({"displacement", "stress"} <= found) == seen


@pytest.mark.parametrize("fault", FAULTS[:5], ids=lambda fault: fault.name)
def test_faults_of_thermal_forces_are_seen(fault):
    with applied({fault.target: fault.change}):
        assert failed(EXPANSION, thermoelastic.expansion(1.0, CELLS), CELLS)
