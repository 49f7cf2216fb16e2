"""Small, large and fractional horizons, spacings that do not fit the body, and units."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from cmverify.case import Case, Check, Level, Measurement, Method
from cmverify.cases.common import adapters, warm
from cmverify.cases.hard import bodies
from cmverify.cases.hard.tensors import tensor
from cmverify.judge.norms import worst

LADDER = {Level.QUICK: (24,), Level.STANDARD: (24, 48), Level.PAPER: (24, 48, 96)}


def _tilted() -> Any:
    from solver import polygon

    corners = [(-0.41, -0.37), (0.53, -0.29), (0.47, 0.44), (-0.21, 0.51)]
    return polygon(corners)


def _disc() -> Any:
    from solver import disc

    return disc(0.497)


@dataclass(frozen=True)
class Setting:
    """How a lattice departs from m = 5, partial areas and a body of whole cells."""

    name: str
    m: float = 5
    scene: dict[str, Any] = field(default_factory=dict)
    region: Callable[[], Any] | None = None
    cells: float = 0.0  # added to the whole number of cells along the unit length


def fit(setting: Setting, n: int) -> Measurement:
    """Patch test of the fully anisotropic solid."""
    voigt = tensor("fully anisotropic")
    exact = bodies.field_of(voigt, (1, 2))
    scene = dict(setting.scene)
    if setting.region:
        scene["region"] = setting.region()
    scene["spacing"] = 1.0 / (n + setting.cells)
    solution = bodies.solve(voigt, exact, n, setting.m, **scene)
    found = bodies.errors(solution, exact)
    s = solution.statistics
    found |= {"iterations": float(s.iterations), "residual": s.residual, "margin": s.margin}
    return Measurement(s.unknowns, found, statistics=adapters.solver_statistics(s))


SETTINGS = (
    *(Setting(f"m = {m:g}", m) for m in (2, 2.5, 3, 3.7, np.pi, 7)),
    *(Setting(f"m = 3, {rule} areas", 3, {"area_rule": rule}) for rule in ("full", "exact")),
    Setting("spacing 1/(n + 0.37)", cells=0.37),
    Setting("tilted quadrilateral", region=_tilted, cells=0.37),
    Setting("disc, radius 0.497", region=_disc),
)


@dataclass(frozen=True)
class Units:
    """Factors on stiffness, displacement and length."""

    name: str
    stiffness: float = 1.0
    displacement: float = 1.0
    length: float = 1.0


def rescale(units: Units, n: int) -> Measurement:
    """The same problem in other units: fields and iterations must not change beyond rounding."""
    from solver import rectangle

    voigt = tensor("fully anisotropic") / 100.0
    exact = bodies.field_of(voigt, (3, 4))  # nothing exact about it: every digit is the solver's
    base = bodies.solve(voigt, exact, n)
    factor, size = units.displacement, units.length

    class Scaled:
        """The field in the other units."""

        def displacement(self, x: Any, y: Any) -> Any:
            return factor * exact.displacement(x / size, y / size)

        def rotation(self, x: Any, y: Any) -> Any:
            return factor / size * exact.rotation(x / size, y / size)

    other = bodies.solve(
        units.stiffness * voigt,
        Scaled(),
        n,
        region=rectangle(size, size),
        spacing=size / n,
    )
    free = ~base.prescribed
    change = np.abs(other.displacement / factor - base.displacement)[free]
    turn = np.abs(other.rotation * size / factor - base.rotation)[free]
    s = other.statistics
    return Measurement(
        s.unknowns,
        {
            "change": float(
                worst(
                    (
                        change.max() / np.abs(base.displacement[free]).max(),
                        turn.max() / np.abs(base.rotation[free]).max(),
                    )
                )
            ),
            "more iterations": float(abs(s.iterations - base.statistics.iterations)),
            "residual": s.residual,
            "iterations": float(s.iterations),
        },
        statistics=adapters.solver_statistics(s),
    )


UNITS = (
    Units("stiffness × 1e12", stiffness=1e12),
    Units("displacement × 1e−12", displacement=1e-12),
    Units("length × 1e−6", length=1e-6),
    Units("all three", 1e12, 1e-12, 1e-6),
)

_QUANTITIES = {name: text for name, text in bodies.QUANTITIES.items() if name != "quartic"}

CASES = (
    Case(
        name="hard-lattices",
        title="Horizons of 2 to 7 cells, whole or not, and bodies that the lattice does not fit",
        section="Sect. 2.2",
        tags=("hard", "elasticity"),
        shows=(
            "Calibration on the lattice's own sums is exact for any m ≥ 2, area rule and position "
            "of the body's edge relative to the lattice."
        ),
        methods=tuple(
            Method(f"bond/lattice {s.name}", "bond", partial(fit, s), LADDER, warm.statics)
            for s in SETTINGS
        ),
        checks=tuple(
            check
            for s in SETTINGS
            for check in (
                Check(
                    f"bond/lattice {s.name}",
                    "displacement",
                    {24: 1e-11},
                    source=bodies.SOURCE,
                    exact=True,
                ),
                Check(
                    f"bond/lattice {s.name}",
                    "rotation",
                    {24: 1e-10},
                    source=bodies.SOURCE,
                    exact=True,
                ),
                Check(
                    f"bond/lattice {s.name}",
                    "residual",
                    {24: bodies.TOLERANCE},
                    source="asked for",
                    exact=True,
                ),
            )
        ),
        quantities=_QUANTITIES,
        primary="displacement",
        featured=f"bond/lattice {SETTINGS[0].name}",
        length="L",
        timed=False,
    ),
    Case(
        name="hard-units",
        title="Stiffness of 1e12, displacements of 1e−12, lengths of 1e−6",
        section="Sect. 2.1",
        tags=("hard", "elasticity"),
        shows="Units do not matter: the solution changes by rounding, iterations hardly.",
        methods=tuple(
            Method(f"bond/lattice {u.name}", "bond", partial(rescale, u), LADDER, warm.statics)
            for u in UNITS
        ),
        checks=tuple(
            check
            for u in UNITS
            for check in (
                Check(
                    f"bond/lattice {u.name}",
                    "change",
                    {24: 1e-11},
                    source="units do not matter",
                    exact=True,
                ),
                Check(
                    f"bond/lattice {u.name}",
                    "more iterations",
                    {24: 1.0},
                    source="units do not matter",
                    exact=True,
                ),
            )
        ),
        quantities={
            "change": "largest relative change of displacement or rotation",
            "more iterations": "change of the number of iterations",
            "residual": bodies.QUANTITIES["residual"],
            "iterations": "Krylov iterations to a residual of 1e-13",
        },
        primary="change",
        featured=f"bond/lattice {UNITS[0].name}",
        length="L",
        timed=False,
    ),
)
