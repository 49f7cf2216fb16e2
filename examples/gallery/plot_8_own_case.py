"""
A case of one's own
===================

A case declares a problem once: methods that solve it, resolutions, and checks with the source of
their bounds. The runner, the report, asv and pytest take it from there. Here it is run by hand.
"""

import numpy as np

from cmverify.case import Case, Check, Level, Measurement, Method, OrderBand
from cmverify.judge.norms import relative_l2
from cmverify.judge.verdict import judge
from solver import ConductivityTensor, Scene, Support, rectangle

# %%
# The problem: a rectangle that conducts, anisotropic, with the temperature sin(πx) sinh(ky) in it.
# It solves div(D∇T) = 0 for D = diag(1, 4) with k = π/2.


def exact(x, y):
    return np.sin(np.pi * x) * np.sinh(0.5 * np.pi * y)


def solve(n, across=4.0):
    scene = Scene(
        region=rectangle(1.0, 1.0, (0.5, 0.5)),
        spacing=1 / n,
        m=3,
        material=ConductivityTensor([[1.0, 0.0], [0.0, across]]),
        supports=[Support.layer(cells=3.5, temperature=exact)],
    )
    solution = scene.solve(tolerance=1e-11)
    free = ~solution.prescribed
    truth = exact(*solution.points[free].T)
    return Measurement(
        unknowns=solution.statistics.unknowns,
        quantities={"temperature": relative_l2(solution.temperature[free], truth)},
    )


# %%
# What must hold, and why: second order from theory, an absolute bound from a measurement with a
# margin. A check without a bound is refused, and so is one of a method that is not there.
case = Case(
    name="my-rectangle",
    title="Separated solution in a rectangle",
    section="mine",
    shows="Smooth anisotropic conduction converges at second order.",
    methods=(Method("bond/lattice", "bond", solve, {Level.QUICK: (40, 80)}),),
    checks=(
        Check(
            "bond/lattice",
            "temperature",
            {40: 1e-5, 80: 3e-6},
            order=OrderBand(1.7, 2.4),
            source="closed form; second order by theory, measured with half as much again",
        ),
    ),
    quantities={"temperature": "relative L2 error of the temperature"},
    primary="temperature",
    featured="bond/lattice",
)
outcomes = {method.name: {} for method in case.methods}
for method, n in case.plan(Level.QUICK):
    outcomes[method.name][n] = method.run(n)
verdicts = judge(case, outcomes)
for verdict in verdicts:
    print("holds" if verdict.passed else "FAILS", verdict)
assert all(verdict.passed for verdict in verdicts)

# %%
# Would it notice a fault? A check that cannot fail is worth nothing: conduct 1 % too well across.
wrong = {"bond/lattice": {n: solve(n, across=4.04) for n in (40, 80)}}
failing = [verdict for verdict in judge(case, wrong) if not verdict.passed]
for verdict in failing:
    print("FAILS", verdict)
assert failing

# %%
# Put ``CASES = (case,)`` into a module of ``cmverify/cases`` and it is part of the suite.
