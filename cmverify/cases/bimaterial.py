"""Bodies of two solids, beyond the paper: interfaces, a disc in a plate, bands of other thickness.

Bonds end at the interface, whose nodes both sides share. So a state that is homogeneous on both
sides and fulfils both is exact whatever the contrast; a disc of another solid in a uniform far
field has the uniform field of Eshelby, and what Goodier found around it.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from cmverify.case import Array, Case, Check, Field, FieldSet, Level, Measurement, Method, OrderBand
from cmverify.cases.common import adapters, warm
from cmverify.cases.surfaces.bodies import symmetric
from cmverify.exchange.statement import Pose, Statement, Target, laid_out
from cmverify.faults.changes import argument, result, scaled
from cmverify.faults.fault import Fault
from cmverify.judge.norms import relative_l2, worst

M = 3
CELLS = 10
CONTRASTS = (1e-3, 5.0)
RADIUS = 0.5
#: Plate and disc: Young's moduli and Poisson's ratios; the stress far away.
PLATE, DISC, FAR = (1.0, 0.2), (10.0, 0.25), (1.0, 0.3, 0.4)
#: Cells from the interface within which the disc's own stress is judged apart.
WITHIN = 0.3


def kinked(ratio: float, scale: float, surface: Any) -> Any:
    """Conduction across and along an interface, both solids anisotropic; its largest error."""
    from solver import ConductivityTensor, Inclusion, Scene, Support, rectangle

    outer = np.array([[2.0, 0.6], [0.6, 1.0]])
    inner = ratio * np.array([[1.0, -0.3], [-0.3, 2.0]])
    slope = 0.4
    left, right = ((1.0 - k[0, 1] * slope) / k[0, 0] for k in (outer, scale * inner))

    def field(x: Array, y: Array) -> Array:
        return np.asarray(np.where(x < 0, left, right) * x + slope * y)

    h = 1.0 / CELLS
    scene = Scene(
        rectangle(1.8, 2.2),
        h,
        ConductivityTensor(outer),
        supports=[Support.layer(8.0, temperature=field)],
        m=M,
        surface=surface,
        inclusions=[Inclusion(rectangle(4.0, 4.0, (2.0, 0.0)), ConductivityTensor(inner))],
    )
    solution = scene.solve(tolerance=1e-12)
    wanted = field(*solution.points.T)
    return solution, float(np.abs(solution.temperature - wanted).max() / np.abs(wanted).max())


def sheared(scale: float) -> float:
    """A stress across an interface that turns both solids differently: error of displacement."""
    from solver import ElasticTensor, Inclusion, Scene, Support, rectangle

    outer = ElasticTensor.isotropic(*PLATE)
    inner = ElasticTensor.orthotropic(30.0, 10.0, 8.0, 0.2).rotated(0.4)
    along = 0.3
    strains = []
    for voigt in (outer.voigt, scale * inner.voigt):
        across = np.array([1.0, 0.7]) - along * voigt[::2, 1]
        strains.append(np.linalg.solve(voigt[::2, ::2], across))

    def displacement(x: Array, y: Array) -> Array:
        stretch, shear = np.where((x < 0)[..., None], *strains).T
        return np.stack([stretch.T * x, along * y + shear.T * x], axis=-1)

    def rotation(x: Array, y: Array) -> Array:
        return np.asarray(0.5 * np.where(x < 0, strains[0][1], strains[1][1]))

    scene = Scene(
        rectangle(1.8, 2.2),
        1.0 / CELLS,
        outer,
        [Support.layer(8.0, displacement=displacement, rotation=rotation)],
        m=M,
        inclusions=[Inclusion(rectangle(4.0, 4.0, (2.0, 0.0)), inner)],
    )
    solution = scene.solve(tolerance=1e-12)
    wanted = displacement(*solution.points.T)
    return float(np.abs(solution.displacement - wanted).max() / np.abs(wanted).max())


def banded(scale: float, how: str) -> float:
    """A thinner band in series: largest error of the temperature."""
    from solver import ConductivityTensor, Inclusion, Scene, Support, rectangle

    thin, metal = 0.25, ConductivityTensor.isotropic(1.0)

    def field(x: Array, y: Array) -> Array:
        inside = x / (scale * thin)
        return np.asarray(
            np.where(np.abs(x) < 0.5, inside, np.sign(x) * (0.5 / (scale * thin) + np.abs(x) - 0.5))
        )

    band: dict[str, Any] = {"thickness": lambda x, y: np.where(np.abs(x) < 0.5, thin, 1.0)}
    if how == "inclusion":
        inclusion = Inclusion(rectangle(1.0, 2.0), metal, thickness=thin)
        band = {"thickness": 1.0, "inclusions": [inclusion]}
    held = Support.where(lambda x, y: np.abs(x) > 1.5 - M / CELLS, temperature=field)
    scene = Scene(rectangle(3.0, 0.6), 1 / CELLS, metal, [held], m=M, surface="none", **band)
    solution = scene.solve(tolerance=1e-13)
    return float(np.abs(solution.temperature - field(*solution.points.T)).max())


def patches(scale: float, n: int) -> Measurement:
    """Homogeneous states on both sides of an interface, and bands in series.

    `scale` is, for tests, a factor on what the other solid, or the band, is expected to be.
    """
    cases = [kinked(ratio, scale, "none") for ratio in CONTRASTS]
    bands = {f"band, {how}": banded(scale, how) for how in ("function", "inclusion")}
    return Measurement(
        cases[0][0].statistics.unknowns,
        {"interface": worst([error for _, error in cases]), "sheared": sheared(scale), **bands},
        statistics=adapters.solver_statistics(cases[0][0].statistics),
    )


def scene_of(exact: Any, n: int) -> Any:
    """A disc in a plate at spacing a/n, held in a layer as the closed form has it."""
    from solver import ElasticTensor, Inclusion, Scene, Support, disc, rectangle

    held = Support.layer(M + 0.5, displacement=exact.displacement, rotation=exact.rotation)
    return Scene(
        rectangle(2.0, 2.0),
        1.0 / n,
        ElasticTensor.isotropic(*PLATE),
        [held],
        m=M,
        inclusions=[Inclusion(disc(RADIUS), ElasticTensor.isotropic(*DISC))],
    )


def state(n: int) -> Statement:
    """Disc and plate, and what is judged of an answer: every particle."""
    from references.analytic.inclusion import ElasticInclusion

    exact = ElasticInclusion(PLATE, DISC, FAR, RADIUS)
    scene = scene_of(exact, n)
    points = laid_out(scene).lattice.places
    wanted = exact.displacement(*points.T)
    target = Target("displacement", "displacement", "m", wanted, points=points,
                    columns=("u1", "u2"))  # fmt: skip
    return Statement(scene, (target,))


def plate(scale: float, n: int) -> Measurement:
    """A stiff disc in a plate under a uniform stress far away."""
    from references.analytic.inclusion import ElasticInclusion
    from solver import recovery

    exact = ElasticInclusion(PLATE, (scale * DISC[0], DISC[1]), FAR, RADIUS)
    solution = scene_of(exact, n).solve()
    x, y = solution.points.T
    wanted, stress = exact.displacement(x, y), symmetric(recovery.stress(solution))
    there = exact.stress_at(x, y)
    # Families of the held layer are cut: nothing recovers a stress from them.
    whole = np.maximum(abs(x), abs(y)) < 1.0 - M / n
    core = np.hypot(x, y) < WITHIN
    error = np.abs(solution.displacement - wanted).max() / np.abs(wanted).max()
    items = {
        f"s{name}": Field(f"$\\sigma_{{{name}}}$", "Pa", stress[whole, k], there[whole, k])
        for k, name in enumerate(("11", "22", "12"))
    }
    return Measurement(
        solution.statistics.unknowns,
        {
            "displacement": relative_l2(solution.displacement, wanted),
            "largest": float(error),
            "stress in the disc": relative_l2(stress[core], there[core]),
        },
        adapters.solver_seconds(solution.statistics),
        adapters.solver_statistics(solution.statistics),
        FieldSet(solution.points[whole], items, spacing=1.0 / n),
    )


def fem(order: int, graded: bool, n: int) -> Measurement:
    """Disc and plate by scikit-fem, exact displacements on the plate's edge; at our particles.

    P2 takes elements of twice the size, so that unknowns compare; `graded` has chords of the
    interface a quarter of that.
    """
    from references.analytic.inclusion import ElasticInclusion
    from references.fem import general
    from solver import ElasticTensor

    exact = ElasticInclusion(PLATE, DISC, FAR, RADIUS)
    size = order / n
    body, meshing = adapters.timed_mesh(_meshed, size, chord=size / 4 if graded else size)
    inside = np.hypot(*body.points[body.triangles].mean(axis=1).T) < RADIUS
    tensors = np.stack([ElasticTensor.isotropic(*one).voigt for one in (PLATE, DISC)])

    def held(nodes: Array, edge: Any) -> Array:
        return np.asarray(np.where(edge[:, None], exact.displacement(*nodes.T), np.nan))

    seconds = {"meshing": meshing}
    with adapters.stopwatch(seconds, "solve"):
        solution = general.solve(
            body, tensors, inside.astype(np.int64), held, general.Acting(), order=order
        )
    target = state(n).targets[0]
    assert target.points is not None
    return Measurement(
        solution.values.size,
        {"displacement": target.error(solution.at(target.points))},
        seconds,
        adapters.fem_statistics(body, order),
    )


def _meshed(size: float, chord: float) -> Any:
    """The plate around the disc's polygon, whose corners lie on the circle."""
    from references.fem.polygons import polygons

    count = int(np.ceil(2 * np.pi * RADIUS / chord))
    angles = 2 * np.pi * np.arange(count) / count
    circle = RADIUS * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    return polygons([(square, [circle]), (circle, [])], size)


#: Spacings of the disc in a plate.
LADDER = {Level.QUICK: (20,), Level.STANDARD: (20, 40), Level.PAPER: (20, 40, 80)}

CASES = (
    Case(
        name="bimaterial-patch",
        title="Two solids on both sides of an interface, and bands of another thickness",
        section="Sect. 2, beyond the paper",
        equations=(),
        tags=("bimaterial", "conduction", "elasticity"),
        shows=(
            "A flux across and a gradient along an interface between two anisotropic conductors "
            "are exact at any contrast, so are stresses that turn both sides differently, and a "
            "thinner band in series: bonds end at interfaces, and no mean stands for two moduli."
        ),
        methods=(
            Method("bond/lattice", "bond", partial(patches, 1.0),
                   dict.fromkeys(Level, (CELLS,)), partial(warm.statics, "extrapolated")),
        ),
        checks=(
            *(
                Check("bond/lattice", quantity, {CELLS: 2e-6},
                      source="exact but for the ends of the interface, which fade by four a cell "
                      "in the support of eight")
                for quantity in ("interface", "sheared")
            ),
            *(
                Check("bond/lattice", f"band, {how}", {CELLS: 1e-10}, source="rounding", exact=True)
                for how in ("function", "inclusion")
            ),
        ),
        quantities={
            "interface": "largest error of the temperature over the largest, contrasts 1e-3 and 5",
            "sheared": "largest error of the displacement over the largest, one solid turned",
            "band, function": "a quarter of the thickness as a function of place: largest error",
            "band, inclusion": "the same as an inclusion",
        },
        primary="interface",
        featured="bond/lattice",
        length="L",
        timed=False,
    ),
    Case(
        name="bimaterial-disc",
        title="A disc ten times as stiff in a plate under a uniform stress",
        section="Sect. 2, beyond the paper",
        equations=(),
        tags=("bimaterial", "elasticity", "work-precision"),
        shows=(
            "Displacements are those of Goodier's closed form at second order, and the stress in "
            "the disc is uniform, as Eshelby's is."
        ),
        methods=(
            Method("bond/lattice", "bond", partial(plate, 1.0),
                   LADDER, partial(warm.statics, "extrapolated")),
        ),
        checks=(
            *(
                Check("bond/lattice", quantity, bounds, order=OrderBand(1.2, 2.6, fitted=True),
                      source="closed form; measured with half as much again, second order of bonds "
                      "and of the interface's chords")
                for quantity, bounds in (
                    ("displacement", {20: 3.4e-3, 40: 1.15e-3, 80: 3.4e-4}),
                    ("stress in the disc", {20: 9e-3, 40: 3e-3, 80: 1e-3}),
                )
            ),
            Check("bond/lattice", "largest", {20: 7e-3, 40: 2.8e-3, 80: 1.4e-3},
                  source="closed form; measured with half as much again"),
        ),
        quantities={
            "displacement": "relative L2 error of the displacement",
            "largest": "largest error of the displacement over the largest displacement",
            "stress in the disc": "relative L2 error of the stress within 0.6 of its radius",
        },
        primary="displacement",
        featured="bond/lattice",
        poses=(Pose("bond/lattice", state),),
        rivals=adapters.elements(fem, LADDER),
    ),
)  # fmt: skip

FAULTS = (
    Fault(
        "the other solid's bonds + 1 %",
        "solver.material.mixture.Mixture.of_bonds",
        scaled(1.01),
        "bimaterial",
    ),
    Fault(
        "rotations shared across interfaces",
        "solver.operators.surface_stiffness.SurfaceStiffness._sharing",
        lambda right: lambda self, moduli: right(self, _Untwisted(moduli)),
        "bimaterial",
    ),
    Fault(
        "interfaces shifted by 2 %",
        "solver.geometry.phases._fitted",
        argument(0, lambda shapes: [shapes[0], *(_grown(s) for s in shapes[1:])]),
        "bimaterial",
    ),
    Fault(
        "thickness of inclusions + 1 %",
        "solver.problem.thickness.of_phases",
        result(lambda thick: thick * np.where(np.arange(len(thick)) > 0, 1.01, 1.0)),
        "bimaterial",
    ),
    Fault(
        "thickness of a bond the same mean of all its cells",
        "solver.problem.thickness._shares",
        result(lambda found: (found[0], np.full(len(found[1]), 1.0 / len(found[1])))),
        "bimaterial",
    ),
    Fault(
        "stress around an inclusion + 1 %",
        "references.analytic.inclusion.ElasticInclusion.stress_at",
        scaled(1.01),
        "closed forms",
    ),
)


class _Untwisted:
    """Moduli whose physics knows no rotations."""

    def __init__(self, moduli: Any) -> None:
        from dataclasses import replace

        self.physics = replace(moduli.physics, turning=(False,) * len(moduli.physics.turning))


def _grown(shape: Any) -> Any:
    import shapely

    return shapely.affinity.scale(shape, 1.02, 1.02, origin=(0.0, 0.0))
