"""Fields recovered from a solution: stress, flux, energy, macroscopic rotation.

All are sums over bonds, done one offset at a time for the whole body. Near an edge (a prescribed
layer included) families lack bonds, and stress and flux there are those of the bonds that exist;
with the surface treatment ``extrapolated`` bonds that end at the surface stand in for them. On the
edge itself ask `edge_strain` (or `edge_gradient`): they fit the displacements around.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from . import bonds as bond_room
from .arrays import Array
from .edge_recovery import edge_gradient, edge_strain
from .material import Family, Moduli, PolarModuli
from .material.physics import ELASTICITY, ELECTRICITY, HEAT, Physics
from .material.strains import directions, elongations
from .state import State

__all__ = [
    "couple_stress",
    "current_density",
    "damage",
    "displacement_gradient",
    "dissipation",
    "edge_gradient",
    "edge_strain",
    "fields",
    "flux",
    "joule_heat",
    "macrorotation",
    "strain_energy_density",
    "stress",
]


@dataclass(frozen=True)
class _Pair:
    """Everything about the bonds of one offset: geometry and end values of every particle."""

    index: int
    weight: float
    strength: Array
    length: float
    normal: Array
    directions: Array
    difference: Array
    strains: Array


def _pairs(solution: State) -> Iterator[_Pair]:
    """The bonds of each offset: differences (components, N) and strains (strains, N).

    Strains are mechanical: less what a temperature strains without stress.
    """
    body = solution.discretisation
    lattice, family, bonds, moduli = body.lattice, body.family, body.bonds, body.moduli
    # Parts set aside are NaN and have no bonds: zeros keep them from spoiling their neighbours,
    # whose bonds to them have no strength.
    known = np.nan_to_num(solution.values, nan=0.0)
    grid = lattice.to_grid(known)
    rows, columns = lattice.rows_columns
    for o, (dx, dy) in enumerate(family.offsets):
        there = grid[:, rows + dy, columns + dx]
        length = float(family.length[o])
        normal = np.broadcast_to(family.normal[o][:, None], (2, lattice.count))
        turn = 0.5 * length * (there[-1] + known[-1]) if moduli.turns else np.zeros(lattice.count)
        strains = elongations(moduli.strains, normal, there - known, turn) / length
        if body.eigenstrain is not None:
            strains -= body.eigenstrain.of_offset(o)
        yield _Pair(
            o,
            float(family.weight[o] * family.cell_area),
            bonds.strength(o),
            length,
            family.normal[o],
            directions(moduli.strains, family.normal[o]),
            there - known,
            strains,
        )


@dataclass(frozen=True)
class _Ends:
    """Bonds that end at the surface: strains and geometry, one value a bond."""

    particle: NDArray[np.int64]
    offset: NDArray[np.int64]
    weight: Array
    strength: Array
    length: Array
    difference: Array
    strains: Array
    phase: NDArray[np.int64] | None

    def add(self, values: Array, result: Array) -> None:
        """Add values (..., bonds) to their particles' in `result`, shape (..., N)."""
        for into, what in zip(
            result.reshape(-1, result.shape[-1]),
            values.reshape(-1, len(self.particle)),
            strict=True,
        ):
            into += np.bincount(self.particle, what, minlength=len(into))


def _ends(solution: State) -> _Ends | None:
    """The bonds that end at the surface, if the body has any."""
    body = solution.discretisation
    ended, surface, family = body.bonds.ended, body.operator.ended_stiffness, body.family
    nodal = body.surface_values(solution.unknowns)
    if ended is None or surface is None or nodal is None:
        return None
    strains, difference = surface.strains(
        np.nan_to_num(solution.unknowns[:, surface.particles]),
        nodal,
    )
    if body.eigenstrain is not None:
        strains = strains - body.eigenstrain.of_ended(ended)
    weight = family.weight[ended.offset] * family.cell_area
    strength = np.ones(len(ended)) if ended.factor is None else ended.factor
    return _Ends(
        ended.particle,
        ended.offset,
        weight,
        strength,
        ended.length,
        difference,
        strains,
        ended.phase,
    )


def _per_volume(solution: State, result: Array) -> Array:
    """`result` (..., N) over the thickness: what acts in the solid, not in the plane."""
    thick = solution.discretisation.thickness
    return result if thick is None else result / thick


def _aside(solution: State, result: Array) -> Array:
    """`result` (N, ...) with NaN at the particles that were set aside."""
    result[np.isnan(solution.unknowns).any(axis=0)] = np.nan
    return result


def _need(solution: State, physics: Physics, what: str) -> None:
    if solution.physics is not physics:
        raise TypeError(
            f"{what} is recovered from solutions of {physics.name} only, not of "
            f"{solution.physics.name}"
        )


def _force(pair: _Pair, moduli: Moduli) -> Array:
    """Pairwise force density f_n n + f_t t with its strength (Eq. 21), or k g n, shape (2, N)."""
    stress = moduli.of_offset(pair.index) * pair.strains
    return pair.strength * np.einsum("ai,an->in", pair.directions, stress)


def _ended_force(ends: _Ends, moduli: Moduli, family: Family) -> Array:
    """The same of the bonds that end at the surface, shape (2, bonds)."""
    along = directions(moduli.strains, family.normal[ends.offset].T)
    stiffness = ends.strength * moduli.of_bonds(ends.offset, ends.phase)
    return np.einsum("ak,aik,ak->ik", stiffness, along, ends.strains)


def stress(solution: State, rule: Literal["plane", "family"] | None = None) -> Array:
    """Stress at the particles.

    Parameters
    ----------
    solution : Solution, or the State of any analysis
        Of an elastic scene.
    rule : {"plane", "family"}, optional
        By default the one that fits the treatment of surfaces: ``family`` where bonds end at them
        (``extrapolated``), which has the whole stress on an edge, else ``plane``.
        ``plane``: Saint-Venant and Cauchy's definition (Eq. 83), force per area through the
        section Δx of the particle. Bonds between particles only: beside a surface take
        ``family``. A bond counts by half where it starts or ends on the plane
        (the mean of the planes just before and behind the centre) and where it passes exactly
        between two sections; without this the sum of a homogeneous strain comes out wrong.
        ``family``: ½ Σ f ⊗ ξ α Δv, the virial of the particle's own bonds.

    Returns
    -------
    ndarray, shape (N, 2, 2), Pa
        [p, i, j]: component i of the traction on the plane with normal j. Not symmetric in
        general: bonds transmit moments.

    Raises
    ------
    ValueError
        If the rule is unknown.
    """
    _need(solution, ELASTICITY, "stress")
    body = solution.discretisation
    lattice, family, moduli = body.lattice, body.family, body.moduli
    if rule is None:
        rule = "plane" if body.bonds.ended is None else "family"
    result = np.zeros((2, 2, lattice.count))
    if rule == "family":
        for pair in _pairs(solution):
            force = _force(pair, moduli) * (0.5 * pair.weight * pair.length)
            result += force[:, None, :] * pair.normal[None, :, None]
        if (ends := _ends(solution)) is not None:
            normal = family.normal[ends.offset].T
            force = _ended_force(ends, moduli, family)
            force *= 0.5 * ends.weight * family.length[ends.offset]
            ends.add(force[:, None] * normal[None], result)
    elif rule == "plane":
        rows, columns = lattice.rows_columns
        for pair in _pairs(solution):
            offset = family.offsets[pair.index]
            force = _force(pair, moduli)
            force = lattice.to_grid(force * (pair.weight * family.cell_area / solution.spacing))
            for axis in (0, 1):
                for start, share in _crossings(offset, axis):
                    result[:, axis] += share * force[:, rows + start[1], columns + start[0]]
    else:
        raise ValueError(f"unknown stress rule {rule!r}; known: plane, family")
    return _aside(solution, np.moveaxis(_per_volume(solution, result), 2, 0))


def _crossings(offset: NDArray[np.int64], axis: int) -> Iterator[tuple[tuple[int, int], float]]:
    """Starts (relative to p) of bonds of one offset through p's section normal to `axis`.

    Only offsets that point to the positive side count: each bond once.
    """
    through, along = int(offset[axis]), int(offset[1 - axis])
    if through <= 0:
        return
    for behind in range(through + 1):
        share = 0.5 if behind in (0, through) else 1.0
        # The bond meets the plane at start + along·behind/through; integers keep ties exact.
        numerator = -along * behind
        below = numerator // through
        remainder = 2 * (numerator - below * through)
        if remainder < through:
            starts = [(below, share)]
        elif remainder > through:
            starts = [(below + 1, share)]
        else:
            starts = [(below, 0.5 * share), (below + 1, 0.5 * share)]
        for side, weight in starts:
            start = (-behind, side) if axis == 0 else (side, -behind)
            yield start, weight


def flux(solution: State, rule: Literal["consistent", "hotter"] = "consistent") -> Array:
    """Heat flux at the particles.

    Parameters
    ----------
    solution : Solution, or the State of any analysis
        Of a scene of heat conduction.
    rule : {"consistent", "hotter"}
        ``consistent``: −½ Σ k g n α Δv over the whole family, the half sum that a homogeneous
        gradient makes exact. ``hotter``: Eq. 170 over the hotter neighbours only, with the sign
        of Fourier's law and the area fractions that the print leaves out.

    Returns
    -------
    ndarray, shape (N, 2), W/m²

    Raises
    ------
    ValueError
        If the rule is unknown.
    """
    _need(solution, HEAT, "flux")
    if rule not in ("consistent", "hotter"):
        raise ValueError(f"unknown flux rule {rule!r}; known: consistent, hotter")
    return _flow(solution, rule)


def current_density(solution: State) -> Array:
    """Current density j at the particles, shape (N, 2), A/m²: `flux` with φ for T.

    −½ Σ k g n α Δv over the whole family, which a homogeneous field makes exact.
    """
    _need(solution, ELECTRICITY, "a current density")
    return _flow(solution, "consistent")


def joule_heat(solution: State) -> Array:
    """Heat that the current makes, j·E, shape (N,), W/m³.

    A pair gives off k g² α Δv² (its current times its voltage), twice its share of the
    macro-potential of Eq. 115.
    """
    _need(solution, ELECTRICITY, "Joule heat")
    return 2.0 * strain_energy_density(solution)


def dissipation(solution: State) -> Array:
    """Heat that the current makes, shape (N,), W/m³ of a whole cell (W/m² with a thickness).

    Every bond's current times its voltage, k g² α Δv², half at each end; of one that ends at the
    surface what lies in the body, at its particle. Unlike `joule_heat`, a density up to the edge,
    it adds up: times Δx² the sum is what the leads supply. Zero at parts that were set aside.
    """
    _need(solution, ELECTRICITY, "a dissipation")
    body = solution.discretisation
    stiffness = body.moduli.stiffness[0]
    result = np.zeros(body.lattice.count)
    for pair in _pairs(solution):
        share = 0.5 * pair.weight * pair.strength * stiffness[pair.index]
        result += share * pair.strains[0] ** 2
    surface, nodal = body.operator.ended_stiffness, body.surface_values(solution.unknowns)
    if surface is not None and nodal is not None:
        values = np.nan_to_num(solution.unknowns[:, surface.particles])
        of_bonds, others = surface.energies(body.family, body.moduli, values, nodal)
        others.append((body.bonds.lattice.points[surface.ended.particle], of_bonds))
        for places, energy in others:
            _, nearest = body.bonds.lattice.tree.query(places)
            result += np.bincount(nearest, 2.0 * energy, minlength=len(result))
    return result


def _flow(solution: State, rule: str) -> Array:
    body = solution.discretisation
    result = np.zeros((2, body.lattice.count))
    for pair in _pairs(solution):
        result -= _share(rule, pair.strains[0]) * pair.weight * _force(pair, body.moduli)
    if (ends := _ends(solution)) is not None:
        share = _share(rule, ends.strains[0])
        ends.add(-share * ends.weight * _ended_force(ends, body.moduli, body.family), result)
    return _aside(solution, _per_volume(solution, result).T)


def _share(rule: str, gradient: Array) -> Array:
    return np.where(gradient > 0, 1.0, 0.0) if rule == "hotter" else np.full_like(gradient, 0.5)


def strain_energy_density(solution: State) -> Array:
    """Macroelastic energy density W of each particle (Eq. 11), shape (N,), J/m³.

    Each bond gives half its energy to either end; one that ends at the surface as much as if it
    were whole, so that a homogeneous strain has its density right up to the edge; what a calibrated
    tip adds, which can be negative, is spread over its particles. In conduction the macro-potential
    of Eq. 115.
    """
    body = solution.discretisation
    moduli, length = body.moduli, body.moduli.pair_length(body.family)
    result = np.zeros(body.lattice.count)
    for pair in _pairs(solution):
        energy = moduli.of_offset(pair.index) * pair.strains**2
        density = length[pair.index] * energy.sum(axis=0)
        result += 0.25 * pair.weight * pair.strength * density
    if (ends := _ends(solution)) is not None:
        o = ends.offset
        density = length[o] * (moduli.of_bonds(o, ends.phase) * ends.strains**2).sum(axis=0)
        ends.add(0.25 * ends.weight * ends.strength * density, result)
    for tip in body.operator.tips:
        added = tip.energy(solution.unknowns[:, tip.particles])
        result[tip.particles] += added / len(tip.particles)
    return _aside(solution, _per_volume(solution, result))


def damage(solution: State) -> Array:
    """Share of each particle's family that is cut or broken (Eq. 105), shape (N,); see
    `solver.bonds.damage`. NaN at parts that were set aside.
    """
    return _aside(solution, bond_room.damage(solution.discretisation.bonds))


def displacement_gradient(solution: State) -> Array:
    """∂u_i/∂x_j by weighted least squares over the bonds that exist, shape (N, 2, 2).

    Exact for linear fields in every family that is not degenerate.
    """
    _need(solution, ELASTICITY, "a displacement gradient")
    count = solution.discretisation.lattice.count
    moment, slope = np.zeros((count, 2, 2)), np.zeros((count, 2, 2))
    for pair in _pairs(solution):
        weight = pair.weight * (pair.strength > 0)
        xi = pair.length * pair.normal
        moment += weight[:, None, None] * np.outer(xi, xi)
        slope += (weight * pair.difference[:2]).T[:, :, None] * xi
    if (ends := _ends(solution)) is not None:
        xi = ends.length * solution.discretisation.family.normal[ends.offset].T
        ends.add(ends.weight * xi[:, None] * xi[None], moment := np.moveaxis(moment, 0, 2).copy())
        ends.add(
            ends.weight * ends.difference[:2, None] * xi[None],
            slope := np.moveaxis(slope, 0, 2).copy(),
        )
        moment, slope = np.moveaxis(moment, 2, 0), np.moveaxis(slope, 2, 0)
    return _aside(solution, slope @ np.linalg.pinv(moment))


def macrorotation(solution: State) -> Array:
    """½ (∂u2/∂x1 − ∂u1/∂x2), shape (N,), rad: what θ tends to as δ → 0 (Eq. 85)."""
    gradient = displacement_gradient(solution)
    return 0.5 * (gradient[:, 1, 0] - gradient[:, 0, 1])


def fields(solution: State) -> dict[str, Array]:
    """What is worth writing beside the solved fields, by name, (N,) or (N, 2) arrays in SI units.

    Stress components as stress11, stress22, stress12 (the mean of both shears), and the change of
    temperature if one strains the body; or the flux.
    """
    return _RECOVERED[solution.physics.name](solution)


def couple_stress(solution: State) -> Array:
    """Couple stress of a polar solid at the particles, m = E ∇θ (Eq. 178).

    ½ Σ |ξ| k_b χ n α Δv over the whole family, which a homogeneous curvature makes exact.

    Parameters
    ----------
    solution : Solution, or the State of any analysis
        Of a scene whose material is a `PolarTensor`.

    Returns
    -------
    ndarray, shape (N, 2), N/m
        m31 and m32: the couple per area on planes with the normals 1 and 2.

    Raises
    ------
    TypeError
        If its bonds do not resist bending.
    """
    body = solution.discretisation
    moduli, family = body.moduli, body.family
    if not isinstance(moduli, PolarModuli):
        raise TypeError(
            "a couple stress is recovered from solutions of polar solids only (PolarTensor)"
        )
    result, place = np.zeros((2, body.lattice.count)), moduli.strains.index("χ")
    bending = moduli.stiffness[place]
    for pair in _pairs(solution):
        share = 0.5 * pair.weight * pair.length * bending[pair.index]
        result += pair.normal[:, None] * (share * pair.strength * pair.strains[place])
    if (ends := _ends(solution)) is not None:
        o = ends.offset
        share = 0.5 * ends.weight * ends.strength * family.length[o] * bending[o]
        ends.add(family.normal[o].T * (share * ends.strains[place]), result)
    return _aside(solution, _per_volume(solution, result).T)


def _stresses(solution: State) -> dict[str, Array]:
    found = stress(solution)
    named = {
        "stress11": found[:, 0, 0],
        "stress22": found[:, 1, 1],
        "stress12": 0.5 * (found[:, 0, 1] + found[:, 1, 0]),
    }
    if isinstance(solution.discretisation.moduli, PolarModuli):
        # Where rotations do not follow, shear on two planes is not the same.
        named["stress12_less_21"] = found[:, 0, 1] - found[:, 1, 0]
        named["couple_stress"] = couple_stress(solution)
    warm = solution.discretisation.eigenstrain
    if warm is not None and warm.temperature is not None:
        named["temperature"] = warm.temperature
    return named


def _fluxes(solution: State) -> dict[str, Array]:
    return {"flux": flux(solution)}


def _currents(solution: State) -> dict[str, Array]:
    return {"current_density": current_density(solution)}


#: Recovered fields of each physics.
_RECOVERED: dict[str, Callable[[State], dict[str, Array]]] = {
    ELASTICITY.name: _stresses,
    HEAT.name: _fluxes,
    ELECTRICITY.name: _currents,
}
