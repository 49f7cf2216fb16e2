"""What scenes are told of finite elements beside them, judged by scenes that both solve exactly."""

from __future__ import annotations

from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from cmverify.case import Case, Check, Level, Measurement, Method
from cmverify.faults.changes import result, scaled
from cmverify.faults.fault import Fault

#: A turned orthotropic solid; u quadratic, prescribed in a layer, and the force that it takes.
SCENE = """
[discretisation]
spacing = 0.1
m = 2
surface = "extrapolated"
[region]
shape = "rectangle"
width = 0.7
height = 0.6
[material]
kind = "elastic"
voigt = [[2.0, 0.5, 0.2], [0.5, 1.0, 0.1], [0.2, 0.1, 0.4]]
[[support]]
layer_cells = 2
displacement = ["{scale} * (x**2 + 0.5*x*y + 0.2*y)", "{scale} * (y**2 - x*y - 0.3*x)"]
rotation = "{scale} * 0.5 * (-y - 0.3 - 0.5*x - 0.2)"
[[load]]
kind = "body_force"
value = [{force[0]}, {force[1]}]
"""
STIFFNESS = np.array([[2.0, 0.5, 0.2], [0.5, 1.0, 0.1], [0.2, 0.1, 0.4]])
#: Slopes along x and y of the strain of that displacement, (2x + y/2, 2y − x, x/2 − y − 1/10).
STRAIN_X, STRAIN_Y = np.array([2.0, -1.0, 0.5]), np.array([0.5, 2.0, -1.0])


def text(scale: float) -> str:
    """The scene, what acts in it times a scale."""
    sx, sy = STIFFNESS @ STRAIN_X, STIFFNESS @ STRAIN_Y
    force = -scale * np.array([sx[0] + sy[2], sx[2] + sy[1]])
    return SCENE.format(scale=scale, force=force.tolist())


def statics(_: int) -> Measurement:
    """Both are exact, and 1/101 apart when the elements' scene has one per cent more of all."""
    from pathlib import Path

    from cmverify.exchange import comparison, scene_file

    with TemporaryDirectory() as folder:
        requests = []
        for scale in (1.0, 1.01):
            path = Path(folder) / f"{scale}.toml"
            path.write_text(text(scale), encoding="utf-8")
            requests.append(scene_file.request(path))
        own = requests[0].run()
        found = {one.quantity: one for one in comparison.compare(requests[1], own).differences}
    u, stress = found["displacement"], found["stress"]
    return Measurement(
        0,
        {
            "displacement": abs(101.0 * u.l2 - 1.0),
            "stress": abs(101.0 * stress.l2 - 1.0),
            "largest": max(abs(101.0 * one.largest - 1.0) for one in (u, stress)),
            "elements' own": u.own,
        },
    )


def modes(_: int) -> Measurement:
    """Modes in another order, of other signs and, where two are one group, mixed."""
    from cmverify.exchange.modes_paired import paired

    generator = np.random.default_rng(2022)
    shapes = np.linalg.qr(generator.normal(size=(40, 6)))[0].T.reshape(6, 20, 2)
    own = np.array([1.0, 1.3, 1.3, 1.7, 2.2, 2.6])
    order, turn = np.array([2, 0, 1, 4, 3, 5]), 0.6
    others, theirs = shapes.copy(), own * 1.001
    c, s = np.cos(turn), np.sin(turn)
    others[1], others[2] = c * shapes[1] + s * shapes[2], c * shapes[2] - s * shapes[1]
    found = paired(own, shapes, theirs[order], -others[order], np.ones(20))
    # The last of them has no shape like it.
    lost = paired(own, shapes, theirs[:5], others[:5], np.ones(20))
    return Measurement(
        0,
        {
            "frequencies": float(np.abs(found.frequencies / own / 1.001 - 1.0).max()),
            "shapes": float(np.abs(found.shapes - shapes).max()),
            "modes paired wrongly": float((lost.alike != [True] * 5 + [False]).sum()),
        },
    )


def cross_check(_: int) -> Measurement:
    """Rows of the cross-check by FEniCSx that hold, and such that do not."""
    from cmverify.studies.crosscheck import Row

    sound: dict[str, Any] = {"difference": 1e-11, "change": 2e-3, "theirs": 1e-2, "finer": 5e-3}
    wrong: list[dict[str, Any]] = [
        {"difference": 2e-9}, {"difference": float("nan")}, {"difference": None}, {"change": 0.05},
        {"finer": 2e-2}, {"failure": "no answer"},
    ]  # fmt: skip
    bad = sum(Row("c", "p", **{**sound, **change}).passed for change in wrong)
    good = Row("c", "p", **sound).passed
    return Measurement(0, {"rows misjudged": float(bad + (not good))})


METHODS = {
    "statics": (
        statics,
        {"displacement": 1e-9, "stress": 1e-9, "largest": 1e-9, "elements' own": 1e-10},
        "quadratic fields, of which lattice and elements are exact",
    ),
    "modes": (modes, {"frequencies": 1e-12, "shapes": 1e-12}, "mixtures of the same shapes"),
    "cross-check": (cross_check, {}, ""),
}  # fmt: skip
COUNTED = (("modes", "modes paired wrongly"), ("cross-check", "rows misjudged"))

CASES = (
    Case(
        name="beside-elements",
        title="Scenes beside finite elements, and finite elements beside others",
        section="Sect. 2.3 (error norms)",
        tags=("judges",),
        shows=(
            'What `compare = "fem"` calls a difference is one: none where both are exact, one per '
            "cent where the scenes differ by that. Modes are paired by their shapes, and what "
            "FEniCSx does not confirm does not pass."
        ),
        methods=tuple(
            Method(name, "exact", run, dict.fromkeys(Level, (1,)))
            for name, (run, _, _) in METHODS.items()
        ),
        checks=(
            *(
                Check(name, quantity, {1: bound}, source=source, exact=True)
                for name, (_, bounds, source) in METHODS.items()
                for quantity, bound in bounds.items()
            ),
            *(Check(name, q, equals={1: 0.0}, source="arithmetic") for name, q in COUNTED),
        ),
        quantities={
            "displacement": "relative deviation of a difference of 1/101 of the displacement",
            "stress": "the same of the stress",
            "largest": "the same of the largest differences",
            "elements' own": "what elements that are exact say of themselves",
            "frequencies": "relative deviation of paired frequencies",
            "shapes": "largest deviation of paired shapes",
            "modes paired wrongly": "modes told to have none alike that have one, or the reverse",
            "rows misjudged": "rows of the cross-check that pass and must not, or the reverse",
        },
        primary="displacement",
        featured="statics",
        length="a",
        timed=False,
    ),
)


def _halved(differences):  # type: ignore[no-untyped-def]
    import dataclasses

    return dataclasses.replace(differences, l2=0.5 * differences.l2)


def _shifted(found):  # type: ignore[no-untyped-def]
    import dataclasses

    return dataclasses.replace(found, frequencies=np.roll(found.frequencies, 1))


B, X = "references.fem.body.Body", "cmverify.exchange"
FAULTS = (
    Fault("loads of elements beside a scene + 1 %", f"{B}.load", scaled(1.01), "beside elements"),
    Fault(
        "stiffness of elements beside a scene + 1 %", f"{B}.stiffness", scaled(1.01),
        "beside elements",
    ),
    Fault(
        "what elements beside a scene are held at + 1 %", f"{B}.held", scaled(1.01),
        "beside elements",
    ),
    Fault(
        "stress of elements beside a scene of the other sign",
        "references.fem.general.GeneralSolution.flux_at", scaled(-1.0), "beside elements",
    ),
    Fault(
        "loads beside a scene left out", f"{X}.finite_elements._acting",
        result(lambda acting: type(acting)()), "beside elements",
    ),
    Fault(
        "differences from elements halved", f"{X}.comparison._difference", result(_halved),
        "beside elements",
    ),
    Fault("modes paired with the next", f"{X}.modes_paired.paired", result(_shifted),
          "beside elements"),
    Fault("cross-checks that always hold", "cmverify.studies.crosscheck.Row.passed",
          result(lambda passed: True), "beside elements"),
)  # fmt: skip
