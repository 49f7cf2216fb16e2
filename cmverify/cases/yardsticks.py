"""The judges judged: norms, orders and extrapolation of numbers whose answer is known."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from cmverify.case import Array, Case, Check, Level, Measurement, Method
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


def answers(_: int) -> Measurement:
    """What `cmverify compare` says of answers that are off by what is known.

    Fields are carried to points between the answer's own: quadratic ones by its particles and
    linear ones by its triangles exactly, and cubics in time. A crack's path is off by a shift.
    """
    from cmverify.exchange import compare
    from cmverify.exchange.answers import Answer
    from cmverify.exchange.statement import (
        ABSOLUTE,
        L2,
        L2_STRAINED,
        LARGEST,
        LINES,
        Statement,
        Target,
    )
    from solver import Crack, ElasticTensor, Scene, rectangle

    scene = Scene(
        region=rectangle(2.0, 2.0),
        spacing=0.1,
        m=3,
        material=ElasticTensor.isotropic(1.0, 0.2),
        cracks=[Crack((-0.9, 0.0), (0.9, 0.0))],
    )
    wanted = np.random.default_rng(2022).uniform(-0.8, 0.8, size=(40, 2))
    side = (np.arange(20) - 9.5) / 10
    points = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    # Two triangles a square of the answer's points.
    first = (20 * np.arange(19)[:, None] + np.arange(19)).ravel()
    squares = first[:, None, None] + np.array([[0, 1, 21], [0, 21, 20]])
    triangles = squares.reshape(-1, 3)

    def parted(at: Array) -> Array:
        """Quadratic on either side of the crack, with a jump at it."""
        x, y = at.T
        return np.where(y > 0, 5.0 + x**2 - x * y, 2.0 * y**2 - x)

    def linear(at: Array) -> Array:
        return 3.0 + at @ [1.0, -0.5]

    def moved(at: Array) -> Array:
        """A strain; the answer adds to it a rigid motion that is none of its errors."""
        return at @ np.array([[0.3, 0.1], [0.1, -0.2]])

    def motion(at: Array) -> Array:
        return np.array([0.4, -0.7]) + 0.9 * np.stack([-at[:, 1], at[:, 0]], axis=-1)

    def cubic(times: Array, at: Array) -> Array:
        return (1.0 + times**3)[:, None] * linear(at)

    when, then = np.linspace(0.0, 1.0, 7), np.array([0.05, 0.52, 0.9])
    line = np.array([[0.0, 0.0], [0.3, 0.0], [0.5, 0.1]])
    numbers = np.array([1.0, 2.0, 4.0])
    angle = np.array([-42.0])
    stated = Target("angle", "angle", "°", angle, ABSOLUTE)

    def error(target: Target, values: Array, **more: Any) -> float:
        given = Answer("another", {target.key: values}, **more)
        found = compare.score(Statement(scene, (target,)), given)
        return found.quantities[target.quantity]

    def field(name: str, exact: Array, norm: str, **more: Any) -> Target:
        return Target(name, name, "", exact, norm, points=wanted, **more)

    off = {
        "carried by particles": error(
            field("T", parted(wanted), L2), 1.01 * parted(points), points=points
        ),
        "carried by triangles": error(
            field("T", linear(wanted), L2), 1.01 * linear(points), points=points,
            triangles=triangles,
        ),
        "carried in time": error(
            field("T", cubic(then, wanted), L2, times=then), 1.01 * cubic(when, points),
            points=points, times=when,
        ),
        "but for a motion": error(
            field("u", moved(wanted), L2_STRAINED), 1.01 * moved(points) + motion(points),
            points=points,
        ),
        "largest of numbers": error(
            Target("f", "f", "Hz", numbers, LARGEST), numbers * [1.0, 0.99, 1.005]
        ),
        "angle": error(stated, angle + 0.01),
        "path": error(Target("path", "path", "m", line, LINES), line + np.array([0.0, 0.01])),
    }  # fmt: skip
    return Measurement(0, {name: abs(found / 0.01 - 1.0) for name, found in off.items()})


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
    "carried by particles": "relative deviation of the error of an answer that is 1 % off, carried "
    "from particles on both sides of a crack",
    "carried by triangles": "the same of a linear field on triangles",
    "carried in time": "the same of a field that grows with the cube of time",
    "but for a motion": "the same of a strain to which a rigid motion is added",
    "largest of numbers": "the same of numbers of which the worst is 1 % off",
    "angle": "the same of an angle that is 0.01° off",
    "path": "the same of a crack's path that lies 0.01 beside the right one",
}

COUNTED = ("waves misjudged", "numbers made of NaN")
ANSWERS = (
    "carried by particles", "carried by triangles", "carried in time", "but for a motion",
    "largest of numbers", "angle", "path",
)  # fmt: skip

CASES = (
    Case(
        name="yardsticks",
        title="Norms, orders and limits of known numbers",
        section="Sect. 2.3 (error norms)",
        tags=("judges",),
        shows=(
            "An error of one per cent is reported as one per cent, and NaN as NaN; so are those "
            "of another program's answer, wherever its points lie."
        ),
        methods=(
            Method("judges", "exact", measure, dict.fromkeys(Level, (1,))),
            Method("answers", "exact", answers, dict.fromkeys(Level, (1,))),
        ),
        checks=(
            *(
                Check("judges", q, {1: 1e-9}, source="arithmetic", exact=True)
                for q in QUANTITIES
                if q not in (*COUNTED, *ANSWERS)
            ),
            *(
                Check(
                    "answers",
                    q,
                    {1: 1e-8},
                    source="what is carried exactly, over an error of 1e-2",
                    exact=True,
                )
                for q in ANSWERS
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
