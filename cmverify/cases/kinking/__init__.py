"""Crack kinking in anisotropic bodies: angles, and what their errors are made of (Figs. 24–27)."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from cmverify.case import Case, Check, Level, Method
from cmverify.cases.common import adapters, warm
from cmverify.cases.kinking.measure import Study, study
from cmverify.cases.kinking.problem import ANGLES, MATERIALS, Kink
from cmverify.exchange.statement import ABSOLUTE, LINES, Pose, Statement, Target

LADDER = {Level.QUICK: (30,), Level.STANDARD: (30, 60), Level.PAPER: (30, 60, 120)}
#: Along the equilibrium path, with cuts in every direction of bonds costing the same.
LED = "levelled cuts, batch ÷ 8"
#: One thing changed at a time, at a/60; m is changed with the number of bonds that break together.
VARIATIONS: dict[str, dict[str, Any]] = {
    "m = 3": {"m": 3},
    "m = 7": {"m": 7},
    "batch ÷ 8": {"front": 1 / 8},
    "batch ÷ 2": {"front": 1 / 2},
    "batch × 2": {"front": 2.0},
    "turned 22.5°": {"turn": 22.5},
    "turned 22.5°, batch ÷ 8": {"turn": 22.5, "front": 1 / 8},
    "even bonds, batch ÷ 2": {"toughness": "even", "front": 1 / 2},
    LED: {"toughness": "directions", "front": 1 / 8},
    "no surface factors": {"surface": "none"},
    "extrapolated faces": {"surface": "extrapolated"},
}
#: The load held while bonds are overloaded, which takes ten times the solves: three mixities.
HELD = "load held, three mixities"
VARIED = {Level.PAPER: (60,)}
FIGURES = "Figs. 25–27: scatter of the paper's own angles about the criterion"

PATHS = "the bound of the angle over a/4, and a cell of a/30 to the side at the old tip"
QUANTITIES = {
    "rms": "root mean square deviation of the kink angles (line fitted to a/4) from where the "
    "energy release rate is largest, degrees",
    "largest": "largest such deviation, degrees",
    "rms hoop": "root mean square deviation from the hoop-stress criterion, degrees",
    "largest hoop": "largest such deviation, degrees",
    "rms apart": "how far the two criteria are from each other, root mean square, degrees",
    "rms near": "as rms, the line fitted up to a/10 only: the K-field at the edge is held fixed "
    "while the crack grows, which matters less there",
    "rms chord": "as rms, from the chord between old and new tip instead of a fitted line",
    "path": "largest distance, up to a/4 from the old tip, between the crack's path and the "
    "straight kink of largest energy release rate, a",
    "drive": "median of G over the toughness when the kink is one horizon long; 1 is Griffith's",
    "straight": "deviation from straight in mode I, degrees",
    "mirror": "largest distance between the path and the mirror image of the mirrored crack's, a",
    "seconds": "wall seconds of the slowest angle",
}


def _state(kink: Kink, n: int) -> Statement:
    """One mixity: how the crack kinks, by number or by its path."""
    from cmverify.cases.kinking.angles import energy_angle, grown_path, path_angle, straight
    from cmverify.cases.kinking.problem import scene_of

    angle = energy_angle(kink.material, kink.mixity)
    return Statement(
        scene_of(replace(kink, n=n)),
        (
            Target("kink_angle", "largest", "°", np.array([angle]), ABSOLUTE,
                   read=lambda path: np.array([path_angle(path)])),
            Target("path", "path", "a", straight(angle), LINES, needed=False, read=grown_path),
        ),
        (
            "What is prescribed is the field of K_I = cos α, K_II = sin α; times a factor that is "
            "raised until the crack has grown to a distance of a/4 from its old tip, the origin.",
            "The toughness is the same in all directions.",
            "Judged: kink_angle, one number in degrees from the crack's direction anticlockwise, "
            "or path, (k, 2) from the old tip on (in a table columns x and y and no others), from "
            "which the angle of the straight line through it up to a/4 is read.",
        ),
    )  # fmt: skip


def _case(material: str, name: str, shows: str) -> Case:
    kink = Kink(material, 0.0, 0)
    main = "bond/lattice"
    silicon = [
        Check(main, "straight", {30: 1.0}, source="symmetry", exact=True),
        Check(f"bond/{LED}", "rms", {60: 4.0}, source=FIGURES),
    ]
    return Case(
        name=f"kinking-{name}",
        title=f"Crack kinking, {material} material"
        if name != "silicon"
        else "Crack kinking, silicon",
        section="Sect. 3.1.1",
        equations=("Eqs. 92, 100 and 104", "Eqs. 106–107"),
        figures=("Fig. 24", "Fig. 25" if name == "silicon" else "Fig. 26", "Fig. 27"),
        tags=("kinking", "fracture"),
        shows=shows,
        methods=(
            Method(main, "bond", partial(study, Study(kink, extra=True)), LADDER, warm.growth),
            *(
                Method(
                    f"bond/{label}",
                    "bond",
                    partial(study, Study(replace(kink, **change))),
                    VARIED,
                    warm.growth,
                )
                for label, change in VARIATIONS.items()
            ),
            Method(
                f"bond/{HELD}",
                "bond",
                partial(
                    study,
                    Study(replace(kink, control="fixed"), mixities=(0.0, 45.0, 90.0)),
                ),
                VARIED,
                warm.growth,
            ),
        ),
        checks=(
            Check(main, "rms", {30: 8.0, 60: 4.0}, source=FIGURES),
            Check(main, "largest", {30: 12.0, 60: 8.0}, source=FIGURES),
            Check(main, "path", {30: 0.085}, source=PATHS),
            Check(main, "mirror", {30: 1e-6}, source="symmetry", exact=True),
            # The fully anisotropic body misses the latter by 1° (docs/results.md).
            *(silicon if name == "silicon" else []),
        ),
        quantities=QUANTITIES,
        elements=adapters.stored(f"kinks-{MATERIALS[material]}", degrees=[30.0]),
        primary="rms",
        featured=main,
        timed=False,
        poses=tuple(
            Pose(main, partial(_state, replace(kink, mixity=a)), f"mixity {a:g}°") for a in ANGLES
        ),
    )


CASES = (
    _case(
        "silicon",
        "silicon",
        "A crack under a mixed-mode K-field kinks where the energy release rate is largest, within "
        "a few degrees, if a cell's worth of bonds breaks at a time, which overdrives the crack. G "
        "is flat there, 0.4 % less at 5° from it, so that small things decide: along the "
        "equilibrium path, which small batches and a held load follow, the rows of the lattice. "
        "The hoop criterion, up to 5° off the energy criterion in silicon, is met less well.",
    ),
    _case(
        "fully anisotropic",
        "anisotropic",
        "In the fully anisotropic body the two criteria differ by up to 10°, most in mode I, and "
        "the bond model goes with the energy criterion if a cell's worth of bonds breaks at a "
        "time. With fewer it goes along the rows of the lattice, up to 11° off; with levelled cuts "
        "it is 5° off (rms), most in mode I, where the row in which the crack lies holds it.",
    ),
)
