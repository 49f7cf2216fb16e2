"""Polar cases: they hold, and see one per cent of the closed forms, and each fault."""

import pytest

from cmverify.cases import polar
from cmverify.cases.polar import CASES, CELLS, FAULTS
from cmverify.faults.fault import applied
from cmverify.judge.verdict import judge

PATCH, STRIPS = CASES


def failed(case, method: str, outcome, n: int) -> set[str]:
    """Quantities whose bounds do not hold."""
    verdicts = judge(case, {method: {n: outcome}})
    assert verdicts
    return {v.quantity for v in verdicts if not v.passed and v.kind != "order"}


@pytest.mark.parametrize(("scale", "seen"), [(1.0, set()), (1.01, {"couple stress"})])
def test_patches(scale, seen):
    found = failed(PATCH, "bond/lattice", polar.patch(scale, CELLS), CELLS)
    assert {name.split(", ")[-1] for name in found} == seen


@pytest.mark.parametrize(("scale", "seen"), [(1.0, set()), (1.01, {"bending effect"})])
def test_strips(scale, seen):
    assert failed(STRIPS, "bond/few", polar.few(scale, 20), 20) == seen


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_faults_are_seen(fault):
    with applied({fault.target: fault.change}):
        found = failed(PATCH, "bond/lattice", polar.patch(1.0, CELLS), CELLS)
        if not found:
            found = failed(STRIPS, "bond/few", polar.few(1.0, 20), 20)
    assert found
