"""Studies of convergence: each order that a case promises, and which path leads to what limit.

Parametrised over cases, norms and levels. `test_cases` judges every order at quick; here those
of the discs alone are measured then, and with ``--slow`` all of them at every level.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from cmverify.case import Check, Level, Measurement
from cmverify.cases import disc, registry
from cmverify.judge.convergence import fitted_order, observed_orders
from cmverify.judge.norms import relative_l2
from cmverify.run import worker


def ladder(case, check: Check, level: Level) -> tuple[int, ...]:
    assert check.order is not None
    found = case.method(check.method).resolutions.get(level, ())
    return tuple(n for n in found if n >= check.order.since)


def studies(level: Level):
    """Every order of every case that this level has two spacings for; each norm is its own."""
    for case in registry.all_cases():
        for check in case.checks:
            if check.order is not None and len(ladder(case, check, level)) > 1:
                name = f"{case.name}-{check.method}-{check.quantity}-{level}"
                cheap = level == Level.QUICK and check.method.startswith("bond")
                marks = () if cheap and "disc" in case.tags[:1] else pytest.mark.slow
                yield pytest.param(case, check, level, id=name, marks=marks)


@cache
def measured(case_name: str, method: str, n: int) -> Measurement:
    return worker.measure(registry.get(case_name).method(method), n)


@pytest.mark.parametrize(("case", "check", "level"), [p for level in Level for p in studies(level)])
def test_the_order_of(case, check, level):
    ns = np.array(ladder(case, check, level))
    found = [measured(case.name, check.method, int(n)) for n in ns]
    errors = [m.quantities[check.quantity] for m in found]
    if check.order.fitted:
        order = fitted_order(1.0 / ns, errors).order
    else:
        order = observed_orders(1.0 / ns, errors)[-1]
    assert check.order.low <= order <= check.order.high, list(zip(ns, errors, strict=True))


def error(calibration, m: float, n: int, norm: str) -> float:
    """Of a temperature that no polynomial is; the layer that is prescribed holds whole families."""
    scene = disc.scene_of(disc.EXPONENTIAL, calibration, n, m=m)
    solution = scene.solve(tolerance=1e-12)
    # Clear of what is prescribed for the longest bonds of any path, at the same places.
    inner = np.hypot(*solution.points.T) < 0.7
    exact = disc.EXPONENTIAL.exact().value(*solution.points[inner].T)
    if norm == "largest":
        return float(abs(solution.temperature[inner] - exact).max() / abs(exact).max())
    return relative_l2(solution.temperature[inner], exact)


#: Horizons of the spacings a/20, a/40 (and a/80 with --slow).
PATHS = {
    "m fixed, δ → 0": (3, 3, 3),
    "δ fixed, m → ∞": (2, 4, 8),
    "δ → 0, m → ∞": (2, 3, 4),
}
#: What the integrals of a continuum leave at a fixed m is an error that no refinement takes away.
CONVERGES = {
    ("continuum", "m fixed, δ → 0"): False,
    ("continuum", "δ fixed, m → ∞"): True,
    ("continuum", "δ → 0, m → ∞"): True,
    ("positive", "m fixed, δ → 0"): True,
    ("positive", "δ → 0, m → ∞"): True,
}


@pytest.mark.parametrize(
    "ns", [(20, 40), pytest.param((20, 40, 80), marks=pytest.mark.slow)], ids=["coarse", "fine"]
)
@pytest.mark.parametrize("norm", ["L2", "largest"])
@pytest.mark.parametrize(("calibration", "path"), CONVERGES, ids=map(", ".join, CONVERGES))
def test_which_path_leads_to_the_limit(calibration, path, norm, ns):
    errors = [error(calibration, m, n, norm) for m, n in zip(PATHS[path], ns, strict=False)]
    falls = np.array(errors[1:]) / errors[:-1]
    if CONVERGES[calibration, path]:
        assert (falls < 0.75).all(), errors
    else:
        assert (falls > 0.9).all(), errors
        assert errors[-1] > 1e-3
