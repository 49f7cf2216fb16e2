"""Transient cases see a conductivity that is 1 % off."""

import pytest

from cmverify.cases import transient
from cmverify.judge.verdict import judge

CASES = {case.name: case for case in transient.CASES}


def passed(name, method, measured, n, quantity):
    verdicts = judge(CASES[name], {method: {n: measured}})
    found = [v.passed for v in verdicts if v.quantity == quantity and v.kind == "bound"]
    assert found
    return all(found)


@pytest.mark.parametrize(
    ("name", "method", "measure", "n"),
    [
        ("heat-point-source", "bond/lattice", transient.spread, 50),
        ("heat-crack", "bond/extrapolated", transient.cool, 40),
    ],
)
def test_one_percent_of_conductivity_is_seen(name, method, measure, n):
    wrong = measure(transient.Heat(distortion=1.01), n)
    assert not passed(name, method, wrong, n, "temperature")
    assert passed(name, method, wrong, n, "balance")


def test_the_turned_rectangle_sees_it_where_it_is_fine_enough():
    right, wrong = (transient.decay(transient.Heat(distortion=d), 80) for d in (1.0, 1.02))
    assert passed("heat-cosines", "bond/extrapolated", right, 80, "temperature")
    assert not passed("heat-cosines", "bond/extrapolated", wrong, 80, "temperature")
