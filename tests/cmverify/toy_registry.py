"""Tiny cases with a known order, looked up by worker processes in the tests of the harness."""

import os
import time

import numpy as np

from cmverify.case import (
    Case,
    Check,
    Curve,
    Field,
    FieldSet,
    Level,
    LinePlot,
    Measurement,
    Method,
    OrderBand,
)

LADDER = {Level.QUICK: (10, 20), Level.STANDARD: (10, 20, 40), Level.PAPER: (10, 20, 40)}


def trapezium(n: int, scale: float = 1.0) -> Measurement:
    """The integral of exp over [0, 1] by the trapezium rule: order 2, exact value e - 1."""
    x = np.linspace(0.0, 1.0, n + 1)
    y = np.exp(x)
    # By hand: each worker process would load SciPy for it.
    value = scale * float(np.sum(y[1:] + y[:-1])) / (2 * n)
    error = abs(value / (np.e - 1.0) - 1.0)
    grid = np.column_stack([np.tile(x, 2), np.repeat([0.0, 1.0 / n], n + 1)])
    exact = np.exp(grid[:, 0])
    fields = FieldSet(grid, {"f": Field("$f$", "1", exact * scale, exact)}, spacing=1.0 / n)
    curve = Curve("f", x, scale * np.exp(x), np.exp(x))
    return Measurement(
        unknowns=n + 1,
        quantities={"integral": float(error)},
        seconds={"setup": 1e-4 * n, "solve": 2e-4 * n},
        statistics={"points": n + 1, "rule": "trapezium"},
        fields=fields,
        lines=(LinePlot("f along x", "x", "f", (curve,)),),
    )


def raises(n: int) -> Measurement:
    raise ArithmeticError(f"no luck at {n} [/brackets]")


def dies(n: int) -> Measurement:
    os._exit(7)


def naps(n: int) -> Measurement:
    time.sleep(0.2)
    return trapezium(n)


def sleeps(n: int) -> Measurement:
    time.sleep(60.0)
    return trapezium(n)


def toy(name="toy", run=trapezium, tags=("toys",), checks=None) -> Case:
    method = Method("bond/trapezium", "bond", run, LADDER)
    return Case(
        name=name,
        title="A toy",
        section="none",
        shows="that the harness works",
        methods=(method,),
        checks=(
            checks
            if checks is not None
            else (
                # (1/12) h^2 is the leading error of the rule for exp, relative to the integral
                Check("bond/trapezium", "integral", {10: 8.5e-4}, order=OrderBand(1.9, 2.1)),
            )
        ),
        quantities={"integral": "relative error of the integral"},
        primary="integral",
        featured="bond/trapezium",
        tags=tags,
    )


CASES = {
    "toy": toy(),
    "raising": toy("raising", raises),
    "dying": toy("dying", dies),
    "napping": toy("napping", naps),
    "sleeping": toy("sleeping", sleeps, tags=()),
}


def get(name: str) -> Case:
    return CASES[name]
