"""Isotropic solids over the range of Poisson's ratio: positive, zero and negative shear bonds."""

from __future__ import annotations

from functools import partial
from typing import Any, Literal

from cmverify.case import Case, Level
from cmverify.cases.common import materials
from cmverify.cases.hard import bodies
from cmverify.cases.hard.bodies import Expected, Solid

SHORT = {Level.QUICK: (24,), Level.STANDARD: (24, 48), Level.PAPER: (24, 48)}


def _row(
    plane: Literal["stress", "strain"],
    poisson: float,
    quartic: tuple[float, ...],
    iterations: tuple[int, ...],
    **others: Any,
) -> Expected:
    central = (plane, poisson) == ("stress", 1 / 3)  # no bond resists shear: no rotations
    ratio = "1/3" if central else f"{poisson:g}"
    solid = Solid(partial(materials.isotropic, poisson, plane))
    return Expected(
        f"{plane} ν = {ratio}", solid, quartic, iterations, rotation=not central, **others
    )


ROWS = (
    _row("stress", -0.5, (2.9e-04, 2.3e-05, 4.3e-06, 1.4e-06), (29, 13, 15, 15)),
    _row("stress", 0.0, (3.8e-04, 3.2e-05, 5.8e-06, 1.9e-06), (26, 13, 15, 15)),
    _row("stress", 0.2, (4.2e-04, 3.7e-05, 6.8e-06, 2.2e-06), (25, 13, 15, 15)),
    _row("stress", 1 / 3, (1.2e-04, 1.3e-05, 2.4e-06, 8.0e-07), (24, 13, 15, 15)),
    _row("stress", 0.35, (4.2e-04, 3.6e-05, 6.5e-06, 2.1e-06), (26, 15, 17, 17)),
    _row("stress", 0.4, (4.3e-04, 3.6e-05, 6.5e-06, 2.1e-06), (28, 18, 20, 20)),
    _row("stress", 0.49, (4.5e-04, 3.7e-05, 6.6e-06, 2.1e-06), (34, 27, 27, 27)),
    _row("stress", 0.499, (4.5e-04, 3.7e-05, 6.6e-06, 2.1e-06), (34, 28, 29, 29)),
    _row("strain", 0.36, (4.8e-04, 3.9e-05, 6.8e-06, 2.2e-06), (42, 45, 47, 47)),
    _row("strain", 0.37, (5.2e-04, 4.1e-05, 6.9e-06, 2.2e-06), (48, 63, 67, 68)),
    _row("strain", 0.375, (5.7e-04, 4.4e-05, 7.2e-06, 2.2e-06), (49, 81, 89, 92)),
    # A bulk margin of 7e-4: waves of some seven cells hardly resist, which the coarse grid does
    # not see, and a clamped square of 96 cells is unstable (its families are cut by the layer).
    _row("strain", 0.38, (7.0e-04, 4.0e-04), (53, 179), floor=1e-10, ladder=SHORT),
)

CASES = (
    Case(
        name="hard-poisson",
        title="Poisson's ratio from −1/2 to 0.499 and, in plane strain, to its limit",
        section="Sect. 2.2.1",
        equations=("Eqs. 71–72",),
        figures=("Fig. 3",),
        tags=("hard", "elasticity", "stability"),
        shows=(
            "The bonds' shear stiffness changes sign at ν = 1/3 in plane stress and 1/4 in plane "
            "strain; the solver keeps its accuracy on either side and at the change, by conjugate "
            "gradients, without rotations, or as a saddle point, up to the limit of stability."
        ),
        methods=tuple(row.method for row in ROWS),
        checks=tuple(check for row in ROWS for check in row.checks),
        quantities=bodies.QUANTITIES,
        primary="quartic",
        featured=ROWS[0].method.name,
        length="L",
        timed=False,
    ),
)
