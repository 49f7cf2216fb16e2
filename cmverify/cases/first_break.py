"""The first bonds of a growing crack: load, energies and costs, bond by bond.

A short strip with a crack, pulled apart. One static solution says which bond of all is the most
loaded: w = ½ |ξ| (k_n s² + k_t γ²) against w_c, from displacements and rotations at its ends. The
fracture run has to break that bond (and its mirror image) first, at the load at which w is w_c,
and its books have to hold what the bonds hold.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.case import Array, Case, Check, Level, Measurement, Method
from cmverify.cases.common import materials, warm

if TYPE_CHECKING:
    from solver import Scene, Solution

CELLS, M = 12, 3
LADDER = dict.fromkeys(Level, (CELLS,))
CRITICAL = 3.0  # w_c of every bond
TIE = 1e-4


def scene(n: int) -> Scene:
    """A square with an edge crack to its middle, its upper and lower layers pulled apart."""
    from solver import Crack, ElasticTensor, Scene, Support, rectangle

    def pulled(x: Array, y: Array) -> Array:
        return np.stack([0.0 * x, np.sign(y)], axis=-1)

    def grips(x: Array, y: Array) -> np.ndarray:
        return np.abs(y) > 0.5 - (M + 0.5) / n

    return Scene(
        region=rectangle(1.0, 1.0),
        spacing=1.0 / n,
        m=M,
        material=ElasticTensor(materials.isotropic(0.2)),
        surface="none",
        cracks=[Crack((-0.6, 0.0), (0.0, 0.0))],
        supports=[Support.where(grips, displacement=pulled, rotation=0.0)],
    )


def bond_energies(solution: Solution) -> tuple[Array, Array, Array]:
    """Energy density of every intact bond that may break, what a pair holds, and what it costs.

    Each bond from its ends: stretch and shear of Eqs. 1–2.
    """
    d = solution.discretisation
    lattice, family, moduli = d.lattice, d.family, d.moduli
    number, (rows, columns) = lattice.number(), lattice.rows_columns
    u, theta = solution.displacement, solution.rotation
    density, held, cost = [], [], []
    for o in range(family.size // 2):
        dx, dy = family.offsets[o]
        other = number[rows + dy, columns + dx]
        here = np.nonzero((other >= 0) & (d.bonds.strength(o) > 0))[0]
        there = other[here]
        length = np.hypot(dx, dy) * family.spacing
        n = np.array([dx, dy]) * family.spacing / length
        jump = (u[there] - u[here]) / length
        stretch = jump @ n
        shear = jump @ [-n[1], n[0]] - 0.5 * (theta[here] + theta[there])
        w = 0.5 * length * (moduli.normal[o] * stretch**2 + moduli.shear[o] * shear**2)  # type: ignore[attr-defined]
        pair = family.fraction[o] * family.spacing**4
        held.append(pair * w)
        rigid = solution.prescribed[here] & solution.prescribed[there]
        density.append(np.where((stretch > 0) & ~rigid, w, 0.0))
        cost.append(np.full(len(here), pair * CRITICAL))
    return np.concatenate(density), np.concatenate(held), np.concatenate(cost)


def measure(n: int) -> Measurement:
    """The first batch of bonds against the static solution, bond by bond."""
    from solver import Family, Programme, fracture, recovery

    body = scene(n)
    solution = body.solve(tolerance=1e-12)
    density, held, cost = bond_energies(solution)
    load = 1.0 / np.sqrt(density.max() / CRITICAL)
    first = density >= density.max() * (1 - TIE)
    size = Family(M).size
    run: Any = fracture.grow(
        body,
        np.full(size, CRITICAL),
        Programme(control="following"),
        batch=1,
        tolerance=1e-11,
        max_solves=12,
    )
    h, breaks = run.history, run.breaks
    # Records: the body without load, then before every batch.
    before = int(np.argmax(h.load_factor > 0))
    stored = load**2 * held.sum()
    density_sum = recovery.strain_energy_density(solution).sum() / n**2
    batch = breaks["step"] == breaks["step"][0]
    spent = h.dissipated[h.broken == batch.sum()]
    length = float(np.hypot(*(run.path[-1] - run.path[0])))
    gone = run.bonds.strengths.ravel()[run.broken_bonds]
    return Measurement(
        solution.statistics.unknowns,
        {
            "load": float(abs(breaks["load_factor"][0] / load - 1.0)),
            "bonds": float(abs(batch.sum() - first.sum())),
            "stored": float(abs(h.stored[before] / stored - 1.0)),
            "work": float(abs(h.work[before] / stored - 1.0)),
            "density": float(abs(density_sum / held.sum() - 1.0)),
            "cost": float(abs(spent[0] / cost[first].sum() - 1.0)) if len(spent) else float("nan"),
            "advance": abs(run.advance / length - 1.0) if length else float("nan"),
            "left": float(np.abs(gone).max()),
            "balance": float(np.abs(h.imbalance).max() / h.work.max()),
        },
        statistics={"bonds of the first batch": int(batch.sum())},
    )


QUANTITIES = {
    "load": "load factor at which the first bond breaks, against √(w_c/w)",
    "bonds": "bonds that break together less those that are equally loaded",
    "stored": "energy that the run's books store before it, against the sum over bonds",
    "work": "work of the supports by then, against the same",
    "density": "sum of the recovered energy densities against the sum over bonds",
    "cost": "energy dissipated by the first batch against w_c α Δv Δv of its bonds",
    "advance": "advance against the distance between the ends of the path",
    "left": "strength that broken bonds have left",
    "balance": "work − stored − dissipated − excess over the work, of a dozen batches",
}
BOUNDS = {
    "load": 1e-8,
    "stored": 1e-8,
    "work": 1e-8,
    "density": 1e-9,
    "cost": 1e-9,
    "advance": 1e-9,
    "left": 1e-14,
    "balance": 1e-9,
}

CASES = (
    Case(
        name="first-break",
        title="The first bonds that break, one by one",
        section="Sect. 3",
        equations=("Eqs. 1–2", "Eq. 104"),
        tags=("fracture", "elasticity"),
        shows=(
            "The most loaded bond breaks first, at the load at which its energy is critical, and "
            "work, stored energy and cost are the sums over the bonds."
        ),
        methods=(Method("bond/lattice", "bond", measure, LADDER, warm.growth),),
        checks=(
            *(
                Check("bond/lattice", q, {CELLS: bound}, source="sum over bonds", exact=True)
                for q, bound in BOUNDS.items()
            ),
            Check("bond/lattice", "bonds", equals={CELLS: 0.0}, source="sum over bonds"),
        ),
        quantities=QUANTITIES,
        primary="load",
        featured="bond/lattice",
        length="L",
        timed=False,
    ),
)
