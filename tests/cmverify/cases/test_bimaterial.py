"""Cases of two solids: they hold, and each kind of check sees a few per cent, or a fault."""

import pytest

from cmverify.cases import bimaterial
from cmverify.cases.bimaterial import CASES, CELLS, FAULTS
from cmverify.faults.fault import applied
from cmverify.judge.verdict import judge

PATCH, PLATE = CASES


def failed(case, outcome, n: int) -> set[str]:
    """Quantities whose bounds do not hold."""
    (method,) = case.methods
    verdicts = judge(case, {method.name: {n: outcome}})
    return {v.quantity for v in verdicts if not v.passed and v.kind != "order"}


@pytest.mark.parametrize(("scale", "seen"), [(1.0, 0), (1.01, 4)])
def test_patches(scale, seen):
    assert len(failed(PATCH, bimaterial.patches(scale, CELLS), CELLS)) == seen


@pytest.mark.parametrize(("scale", "seen"), [(1.0, False), (1.1, True)])
def test_the_disc(scale, seen):
    """A stiff disc strains little: a tenth of its modulus is a percent of the plate's."""
    assert bool(failed(PLATE, bimaterial.plate(scale, 20), 20)) == seen


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_faults_are_seen(fault):
    with applied({fault.target: fault.change}):
        seen = failed(PATCH, bimaterial.patches(1.0, CELLS), CELLS)
        assert seen or failed(PLATE, bimaterial.plate(1.0, 20), 20)
