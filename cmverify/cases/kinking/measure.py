"""What is measured of a family of kinks: errors of their angles, costs, and figures."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cmverify.case import Array, Curve, Field, FieldSet, LinePlot, Measurement
from cmverify.cases.kinking.angles import (
    chord_angle,
    energy_angle,
    energy_release,
    grown_path,
    hoop_angle,
    read_angle,
    straight,
)
from cmverify.cases.kinking.problem import ANGLES, REACH, Grown, Kink, grow_kink
from cmverify.judge.norms import line_distance, worst

#: Coarse grids are for the quick level, which has no time for all mixities.
FEW = (0.0, 90.0)
COARSE = 30


@dataclass(frozen=True)
class Study:
    """Kinks of one material at all mixities, alike in everything else.

    Attributes
    ----------
    kink : Kink
        Whose mixity and spacing are replaced.
    extra : bool
        Also grow the mirrored crack, and keep fields and curves for the report.
    mixities : tuple of float
        α_K, degrees; fewer on coarse grids.
    shift : float
        Added to every angle that is read, degrees (for tests).
    """

    kink: Kink
    extra: bool = False
    mixities: tuple[float, ...] = ANGLES
    shift: float = 0.0


def rms(values: Sequence[float]) -> float:
    """Root mean square; NaN if one is."""
    return float(np.sqrt(np.mean(np.square(values))))


def study(plan: Study, n: int) -> Measurement:
    """Grow the kinks at spacing a/n and compare their angles with both criteria."""
    material = plan.kink.material
    mixities = FEW if n <= COARSE else plan.mixities
    grown: list[Grown] = []
    seconds = []
    for mixity in mixities:
        begun = time.perf_counter()
        grown.append(grow_kink(replace(plan.kink, mixity=mixity, n=n)))
        seconds.append(time.perf_counter() - begun)
    read = np.array([read_angle(g.marks) for g in grown]) + plan.shift
    energy = np.array([energy_angle(material, a) for a in mixities])
    hoop = np.array([hoop_angle(material, a) for a in mixities])
    near = np.array([read_angle(g.marks, 0.1) for g in grown])
    chord = np.array([chord_angle(g.path) for g in grown])
    quantities = {
        "rms": rms(read - energy),
        "largest": float(np.abs(read - energy).max()),
        "rms hoop": rms(read - hoop),
        "largest hoop": float(np.abs(read - hoop).max()),
        "rms apart": rms(hoop - energy),
        "rms near": rms(near - energy),
        "rms chord": rms(chord - energy),
        "path": worst(
            line_distance(grown_path(g.path), straight(a))
            for g, a in zip(grown, energy, strict=True)
        ),
        "drive": float(np.median([drive(g) for g in grown])),
        "seconds": max(seconds),
    }
    if material == "silicon" and 0.0 in mixities:
        quantities["straight"] = float(abs(read[mixities.index(0.0)]))
    if plan.extra:
        quantities["mirror"] = mirror_distance(grown[1])
    steps = np.concatenate([g.run.steps for g in grown])
    growing = steps[steps["broken"] > 0]
    return Measurement(
        grown[0].run.solution.statistics.unknowns,
        quantities,
        {"setup": 0.0, "solve": sum(seconds)},
        {
            "angles": len(grown),
            "solves": len(steps),
            "iterations a solve": round(float(steps["iterations"].mean()), 1),
            "bonds a solve": round(float(growing["broken"].mean()), 1),
            "seconds an angle": round(float(np.mean(seconds)), 2),
        },
        fields=_fields(grown[-1]) if plan.extra else None,
        lines=(
            *_deviations(plan.kink, mixities, read, energy),
            *(_lines(material, mixities, grown, read) if plan.extra else ()),
        ),
    )


def drive(grown: Grown) -> float:
    """Largest G(ω) of the kink over the toughness when it had grown by one horizon.

    From the load factor alone: K = factor at the edge. One is Griffith's crack.
    """
    from cmverify.cases.kinking.angles import largest_release

    history = grown.run.history
    horizon = grown.kink.m / grown.kink.n
    first = int(np.argmax(np.asarray(history.advance) >= horizon))
    factor = float(np.asarray(history.load_factor)[first])
    return factor**2 * largest_release(grown.kink.material, grown.kink.mixity)


def mirror_distance(grown: Grown) -> float:
    """Largest distance (a) between a path and the reflected path of the reflected crack."""
    other = grow_kink(replace(grown.kink, mirrored=True)).path * [1.0, -1.0]
    if len(other) != len(grown.path):
        return float("inf")
    return float(np.linalg.norm(other - grown.path, axis=1).max())


def _fields(grown: Grown) -> FieldSet:
    """Fig. 24: the horizontal displacement with the kinked crack, beside the field prescribed."""
    solution = grown.run.solution
    factor = grown.run.load_factor
    kink, points = grown.kink, solution.points
    given = factor * kink.displacement(*points.T)
    sizes = np.abs(given[:, 0]).max()
    items = {
        "u1": Field(
            "$u_1$", "largest prescribed", solution.displacement[:, 0] / sizes, given[:, 0] / sizes
        )
    }
    whole = ~np.isnan(solution.displacement[:, 0])
    kept = {
        k: Field(f.label, f.unit, f.computed[whole], f.reference[whole]) for k, f in items.items()
    }
    return FieldSet(points[whole], kept, spacing=1.0 / kink.n)


def _deviations(
    kink: Kink, mixities: Sequence[float], read: Array, energy: Array
) -> tuple[LinePlot, LinePlot]:
    """What is varied beside what is not: deviations, and how the rows of the lattice draw."""
    mixed, fine = np.array(mixities), np.linspace(0.0, 90.0, 31)
    apart = np.array([hoop_angle(kink.material, a) - energy_angle(kink.material, a) for a in fine])
    ends = np.array([-100.0, 40.0])
    return (
        LinePlot(
            "Off the energy criterion, one thing varied",
            "$\\alpha_K$ (°)",
            "deviation of the kink angle (°)",
            (Curve("bond model", mixed, read - energy, apart, fine),),
            over_methods=True,
            joined=True,
            reference_label="hoop criterion",
        ),
        LinePlot(
            "Directions to the lattice (rows at 0, ±45, 90°)",
            "by the energy criterion (°)",
            "found (°)",
            (Curve("bond model", energy + kink.turn, read + kink.turn, ends, ends),),
            over_methods=True,
            reference_label="equal",
        ),
    )


def _lines(
    material: str, mixities: Sequence[float], grown: Sequence[Grown], read: Array
) -> tuple[LinePlot, ...]:
    """Figs. 25–27: paths, and angles over the mixity."""
    radius = np.linspace(0.0, REACH, 30)
    paths = []
    for g, mixity in zip(grown, mixities, strict=True):
        angle = np.radians(energy_angle(material, mixity))
        paths.append(
            Curve(
                f"α = {mixity:g}°",
                g.path[:, 0],
                g.path[:, 1],
                radius * np.sin(angle),
                radius * np.cos(angle),
            )
        )
    fine = np.linspace(0.0, 90.0, 31)
    energy = np.array([energy_angle(material, a) for a in fine])
    hoop = np.array([hoop_angle(material, a) for a in fine])
    chord = np.array([chord_angle(g.path) for g in grown])
    near = np.array([read_angle(g.marks, 0.1) for g in grown])
    mixed = np.array(mixities)
    angles = (
        Curve("bond model, line to a/4", mixed, read, energy, fine),
        Curve("bond model, line to a/10", mixed, near, energy, fine),
        Curve("bond model, chord", mixed, chord, energy, fine),
        Curve("hoop criterion", fine[::2], hoop[::2], energy, fine),
    )
    degrees = np.linspace(-95.0, 95.0, 191)
    flat = []
    for mixity in (a for a in (0.0, 45.0, 90.0) if a in mixities):
        rate = energy_release(material, mixity, degrees)
        own = float(np.interp(read[list(mixities).index(mixity)], degrees, rate))
        at = read[list(mixities).index(mixity)]
        flat.append(Curve(f"α = {mixity:g}°", np.array([at]), np.array([own]), rate, degrees))
    return (
        LinePlot(
            "Paths of the kinks (Figs. 25, 26)", "$x_1/a$", "$x_2/a$", tuple(paths),
            reference_label="energy criterion",
        ),
        LinePlot(
            "Kink angle over mode mixity (Fig. 27)", "$\\alpha_K$ (°)", "$\\beta_K$ (°)", angles,
            reference_label="energy criterion",
        ),
        LinePlot(
            "Energy release rate of a short kink and the angles found", "kink angle (°)",
            "$G/G_{max}$", tuple(flat), reference_label="finite elements",
        ),
    )  # fmt: skip
