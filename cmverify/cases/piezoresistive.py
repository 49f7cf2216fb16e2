"""Piezoresistivity (Sect. 5): bonds that conduct by their stretch.

A uniaxial strain changes the conductivity of an isotropic conductor by ¾ and ¼ of the bonds' gauge
factor along and across it. The lattice's own sum gives what the solver does to rounding; the
continuum's factors follow with an order in m, or exactly by calibrated fourth moments. A plate
with a hole under tension is held against finite elements whose conductivity is the angular mean
of strained directions: isotropic with a conductivity linear in stretch, bone with a resistivity
linear in stretch and the bonds' actual length.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np

from cmverify.case import Array, Case, Check, Level, Measurement, Method, OrderBand
from cmverify.cases.common import adapters, materials
from cmverify.cases.surfaces.bodies import at_points, held, nearest
from cmverify.faults.changes import result, scaled
from cmverify.faults.fault import Fault
from cmverify.judge.norms import relative_l2, worst

GAUGE = 4.0
STRAIN = 1e-3
#: Laws and lengths that a bond may have.
OPTIONS: tuple[dict[str, Any], ...] = (
    {},
    {"law": "resistivity"},
    {"length": "actual"},
    {"law": "resistivity", "length": "actual"},
)
FIELD = np.array([1.0, 0.8])
FACTORS = {"along": 0.75, "across": 0.25}
#: Of the plate: half its width over the hole's radius, half the probes' distance, tension over C11.
HALF, PROBE, TENSION = 2.0, 1.6, 2e-3
RESISTIVITIES, ANGLE, EXPONENT, M = (170.0, 540.0), 0.5, 4, 3
FEM = "scikit-fem on the same plate (references: strained-plate-…)"


@dataclass(frozen=True)
class Plate:
    """The plate's material; `scale` is, for tests, a factor on the gauge."""

    material: str = "isotropic"
    scale: float = 1.0


# ---- a uniform strain -------------------------------------------------------------------


def current(scene: Any) -> tuple[Array, Any]:
    """Current density in a square's middle in the uniform `FIELD`, A/m² (2,); and its arrays."""
    from dataclasses import replace

    from solver import Support, recovery

    def exact(x: Array, y: Array) -> Array:
        return np.asarray(-(FIELD[0] * x + FIELD[1] * y))

    held = Support.layer(scene.m + 0.5, potential=exact)
    solution = replace(scene, supports=[held]).solve(tolerance=1e-13)
    inside = np.abs(solution.points).max(axis=1) < 0.5 - (scene.m + 1.5) * scene.spacing
    return recovery.current_density(solution)[inside].mean(axis=0), solution.discretisation


def lattice_sum(parts: Any, resistive: bool, actual: bool) -> Array:
    """½ Σ α Λ Δv k f(s) n n over the family, bond by bond, (2, 2)."""
    family, total = parts.family, np.zeros((2, 2))
    for o in range(family.size):
        n = family.normal[o]
        stretch = STRAIN * n[0] ** 2
        k = parts.moduli.conductivity[o]
        k = k / (1 + GAUGE * stretch) if resistive else k * (1 + GAUGE * stretch)
        k = k / (1 + stretch) ** 2 if actual else k
        total += 0.5 * family.weight[o] * family.spacing**2 * k * np.outer(n, n)
    return total


def uniform(scale: float, m: int) -> Measurement:
    """Conductivity of a square under uniform strains, and a square with free edges."""
    from references.analytic.piezoresistive import strained_conductivity
    from solver import (
        Cosine,
        ElasticTensor,
        ElectricConductivityTensor,
        Load,
        Piezoresistance,
        Scene,
        Support,
        rectangle,
        strained,
    )

    common: dict[str, Any] = {"spacing": 1.0 / (2 * m + 6), "m": m}
    square = rectangle(1.0, 1.0)

    def state(strain: Array) -> Any:
        def stretched(x: Array, y: Array) -> Array:
            return np.stack([strain[0] * x + 0.5 * strain[2] * y,
                             0.5 * strain[2] * x + strain[1] * y], axis=-1)  # fmt: skip

        held = Support.where(lambda x, y: x < 1.0, displacement=stretched, rotation=0.0)
        return Scene(square, material=ElasticTensor.isotropic(1.0, 0.2), supports=[held],
                     **common).solve()  # fmt: skip

    base = Scene(square, material=ElectricConductivityTensor.isotropic(2.0), **common)
    bare, parts = current(base)
    pulled, sums = state(STRAIN * np.array([1.0, 0.0, 0.0])), []
    for option in OPTIONS:
        law = Piezoresistance(scale * GAUGE, moments="lattice", **option)
        now, _ = current(strained(base, pulled, law))
        wanted = lattice_sum(parts, "law" in option, "length" in option) @ FIELD
        sums.append(float(np.abs(now - wanted).max() / np.abs(wanted - bare).max()))
        if not option:
            # Linear in the strain, whatever its size.
            factors = (now / bare - 1.0) / (GAUGE * STRAIN)
    found = {name: abs(value / exact - 1.0)
             for value, (name, exact) in zip(factors, FACTORS.items(), strict=True)}  # fmt: skip
    found["lattice sum"] = worst(sums)

    # Bone, its axis turned, under a strain without an axis: the slope at no strain.
    bone = ElectricConductivityTensor.of_resistivities(*RESISTIVITIES, ANGLE)
    turned, slopes = Scene(square, material=bone, law=Cosine(EXPONENT), **common), []
    strain = 0.1 * STRAIN * np.array([1.0, -0.4, 0.7])
    states = [state(sign * strain) for sign in (1.0, -1.0)]
    for option in (OPTIONS[0], OPTIONS[-1]):
        law = Piezoresistance(scale * GAUGE, **option)
        up, down = (current(strained(turned, s, law))[0] for s in states)
        continuum = [
            strained_conductivity(bone.matrix, sign * strain, GAUGE, EXPONENT,
                                  "law" in option, "length" in option)
            for sign in (1.0, -1.0)
        ]  # fmt: skip
        slopes.append(relative_l2(up - down, (continuum[0] - continuum[1]) @ FIELD))
    found["calibrated"] = worst(slopes)

    # Free edges: all of a uniform current passes, and the potential is linear up to them.
    law = Piezoresistance(scale * GAUGE, **OPTIONS[-1])
    passing, _ = current(strained(turned, states[0], law))
    free = Scene(square, material=bone, law=Cosine(EXPONENT), surface="extrapolated",
                 supports=[Support.where(nearest(0.0, 0.0), potential=0.0)],
                 loads=[Load.flux(tuple(passing))], **common)  # fmt: skip
    solution = strained(free, states[0], law).solve(tolerance=1e-13)
    potential = -solution.points @ FIELD
    potential -= potential[nearest(0.0, 0.0)(*solution.points.T)]
    found["free edges"] = relative_l2(solution.potential, potential)
    return Measurement(solution.statistics.unknowns, found)


# ---- a plate with a hole ----------------------------------------------------------------


@cache
def reference(material: str) -> dict[str, Array]:
    """Finite elements' drop and its relative change per tension, current along 0 and 90°."""
    from references.provenance import load

    return dict(load(f"strained-plate-{material}").arrays)


def plate(problem: Plate, n: int) -> Measurement:
    """Drop between two probes and its change under tension, current along and across it."""
    from solver import (
        Cosine,
        ElasticTensor,
        ElectricConductivityTensor,
        Load,
        Piezoresistance,
        Scene,
        Support,
        disc,
        rectangle,
        strained,
    )

    bone = problem.material == "bone"
    if bone:
        elastic = ElasticTensor(materials.TENSORS["bone"] / materials.TENSORS["bone"][0, 0])
    else:
        elastic = ElasticTensor.isotropic(1.0 - 0.3**2, 0.3)
    common: dict[str, Any] = {
        "region": rectangle(2 * HALF, 2 * HALF) - disc(1.0), "spacing": 1.0 / n, "m": M,
        "surface": "extrapolated",
    }  # fmt: skip

    def ends(axis: int) -> Any:
        return lambda x, y: np.abs((x, y)[axis]) > HALF - 1e-6

    option: dict[str, Any] = {"law": "resistivity", "length": "actual"} if bone else {}
    state = Scene(
        material=elastic,
        supports=held((-1.5, 0.5 / n), (1.5, 0.5 / n)),
        loads=[Load.stress((TENSION, 0.0, 0.0), where=ends(0))],
        **common,
    ).solve(tolerance=1e-11)
    conductor = (
        ElectricConductivityTensor.of_resistivities(*RESISTIVITIES, ANGLE)
        if bone
        else ElectricConductivityTensor.isotropic(1.0)
    )
    law = Piezoresistance(problem.scale * GAUGE, **option)
    wanted, found = reference(problem.material), {}
    seconds = adapters.solver_seconds(state.statistics)
    for k, axis in enumerate(("along", "across")):
        flux = tuple(np.eye(2)[k])
        probes = PROBE * np.array([np.eye(2)[k], -np.eye(2)[k]])
        base = Scene(
            material=conductor,
            law=Cosine(EXPONENT),
            supports=[Support.where(nearest(-1.9, -1.9), potential=0.0)],
            loads=[Load.flux(flux, where=ends(k))],
            **common,
        )
        before = base.solve(tolerance=1e-11)
        after = strained(base, state, law).solve(tolerance=1e-11, previous=before)
        drops = []
        for solution in (before, after):
            up, down = at_points(solution.points, solution.potential, probes, solution.spacing)
            drops.append(abs(up - down))
            for stage, spent in adapters.solver_seconds(solution.statistics).items():
                seconds[stage] = seconds.get(stage, 0.0) + spent
        found[f"drop {axis}"] = abs(drops[0] / wanted["drop"][k] - 1.0)
        change = (drops[1] / drops[0] - 1.0) / TENSION
        found[f"change {axis}"] = abs(change / wanted["change"][k] - 1.0)
    found["change"] = max(found["change along"], found["change across"])
    return Measurement(
        after.statistics.unknowns, found, seconds, adapters.solver_statistics(after.statistics)
    )


@cache
def warm_up() -> None:
    """Compile the kernels."""
    uniform(1.0, 2)


_EXACT = (
    ("lattice sum", 1e-8, "the sum over the family, to rounding"),
    ("calibrated", 1e-6, "calibrated moments; what is left is of third order in a strain of 1e-4"),
    ("free edges", 1e-10, "bonds at the edge change as those inside: to rounding"),
)
_LADDER = {Level.STANDARD: (10, 20), Level.PAPER: (10, 20, 40)}
_PLATES = tuple(
    Method(f"bond/{material} plate", "bond", partial(plate, Plate(material)), _LADDER, warm_up)
    for material in ("isotropic", "bone")
)

CASES = (
    Case(
        name="piezoresistive",
        title="Conductors whose bonds conduct by their stretch",
        section="Sect. 5",
        equations=("Eq. 118", "Eq. 119", "Eq. 148"),
        tags=("piezoresistive", "electrical", "conduction", "fem"),
        shows=(
            "Bonds whose conductivity, or resistivity, is linear in their stretch conduct as their "
            "own sum says; ¾ and ¼ of the bonds' gauge factor along and across a uniaxial strain "
            "follow at second order in m, or exactly where fourth moments are calibrated. A plate "
            "with a hole is the strain gauge that finite elements say."
        ),
        methods=(
            Method(
                "bond/uniform strain",
                "bond",
                partial(uniform, 1.0),
                {Level.QUICK: (3,), Level.STANDARD: (3, 5, 7), Level.PAPER: (3, 5, 7, 10)},
                warm_up,
            ),
            *_PLATES,
        ),
        checks=(
            *(
                Check("bond/uniform strain", quantity, {3: bound}, exact=True, source=source)
                for quantity, bound, source in _EXACT
            ),
            *(
                Check(
                    "bond/uniform strain",
                    axis,
                    bounds,
                    order=OrderBand(1.5, 3.0, fitted=True),
                    source="theory (Cauchy-Born); half as much again as measured, second order in "
                    "the number of bonds across the horizon",
                )
                for axis, bounds in (
                    ("along", {3: 3.4e-2, 5: 1e-2, 7: 4.2e-3}),
                    ("across", {3: 1e-1, 5: 3e-2, 7: 1.3e-2}),
                )
            ),
            *(
                Check(method.name, quantity, bounds, source=FEM)
                for method in _PLATES
                for quantity, bounds in (
                    ("drop along", {10: 4e-3, 20: 1.2e-3}),
                    ("drop across", {10: 4e-3, 20: 1.2e-3}),
                    ("change along", {10: 2.4e-2, 20: 8e-3, 40: 2.5e-3}),
                    ("change across", {10: 2e-2, 20: 6e-3, 40: 2.5e-3}),
                )
            ),
            *(
                Check(
                    method.name,
                    "change",
                    order=OrderBand(1.2, 2.5, fitted=True),
                    source="second order of the strains and of the conductor",
                )
                for method in _PLATES
            ),
        ),
        quantities={
            "lattice sum": "difference from ½ Σ α Λ Δv k f(s) n n over its change, all laws and "
            "lengths",
            "along": "relative error of the gauge factor ¾ along a uniaxial strain",
            "across": "relative error of the gauge factor ¼ across it",
            "calibrated": "slope of bone's conductivity in a strain without axis, both laws, with "
            "the continuum's fourth moments",
            "free edges": "potential of a strained square with free edges in a uniform current",
            "drop along": "relative error of the unstrained drop, current along the tension",
            "drop across": "the same across it",
            "change along": "relative error of the drop's change under tension, current along it",
            "change across": "the same across it",
            "change": "the larger of the two",
        },
        elements={
            **adapters.stored("strained-plate-isotropic", degrees=[0.0], size=0.06),
            **adapters.stored("strained-plate-bone", degrees=[90.0], size=0.06),
        },
        primary="along",
        featured="bond/uniform strain",
        length="m, or the hole's radius",
        timed=False,
    ),
)

P = "solver.material.piezoresistance.Piezoresistance"
FAULTS = (
    Fault("gauge of bonds + 1 %", f"{P}.gauges", scaled(1.01), "piezoresistance"),
    Fault("what the actual length adds to a gauge left out", f"{P}._shorter",
          lambda _: lambda self: 0.0, "piezoresistance"),
    Fault("factor of bonds squared", f"{P}.factor", result(lambda f: f**2), "piezoresistance"),
    Fault("stretch of bonds + 1 %", "solver.strained.Stretched.of_offset", scaled(1.01),
          "piezoresistance"),
    Fault("bonds at the surface not strained", "solver.bonds.ended.EndedBonds.scaled",
          lambda _: lambda self, factors: self, "piezoresistance"),
    Fault("bonds at the surface conduct 1 % more", "solver.strained.Stretched._of_surface",
          result(lambda found: (1.01 * found[0], *found[1:])), "piezoresistance"),
    Fault("quartic moments of the continuum + 1 %", "solver.material.calibration.quartic_target",
          scaled(1.01), "piezoresistance"),
    Fault("strained conductivity of the continuum + 1 %",
          "references.analytic.piezoresistive.strained_conductivity", scaled(1.01), "closed forms"),
)  # fmt: skip
