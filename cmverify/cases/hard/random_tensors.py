"""Two hundred random positive-definite tensors: each is solved, or refused for the right reason.

G Gᵀ + 0.05 tr(G Gᵀ) I with normally distributed entries of G, so that no symmetry is favoured and
condition numbers reach about 20. A refusal counts as right if it is confirmed by other means: the
wave that it names has no positive energy, or linear programming finds no non-negative moduli.
What a refusal recommends instead is then tried.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from functools import partial
from itertools import islice

import numpy as np

from cmverify.case import Array, Case, Check, Level, Measurement, Method
from cmverify.cases.common import bond_energies, warm
from cmverify.cases.hard import bodies
from cmverify.judge.norms import worst

M = 3
#: Cells along an edge, and how many tensors are tried there.
COUNTS = {14: 16, 20: 200}
LADDER = {Level.QUICK: (14,), Level.STANDARD: (14, 20), Level.PAPER: (14, 20)}


def tensors() -> Iterator[Array]:
    """Endless random stiffnesses of norm one, (3, 3), from a fixed seed."""
    generator = np.random.default_rng(bodies.SEED)
    while True:
        factor = generator.normal(size=(3, 3))
        voigt = factor @ factor.T
        voigt += 0.05 * np.trace(voigt) * np.eye(3)
        yield voigt / np.linalg.norm(voigt)


def attempt(voigt: Array, n: int, calibration: str) -> tuple[str, float, float]:
    """Outcome of one tensor, its error (0 if refused) and its iterations.

    The outcome is "solved", "inadmissible", "unrepresentable", or "unexplained" for a refusal
    that other means do not confirm; "rescued" is appended where what it recommends was solved.
    """
    from solver import CalibrationError, ElasticTensor, Family, InadmissibleMaterialError
    from solver.material import calibrate

    exact = bodies.field_of(voigt, (1, 2))
    try:
        solution = bodies.solve(voigt, exact, n, M, calibration=calibration)
    except (CalibrationError, InadmissibleMaterialError) as refusal:
        message = str(refusal)
        if isinstance(refusal, CalibrationError):
            kind, right = (
                "unrepresentable",
                not bond_energies.non_negative_moduli_exist(Family(M), voigt),
            )
        else:
            wave = bond_energies.named_wave(message)
            moduli = calibrate(Family(M), ElasticTensor(voigt), calibration)  # type: ignore[arg-type]
            kind = "inadmissible"
            right = wave is not None and bond_energies.is_unstable(Family(M), moduli, wave)  # type: ignore[arg-type]
    else:
        error = worst(bodies.errors(solution, exact).values())
        return "solved", error, float(solution.statistics.iterations)
    if not right:
        return "unexplained", 0.0, 0.0
    remedy = bond_energies.named_remedy(message)
    if remedy is None:
        return kind, 0.0, 0.0
    m = remedy.pop("m", M)
    solution = bodies.solve(voigt, exact, max(n, 2 * m + 8), m, **remedy)
    return f"{kind}, rescued", worst(bodies.errors(solution, exact).values()), 0.0


def population(calibration: str, n: int) -> Measurement:
    """Shares of the outcomes and the worst error over all tensors of a resolution."""
    count, outcomes, largest, iterations = COUNTS[n], Counter[str](), 0.0, 0.0
    for voigt in islice(tensors(), count):
        outcome, error, steps = attempt(voigt, n, calibration)
        outcomes[outcome] += 1
        largest, iterations = worst((largest, error)), max(iterations, steps)
    shares = {key: value / count for key, value in outcomes.items()}
    refused = {k: v for k, v in shares.items() if k != "solved"}
    return Measurement(
        count,
        {
            "solved": shares.get("solved", 0.0),
            "inadmissible": sum(v for k, v in refused.items() if k.startswith("inadm")),
            "unrepresentable": sum(v for k, v in refused.items() if k.startswith("unrep")),
            "rescued": sum(v for k, v in refused.items() if k.endswith("rescued")),
            "unexplained": shares.get("unexplained", 0.0),
            "field": largest,
            "iterations": iterations,
        },
        statistics={"tensors": count, **{f"count {k}": v for k, v in outcomes.items()}},
    )


METHODS = ("bond/lattice", "bond/positive")

CASES = (
    Case(
        name="hard-random",
        title="Two hundred random tensors, each solved or refused for the right reason",
        section="Sect. 2.2",
        tags=("hard", "elasticity", "stability"),
        shows=(
            "Whatever positive-definite tensor is given, the fields are exact, or the refusal is "
            "confirmed by another method and what it recommends instead is exact."
        ),
        methods=tuple(
            Method(m, "bond", partial(population, m.split("/")[1]), LADDER, warm.statics)
            for m in METHODS
        ),
        checks=tuple(
            check
            for m in METHODS
            for check in (
                Check(m, "unexplained", equals=dict.fromkeys(COUNTS, 0.0), source=bodies.CONFIRMED),
                Check(m, "field", {14: 1e-9}, source=bodies.SOURCE, exact=True),
            )
        ),
        quantities={
            "solved": "share of the tensors that are solved as asked",
            "inadmissible": "share refused as unstable in bulk, confirmed by the energy of a wave",
            "unrepresentable": "share refused for want of non-negative bonds, confirmed by a "
            "linear program",
            "rescued": "share refused whose recommended calibration, law or m was then solved",
            "unexplained": "share refused for a reason that nothing else confirms",
            "field": "worst relative L2 error of displacement and rotation, quadratic field",
            "iterations": "most Krylov iterations",
        },
        primary="field",
        featured="bond/lattice",
        length="L",
        timed=False,
    ),
)
