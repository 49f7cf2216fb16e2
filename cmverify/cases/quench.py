"""Cracks that grow in quenched ceramics (Jiang et al. 2012; Bourdin et al. 2014), bond by bond.

The alumina of `thermal_shock`, 10 mm wide, turns cold at its edges at once. Two problems:

*One flaw* at an edge, the temperatures those of two edges as if alone. It runs in and stops, time
after time, where its K of Bueckner's weight function has fallen to what the bonds ask for:
Griffith's K_c, and up to a lattice's trapping more (7 to 30 % from m = 7 to 3, as of any crack in
growth). Bonds may break within 1.5 mm of its line, and ahead of where it began.

*An array* of twenty flaws, 1 mm apart and 0.4 to 0.6 mm deep by the golden ratio, in half the plate
(a line of symmetry opposite the cold edge), temperatures by Fourier's series. All load each other
off: few run in, and the deeper, the wider apart, which is what the experiments' plates show and
what Bourdin et al. computed from bodies without flaws. Where flaws start is given here: without
any, that is a matter of the strength, which in bonds the horizon makes.

Judged: K at rest over K_c; the number of deep cracks by three lattices; how far the others stay
behind; the balance of energy. Shown: depths, and the cracks at four times. The experiments' own
spacings are not judged: their flaws are not known, nor is the film of their baths.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial
from typing import Any

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
from cmverify.cases.thermal_shock import (
    CAPACITY,
    CONDUCTIVITY,
    EXPANSION,
    POISSON,
    TOUGHNESS,
    WIDTH,
    YOUNG,
)
from cmverify.faults.changes import argument, times
from cmverify.faults.fault import Fault
from cmverify.judge.norms import worst

DIFFUSIVITY = CONDUCTIVITY / CAPACITY
#: One flaw: jump, K.
JUMP = 110.0
#: The array: jump, K, length of the plate, distance of flaws, their depths, m, and times, s.
ARRAY_JUMP, ARRAY_M = 250.0, 3
LENGTH, PITCH, DEPTHS = 20e-3, 1e-3, (0.4e-3, 0.6e-3)
ARRAY_TIMES = np.geomspace(2e-3, 1.0, 40)
#: Bonds a batch. The more cracks run at once, the more they may be.
BATCH = 20


@dataclass(frozen=True)
class Flaw:
    """An edge crack that is there before the quench.

    Its depth and the plate's length over W, the toughness over alumina's, and the times, s.
    """

    m: int = 5
    depth: float = 0.1
    length: float = 3.0
    toughness: float = 1.0
    first: float = 0.01
    last: float = 0.06
    times: int = 16

    @property
    def at(self) -> Array:
        """Times at which bonds may break, s."""
        return np.geomspace(self.first, self.last, self.times)


#: What counts as a crack that ran in, m, and how many of them there are.
DEEP, COUNT = 1e-3, 6


def toughness_over(given: Flaw, depth: Array, times: Array) -> Array:
    """K of the weight function over K_c, crack by crack."""
    from references.analytic.edge_crack import intensity, quenched, thermal_stress

    found = []
    for crack, time in zip(depth, times, strict=True):
        reach = float(np.sqrt(DIFFUSIVITY * time))

        def stress(x: Array, reach: float = reach) -> Array:
            return thermal_stress(x, WIDTH, lambda d: quenched(d, WIDTH, reach), YOUNG, EXPANSION)

        found.append(JUMP * intensity(stress, float(crack), WIDTH))
    return np.array(found) / float(np.sqrt(YOUNG * TOUGHNESS * given.toughness))


def series(depth: Array, time: float) -> Array:
    """Temperature of half a plate per degree of the jump, by Fourier, at depths from its edge."""
    height = 0.5 * WIDTH
    k = (np.arange(200) + 0.5) * np.pi / height
    decay = 2 / (k * height) * np.exp(-DIFFUSIVITY * k**2 * time)
    levels, back = np.unique(depth, return_inverse=True)
    return np.asarray((np.sin(np.outer(levels, k)) @ decay)[back] - 1.0)


def one_flaw(given: Flaw, n: int, scale: float = 1.0) -> tuple[Array, Any]:
    """Depth at rest at each of the times, m, and the run."""
    from references.analytic.edge_crack import quenched
    from solver import Crack, ElasticTensor, ExpansionTensor, Scene, Support, Toughness, rectangle
    from solver.fracture import Temperatures, grow

    h, start, times = WIDTH / n, given.depth * WIDTH, given.at

    def near(row: float) -> Any:
        return lambda x, y: np.hypot(x - 0.25 * WIDTH - 0.5 * h, y - row * h) < 0.1 * h

    def whole(x: Array, y: Array) -> Array:
        behind = x < start - 0.5 * WIDTH - given.m * h
        return np.asarray((np.abs(y) > 0.15 * WIDTH) | behind | (x > 0.2 * WIDTH))

    scene = Scene(
        rectangle(WIDTH, given.length * WIDTH),
        h,
        ElasticTensor.isotropic(YOUNG, POISSON),
        [Support.where(near(0.5), u1=0.0, u2=0.0), Support.where(near(2.5), u1=0.0)],
        cracks=[Crack((-WIDTH, 0.0), (start - 0.5 * WIDTH, 0.0))],
        m=given.m,
    )
    x = scene.discretise(sharp_tips=False).lattice.points[:, 0] + 0.5 * WIDTH
    changes = [JUMP * quenched(x, WIDTH, float(np.sqrt(DIFFUSIVITY * t))) for t in times]
    fields = Temperatures(times, changes, ExpansionTensor.isotropic(EXPANSION))
    run = grow(
        scene, Toughness(scale * given.toughness * TOUGHNESS), temperatures=fields, no_fail=[whole]
    )
    h_ = run.history
    last = [np.flatnonzero(h_["time"] == t)[-1] for t in times]
    return start + h_.advance[last], run


def flaw(given: Flaw, n: int, scale: float = 1.0) -> Measurement:
    """K at rest of one flaw that grows; `scale` on the bonds' toughness, for tests."""
    from time import perf_counter

    begun = perf_counter()
    depth, run = one_flaw(given, n, scale)
    k = toughness_over(given, depth, given.at)
    # None has grown: nothing is known of what it takes.
    grown = k[depth > given.depth * WIDTH + 0.5 * WIDTH / n] if run.advance else np.array([np.nan])
    h = run.history
    return Measurement(
        run.body.operator.shape[0],
        {
            "largest K": worst((grown - 1.0).tolist()),
            "least K": float(np.maximum(0.0, worst((1.0 - grown).tolist()))),
            "balance": float(np.abs(h.imbalance).max() / h.work.max()),
        },
        {"solve": perf_counter() - begun},
        {"solves": len(run.steps), "bonds broken": len(run.broken_bonds),
         "last depth, mm": f"{1e3 * depth[-1]:.3f}"},
        lines=(
            LinePlot(
                "Depth of one crack after the quench", "time (s)", "depth over W",
                (Curve("bonds", given.at, depth / WIDTH, griffith(given) / WIDTH),),
                joined=True, reference_label="K = K_c by the weight function",
            ),
        ),
    )  # fmt: skip


def griffith(given: Flaw) -> Array:
    """Depth of a crack that grows at K = K_c, from the flaw's on, m."""
    depth, found = given.depth * WIDTH, []
    for time in given.at:
        while (
            depth < 0.49 * WIDTH
            and toughness_over(given, np.array([depth]), np.array([time]))[0] >= 1
        ):
            depth += 5e-3 * WIDTH
        found.append(depth)
    return np.array(found)


def array(n: int, jump: float = ARRAY_JUMP, times: Array = ARRAY_TIMES, listen: Any = None) -> Any:
    """The run of the array, n cells over half the width; places and depths of its flaws, m."""
    from solver import Crack, ElasticTensor, ExpansionTensor, Scene, Support, Toughness, rectangle
    from solver.fracture import Temperatures, grow

    height = 0.5 * WIDTH
    h, count = height / n, round(LENGTH / PITCH)
    places = (np.arange(count) + 0.5) * PITCH - 0.5 * LENGTH
    depths = DEPTHS[0] + (DEPTHS[1] - DEPTHS[0]) * (np.arange(count) * 0.618034 % 1.0)

    def opposite(x: Array, y: Array) -> Any:
        return y < h - 0.5 * height

    scene = Scene(
        rectangle(LENGTH, height),
        h,
        ElasticTensor.isotropic(YOUNG, POISSON),
        [Support.where(opposite, u2=0.0, rotation=0.0),
         Support.where(lambda x, y: opposite(x, y) & (np.abs(x - 0.5 * h) < 0.1 * h), u1=0.0)],
        cracks=[Crack((float(x), 0.6 * height), (float(x), 0.5 * height - float(d)))
                for x, d in zip(places, depths, strict=True)],
        m=ARRAY_M,
    )  # fmt: skip
    y = scene.discretise(sharp_tips=False).lattice.points[:, 1]
    changes = [jump * series(0.5 * height - y, t) for t in times]
    given = Temperatures(times, changes, ExpansionTensor.isotropic(EXPANSION))
    run = grow(scene, Toughness(TOUGHNESS), temperatures=given, batch=BATCH, listen=listen)
    return run, places, depths


def reached(run: Any, places: Array, depths: Array) -> Array:
    """Depth of every crack: the deepest bond that broke beside its flaw, m."""
    middles, found = run.midpoints, depths.copy()
    for k, x in enumerate(places):
        beside = np.abs(middles[:, 0] - x) < 0.5 * PITCH
        found[k] = max(found[k], (0.25 * WIDTH - middles[beside, 1]).max(initial=0.0))
    return found


def many(n: int) -> Measurement:
    """Depths of the array's cracks at the end."""
    from time import perf_counter

    begun, kept = perf_counter(), {}
    moments = ARRAY_TIMES[[12, 20, 28, 39]]

    def listen(run: Any) -> None:
        if run.resting and run.time in moments:
            kept[run.time] = run.ledger.dissipated, run.damage

    run, places, depths = array(n, listen=listen)
    kept[run.time] = run.ledger.dissipated, run.damage
    seconds = perf_counter() - begun
    depth = reached(run, places, depths)
    order = np.sort(depth)[::-1]
    h = run.history
    deep = int((depth > DEEP).sum())
    return Measurement(
        run.body.operator.shape[0],
        {
            "deep cracks": abs(deep / COUNT - 1.0),
            "left behind": float(np.median(depth) / order[:4].mean()),
            "balance": float(np.abs(h.imbalance).max() / h.work.max()),
        },
        {"solve": seconds},
        {"solves": len(run.steps), "bonds broken": len(run.broken_bonds), "deep cracks": deep,
         "deepest, mm": ", ".join(f"{1e3 * d:.2f}" for d in order[:8])},
        lines=(
            LinePlot(
                "Energy that cracks have taken", "time (s)", "energy (J/m)",
                (Curve(f"{n} cells", h["time"], h.dissipated, np.zeros(0), np.zeros(0)),),
                joined=True,
            ),
            LinePlot(
                "Cracks deeper than a depth", "depth over W", "number",
                (Curve(f"{n} cells", order / WIDTH, np.arange(1.0, 1.0 + len(order)), np.zeros(0),
                       np.zeros(0)),),
                joined=True, over_methods=True,
            ),
        ),
        stages=Stages(
            "damage", run.points, run.scene.spacing,
            tuple(Stage(f"{time:.3f} s", np.array([time, spent]), damage)
                  for time, (spent, damage) in sorted(kept.items())),
        ),
    )  # fmt: skip


@cache
def warm_up() -> None:
    """Compile the kernels."""
    one_flaw(SMALL, 12)


#: Too coarse for its K; its energies balance all the same.
SMALL = Flaw(m=2, depth=0.2, length=1.0, toughness=0.4, first=0.04, last=0.12, times=3)
_SMALL = Method(
    "one flaw, coarse",
    "bond",
    partial(flaw, SMALL),
    {Level.QUICK: (12,), Level.STANDARD: (12,), Level.PAPER: (12,)},
    warm_up,
)
_ONE = Method(
    "one flaw",
    "bond",
    partial(flaw, Flaw()),
    {Level.STANDARD: (40,), Level.PAPER: (40, 60)},
    warm_up,
)
_MANY = Method("array", "bond", many, {Level.STANDARD: (32,), Level.PAPER: (32, 48, 64)}, warm_up)

CASES = (
    Case(
        name="thermal-shock-cracks",
        title="Cracks that run into a quenched ceramic plate",
        section="Sect. 5",
        equations=("Eq. 176", "Eq. 104"),
        tags=("thermoelastic", "fracture"),
        shows=(
            "A flaw runs in as far as the weight function lets it. Of twenty flaws a millimetre "
            "apart six run in; they load the others off, and the deeper, the wider apart."
        ),
        methods=(_SMALL, _ONE, _MANY),
        checks=(
            Check(_ONE.name, "largest K", {40: 0.1},
                  source="Griffith, and a lattice's trapping: m = 5"),
            Check(_ONE.name, "least K", {40: 0.05}, exact=True,
                  source="a crack at rest has not run on beyond Griffith's K_c; the weight "
                  "function is good to 1 %, a path to half a cell"),
            Check(_MANY.name, "deep cracks", {32: 0.17}, exact=True,
                  source="six of twenty, one crack more or less: the same by three lattices"),
            Check(_MANY.name, "left behind", {32: 0.4},
                  source="measured, with half as much again: flaws that all ran would give 1"),
            *(Check(m.name, "balance", {12: 1e-6}, exact=True,
                    source="the solves' tolerance") for m in (_SMALL, _ONE, _MANY)),
        ),
        quantities={
            "largest K": "by how much K at rest, of a crack that has grown, exceeds K_c",
            "least K": "by how much it falls short",
            "deep cracks": f"relative difference of the number of cracks beyond 1 mm from {COUNT}",
            "left behind": "median depth over that of the four deepest",
            "balance": "work − stored − dissipated − excess, relative to the work",
        },
        primary="largest K",
        featured=_MANY.name,
        length="W",
        timed=False,
    ),
)  # fmt: skip

FAULTS = (
    Fault("expansion does half its work", "solver.fracture.ledger.Ledger.warmed",
          argument(1, times(0.5)), "fracture"),
)  # fmt: skip
