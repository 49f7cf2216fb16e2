"""Joule's chain: it holds, and sees one per cent of the closed forms or of the bonds' heat."""

import pytest

from cmverify.cases import joule
from cmverify.cases.joule import CASES, FAULTS
from cmverify.faults.fault import applied
from cmverify.judge.verdict import judge

(CASE,) = CASES


def failed(method, outcome, n) -> set[str]:
    """Quantities whose bounds do not hold."""
    verdicts = judge(CASE, {method: {n: outcome}})
    return {v.quantity for v in verdicts if not v.passed and v.kind != "order"}


@pytest.mark.parametrize("fault", [None, *FAULTS], ids=lambda f: f.name if f else "sound")
def test_energy(fault):
    with applied({fault.target: fault.change} if fault else {}):
        outcome = joule.balanced("extrapolated", 10)
    assert failed("bond/extrapolated", outcome, 10) == ({"imbalance"} if fault else set())


@pytest.mark.parametrize(("scale", "seen"), [(1.0, set()), (1.01, {"temperature", "elongation"})])
def test_closed_forms(scale, seen):
    assert failed("bond/contacts", joule.contacts(scale, 20), 20) == seen
