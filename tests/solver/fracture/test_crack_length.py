"""Crack lengths from drops: exact curves, honest uncertainties, refusals."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver import SceneError
from solver.fracture.crack_length import DropCurve
from solver.fracture.ledger import History

few = settings(derandomize=True, deadline=None, max_examples=25)


def cubic(r):
    z = np.log(r)
    return 0.2 + 0.5 * z - 0.1 * z**2 + 0.02 * z**3


@few
@given(st.floats(1.0, 2.5), st.floats(0.0, 0.1), st.floats(0.5, 500.0))
def test_a_cubic_is_found_and_noise_is_carried(drop, noise, intact):
    r = np.linspace(1.0, 2.5, 9)
    found = DropCurve(cubic(r), intact * r, intact).length(drop, noise)
    assert found.length == pytest.approx(cubic(drop), rel=1e-9)
    slope = (cubic(drop + 1e-6) - cubic(drop - 1e-6)) / 2e-6
    assert found.uncertainty == pytest.approx(slope * noise, rel=1e-5, abs=1e-12)


def test_two_uncertainties_hold_nineteen_of_twenty():
    """Ragged tips and a noisy voltmeter: what is said of the error is what it is."""
    rng = np.random.default_rng(174)
    hits = 0
    for _ in range(300):
        r = np.sort(rng.uniform(1.0, 2.5, 25))
        curve = DropCurve(cubic(r) + rng.normal(0, 4e-3, 25), r, 1.0)
        low, high = curve.range
        true = rng.uniform(low + 0.1, high - 0.1)
        found = curve.length(true + rng.normal(0, 5e-3), noise=5e-3)
        ragged = cubic(true) + rng.normal(0, 4e-3)
        hits += abs(found.length - ragged) < 2 * found.uncertainty
    assert 0.92 <= hits / 300 <= 0.98


def test_a_run_is_a_curve_of_what_broke_bonds_at_rest():
    """Loads that break nothing, avalanches and a body that has parted are left out."""
    history, r = History(("drop",)), np.linspace(1.0, 2.0, 7)
    rows = [(x, cubic(x) - cubic(1.0), k, 1.0) for k, x in enumerate(r)]
    rows[3:3] = [(5.0, 0.0, 3, 0.0), (r[2], rows[2][1], 2, 1.0)]
    rows.append((np.inf, 1.0, 9, 1.0))
    for drop, advance, broken, settled in rows:
        others = dict.fromkeys(History.NAMES, 0.0)
        own = {"advance": advance, "broken": broken, "settled": settled, "drop": 3.0 * drop}
        history.add(**others | own)
    curve = DropCurve.of_run(SimpleNamespace(history=history), "drop", cubic(1.0))
    assert len(curve.lengths) == 7
    assert curve.length(1.63).length == pytest.approx(cubic(1.63), rel=1e-9)


def test_what_tells_nothing_is_refused():
    r = np.linspace(1.0, 2.0, 6)
    with pytest.raises(SceneError, match="at least 5 cracks"):
        DropCurve(cubic(r[:4]), r[:4], 1.0)
    with pytest.raises(SceneError, match="finite"):
        DropCurve(np.where(r > 1.5, np.nan, cubic(r)), r, 1.0)
    with pytest.raises(SceneError, match="does not tell the crack's length"):
        DropCurve((r - 1.5) ** 2, r, 1.0)
    curve = DropCurve(cubic(r), r, 1.0)
    with pytest.raises(SceneError, match="beyond the cracks"):
        curve.length(2.4)
    with pytest.raises(SceneError, match="cannot be -1"):
        curve.length(1.5, noise=-1.0)
