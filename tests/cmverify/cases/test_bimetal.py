"""The bimetal case: it holds, and sees one per cent of the expansion, and its faults."""

import pytest

from cmverify.cases import bimetal
from cmverify.cases.bimetal import CASES, FAULTS
from cmverify.faults.fault import applied
from cmverify.judge.verdict import judge

(CASE,) = CASES


def failed(outcome) -> set[str]:
    """Quantities whose bounds do not hold."""
    verdicts = judge(CASE, {"bond/extrapolated": {12: outcome}})
    return {v.quantity for v in verdicts if not v.passed and v.kind != "order"}


@pytest.mark.parametrize(
    ("scale", "seen"), [(1.0, set()), (1.01, {"displacement", "largest", "curvature"})]
)
def test_the_case(scale, seen):
    assert failed(bimetal.heated(scale, 12)) == seen


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_faults_are_seen(fault):
    with applied({fault.target: fault.change}):
        assert failed(bimetal.heated(1.0, 12))
