"""Polar solids (Eqs. 177–181): patch tests, and the size effect of strips in shear and bending.

Bonds that resist the relative rotation of their ends make a micropolar solid with the Cosserat
modulus μ_c = C66 − C12. Strips of it are the stiffer the thinner they are beside the solid's own
length l = √(E/4μ), whatever the horizon, as long as that is small; without bending of bonds they
are not. Between walls that do not turn a strip in shear goes from μ (thick) to μ + μ_c (thin);
couple-stress elasticity, where rotations follow displacements, would let it become rigid.
"""

from __future__ import annotations

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
    OrderBand,
)
from cmverify.cases.common import adapters
from cmverify.faults.changes import result, scaled, swapped
from cmverify.faults.fault import Fault
from cmverify.judge.norms import relative_l2, worst

M = 3
#: Cells of the patch tests' sides, and of the length of a strip.
CELLS, LENGTH = 14, 8
MU, NU = 1.0, 0.2
#: Thickness over internal length, H/l.
RATIOS = (0.5, 2.0, 5.0, 10.0, 20.0, 50.0)
SEED = 177


def random_solid() -> tuple[Array, Array]:
    """Stiffness with C66 > C12 and bending stiffness, neither with an axis."""
    rng = np.random.default_rng(SEED)
    root, other = rng.normal(size=(3, 3)), rng.normal(size=(2, 2))
    return root @ root.T + np.diag([3.0, 3.0, 4.0]), other @ other.T + np.eye(2)


def quadratic(voigt: Array, rng: np.random.Generator) -> Array:
    """Coefficients (2, 3) of x², xy, y² in u1 and u2: a displacement in equilibrium."""
    units = np.eye(6).reshape(6, 2, 3)

    def strain(q: Array, x: float, y: float) -> Array:
        (a, b, c), (d, e, f) = q
        return np.array(
            [2 * a * x + b * y, e * x + 2 * f * y, b * x + 2 * c * y + 2 * d * x + e * y]
        )

    forces = []
    for q in units:
        along, across = voigt @ strain(q, 1, 0), voigt @ strain(q, 0, 1)
        forces.append([along[0] + across[2], along[2] + across[1]])
    free = np.linalg.svd(np.array(forces).T)[2][2:]
    return np.asarray((rng.normal(size=4) @ free).reshape(2, 3))


def patch(scale: float, n: int) -> Measurement:
    """Two states that bonds reproduce exactly, in boundary layers of exact values.

    `scale` is, for tests, a factor on the bending stiffness that is expected.
    """
    from solver import Load, PolarTensor, Scene, Support, recovery, rectangle

    voigt, bending = random_solid()
    rng = np.random.default_rng(SEED + 1)
    h = 1.0 / n
    q, slope, gradient = quadratic(voigt, rng), rng.normal(size=(2, 2)), rng.normal(size=2)
    mu_c, spin = voigt[2, 2] - voigt[0, 1], 0.5 * (slope[1, 0] - slope[0, 1])

    def linear(x: Array, y: Array) -> Array:
        return np.stack([x, y], axis=-1) @ slope.T

    def curved(x: Array, y: Array) -> Array:
        return linear(x, y) + np.stack([x * x, x * y, y * y], axis=-1) @ q.T

    def following(x: Any, y: Any) -> Array:
        return np.asarray(spin + (q[1, 0] - 0.5 * q[0, 1]) * x + (0.5 * q[1, 1] - q[0, 2]) * y)

    def turning(x: Any, y: Any) -> Array:
        return np.asarray(0.3 + gradient[0] * x + gradient[1] * y)

    # Where points turn against the displacement, forces and couples keep the balance.
    acting = [
        Load.body_force((-2 * mu_c * gradient[1], 2 * mu_c * gradient[0])),
        Load.couple(lambda x, y: -4 * mu_c * (spin - turning(x, y))),
    ]
    states: dict[str, Any] = {
        "constant curvature": (curved, following, [], [following(1, 0), following(0, 1)]),
        "turning points": (linear, turning, acting, [turning(1, 0), turning(0, 1)]),
    }
    found: dict[str, float] = {}
    for name, (displacement, rotation, loads, ahead) in states.items():
        errors = []
        surfaces: tuple[Any, ...] = "volume", "extrapolated"
        for surface in surfaces:
            solution = Scene(
                rectangle(1.0, 1.0),
                h,
                PolarTensor(voigt, bending),
                [Support.layer(M + 0.5, displacement=displacement, rotation=rotation)],
                loads,
                m=M,
                surface=surface,
            ).solve(tolerance=1e-13)
            x, y = solution.points.T
            errors += [
                relative_l2(solution.displacement, displacement(x, y)),
                relative_l2(solution.rotation, rotation(x, y)),
            ]
        wanted = scale * bending @ (np.array(ahead) - rotation(0, 0))
        inside = np.abs(solution.points).max(axis=1) < 0.5 - (M + 1.0) * h
        couples = recovery.couple_stress(solution)[inside]
        found[name] = worst(errors)
        found[f"{name}, couple stress"] = relative_l2(
            couples, np.broadcast_to(wanted, couples.shape)
        )
    return Measurement(
        solution.statistics.unknowns,
        found,
        statistics=adapters.solver_statistics(solution.statistics),
    )


def material(ratio: float) -> Any:
    """Isotropic solid with l = 1/ratio; ratio 0: without bending of bonds."""
    from solver import ElasticTensor, PolarTensor

    solid = ElasticTensor.isotropic(2 * MU * (1 + NU), NU)
    return PolarTensor(solid, 4 * MU / ratio**2 * np.eye(2)) if ratio else solid


def exact(ratio: float, scale: float = 1.0) -> Any:
    """The closed form of a strip of thickness one; `scale` for tests."""
    from references.analytic.cosserat import Strip
    from references.analytic.voigt import isotropic_voigt

    stiffness = scale * 4 * MU / ratio**2
    return Strip(isotropic_voigt(2 * MU * (1 + NU), NU), (stiffness, stiffness))


def sheared(ratio: float, n: int) -> tuple[float, Array, Any]:
    """τH/U between walls that do not turn, rotations and solution.

    On the ends u2 = 0, the rest free: an infinite strip's state, which is odd in reflections.
    """
    from solver import Scene, Support, recovery, rectangle

    length = LENGTH / n
    solution = Scene(
        rectangle(length, 1.0),
        1.0 / n,
        material(ratio),
        [
            Support.edge(lambda x, y: np.abs(x) > length / 2 - 1e-9, u2=0.0),
            Support.edge(lambda x, y: y > 0.5 - 1e-9, displacement=(1.0, 0.0), rotation=0.0),
            Support.edge(lambda x, y: y < -0.5 + 1e-9, displacement=(0.0, 0.0), rotation=0.0),
        ],
        m=M,
        surface="extrapolated",
    ).solve()
    return float(recovery.stress(solution)[:, 0, 1].mean()), solution.rotation, solution


def bent(ratio: float, n: int) -> tuple[float, Any]:
    """M/κ of a strip whose ends turn as sections of pure bending do, over Y H³/12, and solution."""
    from cmverify.cases.surfaces.bodies import nearest
    from solver import Scene, Support, recovery, rectangle

    length = LENGTH / n

    def end(side: float) -> Support:
        return Support.edge(
            lambda x, y: side * x > length / 2 - 1e-9,
            u1=lambda x, y: -side * length / 2 * y,
            rotation=side * length / 2,
        )

    solution = Scene(
        rectangle(length, 1.0),
        1.0 / n,
        material(ratio),
        [end(-1.0), end(1.0), Support.where(nearest(0.0, 0.0), u2=0.0)],
        m=M,
        surface="extrapolated",
    ).solve()
    moment = -recovery.stress(solution)[:, 0, 0] * solution.points[:, 1]
    if ratio:
        moment = moment + recovery.couple_stress(solution)[:, 0]
    return float(moment.sum() / n**2 / length * 12 / (2 * MU * (1 + NU))), solution


def strips(scale: float, n: int) -> Measurement:
    """Size effects over H/l, against Cosserat's; `scale` on the E that is expected, for tests."""
    forms = [exact(ratio, scale) for ratio in RATIOS]
    shear, turns, bending, seconds = [], [], [], 0.0
    for ratio, form in zip(RATIOS, forms, strict=True):
        stiffness, rotation, solution = sheared(ratio, n)
        shear.append(stiffness / MU)
        turns.append(relative_l2(rotation, form.rotation(solution.points[:, 1])))
        seconds += solution.statistics.setup_seconds + solution.statistics.solve_seconds
        stiffness, solution = bent(ratio, n)
        bending.append(stiffness)
        seconds += solution.statistics.setup_seconds + solution.statistics.solve_seconds
    wanted = [form.apparent_shear / MU for form in forms]
    thicker = [form.bending_ratio for form in forms]
    plain = sheared(0.0, n)[0] / MU, bent(0.0, n)[0]
    fine = np.geomspace(RATIOS[0], RATIOS[-1], 200)
    lines = [exact(ratio) for ratio in fine]
    at = np.array(RATIOS)
    # Bounded rotations lie off the scale for thin strips.
    bound = np.minimum([form.couple_stress_shear / MU for form in lines], 4.0)
    plots = (
        LinePlot(
            "Size effect in simple shear",
            "H/l",
            "τH/(U μ)",
            (
                Curve("bonds, Cosserat", at, np.array(shear),
                      np.array([f.apparent_shear / MU for f in lines]), fine),
                Curve("without bending of bonds", at, np.full(len(at), plain[0]),
                      np.ones(len(fine)), fine),
                Curve("couple stress (not of bonds; cut off at 4)", fine, bound, bound, fine),
            ),
        ),
        LinePlot(
            "Size effect in bending",
            "H/l",
            "12 M/(κ Y H³)",
            (
                Curve("bonds, Cosserat (and couple stress)", at, np.array(bending),
                      np.array([f.bending_ratio for f in lines]), fine),
                Curve("without bending of bonds", at, np.full(len(at), plain[1]),
                      np.ones(len(fine)), fine),
            ),
        ),
    )  # fmt: skip
    return Measurement(
        solution.statistics.unknowns,
        {
            "shear": worst(np.abs(np.array(shear) / wanted - 1)),
            "bending": worst(np.abs(np.array(bending) / thicker - 1)),
            "rotation": worst(turns[:3]),
            "shear effect": abs((shear[0] - shear[-1]) / (wanted[0] - wanted[-1]) - 1),
            "bending effect": abs((bending[0] - 1) / (thicker[0] - 1) - 1),
            "shear without": abs(plain[0] - 1),
            "bending without": abs(plain[1] - 1),
        },
        {"setup": seconds},
        adapters.solver_statistics(solution.statistics),
        lines=plots,
    )


def few(scale: float, n: int) -> Measurement:
    """Some of it: a thin, a middling strip and one without bending of bonds in shear, one bent."""
    form = exact(RATIOS[0], scale)
    shear = [(sheared(ratio, n), exact(ratio, scale)) for ratio in (RATIOS[0], 5.0)]
    errors = [abs(stiffness / MU - f.apparent_shear) for (stiffness, *_), f in shear]
    (_, rotation, solution), middling = shear[1]
    turned = relative_l2(rotation, middling.rotation(solution.points[:, 1]))
    bending, last = bent(RATIOS[0], n)
    plain = sheared(0.0, n)[0] / MU
    at, fine = np.array([RATIOS[0], 5.0]), np.geomspace(RATIOS[0], RATIOS[-1], 200)
    plot = LinePlot(
        "Size effect in simple shear",
        "H/l",
        "τH/(U μ)",
        (
            Curve("bonds, Cosserat", at, np.array([stiffness / MU for (stiffness, *_), _ in shear]),
                  np.array([exact(ratio).apparent_shear / MU for ratio in fine]), fine),
            Curve("without bending of bonds", at, np.full(2, plain), np.ones(len(fine)), fine),
        ),
    )  # fmt: skip
    return Measurement(
        last.statistics.unknowns,
        {
            "shear": worst(errors),
            "rotation": turned,
            "bending effect": abs((bending - 1) / (form.bending_ratio - 1) - 1),
            "shear without": abs(plain - 1),
        },
        adapters.solver_seconds(last.statistics),
        adapters.solver_statistics(last.statistics),
        lines=(plot,),
    )


@cache
def warm_up() -> None:
    """Compile the kernels."""
    sheared(1.0, 8)


QUADRATIC = OrderBand(1.5, 2.5)
SOURCE = "Cosserat's closed form; measured with half as much again, second order in the horizon"

CASES = (
    Case(
        name="polar-patch",
        title="Curvature and turning points of a polar solid, exactly",
        section="Sect. 5",
        equations=("Eq. 177", "Eq. 178"),
        tags=("polar", "elasticity"),
        shows=(
            "A random anisotropic polar solid reproduces homogeneous strain with constant "
            "curvature, and points that turn against the displacement, with their couple stress."
        ),
        methods=(
            Method("bond/lattice", "bond", partial(patch, 1.0), dict.fromkeys(Level, (CELLS,)),
                   warm_up),
        ),
        checks=tuple(
            Check(
                "bond/lattice",
                quantity,
                {CELLS: bound},
                source="rounding: sums over the lattice are exact for these states",
                exact=True,
            )
            for quantity, bound in (
                ("constant curvature", 1e-11),
                ("constant curvature, couple stress", 1e-10),
                ("turning points", 1e-11),
                ("turning points, couple stress", 1e-10),
            )
        ),
        quantities={
            "constant curvature": "displacement and rotation, worst surface",
            "constant curvature, couple stress": "couple stress over E ∇θ",
            "turning points": "the same where θ is not ½ curl u",
            "turning points, couple stress": "couple stress over E ∇θ",
        },
        primary="constant curvature",
        featured="bond/lattice",
        length="L",
        timed=False,
    ),
    Case(
        name="polar-strips",
        title="Size effect of strips of a polar solid in shear and bending",
        section="Sect. 5",
        equations=("Eq. 177", "Eq. 178", "Eq. 179", "Eq. 180", "Eq. 181"),
        tags=("polar", "elasticity"),
        shows=(
            "Strips stiffen as their thickness falls to the solid's internal length, by Cosserat's "
            "formulas with μ_c = C66 − C12, from 50 internal lengths to half of one; without "
            "bending of bonds they do not."
        ),
        methods=(
            Method("bond/lattice", "bond", partial(strips, 1.0),
                   {Level.STANDARD: (20, 40), Level.PAPER: (20, 40, 80)}, warm_up),
            Method("bond/few", "bond", partial(few, 1.0), dict.fromkeys(Level, (20,)), warm_up),
        ),
        checks=(
            *(
                Check("bond/few", quantity, {20: bound}, source="Cosserat's closed form (a Cauchy "
                      "solid: no size effect); measured with half as much again")
                for quantity, bound in (
                    ("shear", 5.3e-3),
                    ("rotation", 1.9e-2),
                    ("bending effect", 7e-5),
                    ("shear without", 4.6e-3),
                )
            ),
            Check("bond/lattice", "shear", {20: 1.75e-2, 40: 7.1e-3, 80: 2.3e-3},
                  source="Cosserat's closed form, worst of H/l; measured with half as much again "
                  "(at H/l = 50 the length is that of a cell or two)"),
            Check("bond/lattice", "bending", {20: 5.5e-3, 40: 1.4e-3, 80: 3.5e-4}, {},
                  QUADRATIC, SOURCE),
            Check("bond/lattice", "rotation", {20: 1.6e-2, 40: 4e-3, 80: 1.05e-3}, {}, QUADRATIC,
                  SOURCE),
            Check("bond/lattice", "shear effect", {20: 3.7e-2, 40: 1.5e-2, 80: 4.8e-3},
                  source="Cosserat's closed form; measured with half as much again"),
            Check("bond/lattice", "bending effect", {20: 7e-5, 40: 1.8e-5, 80: 4.5e-6}, {},
                  QUADRATIC, SOURCE),
            Check("bond/lattice", "shear without", {20: 4.5e-3, 40: 2.3e-3, 80: 1.2e-3},
                  order=OrderBand(0.7, 1.4),
                  source="a Cauchy solid has no size effect: what is left is a layer of a horizon "
                  "at walls that hold rotations; measured with half as much again"),
            Check("bond/lattice", "bending without", {20: 5.5e-3, 40: 1.4e-3, 80: 3.5e-4}, {},
                  QUADRATIC, SOURCE),
        ),
        quantities={
            "shear": "apparent shear modulus, worst H/l",
            "bending": "bending stiffness, worst H/l",
            "rotation": "rotations across the sheared strip, relative L2, H/l up to 5",
            "shear effect": "the gain from H/l = 50 to 0.5 over the closed form's",
            "bending effect": "the gain at H/l = 0.5 over the closed form's",
            "shear without": "gain without bending of bonds",
            "bending without": "gain without bending of bonds",
        },
        primary="shear",
        featured="bond/lattice",
        length="H",
    ),
)  # fmt: skip

S = "references.analytic.cosserat.Strip"
FAULTS = (
    Fault("k_b + 1 %", "solver.material.moduli.PolarModuli.stiffness",
          result(lambda k: k * np.array([[1.0], [1.0], [1.01]])), "polar"),
    Fault("k_b missing", "solver.material.moduli.PolarModuli.stiffness",
          result(lambda k: k * np.array([[1.0], [1.0], [0.0]])), "polar"),
    Fault("couple stress + 1 %", "solver.recovery.couple_stress", scaled(1.01), "polar"),
    Fault("couple stress of the other axis", "solver.recovery.couple_stress", result(swapped()),
          "polar"),
    Fault("apparent shear modulus + 5 %", f"{S}.apparent_shear", scaled(1.05), "closed forms"),
    Fault("bending of a polar strip + 1 %", f"{S}.bending_ratio", scaled(1.01), "closed forms"),
)  # fmt: skip
