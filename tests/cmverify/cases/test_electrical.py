"""Cases of current: each kind of check holds, and sees a small change of the conductor."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cmverify.cases import electrical
from cmverify.cases.electrical import CASES, FAULTS, Strip
from cmverify.faults.fault import applied
from cmverify.judge.verdict import judge

STRIPS, LEADS = CASES


def failed(case, method: str, outcome, n: int = 20) -> set[str]:
    """Quantities whose bounds do not hold at n cells."""
    verdicts = judge(case, {method: {n: outcome}})
    return {v.quantity for v in verdicts if not v.passed and v.kind != "order"}


@pytest.mark.parametrize(("scale", "seen"), [(1.0, False), (1.1, True)])
def test_strips(scale, seen):
    """A tenth of the conductivity across is a twentieth of a height: a per cent of the drop."""
    outcome = electrical.cracked(Strip("edge", False, scale), 20)
    assert bool(failed(STRIPS, "bond/edge crack", outcome)) == seen


@pytest.mark.parametrize(("scale", "seen"), [(1.0, set()), (1.01, {"drop"})])
def test_leads_of_given_currents(scale, seen):
    assert failed(LEADS, "bond/currents", electrical.leads(False, 20, scale)) == seen


@pytest.mark.parametrize(("scale", "seen"), [(1.0, set()), (1.01, {"drop", "limit"})])
def test_leads_of_given_potentials(scale, seen):
    """One per cent along the fibres moves the limit by more than its bound."""
    outcome = electrical.leads(True, 40, scale)
    assert failed(LEADS, "bond/potentials", outcome, 40) == seen


@given(st.floats(0.1, 10), st.floats(-1, 1), st.floats(0.01, 1))
def test_limits_of_known_order(limit, size, spacing):
    """Whatever the error's size at the order 4/3."""
    coarse, fine = (limit + size * h ** (4 / 3) for h in (2 * spacing, spacing))
    assert electrical.corner_limit(coarse, fine) == pytest.approx(limit, abs=1e-12)


def test_heat_and_current():
    assert failed(LEADS, "bond/heat", electrical.same(1.0, 20)) == set()
    seen = failed(LEADS, "bond/heat", electrical.same(1.01, 20))
    assert seen == {"current density", "Joule heat"}


@pytest.mark.parametrize("name", ["potential + 1 %", "Joule heat halved", "no conductor floats"])
def test_faults_of_the_solver_are_seen(name):
    (fault,) = (f for f in FAULTS if f.name == name)
    with applied({fault.target: fault.change}):
        assert failed(LEADS, "bond/heat", electrical.same(1.0, 20))
