"""The plates' case holds, sees one per cent of stiffness and modes out of order."""

from dataclasses import replace

from cmverify.cases.modes import plates
from cmverify.judge.verdict import judge

MILD = next(plate for plate in plates.PLATES if plate.name == "mild 30°")
CASE = plates.CASES[0]


def failed(measurements):
    verdicts = judge(CASE, {"bond/mild 30°": measurements})
    return {(v.quantity, v.kind) for v in verdicts if not v.passed}


def test_one_per_cent_and_crossed_modes_are_seen():
    measured = plates.bond(MILD, 24)
    assert not failed({24: measured})
    assert ("first", "bound") in failed({24: plates.bond(MILD, 24, stiffer=1.01)})
    crossed = replace(measured, quantities={**measured.quantities, "crossed": 1.0})
    assert ("crossed", "equal") in failed({100: crossed})


def test_every_plate_has_a_positive_stiffness():
    import numpy as np

    for plate in plates.PLATES:
        assert np.linalg.eigvalsh(plate.voigt)[0] > 0
