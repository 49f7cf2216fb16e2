"""Piezoresistive cases hold, and see one per cent of a gauge or a fault of the solver."""

import pytest

from cmverify.cases import piezoresistive
from cmverify.cases.piezoresistive import CASES, FAULTS, Plate
from cmverify.faults.fault import applied
from cmverify.judge.verdict import judge

(CASE,) = CASES
UNIFORM = "bond/uniform strain"


def failed(method, outcome, n) -> set[str]:
    """Quantities whose bounds do not hold."""
    verdicts = judge(CASE, {method: {n: outcome}})
    return {v.quantity for v in verdicts if not v.passed and v.kind != "order"}


def test_uniform_strains():
    assert not failed(UNIFORM, piezoresistive.uniform(1.0, 3), 3)
    assert {"lattice sum", "calibrated"} <= failed(UNIFORM, piezoresistive.uniform(1.01, 3), 3)


@pytest.mark.parametrize("fault", FAULTS[3:6], ids=lambda fault: fault.name)
def test_faults_are_seen(fault):
    with applied({fault.target: fault.change}):
        assert failed(UNIFORM, piezoresistive.uniform(1.0, 3), 3)


def test_the_plate_sees_its_gauge():
    name = "bond/bone plate"
    assert not failed(name, piezoresistive.plate(Plate("bone"), 10), 10)
    wrong = piezoresistive.plate(Plate("bone", 1.04), 10)
    assert failed(name, wrong, 10) == {"change across"}
