"""Homogeneous strain and flux by loads on all edges: a free square and a rotated rectangle.

What a surface treatment should get right before anything else: the exact field is linear, the
bulk of the lattice has it exactly, and all error comes from the edges and corners.

The order to expect: in a homogeneous field bonds of one direction stand for the body by its chords
with equally spaced lines. Against a smooth test function that is a trapezoidal rule, exact but for
corners (Δx²); what is left are forces at the edge that change sign from cell to cell. Their field
is as large as a cell's difference, O(Δx), and dies out within cells of the edge: in the L2 norm
Δx Δx^(1/2), order 1.5. How a turned edge cuts the cells differs with the lattice's place, by a
factor of two at 20 cells, so that one placement a spacing shows orders from 1.2 to 1.7; the mean
over several shows the method's own.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from cmverify.case import Array, Case, Check, Field, FieldSet, Measurement
from cmverify.cases.common import adapters, materials
from cmverify.cases.surfaces import bodies
from cmverify.cases.surfaces.bodies import Treatment
from cmverify.judge.norms import relative_l2

STRESS = (1.0, -0.4, 0.3)
GRADIENT = (1.0, -0.5)
CONDUCTIVITY = np.array([[5.0, 2.0], [2.0, 1.0]])  # Eq. 168
#: Rotated edges cut the cells at all depths; the sides do not fit a whole number of cells.
TURN = 0.4
# 1/x and 1/x² of the root of x³ = x + 1: multiples fill the unit square evenly (Roberts' R2).
_SPREAD = (0.7548776662466927, 0.5698402909980532)


@dataclass(frozen=True)
class Body:
    """A rectangle of width 1, turned by `angle`, and a factor on the load for tests.

    Errors are the root of the mean square over so many `placements` of the lattice.
    """

    height: float = 1.0
    angle: float = 0.0
    scale: float = 1.0
    placements: int = 1

    @property
    def region(self) -> Any:
        """The solver's region."""
        from solver import rectangle

        return rectangle(1.0, self.height, angle=self.angle)

    @property
    def phases(self) -> list[tuple[float, float] | None]:
        """Where the lattice's cells begin; points of a sequence that fills a cell evenly."""
        if self.placements == 1:
            return [None]
        return [(_SPREAD[0] * k % 1.0, _SPREAD[1] * k % 1.0) for k in range(1, self.placements + 1)]


SQUARE, TURNED = Body(), Body(0.8, TURN)
PLACED = Body(0.8, TURN, placements=4)


def strain(body: Body, treatment: Treatment, m: float, n: int) -> Measurement:
    """The fully anisotropic solid under a homogeneous stress on all edges."""
    from solver import ElasticTensor, Load, Scene, recovery

    voigt = materials.TENSORS["fully anisotropic"] / 100.0
    e11, e22, shear = np.linalg.solve(voigt, STRESS)
    slope = np.array([[e11, shear / 2], [shear / 2, e22]])

    def exact(x: Array, y: Array) -> Array:
        return np.stack([x, y], axis=-1) @ slope.T

    solution = Scene(
        region=body.region,
        spacing=1.0 / n,
        m=m,
        material=ElasticTensor(voigt),
        surface=treatment,
        supports=bodies.held((-0.25, 0.0), (0.25, 0.0), exact),
        loads=[Load.stress(tuple(body.scale * s for s in STRESS))],
    ).solve(tolerance=bodies.TOLERANCE)
    points, u = solution.points, exact(*solution.points.T)
    stress = bodies.symmetric(recovery.stress(solution, rule="family"))
    wanted = np.broadcast_to(STRESS, stress.shape)
    at_surface = {}
    if treatment == "extrapolated":
        nodes = solution.surface_points
        at_surface["surface"] = bodies.displacement_errors(
            nodes, solution.surface_displacement, exact(*nodes.T)
        )["displacement"]
    items = {
        f"u{i + 1}": Field(f"$u_{i + 1}$", "σL/C", solution.displacement[:, i], u[:, i])
        for i in (0, 1)
    }
    return Measurement(
        solution.statistics.unknowns,
        {
            **bodies.displacement_errors(points, solution.displacement, u),
            "stress": relative_l2(stress, wanted),
            **at_surface,
            "iterations": float(solution.statistics.iterations),
        },
        adapters.solver_seconds(solution.statistics),
        bodies.statistics_of(solution),
        FieldSet(points, items, spacing=1.0 / n) if n >= 50 else None,
    )


def heat(body: Body, treatment: Treatment, m: float, n: int) -> Measurement:
    """A homogeneous flux along the body: two edges carry it, the others are insulated.

    In the turned rectangle the flux runs along its sides; in the square too, whatever the
    conductor's axes.
    """
    from solver import ConductivityTensor, Load, Scene, Support, recovery

    flux = np.array([np.cos(body.angle), np.sin(body.angle)])
    slope = -np.linalg.solve(CONDUCTIVITY, flux)

    def exact(x: Array, y: Array) -> Array:
        return np.asarray(slope[0] * x + slope[1] * y)

    def ends(x: Array, y: Array) -> np.ndarray:
        # The edges at both ends of the flux, corners shared with the insulated sides.
        along = flux[0] * x + flux[1] * y
        across = flux[0] * y - flux[1] * x
        return np.abs(along) / 0.5 > np.abs(across) / (0.5 * body.height)

    def solve(phase: tuple[float, float] | None) -> Any:
        return Scene(
            region=body.region,
            spacing=1.0 / n,
            m=m,
            material=ConductivityTensor(CONDUCTIVITY),
            calibration="positive",
            surface=treatment,
            supports=[Support.where(bodies.nearest(0.0, 0.0), temperature=exact)],
            loads=[Load.flux(tuple(body.scale * flux), where=ends)],
            phase=phase,
        ).solve(tolerance=bodies.TOLERANCE)

    squares, seconds = {"temperature": 0.0, "flux": 0.0}, dict[str, float]()
    for phase in body.phases:
        solution = solve(phase)
        points, temperature = solution.points, exact(*solution.points.T)
        found = recovery.flux(solution, rule="consistent")
        wanted = np.broadcast_to(flux, found.shape)
        squares["temperature"] += relative_l2(solution.temperature, temperature) ** 2
        squares["flux"] += relative_l2(found, wanted) ** 2
        for stage, time in adapters.solver_seconds(solution.statistics).items():
            seconds[stage] = seconds.get(stage, 0.0) + time / len(body.phases)
    items = {"temperature": Field("$T$", "qL/K", solution.temperature, temperature)}
    return Measurement(
        solution.statistics.unknowns,
        {
            **{name: float(np.sqrt(s / len(body.phases))) for name, s in squares.items()},
            "iterations": float(solution.statistics.iterations),
        },
        seconds,
        bodies.statistics_of(solution),
        FieldSet(points, items, spacing=1.0 / n) if n >= 50 else None,
    )


_ELASTIC = {
    "surface": "relative L2 error of the displacement at the surface's nodes, rigid motion aside",
    "displacement": "relative L2 error of the displacement, rigid motion aside",
    "largest": "largest error of the displacement over the largest displacement",
    "stress": "relative L2 error of the stress (family sum), particles at edges included",
    "iterations": "Krylov iterations to a residual of 1e-11",
}
_CONDUCTIVE = {
    "temperature": "relative L2 error of the temperature",
    "flux": "relative L2 error of the flux (half sum), particles at edges included",
    "iterations": "Krylov iterations to a residual of 1e-11",
}


def _strained(
    name: str,
    title: str,
    body: Body,
    bounds: dict[int, float],
    order: float,
    others: dict[str, float],
) -> Case:
    return Case(
        name=name,
        title=title,
        section="Sect. 2.2.1 (surface correction)",
        tags=("surface", "elasticity"),
        shows=(
            "A body that tractions strain homogeneously shows nothing but what its edges and "
            "corners do: bonds that end at the surface leave a small error, stiffened or "
            "untreated families a large one."
        ),
        methods=bodies.methods(partial(strain, body)),
        checks=(
            bodies.converging("displacement", bounds, order),
            *(
                Check(
                    "bond/extrapolated",
                    quantity,
                    {20: bound},
                    source="exact field; measured with half as much again",
                )
                for quantity, bound in others.items()
            ),
        ),
        quantities=_ELASTIC,
        primary="displacement",
        featured="bond/extrapolated",
        length="L",
    )


def _heated(
    name: str,
    title: str,
    body: Body,
    checks: tuple[Check, ...],
) -> Case:
    return Case(
        name=name,
        title=title,
        section="Sect. 4.1 (surface correction)",
        tags=("surface", "conduction"),
        shows=(
            "Insulated edges turn no heat: a flux along a body with an oblique conductor stays "
            "homogeneous up to its sides."
        ),
        methods=bodies.methods(partial(heat, body), other=None, conductive=True),
        checks=checks,
        quantities=_CONDUCTIVE,
        primary="temperature",
        featured="bond/extrapolated",
        length="L",
    )


CASES = (
    _strained(
        "free-square",
        "Free square under tractions of a homogeneous stress",
        SQUARE,
        {20: 1.5e-3, 50: 3e-4, 100: 8e-5},
        1.5,
        {"stress": 3e-3, "surface": 6e-3},
    ),
    _strained(
        "free-turned-rectangle",
        "Free rectangle, turned in the lattice, under tractions of a homogeneous stress",
        TURNED,
        {20: 2.1e-3, 50: 5e-4, 100: 1.8e-4},
        1.4,
        {"stress": 3e-2},
    ),
    # Exact: all nodes between rows of cells see the same bonds; 8e-13 measured at 100 cells.
    _heated(
        "insulated-square",
        "Square with two insulated edges",
        SQUARE,
        (
            Check(
                "bond/extrapolated",
                "temperature",
                {20: 1e-11},
                source="rounding: bonds between two rows are alike up to an edge",
                exact=True,
            ),
        ),
    ),
    _heated(
        "insulated-turned-rectangle",
        "Rectangle, turned in the lattice, with two insulated edges",
        PLACED,
        # 1.5 from 30 to 100 cells, 1.6 to 70.
        (bodies.converging("temperature", {20: 3.6e-3, 50: 1.1e-3, 100: 4.1e-4}, 1.3, since=30),),
    ),
)
