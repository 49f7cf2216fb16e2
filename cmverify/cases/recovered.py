"""Stress, energy, gradient, rotation, flux, damage: what is read from a solution that is exact.

Linear fields prescribed in a layer are exact inside, and there every recovered field is known:
σ = C ε by both rules, W = ½ ε·C·ε, the gradient and its skew half, q = −D ∇T. Body forces and
couples that hold a quadratic displacement or a rotation of the particles alone close the balance
of forces and moments.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cmverify.case import Array, Case, Check, Level, Measurement, Method
from cmverify.cases.common import adapters, bond_energies, materials, warm
from cmverify.cases.hard import bodies
from cmverify.judge.norms import relative_l2

CELLS, M = 16, 3
LADDER = dict.fromkeys(Level, (CELLS,))
GRADIENT = np.array([[0.8, -0.5], [0.9, -0.3]])  # of the displacement: strain and rotation
SLOPE = np.array([1.0, -0.5])  # of the temperature
CONDUCTIVITY = np.array([[5.0, 2.0], [2.0, 1.0]])  # Eq. 168
SEED = 2022


class Linear:
    """u = G x with the rotation that belongs to it."""

    def displacement(self, x: Array, y: Array) -> Array:
        """(..., 2)."""
        return np.asarray(np.stack([x, y], axis=-1) @ GRADIENT.T)

    def rotation(self, x: Array, y: Array) -> Array:
        """Half the curl."""
        return np.full(np.shape(x), 0.5 * (GRADIENT[1, 0] - GRADIENT[0, 1]))


def inside(solution: Any) -> np.ndarray:
    """Particles whose families, and those of their neighbours, are whole."""
    n = 1.0 / solution.spacing
    return np.asarray(np.abs(solution.points).max(axis=1) < 0.5 - (M + 1.5) / n)


def elastic(n: int) -> Measurement:
    """Everything that is recovered from a homogeneous strain with a rotation."""
    from solver import recovery

    voigt = materials.TENSORS["fully anisotropic"] / 100.0
    solution = bodies.solve(voigt, Linear(), n, M)
    whole = inside(solution)
    strain = np.array([GRADIENT[0, 0], GRADIENT[1, 1], GRADIENT[0, 1] + GRADIENT[1, 0]])
    s11, s22, s12 = voigt @ strain
    wanted = np.broadcast_to([[s11, s12], [s12, s22]], (whole.sum(), 2, 2))
    gradient = np.broadcast_to(GRADIENT, (whole.sum(), 2, 2))
    spin = np.full(whole.sum(), 0.5 * (GRADIENT[1, 0] - GRADIENT[0, 1]))
    energy = np.full(whole.sum(), 0.5 * strain @ voigt @ strain)

    # What fits cubics is exact in the body too, where no surface is in its window.
    places = [(0.07, 0.1), (-0.12, 0.03)]
    symmetric = np.broadcast_to(0.5 * (GRADIENT + GRADIENT.T), (len(places), 2, 2))
    cells = solution.cells

    def error(found: Array, exact: Array) -> float:
        return relative_l2(found[whole].reshape(-1), exact.reshape(-1))

    return Measurement(
        solution.statistics.unknowns,
        {
            "stress by planes": error(recovery.stress(solution), wanted),
            "stress by families": error(recovery.stress(solution, rule="family"), wanted),
            "energy": error(recovery.strain_energy_density(solution), energy),
            "gradient": error(recovery.displacement_gradient(solution), gradient),
            "macrorotation": error(recovery.macrorotation(solution), spin),
            "rotation": error(solution.rotation, spin),
            "strain at places": relative_l2(
                recovery.edge_strain(solution, places).reshape(-1), symmetric.reshape(-1)
            ),
            "corners of cells": relative_l2(
                cells.at_corners(solution.displacement).reshape(-1),
                (cells.corners @ GRADIENT.T).reshape(-1),
            ),
        },
        statistics=adapters.solver_statistics(solution.statistics),
    )


def loaded(n: int) -> Measurement:
    """A quadratic displacement held by its body force, and particles turned by a couple."""
    from references.analytic.elasticity import PolynomialDisplacement
    from solver import ElasticTensor, Family, Load, Scene, Support, rectangle
    from solver.material import calibrate

    voigt = materials.TENSORS["fully anisotropic"] / 100.0
    coefficients = np.zeros((2, 3, 3))
    coefficients[:, [2, 1, 0], [0, 1, 2]] = np.random.default_rng(SEED).normal(size=(2, 3))
    quadratic = PolynomialDisplacement(voigt, coefficients)
    # A strain that varies needs no couple: stresses by bonds are symmetric on the average.
    held = bodies.solve(
        voigt, quadratic, n, M, loads=[Load.body_force(quadratic.body_force)]
    )  # fmt: skip
    found = bodies.errors(held, quadratic)
    material = ElasticTensor(voigt)
    moduli = calibrate(Family(M), material, "lattice")
    # Particles turned by φ in a body at rest store ½ E φ² a volume: the couple is E φ.
    resistance = bond_energies.energy_of_strain(Family(M), moduli)[3, 3]  # type: ignore[arg-type]
    angle = 0.3
    solution = Scene(
        region=rectangle(1.0, 1.0),
        spacing=1.0 / n,
        m=M,
        material=material,
        loads=[Load.couple(angle * resistance)],
        supports=[Support.layer(cells=M + 0.5, displacement=(0.0, 0.0), rotation=angle)],
    ).solve(tolerance=1e-12)
    return Measurement(
        held.statistics.unknowns,
        {
            "displacement": found["displacement"],
            "turned by a couple": relative_l2(
                solution.rotation, np.full(len(solution.points), angle)
            ),
        },
        statistics=adapters.solver_statistics(held.statistics),
    )


def conductive(n: int) -> Measurement:
    """Flux and potential of a homogeneous gradient."""
    from solver import ConductivityTensor, Scene, Support, recovery, rectangle

    def exact(x: Array, y: Array) -> Array:
        return np.asarray(SLOPE[0] * x + SLOPE[1] * y)

    solution = Scene(
        region=rectangle(1.0, 1.0),
        spacing=1.0 / n,
        m=M,
        material=ConductivityTensor(CONDUCTIVITY),
        supports=[Support.layer(cells=M + 0.5, temperature=exact)],
    ).solve(tolerance=1e-13)
    whole = inside(solution)
    flux = np.broadcast_to(-CONDUCTIVITY @ SLOPE, (whole.sum(), 2))
    energy = np.full(whole.sum(), 0.5 * SLOPE @ CONDUCTIVITY @ SLOPE)
    return Measurement(
        solution.statistics.unknowns,
        {
            "flux": relative_l2(recovery.flux(solution)[whole], flux),
            "flux by Eq. 170": relative_l2(recovery.flux(solution, rule="hotter")[whole], flux),
            "energy": relative_l2(recovery.strain_energy_density(solution)[whole], energy),
            "temperature": relative_l2(solution.temperature, exact(*solution.points.T)),
        },
        statistics=adapters.solver_statistics(solution.statistics),
    )


def cut(n: int) -> Measurement:
    """Damage beside a crack that is longer than a family, counted from the bonds' heights."""
    from solver import Crack, ElasticTensor, Family, Scene, Support, recovery, rectangle

    solution = Scene(
        region=rectangle(1.0, 1.0),
        spacing=1.0 / n,
        m=M,
        material=ElasticTensor.isotropic(1.0, 0.2),
        surface="none",
        cracks=[Crack((-0.4, 0.0), (0.4, 0.0))],
        supports=[Support.layer(cells=1.5, displacement=(0.0, 0.0), rotation=0.0)],
    ).solve()
    damage = recovery.damage(solution)
    x, y = solution.points.T
    family = Family(M)
    height = np.abs(y) * n + 0.5  # rows from the crack, from one
    near = (np.abs(x) < 0.75 / n) & (np.abs(y) < 0.3)
    wanted = (
        np.array([family.fraction[family.offsets[:, 1] >= h].sum() for h in height[near]])
        / family.fraction.sum()
    )
    # Corners in a row that both cells above and both below are parted from: one a face.
    inner = 2 * int(np.floor(0.4 * n - 0.5)) + 1
    corners = len(solution.cells.corners) - ((n + 1) ** 2 + inner)
    beyond = damage[(np.abs(x) < 0.3) & (height > M + 1)]
    return Measurement(
        solution.statistics.unknowns,
        {
            "damage": relative_l2(damage[near], wanted),
            "damage beyond a family": float(np.abs(beyond).max()),
            "corners along a crack": float(abs(corners)),
        },
    )


QUANTITIES = {
    "stress by planes": "stress by Saint-Venant and Cauchy's planes (Eq. 83)",
    "stress by families": "stress by the virial of each family",
    "energy": "macroelastic energy density (Eq. 11), macro-potential (Eq. 115)",
    "gradient": "gradient of the displacement by least squares",
    "macrorotation": "its skew half (Eq. 85)",
    "rotation": "rotation of the particles",
    "displacement": "quadratic displacement under the body force that it needs",
    "turned by a couple": "rotation of particles that a body couple turns in a body at rest",
    "flux": "flux, consistent half sum",
    "flux by Eq. 170": "flux over the hotter neighbours",
    "temperature": "temperature",
    "strain at places": "strain by the cubic that `edge_strain` fits, at places in the body",
    "corners of cells": "displacement carried to the corners of the particles' cells",
    "corners along a crack": "corners of cells that a crack parts, too many or too few",
    "damage": "share of cut bonds beside a crack (Eq. 105), counted by heights",
    "damage beyond a family": "damage of particles that no cut bond reaches",
}
METHODS = {
    "bond/elastic": (
        elastic,
        (
            "stress by planes",
            "stress by families",
            "energy",
            "gradient",
            "macrorotation",
            "rotation",
            "strain at places",
            "corners of cells",
        ),
    ),
    "bond/loaded": (loaded, ("displacement", "turned by a couple")),
    "bond/conductive": (conductive, ("flux", "flux by Eq. 170", "energy", "temperature")),
    "bond/cut": (cut, ("damage", "damage beyond a family", "corners along a crack")),
}

CASES = (
    Case(
        name="recovered",
        title="Fields recovered from exact solutions, and loads that hold them",
        section="Sects. 2.2.2 and 4.3",
        equations=("Eq. 11", "Eq. 83", "Eq. 85", "Eq. 105", "Eq. 115", "Eq. 170"),
        tags=("elasticity", "conduction", "recovery"),
        shows=(
            "Stress, energy, gradient, rotation and flux are those of the field to rounding, body "
            "forces and couples have the strength that they are given, and damage is the share of "
            "bonds that a crack cuts."
        ),
        methods=tuple(
            Method(name, "bond", run, LADDER, warm.both) for name, (run, _) in METHODS.items()
        ),
        checks=tuple(
            Check(
                name,
                quantity,
                {CELLS: 1e-9},
                source="rounding: linear and quadratic fields are exact on the lattice's own sums",
                exact=True,
            )
            for name, (_, quantities) in METHODS.items()
            for quantity in quantities
        ),
        quantities=QUANTITIES,
        primary="stress by planes",
        featured="bond/elastic",
        length="L",
        timed=False,
    ),
)
