"""The quenched plate: it holds, and sees faults of the closed forms."""

import pytest

from cmverify.cases.thermal_shock import CASES, beside, jumps
from cmverify.faults.changes import scaled
from cmverify.faults.fault import applied
from cmverify.judge.verdict import judge

(CASE,) = CASES
METHOD = "bond/volume"


def failed(outcome, n):
    """Quantities whose bounds do not hold."""
    verdicts = judge(CASE, {METHOD: {n: outcome}})
    assert verdicts
    return {v.quantity for v in verdicts if not v.passed and v.kind != "order"}


@pytest.fixture(scope="module")
def bonds():
    """Jumps at 20 cells across; the faults are of closed forms."""
    return jumps("volume", 20)


def test_jumps_hold(bonds):
    assert not failed(beside(*bonds), 20)


def test_a_jump_that_is_too_large_is_seen(bonds):
    assert failed(beside(*bonds, 1.05), 20) == {"jump at 0.2 W", "jump at 0.4 W"}


@pytest.mark.parametrize("name", ["intensity", "thermal_stress"])
def test_faults_are_seen(bonds, name):
    with applied({f"references.analytic.edge_crack.{name}": scaled(0.92)}):
        assert failed(beside(*bonds), 20)
