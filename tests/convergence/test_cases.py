"""Every declared case must hold: quick level always, the paper's resolution with --slow."""

import pytest

from cmverify.case import Case, Level
from cmverify.cases import registry

CASES = registry.all_cases()


def complaints(result) -> list[str]:
    return [
        f"{v.method} {v.quantity} {v.where}: {v.value:.4g}, must hold {v.asked} {v.message}"
        for v in result.verdicts
        if not v.passed
    ]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_quick_level(case: Case, measurements):
    result = measurements.of(case, Level.QUICK)
    assert not complaints(result)
    assert result.passed


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_standard_level(case: Case, measurements):
    assert not complaints(measurements.of(case, Level.STANDARD))


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_papers_resolution(case: Case, measurements):
    result = measurements.of(case, Level.PAPER)
    assert not complaints(result)
    assert result.passed
    assert not result.unjudged, "the paper's level judges every check"
