"""Transient heat: an anisotropic point source, a cosine product in a turned body, a crack."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from cmverify.case import Array, Case, Check, Field, FieldSet, Level, Measurement, Method, OrderBand
from cmverify.cases.common import adapters
from cmverify.cases.common.warm import conduction_in_time
from cmverify.judge.norms import relative_l2

CONDUCTIVITY = np.array([[5.0, 2.0], [2.0, 1.0]])
CAPACITY = 2.0
# Errors in time stay well below those of the lattice.
TOLERANCE = 1e-6
M = 3


@dataclass(frozen=True)
class Heat:
    """Surface treatment; `distortion`, for tests, is a factor on the conductivity's first entry."""

    surface: Any = "extrapolated"
    distortion: float = 1.0

    def tensor(self, exact: Array) -> Array:
        """The conductivity that the solver is given."""
        given = exact.copy()
        given[0, 0] *= self.distortion
        return given


def measured(run: Any, exact: Array, extra: dict[str, float] | None = None) -> Measurement:
    """Error at the end, balance of heat, and how it was reached."""
    statistics = run.statistics
    where = run.points
    return Measurement(
        statistics.unknowns,
        {
            "temperature": relative_l2(run.temperature[-1], exact),
            "balance": statistics.balance,
            **(extra or {}),
        },
        {"setup": statistics.setup_seconds, "solve": statistics.solve_seconds},
        {
            "steps": statistics.steps,
            "iterations a step": statistics.iterations / max(statistics.steps, 1),
            "preconditioners": statistics.preconditioners,
        },
        FieldSet(
            where,
            {"temperature": Field("$T$", "K", run.temperature[-1], exact)},
            spacing=run.body.scene.spacing,
        ),
    )


# ---- an instantaneous point source -----------------------------------------------------------

BEFORE, END = 0.05, 0.1


def spreading(x: Array, y: Array, t: float) -> Array:
    """A source of strength one at the origin in the plane, `BEFORE` ago at t = 0."""
    inverse = np.linalg.inv(CONDUCTIVITY)
    square = inverse[0, 0] * x * x + 2 * inverse[0, 1] * x * y + inverse[1, 1] * y * y
    later = t + BEFORE
    height = CAPACITY / (4 * np.pi * later * np.sqrt(np.linalg.det(CONDUCTIVITY)))
    found: Array = height * np.exp(-CAPACITY * square / (4 * later))
    return found


def spread(problem: Heat, n: int) -> Measurement:
    """The source in a disc whose rim follows the exact field; steps of second order besides."""
    from solver import ConductivityTensor, Scene, Support, disc, transient

    scene = Scene(
        region=disc(1.0),
        spacing=1.0 / n,
        m=M,
        material=ConductivityTensor(problem.tensor(CONDUCTIVITY)),
        heat_capacity=CAPACITY,
        supports=[Support.layer(M + 0.5, temperature=spreading)],
    )

    def march(**options: Any) -> Any:
        return transient.run(scene, lambda x, y: spreading(x, y, 0.0), [END], **options)

    run = march(tolerance=TOLERANCE)
    # On one lattice, so that nothing but time is seen.
    fine, *coarse = (march(step=END / k).temperature[-1] for k in (64, 8, 16))
    errors = [np.linalg.norm(field - fine) for field in coarse]
    order = float(np.log2(errors[0] / errors[1]))
    extra = {"order in time": order, "off second order": abs(order - 2.0)}
    x, y = run.points.T
    return measured(run, spreading(x, y, END), extra)


# ---- a cosine product in an insulated turned rectangle ---------------------------------------

ANGLE, WIDTH, HEIGHT, LATE = 0.35, 1.0, 0.6, 0.02
ALONG = np.array([[np.cos(ANGLE), -np.sin(ANGLE)], [np.sin(ANGLE), np.cos(ANGLE)]])
TURNED = ALONG @ np.diag([3.0, 1.0]) @ ALONG.T


def cosines(x: Array, y: Array, t: float) -> Array:
    """Two half waves along, one across: they decay as they are."""
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    along, across = c * x + s * y + WIDTH / 2, c * y - s * x + HEIGHT / 2
    p, q = 2 * np.pi / WIDTH, np.pi / HEIGHT
    decay = np.exp(-(3.0 * p * p + q * q) * t / CAPACITY)
    found: Array = np.cos(p * along) * np.cos(q * across) * decay
    return found


def decay(problem: Heat, n: int) -> Measurement:
    """The product in a rectangle that no lattice fits, by a treatment of its surface."""
    from solver import ConductivityTensor, Scene, rectangle, transient

    scene = Scene(
        region=rectangle(WIDTH, HEIGHT, angle=ANGLE),
        spacing=1.0 / n,
        m=M,
        material=ConductivityTensor(problem.tensor(TURNED)),
        heat_capacity=CAPACITY,
        surface=problem.surface,
    )
    run = transient.run(scene, lambda x, y: cosines(x, y, 0.0), [LATE], tolerance=TOLERANCE)
    x, y = run.points.T
    return measured(run, cosines(x, y, LATE))


# ---- a cracked body against finite elements --------------------------------------------------

CRACK = ((-0.5, 0.0), (0.1, 0.0))
COOLED = 0.05


def warm(x: Array, y: Array) -> Array:
    """Warm above, cold below, no gradient across the edges."""
    return np.asarray(0.5 + 0.5 * np.sin(np.pi * np.clip(y, -0.5, 0.5)))


def by_elements(n: int) -> Array:
    """The same by quadratic elements, fine about the tip: stored at the particles of spacing L/n.

    Raises
    ------
    LookupError
        If what is stored is not this problem, or not for this spacing.
    """
    from references.provenance import load

    stored = load("cracked-square-cools")
    given = stored.record["arguments"]
    problem = {"capacity": CAPACITY, "tip": CRACK[1][0], "duration": COOLED}
    same = all(given[key] == value for key, value in problem.items())
    if not same or np.any(given["conductivity"] != CONDUCTIVITY) or n not in given["grids"]:
        raise LookupError(f"cracked-square-cools is of another problem, or not stored at L/{n}")
    return stored[f"grid_{n}"]


def cool(problem: Heat, n: int) -> Measurement:
    """An insulated square with an edge crack between its warm and its cold half."""
    from solver import ConductivityTensor, Crack, Scene, rectangle, transient

    scene = Scene(
        region=rectangle(1.0, 1.0),
        spacing=1.0 / n,
        m=M,
        material=ConductivityTensor(problem.tensor(CONDUCTIVITY)),
        heat_capacity=CAPACITY,
        surface=problem.surface,
        cracks=[Crack((-0.6, 0.0), CRACK[1])],
    )
    run = transient.run(scene, warm, [COOLED], tolerance=TOLERANCE)
    exact = by_elements(n)
    # Relative to how far it is from even: the mean says nothing.
    mean = float(exact.mean())
    found = measured(run, exact)
    error = relative_l2(run.temperature[-1] - mean, exact - mean)
    quantities = {**found.quantities, "temperature": error}
    return Measurement(
        found.unknowns, quantities, found.seconds, found.statistics, found.fields, found.lines
    )


BALANCE = "heat is conserved part by part to rounding"
SECOND = "second order of the lattice; bounds one and a half times the measured values"
LADDER = {Level.QUICK: (25,), Level.STANDARD: (25, 50), Level.PAPER: (25, 50, 100)}
TURNS = {Level.QUICK: (20, 40), Level.STANDARD: (20, 40, 80), Level.PAPER: (20, 40, 80, 160)}
OTHERS = {Level.STANDARD: (20, 40, 80), Level.PAPER: (20, 40, 80, 160)}
CRACKS = {Level.STANDARD: (20, 40), Level.PAPER: (20, 40, 80)}
QUANTITIES = {
    "temperature": "relative L2 error of the temperature at the end",
    "balance": "|heat stored − heat that flowed in|, relative",
}

CASES = (
    Case(
        name="heat-point-source",
        title="An instantaneous point source spreads in an anisotropic plane",
        section="Sect. 4",
        equations=("Eqs. 130, 168",),
        tags=("transient", "conduction"),
        shows=(
            "With its rim following the exact field a disc has the closed form at second order in "
            "space and in time, and its heat balances to rounding."
        ),
        methods=(
            Method("bond/lattice", "bond", partial(spread, Heat()), LADDER, conduction_in_time),
        ),
        checks=(
            Check(
                "bond/lattice",
                "temperature",
                {25: 3.5e-3, 50: 9e-4, 100: 2.3e-4},
                order=OrderBand(1.7, 2.3),
                source=SECOND,
            ),
            Check("bond/lattice", "balance", {25: 1e-10}, source=BALANCE, exact=True),
            Check(
                "bond/lattice",
                "off second order",
                {25: 0.2},
                source="TR-BDF2 is of second order; on one lattice nothing else is seen",
            ),
        ),
        quantities=QUANTITIES
        | {
            "order in time": "observed order of fixed steps on one lattice",
            "off second order": "|order in time − 2|",
        },
        primary="temperature",
        featured="bond/lattice",
    ),
    Case(
        name="heat-cosines",
        title="A cosine product decays in an insulated rectangle that the lattice does not fit",
        section="Sect. 4",
        equations=("Eq. 130",),
        tags=("transient", "conduction", "surfaces"),
        shows=(
            "Insulated edges at any angle are of second order with bonds that end at the surface "
            "and particles that store their strip's heat; the other treatments are of first."
        ),
        methods=tuple(
            Method(f"bond/{s}", "bond", partial(decay, Heat(s)), levels, conduction_in_time)
            for s, levels in (("extrapolated", TURNS), ("volume", OTHERS), ("none", OTHERS))
        ),
        checks=(
            Check(
                "bond/extrapolated",
                "temperature",
                {20: 0.11, 40: 0.031, 80: 7.5e-3, 160: 1.9e-3},
                order=OrderBand(1.6, 2.4),
                source=SECOND,
            ),
            *(
                Check(f"bond/{s}", "balance", {20: 1e-10}, source=BALANCE, exact=True)
                for s in ("extrapolated", "volume", "none")
            ),
        ),
        quantities=QUANTITIES,
        primary="temperature",
        featured="bond/extrapolated",
    ),
    Case(
        name="heat-crack",
        title="A warm and a cold half, a crack between them, against finite elements",
        section="Sect. 4",
        equations=("Eq. 130",),
        tags=("transient", "conduction", "crack"),
        shows=(
            "Heat goes round an insulating crack as quadratic elements on a mesh with a real slit "
            "have it."
        ),
        methods=(
            Method(
                "bond/extrapolated",
                "bond",
                partial(cool, Heat()),
                {Level.QUICK: (20,), **CRACKS},
                conduction_in_time,
            ),
            Method(
                "bond/volume", "bond", partial(cool, Heat("volume")), CRACKS, conduction_in_time
            ),
        ),
        checks=(
            Check(
                "bond/extrapolated",
                "temperature",
                {20: 5.2e-3, 40: 1.9e-3, 80: 1.1e-3},
                order=OrderBand(0.8, 2.4),
                source="the tip's √r limits the order to about one; bounds from measured values",
            ),
            Check("bond/extrapolated", "balance", {20: 1e-10}, source=BALANCE, exact=True),
        ),
        quantities=QUANTITIES,
        elements=adapters.stored("cracked-square-cools", size=0.05, steps=40, grids=[20]),
        primary="temperature",
        featured="bond/extrapolated",
        length="L",
    ),
)
