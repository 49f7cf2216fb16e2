"""Deformational heating: the case holds, sees a wrong T₀ and each of its faults."""

import pytest

from cmverify.cases import deformational_heating
from cmverify.cases.deformational_heating import CASES, FAULTS
from cmverify.faults.fault import applied
from cmverify.judge.verdict import judge

(CASE,) = CASES


def failed(outcome) -> set[str]:
    """Quantities whose bounds do not hold."""
    verdicts = judge(CASE, {"bond/volume": {6: outcome}})
    return {v.quantity for v in verdicts if not v.passed and v.kind != "order"}


@pytest.mark.parametrize(("scale", "seen"), [(1.0, set()), (0.9, {"waves", "loss"})])
def test_the_case(scale, seen):
    assert failed(deformational_heating.heating(scale, 6)) == seen


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_faults_are_seen(fault):
    with applied({fault.target: fault.change}):
        assert failed(deformational_heating.heating(1.0, 6))
