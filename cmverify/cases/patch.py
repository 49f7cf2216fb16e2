"""Elastic patch test: quadratic displacement fields in equilibrium, for tensors of every sign.

Displacement and rotation of a random quadratic equilibrium field are prescribed in a layer as
thick as a family around a square; the lattice has to find the field inside. It can be exact,
because the calibrated lattice gives every constant strain its exact energy and a linear strain
its exact balance of forces. The sign of C66 - C12 is that of the mean shear modulus of the bonds:
positive, zero (no rotations at all) or negative (an indefinite matrix), and each is tried.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from cmverify.case import Array, Case, Check, Level, Measurement, Method
from cmverify.cases.common import adapters
from cmverify.exchange.statement import Pose, Statement, Target, free_particles
from cmverify.judge.norms import relative_l2, worst

SIGNS = ("positive", "zero", "negative")
M = 3
TENSORS = 6  # admissible ones tried of each sign
ATTEMPTS = 200
SEED = 2022
LADDER = {Level.QUICK: (20,), Level.STANDARD: (20, 40), Level.PAPER: (20, 40)}


@dataclass(frozen=True)
class Patch:
    """The sign of C66 - C12, and how bonds weigh in by their length (Λ of Eq. 56).

    Tests put a factor on the stiffness C11 that the solver is given.
    """

    sign: str
    distortion: float = 1.0
    influence: str = "constant"


def random_tensors(sign: str) -> Iterator[Array]:
    """Random positive-definite plane tensors, (3, 3) in Voigt's order, of one sign of C66 - C12.

    Zero means Cauchy's symmetry exactly: C66 = C12. Endless, from a fixed seed.
    """
    generator = np.random.default_rng([SEED, SIGNS.index(sign)])
    while True:
        factor = generator.normal(size=(3, 3))
        voigt = factor @ factor.T + 0.5 * np.eye(3)
        if sign == "zero":
            voigt[2, 2] = voigt[0, 1]
        if np.linalg.eigvalsh(voigt)[0] < 0.05:
            continue
        mean = voigt[2, 2] - voigt[0, 1]
        if sign == "zero" or np.sign(mean) == (1 if sign == "positive" else -1):
            yield voigt / np.linalg.norm(voigt)


def problems(sign: str) -> Iterator[tuple[Array, Any]]:
    """Tensors of one sign, each with a random quadratic field in equilibrium."""
    from references.analytic.elasticity import combine, equilibrium_polynomials

    generator = np.random.default_rng(SEED)
    for _, voigt in zip(range(ATTEMPTS), random_tensors(sign), strict=False):
        fields = [f for degree in (1, 2) for f in equilibrium_polynomials(voigt, degree)]
        yield voigt, combine(fields, generator.normal(size=len(fields)).tolist())


def scene_of(
    voigt: Array, exact: Any, n: int, distortion: float = 1.0, influence: str = "constant"
) -> Any:
    """The square that a field of one tensor holds at its edges."""
    from solver import ElasticTensor, Scene, Support, UniformShear, rectangle

    # With Cauchy's symmetry the two-harmonic k_t varies as cos 4 psi about zero and leaves the
    # rotation block singular; the uniform-shear law has no shear bonds then.
    cauchy = voigt[2, 2] == voigt[0, 1]
    given = voigt.copy()
    given[0, 0] *= distortion
    return Scene(
        region=rectangle(1.0, 1.0),
        spacing=1.0 / n,
        m=M,
        material=ElasticTensor(given),
        calibration="lattice",
        law=UniformShear() if cauchy else None,
        influence=influence,
        supports=[
            Support.layer(cells=M + 0.5, displacement=exact.displacement, rotation=exact.rotation)
        ],
    )


def error(voigt: Array, exact: Any, n: int, problem: Patch) -> dict:
    """Relative L2 errors of displacement and rotation of one random field, and the solution."""
    scene = scene_of(voigt, exact, n, problem.distortion, problem.influence)
    solution = scene.solve(tolerance=1e-13)
    free = ~solution.prescribed
    x, y = solution.points[free].T
    found = {"displacement": relative_l2(solution.displacement[free], exact.displacement(x, y))}
    if not np.isnan(solution.rotation).all():
        found["rotation"] = relative_l2(solution.rotation[free], exact.rotation(x, y))
    return {"errors": found, "statistics": solution.statistics, "solution": solution}


def recovered(solution: Any, exact: Any, n: int) -> dict[str, float]:
    """Errors of what is read from the solution where families, and their neighbours', are whole.

    Fits that are symmetric about a particle are exact for quadratics, and so are means of the
    forces on both sides of a plane.
    """
    from solver import recovery

    inner = np.abs(solution.points).max(axis=1) < 0.5 - (M + 1.5) / n
    x, y = solution.points[inner].T
    gradient = recovery.displacement_gradient(solution)[inner]

    def slopes(x: Array, y: Array) -> Array:
        """∂u_i/∂x_j, (n, 2, 2): central differences of any step are exact for quadratics."""
        steps = ((0.5, 0.0), (0.0, 0.5))
        found = [
            exact.displacement(x + dx, y + dy) - exact.displacement(x - dx, y - dy)
            for dx, dy in steps
        ]
        return np.stack(found, axis=-1)

    # Where no surface is in the window of the cubic that is fitted.
    places = np.array([[0.07, 0.1], [-0.12, 0.03]])
    there = slopes(*places.T)
    strain = 0.5 * (there + there.swapaxes(1, 2))
    s11, s22, s12 = np.moveaxis(exact.stress(x, y), -1, 0)
    stress = np.stack([s11, s12, s12, s22], axis=-1)
    return {
        "gradient": relative_l2(gradient.reshape(-1), slopes(x, y).reshape(-1)),
        "strain at places": relative_l2(
            recovery.edge_strain(solution, places).reshape(-1), strain.reshape(-1)
        ),
        "macrorotation": relative_l2(recovery.macrorotation(solution)[inner], exact.rotation(x, y)),
        "stress": relative_l2(recovery.stress(solution)[inner].reshape(-1, 4), stress),
    }


def patch(problem: Patch, n: int) -> Measurement:
    """The worst error over several admissible random tensors of one sign.

    Tensors that the solver refuses as inadmissible or not representable are counted, not solved.

    Raises
    ------
    RuntimeError
        If too few tensors of that sign are accepted.
    """
    from solver import CalibrationError, InadmissibleMaterialError

    largest: dict[str, float] = {}
    seconds: dict[str, float] = {}
    solved, refused, unknowns, methods = 0, 0, 0, set()
    for voigt, exact in problems(problem.sign):
        try:
            found = error(voigt, exact, n, problem)
        except (InadmissibleMaterialError, CalibrationError):
            refused += 1
            continue
        statistics = found["statistics"]
        if not solved:
            largest |= recovered(found["solution"], exact, n)
        for name, value in found["errors"].items():
            largest[name] = worst((largest.get(name, 0.0), value))
        for stage, spent in adapters.solver_seconds(statistics).items():
            seconds[stage] = seconds.get(stage, 0.0) + spent
        unknowns = max(unknowns, statistics.unknowns)
        methods.add(statistics.method)
        solved += 1
        if solved == TENSORS:
            break
    else:
        raise RuntimeError(
            f"of {ATTEMPTS} tensors with C66 - C12 {problem.sign} only {solved} "
            f"were accepted, {TENSORS} were wanted"
        )
    return Measurement(
        unknowns,
        largest,
        seconds,
        {"tensors": solved, "refused": refused, "method": ", ".join(sorted(methods))},
    )


def state(sign: str, n: int) -> Statement:
    """The first tensor of one sign that the lattice can be, and its field."""
    from solver import CalibrationError, InadmissibleMaterialError

    for voigt, exact in problems(sign):
        scene = scene_of(voigt, exact, n)
        try:
            points = free_particles(scene)
        except (InadmissibleMaterialError, CalibrationError):
            continue
        found = exact.displacement(*points.T), exact.rotation(*points.T)
        targets = (
            Target("displacement", "displacement", "L", found[0], points=points, columns=U),
            Target("rotation", "rotation", "1", found[1], points=points, needed=False),
        )
        # Without shear bonds rotations are nobody's unknowns.
        return Statement(scene, targets[:1] if sign == "zero" else targets)
    raise RuntimeError(f"no tensor with C66 - C12 {sign} was accepted")


U = ("u1", "u2")
QUANTITIES = {
    "displacement": "worst relative L2 error of the displacement over the tensors",
    "rotation": "worst relative L2 error of the rotation over the tensors",
    "gradient": "relative L2 error of the recovered displacement gradient, first tensor",
    "strain at places": "the same of the strain by the cubic that `edge_strain` fits, in the body",
    "macrorotation": "relative L2 error of its skew half (Eq. 85)",
    "stress": "relative L2 error of the stress by Saint-Venant and Cauchy's planes (Eq. 83)",
}
SOURCE = "rounding: constant and linear strains are exact on the lattice's own sums"
NAMES = {"positive": "C66 > C12", "zero": "C66 = C12", "negative": "C66 < C12"}
#: Long bonds weigh less: Λ = 1 − |ξ|/δ.
CONICAL = "bond/lattice C66 > C12, conical influence"

CASES = (
    Case(
        name="elastic-patch",
        title="Elastic patch test with random tensors of every sign of C₆₆ − C₁₂",
        section="Sect. 2.2",
        equations=("Eq. 56, Λ constant and conical", "Eqs. 65–70, on the lattice's own sums"),
        tags=("patch", "elasticity"),
        shows=(
            "Given displacement and rotation in the layer, any quadratic field in equilibrium is "
            "reproduced to rounding, whether the shear bonds are stiff, absent or of negative "
            "stiffness."
        ),
        methods=(
            *(
                Method(f"bond/lattice {NAMES[s]}", "bond", partial(patch, Patch(s)), LADDER)
                for s in SIGNS
            ),
            Method(
                CONICAL,
                "bond",
                partial(patch, Patch("positive", influence="conical")),
                {level: ladder[:1] for level, ladder in LADDER.items()},
            ),
        ),
        checks=tuple(
            Check(name, quantity, {20: 1e-11}, source=SOURCE, exact=True)
            for name in (*(f"bond/lattice {NAMES[s]}" for s in SIGNS), CONICAL)
            for quantity in QUANTITIES
            # No shear bonds, no rotations.
            if (name, quantity) != (f"bond/lattice {NAMES['zero']}", "rotation")
        ),
        quantities=QUANTITIES,
        primary="displacement",
        featured="bond/lattice C66 > C12",
        length="L",
        timed=False,
        poses=tuple(Pose(f"bond/lattice {NAMES[s]}", partial(state, s), NAMES[s]) for s in SIGNS),
    ),
)
