"""Discs and plates with a round hole loaded by tractions on their edges, three materials.

The disc carries the tractions of an equilibrium field whose stress is linear and quadratic in the
coordinates, all the way round. The plate is a square cut from the infinite plate with a hole
(Lekhnitskii), under the tractions that the rest of the infinite plate exerts: a closed form on a
finite body, and no traction on the hole.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from cmverify.case import Array, Case, Curve, Field, FieldSet, LinePlot, Measurement
from cmverify.cases.common import adapters, materials
from cmverify.cases.surfaces import bodies
from cmverify.cases.surfaces.bodies import Treatment
from cmverify.exchange.statement import L2_STRAINED, Pose, Statement, Target, laid_out
from cmverify.judge.norms import relative_l2

if TYPE_CHECKING:
    from solver import ElasticTensor

Shape = Literal["disc", "hole"]
#: Of the hole; the plate has width 1, so that 100 cells across are 20 cells per radius.
RADIUS = 0.2
#: Remote tension along axis 1 with a shear that no symmetry forbids.
REMOTE = (1.0, 0.0, 0.25)
SEED = 2022
ANGLES = np.radians(np.arange(0.0, 360.0, 5.0))

#: Moduli of order one. The orthotropic solid is bone with its axes turned by 30°.
SOLIDS = ("isotropic", "orthotropic", "anisotropic")


@cache
def stiffness(solid: str) -> Array:
    """Of a size near one; made when asked for, so that listing the cases stays quick."""
    if solid == "isotropic":
        return materials.isotropic(0.25)
    if solid == "orthotropic":
        return materials.turned(materials.TENSORS["bone"], 30.0) / 25.0
    return materials.TENSORS["fully anisotropic"] / 100.0


def material(solid: str) -> ElasticTensor:
    """The same by the solver's constructors, which tractions of the reference then judge."""
    from solver import ElasticTensor

    if solid == "isotropic":
        return ElasticTensor.isotropic(1.0, 0.25)
    if solid == "orthotropic":
        return ElasticTensor(materials.TENSORS["bone"] / 25.0).rotated(float(np.radians(30.0)))
    return ElasticTensor(stiffness(solid))


@dataclass(frozen=True)
class Problem:
    """A body, its solid and, for tests, a factor on the loads."""

    shape: Shape
    solid: str
    scale: float = 1.0

    @property
    def voigt(self) -> Array:
        """Stiffness, (3, 3)."""
        return stiffness(self.solid)

    @property
    def region(self) -> Any:
        """The solver's region, 1 across."""
        from solver import disc, rectangle

        return disc(0.5) if self.shape == "disc" else rectangle(1.0, 1.0) - disc(RADIUS)

    def displacement(self, x: Array, y: Array) -> Array:
        """Exact displacement, (..., 2)."""
        if self.shape == "disc":
            return _polynomial(self.solid).displacement(x, y)
        from references.analytic.hole import hole_displacement

        return hole_displacement(self.voigt, *_outside(x, y), RADIUS, RADIUS, REMOTE)

    def stress(self, x: Array, y: Array) -> Array:
        """Exact stress, (..., 3)."""
        if self.shape == "disc":
            return _polynomial(self.solid).stress(x, y)
        from references.analytic.hole import hole_stress

        return hole_stress(self.voigt, *_outside(x, y), RADIUS, RADIUS, REMOTE)


def _outside(x: Array, y: Array) -> tuple[Array, Array]:
    """Points moved onto the hole's edge where they lie within it, as chords' points do."""
    r = np.hypot(x, y)
    push = np.where(r < RADIUS, RADIUS / np.maximum(r, 1e-300), 1.0)
    return x * push, y * push


@cache
def _polynomial(solid: str) -> Any:
    """A random sum of all equilibrium displacements of degrees 1 to 3."""
    from references.analytic.elasticity import combine, equilibrium_polynomials

    generator = np.random.default_rng(SEED)
    fields = [f for degree in (1, 2, 3) for f in equilibrium_polynomials(stiffness(solid), degree)]
    # Each degree alike at the edge, half a unit away; the rotation among them is harmless.
    weights = generator.normal(size=len(fields)) * np.repeat([1.0, 2.0, 4.0], 4)
    return combine(fields, weights.tolist())


def scene_of(problem: Problem, treatment: Treatment, m: float, n: int) -> Any:
    """The body under the exact tractions."""
    from solver import Load, Scene

    def traction(x: Array, y: Array) -> Array:
        return problem.scale * problem.stress(x, y)

    def outer(x: Array, y: Array) -> np.ndarray:
        return np.hypot(x, y) > 0.45

    at = 0.25 if problem.shape == "disc" else 0.35
    return Scene(
        region=problem.region,
        spacing=1.0 / n,
        m=m,
        material=material(problem.solid),
        surface=treatment,
        supports=bodies.held((-at, 0.0), (at, 0.0), problem.displacement),
        loads=[Load.stress(traction, where=outer)],
    )


def state(problem: Problem, n: int) -> Statement:
    """The body, and what is judged of an answer: every particle."""
    scene = scene_of(problem, "extrapolated", 5, n)
    points = laid_out(scene).lattice.places
    u, stress = problem.displacement(*points.T), problem.stress(*points.T)
    of_u, of_stress = ("u1", "u2"), ("s11", "s22", "s12")
    return Statement(
        scene,
        (
            Target("displacement", "displacement", "σL/C", u, L2_STRAINED, points, columns=of_u),
            Target("stress", "stress", "σ", stress, points=points, columns=of_stress, needed=False),
        ),
    )


def loaded(problem: Problem, treatment: Treatment, m: float, n: int) -> Measurement:
    """Solve under the exact tractions and compare with the closed form everywhere."""
    from solver import recovery

    solution = scene_of(problem, treatment, m, n).solve(tolerance=bodies.TOLERANCE)
    points = solution.points
    u = problem.displacement(*points.T)
    stress = bodies.symmetric(recovery.stress(solution, rule="family"))
    wanted = problem.stress(*points.T)
    found = {
        **bodies.displacement_errors(points, solution.displacement, u),
        "stress": relative_l2(stress, wanted),
        "iterations": float(solution.statistics.iterations),
    }
    lines: tuple[LinePlot, ...] = ()
    if problem.shape == "hole":
        lines = _around_the_hole(problem, solution, stress, n, found)
    items = {
        f"u{i + 1}": Field(f"$u_{i + 1}$", "σL/C", solution.displacement[:, i], u[:, i])
        for i in (0, 1)
    }
    return Measurement(
        solution.statistics.unknowns,
        found,
        adapters.solver_seconds(solution.statistics),
        bodies.statistics_of(solution),
        FieldSet(points, items, spacing=1.0 / n) if n >= 50 else None,
        lines if n >= 50 else (),
    )


def fem(problem: Problem, order: int, graded: bool, n: int) -> Measurement:
    """The plate with a hole by scikit-fem, judged at the particles of spacing L/n.

    P2 takes elements of twice the size, so that unknowns compare; `graded` makes those at the hole
    a quarter of that, as one would who knows the solution.
    """
    from references.fem import elasticity

    size = order / n
    options = {"hole_size": size / 4} if graded else {}
    body, meshing = adapters.timed_mesh(_holed, size, **options)

    def pull(normal: tuple[float, float]) -> Callable[[Array, Array], Array]:
        def traction(x: Array, y: Array) -> Array:
            s11, s22, s12 = np.moveaxis(problem.scale * problem.stress(x, y), -1, 0)
            n1, n2 = normal
            return np.stack([s11 * n1 + s12 * n2, s12 * n1 + s22 * n2], axis=-1)

        return traction

    normals = {"left": (-1.0, 0.0), "right": (1.0, 0.0), "bottom": (0.0, -1.0), "top": (0.0, 1.0)}
    solution = elasticity.solve_elasticity(
        body, problem.voigt, tractions={side: pull(n) for side, n in normals.items()}, order=order
    )
    target = state(problem, n).targets[0]
    assert target.points is not None
    return Measurement(
        solution.unknowns,
        {"displacement": target.error(solution.at(target.points))},
        adapters.fem_seconds(meshing, solution.seconds),
        adapters.fem_statistics(body, order),
    )


def _holed(size: float, hole_size: float | None = None) -> Any:
    from references.fem import mesh

    return mesh.rectangle(1.0, 1.0, size, [(0.0, 0.0, RADIUS)], hole_size=hole_size)


def _around_the_hole(
    problem: Problem, solution: Any, stress: Array, n: int, found: dict[str, float]
) -> tuple[LinePlot, ...]:
    """Displacement and hoop stress at the hole's edge, fitted there from the particles around."""
    edge = RADIUS * np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=-1)
    spacing = 1.0 / n
    u = bodies.at_points(solution.points, solution.displacement, edge, spacing)
    at_edge = bodies.at_points(solution.points, stress, edge, spacing)
    exact = problem.displacement(*edge.T)
    hoop = hoop_stress(at_edge, ANGLES)
    wanted = hoop_stress(problem.stress(*edge.T), ANGLES)
    found["edge displacement"] = bodies.displacement_errors(edge, u, exact)["displacement"]
    found["hoop stress"] = relative_l2(hoop, wanted)
    found["peak stress"] = float(abs(hoop.max() / wanted.max() - 1.0))
    if len(solution.surface_points):
        found["hoop strain"] = _hoop_strain(problem, solution, edge)
    fine = np.radians(np.arange(0.0, 360.1, 1.0))
    ring = RADIUS * np.stack([np.cos(fine), np.sin(fine)])
    curve = Curve(
        "hoop stress",
        np.degrees(ANGLES),
        hoop,
        hoop_stress(problem.stress(*ring), fine),
        np.degrees(fine),
    )
    return (
        LinePlot(
            "Hoop stress at the edge of the hole",
            "polar angle (degrees)",
            "hoop stress over remote tension",
            (curve,),
            over_methods=True,
        ),
    )


def _hoop_strain(problem: Problem, solution: Any, edge: Array) -> float:
    """Relative L2 error of the strain along the hole's edge."""
    from solver import recovery

    along = np.stack([-edge[:, 1], edge[:, 0]], axis=-1) / RADIUS
    found = np.einsum("ki,kij,kj->k", along, recovery.edge_strain(solution, edge), along)
    strain = problem.stress(*edge.T) @ np.linalg.inv(problem.voigt)
    t1, t2 = along.T
    wanted = strain[:, 0] * t1**2 + strain[:, 1] * t2**2 + strain[:, 2] * t1 * t2
    return relative_l2(found, wanted)


def hoop_stress(stress: Array, angle: Array) -> Array:
    """Component along the circle of a stress (..., 3)."""
    c, s = np.cos(angle), np.sin(angle)
    hoop: Array = stress[:, 0] * s**2 + stress[:, 1] * c**2 - 2 * stress[:, 2] * s * c
    return hoop


_QUANTITIES = {
    "displacement": "relative L2 error of the displacement, rigid motion aside",
    "largest": "largest error of the displacement over the largest displacement",
    "stress": "relative L2 error of the stress (family sum), particles at edges included",
    "iterations": "Krylov iterations to a residual of 1e-11",
}
_EDGE = {
    "edge displacement": "relative L2 error of the displacement of the hole's edge",
    "hoop stress": "relative L2 error of the hoop stress at the hole's edge",
    "peak stress": "relative error of the largest hoop stress at the hole's edge",
    "hoop strain": "relative L2 error of the strain along the hole's edge (`edge_strain`)",
}


#: At 20, 50 and 100 cells across, and the least order. At 20 cells the isotropic hole's is what it
#: measures (2.23e-2) with a little room: bonds whose chord leaves the body are cut, and the hole of
#: four cells' radius loses many; from 50 cells on that is no longer seen.
BOUNDS: dict[tuple[Shape, str], tuple[dict[int, float], float]] = {
    ("disc", "isotropic"): ({20: 2.3e-2, 50: 3.5e-3, 100: 1e-3}, 1.5),
    ("disc", "orthotropic"): ({20: 2.4e-2, 50: 4.1e-3, 100: 1.2e-3}, 1.5),
    ("disc", "anisotropic"): ({20: 2.5e-2, 50: 4e-3, 100: 1.1e-3}, 1.5),
    ("hole", "isotropic"): ({20: 2.4e-2, 50: 3.5e-3, 100: 6e-4}, 1.5),
    ("hole", "orthotropic"): ({20: 6e-2, 50: 6e-3, 100: 2.6e-3}, 1.5),
    ("hole", "anisotropic"): ({20: 2.2e-2, 50: 6.1e-3, 100: 8e-4}, 1.5),
}

#: Of the strain along the hole's edge, the anisotropic solid's with half as much again: first
#: order, by what a cell makes of it at the edge, or better.
STRAINS = {20: 0.24, 50: 0.077, 100: 0.032}


def _case(shape: Shape, solid: str) -> Case:
    what = {"disc": "Disc", "hole": "Square plate with a round hole"}[shape]
    shows = {
        "disc": (
            "Tractions that vary along a curved edge, which cuts the lattice at all angles, give "
            "the displacements of an equilibrium field up to the edge."
        ),
        "hole": (
            "A free hole concentrates stress as Lekhnitskii's closed form has it; what the "
            "lattice misses at the edge falls with the spacing."
        ),
    }
    return Case(
        name=f"{shape}-tractions-{solid}",
        title=f"{what} under tractions, {solid}",
        section="Sect. 2.2.1 (surface correction)",
        tags=(
            "surface",
            "elasticity",
            *(("hole",) if shape == "hole" else ()),
            *(("work-precision",) if (shape, solid) == ("hole", "anisotropic") else ()),
        ),
        shows=shows[shape],
        methods=bodies.methods(
            partial(loaded, Problem(shape, solid)), other=3 if solid == "anisotropic" else None
        ),
        checks=(
            bodies.converging("displacement", *BOUNDS[shape, solid]),
            *((bodies.converging("hoop strain", STRAINS, 1.0),) if shape == "hole" else ()),
        ),
        quantities=_QUANTITIES | (_EDGE if shape == "hole" else {}),
        primary="displacement",
        featured="bond/extrapolated",
        length="L",
        poses=(Pose("bond/extrapolated", partial(state, Problem(shape, solid))),),
        rivals=adapters.elements(partial(fem, Problem(shape, solid)), bodies.LADDER)
        if shape == "hole"
        else (),
    )


CASES = tuple(_case(shape, solid) for shape in ("disc", "hole") for solid in SOLIDS)
