"""Particles with one bond or none, a fragment cut off, a hinge: found, refused or set aside."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.case import Array, Case, Check, Level, Measurement, Method
from cmverify.cases.common import adapters, warm
from cmverify.cases.hard import broken
from cmverify.judge.norms import relative_l2

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from solver.geometry import Lattice
    from solver.material import Family

TOLERANCE = 1e-12
LADDER = {Level.QUICK: (24,), Level.STANDARD: (24, 60), Level.PAPER: (24, 60)}
CENTRE, RADIUS = (0.02, -0.03), 0.12


def _inside(points: Array) -> NDArray[np.bool_]:
    return np.hypot(points[:, 0] - CENTRE[0], points[:, 1] - CENTRE[1]) < RADIUS


def _middle(lattice: Lattice) -> int:
    return int(np.argmin(np.hypot(*(lattice.points - np.array(CENTRE)).T)))


def _between(lattice: Lattice, family: Family, members: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Bonds between members and others, (family size / 2, N)."""
    number, (rows, columns) = lattice.number(), lattice.rows_columns
    result = np.zeros((family.size // 2, lattice.count), dtype=bool)
    for o, (dx, dy) in enumerate(family.offsets[: family.size // 2]):
        other = number[rows + dy, columns + dx]
        result[o] = (other >= 0) & (members != members[other])
    return result


def lonely(left: int) -> broken.Broken:
    """One particle with only so many bonds left."""

    def cut(lattice: Lattice, family: Family) -> NDArray[np.bool_]:
        members = np.zeros(lattice.count, dtype=bool)
        members[_middle(lattice)] = True
        result = _between(lattice, family, members)
        for o in np.argsort(family.length[: family.size // 2], kind="stable")[:left]:
            result[o, _middle(lattice)] = False
        return result

    return cut


def fragment(bonds_left: int = 0) -> broken.Broken:
    """A round fragment in the middle, held by so many of the nearest bonds to the rest."""

    def cut(lattice: Lattice, family: Family) -> NDArray[np.bool_]:
        members = _inside(lattice.points)
        result = _between(lattice, family, members)
        for _ in range(bonds_left):
            # The rightmost crossing bond of the shortest kind.
            o = int(np.argmin(family.length[: family.size // 2]))
            crossing = np.nonzero(result[o])[0]
            result[o, crossing[np.argmax(lattice.points[crossing, 0])]] = False
        return result

    return cut


def _elsewhere(x: Array, y: Array) -> Array:
    """A body force that leaves the loose part alone, (n, 2)."""
    load = broken.force(x, y)
    load[_inside(np.stack([x, y], axis=-1))] = 0.0
    return load


@dataclass(frozen=True)
class Loose:
    """A body with something loose in it.

    `says` is part of the refusal; `alone` whether only one particle is loose (else the fragment).
    """

    name: str
    broken: broken.Broken
    says: str
    alone: bool
    poisson: float = 0.2


def treat(body: Loose, n: int) -> Measurement:
    """Refused by name, refused if loaded, and solved with the loose part set aside."""
    from solver import ElasticTensor, MechanismError

    material = ElasticTensor.isotropic(1.0, body.poisson)

    def refusal(**settings: Any) -> str:
        try:
            broken.scene(material, n, body.broken, **settings).solve(tolerance=TOLERANCE)
        except MechanismError as error:
            return str(error)
        return ""

    found = {
        "refused": float(body.says in refusal(load=_elsewhere)),
        "load refused": float("a load acts on a part that nothing holds" in refusal(loose="drop")),
    }
    scene = broken.scene(material, n, body.broken, load=_elsewhere, loose="drop")
    solution = scene.solve(tolerance=TOLERANCE)
    d, s = solution.discretisation, solution.statistics
    aside = np.isnan(solution.displacement).any(axis=1)
    members = _inside(d.lattice.points)
    if body.alone:
        members = np.arange(d.lattice.count) == _middle(d.lattice)
    found["wrongly set aside"] = float((aside != members).sum())
    found["difference"] = relative_l2(
        solution.unknowns[:, d.operator.active], broken.direct_solution(d)
    )
    found["energy"] = broken.energy_defect(solution)
    found["residual"], found["iterations"] = s.residual, float(s.iterations)
    return Measurement(s.unknowns, found, statistics=adapters.solver_statistics(s))


BODIES = (
    Loose("no bond", lonely(0), "left free", alone=True),
    Loose("one bond", lonely(1), "too few bonds left", alone=True),
    Loose("fragment", fragment(0), "left free", alone=False),
    Loose("hinge", fragment(1), "a hinge", alone=False),
    Loose("fragment, ν = 0.45", fragment(0), "left free", alone=False, poisson=0.45),
    Loose("one bond, ν = 0.45", lonely(1), "too few bonds left", alone=True, poisson=0.45),
)

CASES = (
    Case(
        name="hard-mechanisms",
        title="Particles with one bond or none, a fragment cut off, a hinge",
        section="Sect. 3",
        equations=("Eq. 105",),
        tags=("hard", "elasticity", "damage"),
        shows=(
            "What damage leaves loose is found and named; it is refused, or set aside so that "
            "exactly the loose particles have no values and the rest is solved."
        ),
        methods=tuple(
            Method(f"bond/lattice {b.name}", "bond", partial(treat, b), LADDER, warm.statics)
            for b in BODIES
        ),
        checks=tuple(
            check
            for b in BODIES
            for check in (
                Check(
                    f"bond/lattice {b.name}",
                    "refused",
                    equals={24: 1.0, 60: 1.0},
                    source="known from the cut",
                ),
                Check(
                    f"bond/lattice {b.name}",
                    "load refused",
                    equals={24: 1.0, 60: 1.0},
                    source="known from the cut",
                ),
                Check(
                    f"bond/lattice {b.name}",
                    "wrongly set aside",
                    equals={24: 0.0, 60: 0.0},
                    source="known from the cut",
                ),
                Check(
                    f"bond/lattice {b.name}",
                    "difference",
                    {24: 1e-9},
                    source="sparse factorisation",
                    exact=True,
                ),
                Check(
                    f"bond/lattice {b.name}",
                    "energy",
                    {24: 1e-9},
                    source="sum over bonds",
                    exact=True,
                ),
            )
        ),
        quantities={
            "refused": "1 if the scene is refused (MechanismError) in the right words",
            "load refused": "1 if a load on the loose part is refused when it is set aside",
            "wrongly set aside": "particles set aside that should not be, or the reverse",
            "difference": "relative L2 difference of the rest from a sparse factorisation",
            "energy": "twice the energy of the bonds against the work of the load, relative",
            "residual": "relative residual at the end",
            "iterations": "Krylov iterations to a residual of 1e-12",
        },
        primary="difference",
        featured="bond/lattice fragment",
        length="L",
        timed=False,
    ),
)
