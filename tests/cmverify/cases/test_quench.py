"""Quenched cracks: the coarse flaw's books hold and see a fault; what they are held against."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import erfc

from cmverify.cases import quench
from cmverify.cases.quench import CASES, FAULTS, PITCH, SMALL, WIDTH, Flaw
from cmverify.faults.fault import applied
from cmverify.judge.verdict import judge

(CASE,) = CASES


def failed(method, outcome, n) -> set[str]:
    """Quantities whose bounds do not hold."""
    verdicts = judge(CASE, {method: {n: outcome}})
    assert verdicts
    return {v.quantity for v in verdicts if not v.passed and v.kind != "order"}


def test_the_coarse_flaw():
    outcome = quench.flaw(SMALL, 12)
    assert not failed("one flaw, coarse", outcome, 12)
    assert outcome.statistics["bonds broken"] > 0
    # Its K is far from Griffith's, and would be seen.
    assert failed("one flaw", outcome, 40) == {"largest K"}


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_faults_are_seen(fault):
    with applied({fault.target: fault.change}):
        assert failed("one flaw, coarse", quench.flaw(SMALL, 12), 12) == {"balance"}


def test_a_flaw_that_never_grows_passes_nothing():
    outcome = quench.flaw(Flaw(m=2, depth=0.2, length=1.0, first=1e-4, last=2e-4, times=2), 12)
    assert {"largest K", "least K"} <= failed("one flaw", outcome, 40)


def test_the_series_is_the_half_space_s_while_it_is_cold_near_the_edge():
    depth = np.linspace(0.0, 0.5 * WIDTH, 30)
    for time in (1e-3, 0.05):
        reach = 2 * np.sqrt(quench.DIFFUSIVITY * time)
        np.testing.assert_allclose(quench.series(depth, time), -erfc(depth / reach), atol=3e-3)


def test_griffith_s_crack_rests_where_its_k_is_that_of_the_material():
    few = Flaw(first=0.02, times=3)
    depth = quench.griffith(few)
    assert (np.diff(depth) > 0).all()
    np.testing.assert_allclose(quench.toughness_over(few, depth, few.at), 1.0, atol=0.02)


def test_depths_are_those_of_the_deepest_bond_beside_a_flaw():
    places, depths = np.array([-PITCH, 0.0, PITCH]), np.full(3, 4e-4)
    run = SimpleNamespace(midpoints=np.array([[1e-4, 0.25 * WIDTH - 2e-3], [1.1e-3, 2.4e-3]]))
    np.testing.assert_allclose(quench.reached(run, places, depths), [4e-4, 2e-3, 4e-4])
