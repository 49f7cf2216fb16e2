"""Anisotropic solids: a stiff ply, 40 : 1, silicon, bone, the block lattice, no symmetry at all."""

from __future__ import annotations

from functools import partial

from cmverify.case import Array, Case
from cmverify.cases.common import materials
from cmverify.cases.hard import bodies
from cmverify.cases.hard.bodies import Expected, Solid


def tensor(name: str, degrees: float = 0.0) -> Array:
    """A solid of `cmverify.cases.common.materials`, turned."""
    return materials.turned(materials.TENSORS[name], degrees)


def forty_to_one() -> Array:
    """E1/E2 = 40 with G12/E2 = 1/2 and ν12 = 1/4, a stiffness ratio that laminates reach."""
    return materials.orthotropic(40.0, 1.0, 0.5, 0.25)


ROWS = (
    Expected(
        "carbon/epoxy 0°",
        Solid(partial(tensor, "carbon/epoxy", 0.0), "positive"),
        (8.9e-03, 9.7e-04, 1.8e-04, 6.0e-05),
        (39, 24, 37, 44),
    ),
    Expected(
        "carbon/epoxy 30°",
        Solid(partial(tensor, "carbon/epoxy", 30.0), "positive"),
        (9.3e-03, 1.1e-03, 2.1e-04, 7.1e-05),
        (34, 21, 27, 28),
    ),
    Expected(
        "carbon/epoxy 45°",
        Solid(partial(tensor, "carbon/epoxy", 45.0), "positive"),
        (6.8e-03, 6.1e-04, 1.2e-04, 3.9e-05),
        (36, 21, 26, 27),
    ),
    Expected(
        "40 : 1",
        Solid(forty_to_one, "positive"),
        (8.5e-03, 9.6e-04, 1.8e-04, 6.0e-05),
        (46, 32, 53, 66),
    ),
    Expected(
        "silicon",
        Solid(partial(tensor, "silicon")),
        (1.6e-02, 1.4e-03, 2.5e-04, 8.1e-05),
        (26, 13, 13, 14),
    ),
    Expected(
        "bone",
        Solid(partial(tensor, "bone")),
        (2.8e-03, 1.5e-04, 2.5e-05, 8.2e-06),
        (28, 14, 17, 17),
    ),
    Expected(
        "fully anisotropic",
        Solid(partial(tensor, "fully anisotropic")),
        (5.3e-03, 6.2e-04, 1.2e-04, 3.9e-05),
        (28, 14, 16, 17),
    ),
    Expected(
        "tetrachiral",
        Solid(materials.tetrachiral),
        (2.5e-02, 2.7e-03, 5.1e-04, 1.7e-04),
        (29, 16, 21, 22),
    ),
)

CASES = (
    Case(
        name="hard-tensors",
        title="Strongly and fully anisotropic solids",
        section="Sect. 2.2",
        equations=("Eqs. 106–108", "Eqs. 87–90"),
        figures=("Fig. 2",),
        tags=("hard", "elasticity", "stability"),
        shows=(
            "Silicon, bone, the block lattice and a solid without symmetry need nothing special; a "
            "carbon/epoxy ply and stiffness ratios of 40 : 1, unstable with the paper's law, are "
            "exact and stable with non-negative bonds, at any angle to the lattice."
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
