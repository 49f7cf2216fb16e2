"""Damage sensing in cortical bone (Sect. 4.3.2): the potential drop over a growing crack.

The compact specimen of `bone-compact-tension` conducts with 170 Ω m along its fibres and 540 Ω m
across, k of Eq. 163 with n = 4. The paper shows its leads in a figure only; ours, declared: 1 A per
m of thickness enters by a square of side 3 W/40 whose corner nearest the crack's mouth is at
(−24, 20) W/40 from the specimen's middle, and leaves by its mirror image; the probes are squares of
2 W/40 at (−24, ±1) W/40, on either side of the mouth, and the leads themselves.

Judged: the drop over drawn cracks, and over a crack along the fibres that grew bond by bond, by its
broken bonds and by a crack drawn along its path (`Sensor.along`), against finite elements with
slits of the same length; over cracks that left their line (fibres at
π/4, π/3, π/2) against cracks drawn along the same path on the same lattice; that no drop falls; the
length that a drop measured on finite elements' slits tells by a curve made on the lattice. Shown:
what a sensor costs beside the mechanics (its target is a fifth), drop and load over displacement
(Fig. 40), drop over length (Fig. 41), potentials (Fig. 39), and the paper's 1.03, 1.10 and 1.16
beside ours.

Why a grown crack misses its slit by more than a drawn one does: two effects of the horizon, each
larger than what they leave together. Bonds that are still whole across its path, those at a small
angle to it, conduct; and the faces that it leaves are bare: beside a drawn crack the volume method
stiffens the bonds that are left, beside a grown one nothing does. Change of the drop by each, from
a/W = 0.45 to 0.73 (`taken_apart`):

    fibres     spacing    whole across    bare faces    together
    ζ = 0      0.5 mm       −6 … −8 %      +5 … +8 %    ≤ 2.0 %
    ζ = 0      0.3 mm       −5 … −6 %      +4 … +5 %    ≤ 2.1 %
    ζ = π/4    0.5 mm       −3 … −14 %     +3 … +4 %    0.3 … 11 %
    ζ = π/3    0.5 mm       −3 … −11 %     +2 … +4 %    0.6 … 8 %
    ζ = π/2    0.5 mm       −3 … −19 %     +7 … +30 %   3 … 5 %

Without bonds across, and without a treatment, the drop of a crack that is drawn to its slit exceeds
the slit's by 3–8 % at 0.5 mm, 2–4 % at 0.3 mm and 1.7–2.5 % at 0.15 mm, less with m = 3: the bare
faces are the horizon's, at an order of 0.6. At a/W = 0.55 in other directions, whole across, bare
faces, together:

    fibres     0.5 mm                     0.3 mm
    ζ = π/4    −6.1 %   +4.3 %   2.0 %    −5.7 %   +2.5 %   3.4 %
    ζ = π/3    −8.8 %   +3.1 %   6.0 %    −7.2 %   +2.2 %   5.2 %
    ζ = π/2    −9.2 %  +15.4 %   4.8 %   −11.5 %  +14.4 %   1.2 %

So what is left may grow while both fall: of two opposed effects only the larger one is a bound.
It is no fault of the path's length: a crack drawn along it has the drop of its slit within 0.7 and
0.4 % at 0.5 and 0.3 mm, from a/W = 0.4 to 0.75, where broken bonds are up to 2.3 and 2.5 % low.
Lengths by the energy that broke (dissipated over G) are shorter by a cell and more, and leave +0.4
… +4 %: they count whole bonds across, and no faces. In other directions bonds along the fibres hold
a crack together far behind its tip, and carry current: such a crack is longer than its drop tells.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.case import (
    Array,
    Case,
    Check,
    Curve,
    Level,
    LinePlot,
    Measurement,
    Method,
    Stage,
    Stages,
)
from cmverify.cases.common import adapters
from cmverify.cases.experiments import bone
from cmverify.cases.experiments.bone import RATIO, TIP, WIDTH, Specimen
from cmverify.cases.experiments.running import bridging
from cmverify.faults.changes import result
from cmverify.faults.fault import Fault
from cmverify.judge.norms import worst

if TYPE_CHECKING:
    from solver import Scene
    from solver.fracture.sensing import Sensor

CELL = WIDTH / 40
LEAD, PROBE = (-24, 20, 3), (-24, 1, 2)
RESISTIVITIES, EXPONENT = (170.0, 540.0), 4
#: Relative drops of the paper for ζ = 0 at displacements in mm (Fig. 39).
PAPER = {0.169: 1.03, 0.211: 1.10, 0.348: 1.16}
#: Lengths a/W within which grown cracks are held against slits; beyond, the ligament is gone.
LONGEST = 0.75
#: Length a/W at which a grown crack is taken apart.
MIDWAY = 0.55
#: Lengths a/W from which on the drop is read along its path, too.
AT = np.array([0.4, 0.5, 0.6, 0.7])
FEM = "scikit-fem with slits of the same length (references: bone-leads)"


@dataclass(frozen=True)
class Conductor:
    """Fibres at `degrees` to the crack; `scale` multiplies the conductivity (for tests)."""

    degrees: float = 0.0
    scale: float = 1.0
    surface: Any = "volume"

    def scene(self, n: int, tip: float = TIP) -> Scene:
        """The specimen as a conductor at spacing unit/n, its crack drawn to `tip`."""
        from solver import Cosine, Crack, ElectricConductivityTensor, Load, Scene, Support

        base, _ = Specimen(self.degrees, surface=self.surface).scene(n)
        along, across = (rho / self.scale for rho in RESISTIVITIES)
        far = 0.55 * WIDTH

        def level(x: Array, y: Array) -> np.ndarray:
            distance = np.hypot(x - far, y - 1e-6 * WIDTH)
            return np.asarray(distance == distance.min())

        return Scene(
            base.region,
            base.spacing,
            ElectricConductivityTensor.of_resistivities(along, across, np.radians(self.degrees)),
            m=base.m,
            law=Cosine(EXPONENT),
            surface=self.surface,
            phase=base.phase,
            cracks=[Crack((-0.65 * WIDTH, 0.0), (tip, 0.0))],
            supports=[Support.where(level, potential=0.0)],
            loads=[Load.lead(1.0, square(LEAD, True)), Load.lead(-1.0, square(LEAD, False))],
        )

    def sensor(self, n: int, place: tuple[int, int, int] = PROBE, tip: float = TIP) -> Sensor:
        """A voltmeter between a square and its mirror image."""
        from solver.fracture.sensing import Sensor

        return Sensor(self.scene(n, tip), square(place, True), square(place, False))


def square(place: tuple[int, int, int], upper: bool) -> Any:
    """A square (left, bottom, side) in units of W/40, above the crack or mirrored below."""
    from solver import rectangle

    x, y, side = (CELL * k for k in place)
    middle = y + 0.5 * side
    return rectangle(side, side, (x + 0.5 * side, middle if upper else -middle))


@cache
def reference(degrees: float) -> Any:
    """Finite elements' drops over a/W: (ratios, mouth, leads).

    Raises
    ------
    LookupError
        If none are stored for fibres at this angle.
    """
    from references.provenance import load

    stored = load("bone-leads")
    rows = np.flatnonzero(stored["degrees"] == degrees)
    if not len(rows):
        raise LookupError(f"bone-leads holds no drops for fibres at {degrees:g}°")
    return tuple(stored[name][rows[0]] for name in ("ratios", "mouth", "leads"))


def slit_drop(degrees: float, ratio: Array, which: int = 1) -> Array:
    """The same at any a/W, by splines."""
    from scipy.interpolate import CubicSpline

    known = reference(degrees)
    return np.asarray(CubicSpline(known[0], known[which])(ratio))


def drawn(conductor: Conductor, n: int, ratios: Array) -> Array:
    """Drops between the probes and between the leads over drawn cracks, (cracks, 2), V."""
    from solver.analyses.statics import solve
    from solver.fracture.sensing import Sensor

    found = []
    for ratio in ratios:
        scene = conductor.scene(n, (ratio - RATIO) * WIDTH + TIP)
        solution = solve(scene.discretise(sharp_tips=False), 1e-9)
        found.append([
            Sensor(scene, square(place, True), square(place, False)).read(solution)
            for place in (PROBE, LEAD)
        ])  # fmt: skip
    return np.array(found)


def slits(conductor: Conductor, few: bool, n: int) -> Measurement:
    """Drops over drawn cracks against slits, and crack lengths told by them."""
    from solver.fracture.crack_length import DropCurve

    ratios, mouth, leads = reference(conductor.degrees)
    chosen = slice(1, None, 2) if few and n <= 2 else slice(None)
    ratios, mouth, leads = ratios[chosen], mouth[chosen], leads[chosen]
    drops = drawn(conductor, n, ratios)
    wanted = np.column_stack([mouth, leads])
    relative = drops / drops[0] / (wanted / wanted[0]) - 1.0
    found = {
        "drop": worst(np.abs(drops / wanted - 1.0).ravel().tolist()),
        "relative drop": worst(np.abs(relative).ravel().tolist()),
    }
    if len(ratios) > 5:
        curve = DropCurve(ratios, drops[:, 0], float(drops[0, 0]))
        between = 0.5 * (ratios[1:] + ratios[:-1])
        measured = slit_drop(conductor.degrees, between) / mouth[0]
        told = [curve.length(float(d), noise=2e-3) for d in measured]
        errors = [abs(t.length - a) for t, a in zip(told, between, strict=True)]
        found["told length"] = worst(errors)
    label = f"ζ = {conductor.degrees:g}°"
    line = LinePlot(
        "Drop over the length of the crack", "$a/W$", "$\\Delta\\phi/\\Delta\\phi_0$",
        (Curve(label, ratios, drops[:, 0] / drops[0, 0], mouth / mouth[0]),),
        over_methods=True, reference_label="finite elements, slits",
    )  # fmt: skip
    return Measurement(len(ratios), found, lines=(line,))


def taken_apart(sensor: Sensor, run: Any) -> dict[str, float]:
    """What whole bonds across a grown crack and its bare faces do to the drop.

    Returns
    -------
    dict
        ``whole across``: relative change by the bonds across the path that are whole; ``bare
        faces``: by faces of cut bonds beside those of a crack drawn along the path; ``beside
        drawn``: size of both together.
    """
    gone = run.broken
    across = np.zeros(gone.size, dtype=bool)
    across[bridging(run)] = True
    here = sensor.read(sensor.solve(gone))
    without = sensor.read(sensor.solve(gone | across.reshape(gone.shape)))
    drawn = sensor.along(run.path)
    return {
        "whole across": here / without - 1.0,
        "bare faces": without / drawn - 1.0,
        "beside drawn": abs(here / drawn - 1.0),
    }


def grown(conductor: Conductor, n: int) -> Measurement:
    """Drop while the crack of the specimen grows, beside what the sensor costs."""
    from time import process_time

    sensor, between = conductor.sensor(n), conductor.sensor(n, LEAD)
    spent: dict[str, float] = {"drop": 0.0, "between": 0.0, "parts": 0.0}
    along: list[tuple[float, float]] = []
    maps: list[tuple[float, float, Array]] = []
    parts: dict[str, float] = {}

    def read(name: str, meter: Sensor, run: Any) -> float:
        begun = process_time()
        drop = meter(run)
        spent[name] += process_time() - begun
        if name == "drop" and not parts and RATIO + run.advance / WIDTH >= MIDWAY:
            begun = process_time()
            parts.update(taken_apart(sensor, run))
            spent["parts"] += process_time() - begun
        length = RATIO + run.advance / WIDTH
        if name == "drop" and conductor.degrees == 0.0 and len(along) < sum(length >= AT):
            begun = process_time()
            along.append((length, sensor.along(run.path)))
            spent["parts"] += process_time() - begun
        if name == "drop" and np.isfinite(drop) and (not maps or drop > 1.03 * maps[-1][1]):
            maps.append((run.load_factor, drop, sensor.solution(run).potential))
        return drop

    begun = process_time()
    monitors = {"drop": partial(read, "drop", sensor), "between": partial(read, "between", between)}
    led = Specimen(conductor.degrees, surface=conductor.surface).led(n, monitors=monitors)
    mechanics = process_time() - begun - sum(spent.values())
    run, h = led.run, led.run.history
    drop = np.array(h["drop"]) / float(h["drop"][0])
    other = np.array(h["between"]) / float(h["between"][0])
    length = RATIO + np.array(h.advance) / WIDTH
    kept = np.isfinite(drop) & (length <= LONGEST)
    force = bone.THICKNESS / bone.MOVE
    shown = np.isfinite(drop)
    statistics: dict[str, float | int | str] = {
        **led.statistics,
        "sensor, CPU s": round(spent["drop"], 2),
        "mechanics, CPU s": round(mechanics, 2),
        "readings": len(drop),
    }
    for moved, value in PAPER.items():
        k = max(0, int(np.searchsorted(h.load_factor, moved, side="right")) - 1)
        statistics[f"drop at {moved} mm (paper {value})"] = (
            f"{drop[k]:.3f} between the probes, {other[k]:.3f} between the leads, a/W "
            f"{length[k]:.3f}"
        )
    found = {
        "cost": spent["drop"] / mechanics,
        "fallen": float(max(0.0, -np.diff(drop[shown]).min())),
        **parts,
    }
    curve = Curve("bond lattice", length[kept], drop[kept], np.zeros(0), np.zeros(0))
    if conductor.degrees == 0.0:
        # Cracks along inclined fibres leave the line on which slits are known.
        slit = slit_drop(0.0, length[kept]) / slit_drop(0.0, np.array([RATIO]))
        found["grown"] = worst(np.abs(drop[kept] / slit - 1.0).tolist())
        at, by = np.array(along).reshape(-1, 2).T
        slit_there = slit_drop(0.0, at) / slit_drop(0.0, np.array([RATIO]))
        found["along path"] = worst(
            np.abs(by / h["drop"][0] / slit_there - 1.0).tolist() or [np.nan]
        )
        curve = Curve("bond lattice", length[kept], drop[kept], slit)
    return Measurement(
        run.body.operator.shape[0],
        found,
        led.seconds,
        statistics,
        lines=(
            LinePlot(
                f"Drop between the probes, ζ = {conductor.degrees:g}°", "$u^*$ (mm)",
                "$\\Delta\\phi/\\Delta\\phi_0$",
                (Curve("bond lattice", np.array(h.load_factor)[shown], drop[shown],
                       np.array(list(PAPER.values())), np.array(list(PAPER))),),
                joined=True, reference_label="the paper's values for ζ = 0, leads of its own",
            ),
            LinePlot(
                f"Force of the pins, ζ = {conductor.degrees:g}°", "$u^*$ (mm)", "force (N)",
                (Curve("bond lattice", np.array(h.load_factor), force * np.array(h.force),
                       np.array([bone.PAPER] * 2), np.array([0.0, float(h.load_factor.max())])),),
                joined=True, reference_label="the paper's peak for ζ = 0",
            ),
            LinePlot(
                f"Drop over the length of the crack, ζ = {conductor.degrees:g}°", "$b/W$",
                "$\\Delta\\phi/\\Delta\\phi_0$", (curve,), joined=conductor.degrees != 0.0,
                reference_label="finite elements, slits" if conductor.degrees == 0.0 else "",
            ),
        ),
        stages=_stages(run.points, run.scene.spacing, maps, float(h["drop"][0])),
    )  # fmt: skip


def _stages(
    points: Array, spacing: float, maps: list[tuple[float, float, Array]], intact: float
) -> Stages | None:
    """Four of the potential maps, over the largest potential of the first.

    A run that was taken up again has those since then; none, if nothing was read any more.
    """
    if not maps:
        return None
    known = maps[0][2][np.isfinite(maps[0][2])]
    most = float(np.abs(known).max())
    chosen = dict.fromkeys(np.linspace(0, len(maps) - 1, 4).round().astype(int).tolist())
    return Stages(
        "potential over the first map's largest",
        points,
        spacing,
        tuple(
            Stage(f"u* = {maps[k][0]:.3f} mm", np.array([maps[k][0], maps[k][1] / intact]),
                  maps[k][2] / most)
            for k in chosen
        ),
    )  # fmt: skip


@cache
def warm_up() -> None:
    """Compile the kernels."""
    drawn(Conductor(), 1, np.array([0.45]))


def _drawn(degrees: float, surface: str = "volume", **ladder: tuple[int, ...]) -> Method:
    levels = {level: ladder.get(level.value, ()) for level in Level}
    run = partial(slits, Conductor(degrees, surface=surface), degrees == 0.0)
    name = f"drawn, ζ = {degrees:g}°" + (", extrapolated" if surface != "volume" else "")
    return Method(name, "bond", run, levels, warm_up)


def _grown(degrees: float, **ladder: tuple[int, ...]) -> Method:
    levels = {level: ladder.get(level.value, ()) for level in Level}
    return Method(f"grown, ζ = {degrees:g}°", "bond", partial(grown, Conductor(degrees)), levels,
                  warm_up)  # fmt: skip


_STRAIGHT = _drawn(0.0, quick=(2,), standard=(2, 3, 5), paper=(2, 3, 5, 10))
_DRAWN = (
    _STRAIGHT,
    _drawn(0.0, "extrapolated", standard=(2, 3, 5), paper=(2, 3, 5, 10)),
    *(_drawn(degrees, standard=(3,), paper=(3, 5)) for degrees in (45.0, 90.0)),
)
_AHEAD = _grown(0.0, standard=(3,), paper=(3, 5))
_GROWN = (_AHEAD, *(_grown(degrees, paper=(3, 5)) for degrees in (45.0, 60.0, 90.0)))
_BOUND = 0.02
_ASKED = "2 % of " + FEM

CASES = (
    Case(
        name="bone-sensing",
        title="Damage sensing: the potential drop over a crack in cortical bone",
        section="Sect. 4.3.2",
        equations=("Eq. 173", "Eq. 174", "Eq. 175"),
        figures=("Fig. 39", "Fig. 40", "Fig. 41"),
        tags=("sensing", "electrical", "fracture", "experiments"),
        shows=(
            "The relative drop over drawn cracks, and over one that grows bond by bond, is that of "
            "finite elements with slits of the same length, and the drop tells the crack's length."
        ),
        methods=(*_DRAWN, *_GROWN),
        checks=(
            *(Check(m.name, "relative drop", {2: _BOUND}, source=_ASKED) for m in _DRAWN),
            *(
                Check(m.name, "drop", {2: 0.1, 3: 0.065, 5: 0.035},
                      source=f"{FEM}; measured with half as much again, probes of whole particles")
                for m in _DRAWN
            ),
            *(
                Check(m.name, "told length", {3: 0.02},
                      source="half a cell of the coarsest lattice, over W")
                for m in _DRAWN
            ),
            Check(_AHEAD.name, "grown", {3: 0.037},
                  source="2 % is asked of drawn cracks. Of one that grew, whole bonds across it "
                  "and bare faces leave 2.3 and 2.5 % at 0.5 and 0.3 mm, each being twice as "
                  f"much; measured against {FEM}, half as much again"),
            Check(_AHEAD.name, "along path", {3: _BOUND}, source=_ASKED),
            *(Check(m.name, "beside drawn", {3: bound},
                    source="a crack drawn along the same path on the same lattice; whole bonds "
                    "across the grown one conduct (measured at 0.5 mm, half as much again; at π/4, "
                    "where two opposed effects nearly cancel by chance, the larger of them)")
              for m, bound in zip(_GROWN, (0.03, 0.061, 0.09, 0.072), strict=True)),
            *(Check(m.name, "fallen", {3: 1e-6}, exact=True,
                    source="fewer bonds conduct less (Rayleigh's law of monotony)")
              for m in _GROWN),
        ),
        quantities={
            "relative drop": "largest relative error of Δφ/Δφ₀, all lengths, probes and leads",
            "drop": "largest relative error of the drop itself",
            "told length": "largest error over W of lengths told by drops of finite elements",
            "grown": "largest relative error of Δφ/Δφ₀ at the length of the path, to a/W = 0.75",
            "along path": "the same of a crack drawn along its path, at four lengths",
            "whole across": "relative change of the drop by bonds across the path that are whole, "
            f"at a/W = {MIDWAY} (shown)",
            "bare faces": "the same by faces that no surface treatment knows (shown)",
            "beside drawn": "relative difference from a crack drawn along the path, both together",
            "cost": "CPU time of the sensor over that of the mechanics (shown)",
            "fallen": "largest fall of Δφ/Δφ₀ from one reading to the next",
        },
        elements=adapters.stored("bone-leads", degrees=[45.0], tips=[0], elements=1),
        primary="relative drop",
        featured=_STRAIGHT.name,
        length="1.5 mm",
        timed=False,
    ),
)  # fmt: skip

FAULTS = (
    Fault("drop of a sensor that grows with itself", "solver.fracture.sensing._difference",
          result(lambda drop: drop * (1 + 1.5e-4 * abs(drop))), "sensing"),
    Fault("potential drop of slits + 10 %", "cmverify.cases.sensing.reference",
          result(lambda found: (found[0], 1.1 * found[1], found[2])), "closed forms"),
)  # fmt: skip
