"""Chiral cases: they hold, and see one per cent of the turns, and each fault."""

import pytest

from cmverify.cases import chiral
from cmverify.cases.chiral import CASES, CELLS, FAULTS
from cmverify.faults.fault import applied
from cmverify.judge.verdict import judge

PATCH, BLOCKS = CASES


def failed(case, method, outcome, n):
    """Quantities whose bounds do not hold."""
    verdicts = judge(case, {method: {n: outcome}})
    assert verdicts
    return {v.quantity for v in verdicts if not v.passed and v.kind != "order"}


@pytest.mark.parametrize(("scale", "seen"), [(1.0, set()), (1.01, {"rotation"})])
def test_patches(scale, seen):
    assert failed(PATCH, "bond/lattice", chiral.patch(scale, CELLS), CELLS) == seen


def test_blocks():
    outcome = chiral.turning(1.0, 25)
    assert not failed(BLOCKS, "bond/extrapolated", outcome, 25)
    assert outcome.quantities["without k_nt"] > 1.0
    assert failed(BLOCKS, "bond/extrapolated", chiral.turning(0.99, 25), 25) == {"rotation"}


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_faults_are_seen(fault):
    with applied({fault.target: fault.change}):
        found = failed(PATCH, "bond/lattice", chiral.patch(1.0, CELLS), CELLS)
        if not found:
            found = failed(BLOCKS, "bond/extrapolated", chiral.turning(1.0, 25), 25)
    assert found
