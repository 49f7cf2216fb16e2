"""The judges judged: norms, orders and extrapolation of numbers whose answer is known."""

from __future__ import annotations

import math

import numpy as np

from cmverify.case import Case, Check, Level, Measurement, Method
from cmverify.cases.common import bond_energies
from cmverify.judge import convergence, norms

SIZES = np.array([1 / 10, 1 / 20, 1 / 40])


def measure(_: int) -> Measurement:
    """Errors of 1 %, energies of waves, orders of 2, a limit of 3, and NaN that has to stay NaN."""
    from solver import ElasticTensor, Family
    from solver.material import ElasticModuli, calibrate

    values = np.random.default_rng(2022).normal(size=(50, 2))
    errors = 0.3 * SIZES**2
    limit = convergence.richardson(SIZES, 3.0 + errors)
    spoilt = [norms.relative_l2([1.0, math.nan], [1.0, 2.0]), norms.worst([0.1, math.nan, 0.2])]
    # A solid whose every wave stores energy, and one with bonds that push where they should pull.
    family, solid = Family(3), ElasticTensor.isotropic(1.0, 0.2)
    stable = calibrate(family, solid, "lattice")
    assert isinstance(stable, ElasticModuli)
    unstable = ElasticModuli(-stable.normal, stable.shear)
    waves = [np.array([1.0, 0.3]), np.array([0.0, 0.0]), np.array([np.pi, np.pi])]
    misjudged = [bond_energies.is_unstable(family, stable, k) for k in waves]
    misjudged += [not bond_energies.is_unstable(family, unstable, k) for k in waves]
    fit = convergence.fitted_order(SIZES, errors)
    return Measurement(
        0,
        {
            "one per cent": abs(norms.relative_l2(1.01 * values, values) / 0.01 - 1.0),
            "worst": abs(norms.worst([0.1, 0.3, 0.2]) / 0.3 - 1.0),
            "order": float(np.abs(convergence.observed_orders(SIZES, errors) - 2.0).max()),
            "fitted order": math.nan if fit is None else abs(fit.order - 2.0),
            "limit": abs(limit.value / 3.0 - 1.0),
            "limit's order": abs(limit.order - 2.0),
            "waves misjudged": float(sum(misjudged)),
            "numbers made of NaN": float(sum(not math.isnan(s) for s in spoilt)),
        },
    )


QUANTITIES = {
    "one per cent": "relative deviation of an L2 error that is 1 %",
    "worst": "the largest of three errors",
    "order": "observed orders of errors that fall with the square of the size",
    "fitted order": "the order fitted to them",
    "limit": "Richardson's limit of values with these errors",
    "limit's order": "the order that it observes",
    "waves misjudged": "waves of a stable solid that the bonds' energies call unstable, and the "
    "reverse",
    "numbers made of NaN": "norms that are numbers although one value is none",
}

COUNTED = ("waves misjudged", "numbers made of NaN")

CASES = (
    Case(
        name="yardsticks",
        title="Norms, orders and limits of known numbers",
        section="Sect. 2.3 (error norms)",
        tags=("judges",),
        shows="An error of one per cent is reported as one per cent, and NaN as NaN.",
        methods=(Method("judges", "exact", measure, dict.fromkeys(Level, (1,))),),
        checks=(
            *(
                Check("judges", q, {1: 1e-9}, source="arithmetic", exact=True)
                for q in QUANTITIES
                if q not in COUNTED
            ),
            *(Check("judges", q, equals={1: 0.0}, source="arithmetic") for q in COUNTED),
        ),
        quantities=QUANTITIES,
        primary="one per cent",
        featured="judges",
        length="a",
        timed=False,
    ),
)
