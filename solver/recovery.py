"""Fields recovered from a solution: stress, flux, energy, macroscopic rotation.

All are sums over bonds, done one offset at a time for the whole body. Near an edge (a prescribed
layer included) families lack bonds, and stress and flux there are those of the bonds that exist;
with the surface treatment ``extrapolated`` bonds that end at the surface stand in for them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from . import bonds as bond_room
from .arrays import Array
from .material import ConductiveModuli, ElasticModuli
from .solution import Solution


@dataclass(frozen=True)
class _Pair:
    """Everything about the bonds of one offset: geometry and end values of every particle."""

    index: int
    weight: float
    factor: Array
    length: float
    normal: Array
    tangent: Array
    difference: Array
    ends: Array


def _pairs(solution: Solution) -> Iterator[_Pair]:
    """The bonds of each offset: `difference` and sum of the `ends`, shape (components, N)."""
    parts = solution.discretisation
    lattice, family, bonds = parts.lattice, parts.family, parts.bonds
    # Parts set aside are NaN and have no bonds: zeros keep them from spoiling their neighbours,
    # whose bonds to them carry the factor 0.
    known = np.nan_to_num(solution.unknowns, nan=0.0)
    grid = lattice.to_grid(known)
    rows, columns = lattice.rows_columns
    for o, (dx, dy) in enumerate(family.offsets):
        there = grid[:, rows + dy, columns + dx]
        yield _Pair(
            o,
            float(family.weight[o] * family.cell_area),
            bonds.strength(o),
            float(family.length[o]),
            family.normal[o],
            family.tangent[o],
            there - known,
            there + known,
        )


@dataclass(frozen=True)
class _Ends:
    """Bonds that end at the surface: strains and geometry, one value a bond."""

    particle: NDArray[np.int64]
    offset: NDArray[np.int64]
    weight: Array
    length: Array
    difference: Array
    strains: Array

    def add(self, values: Array, result: Array) -> None:
        """Add values (..., bonds) to their particles' in `result`, shape (..., N)."""
        for into, what in zip(
            result.reshape(-1, result.shape[-1]),
            values.reshape(-1, len(self.particle)),
            strict=True,
        ):
            into += np.bincount(self.particle, what, minlength=len(into))


def _ends(solution: Solution) -> _Ends | None:
    """The bonds that end at the surface, if the body has any."""
    parts = solution.discretisation
    ended, surface, family = parts.bonds.ended, parts.operator.ended_stiffness, parts.family
    nodal = parts.surface_values(solution.unknowns)
    if ended is None or surface is None or nodal is None:
        return None
    strains, difference = surface.strains(
        np.nan_to_num(solution.unknowns[:, surface.particles]),
        nodal,
    )
    weight = family.weight[ended.offset] * family.cell_area
    return _Ends(ended.particle, ended.offset, weight, ended.length, difference, strains)


def _aside(solution: Solution, result: Array) -> Array:
    """`result` (N, ...) with NaN at the particles that were set aside."""
    result[np.isnan(solution.unknowns).any(axis=0)] = np.nan
    return result


def _elastic(solution: Solution) -> ElasticModuli:
    moduli = solution.discretisation.moduli
    if not isinstance(moduli, ElasticModuli):
        raise TypeError("stress and rotation are recovered from elastic solutions only")
    return moduli


def _stretch(pair: _Pair, spacing: float) -> tuple[Array, Array]:
    """Stretch s and shear γ (Eqs. 1–2) of the bonds of one offset, shape (N,)."""
    eta = pair.difference[:2]
    s = (pair.normal @ eta) / pair.length
    gamma = (pair.tangent @ eta) / pair.length
    if len(pair.difference) == 3:
        gamma = gamma - 0.5 * pair.ends[2] / spacing
    return s, gamma


def _force(pair: _Pair, moduli: ElasticModuli, spacing: float) -> Array:
    """Pairwise force density f_n n + f_t t with its bond factor (Eq. 21), shape (2, N)."""
    s, gamma = _stretch(pair, spacing)
    axial = pair.factor * moduli.normal[pair.index] * s
    transverse = pair.factor * moduli.shear[pair.index] * gamma
    return np.outer(pair.normal, axial) + np.outer(pair.tangent, transverse)


def stress(solution: Solution, rule: Literal["plane", "family"] = "plane") -> Array:
    """Stress at the particles.

    Parameters
    ----------
    solution : Solution
        Of an elastic scene.
    rule : {"plane", "family"}
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
    moduli = _elastic(solution)
    lattice, family = solution.discretisation.lattice, solution.discretisation.family
    result = np.zeros((2, 2, lattice.count))
    if rule == "family":
        for pair in _pairs(solution):
            force = _force(pair, moduli, solution.spacing) * (0.5 * pair.weight * pair.length)
            result += force[:, None, :] * pair.normal[None, :, None]
        if (ends := _ends(solution)) is not None:
            o = ends.offset
            axial, transverse = moduli.normal[o], moduli.shear[o]
            force = family.normal[o].T * (axial * ends.strains[0])
            if len(ends.strains) == 2:
                force += family.tangent[o].T * (transverse * ends.strains[1])
            force *= 0.5 * ends.weight * family.length[o]
            ends.add(force[:, None] * family.normal[o].T[None], result)
    elif rule == "plane":
        rows, columns = lattice.rows_columns
        for pair in _pairs(solution):
            offset = family.offsets[pair.index]
            force = _force(pair, moduli, solution.spacing)
            force = lattice.to_grid(force * (pair.weight * family.cell_area / solution.spacing))
            for axis in (0, 1):
                for start, share in _crossings(offset, axis):
                    result[:, axis] += share * force[:, rows + start[1], columns + start[0]]
    else:
        raise ValueError(f"unknown stress rule {rule!r}; known: plane, family")
    return _aside(solution, np.moveaxis(result, 2, 0))


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


def flux(solution: Solution, rule: Literal["consistent", "hotter"] = "consistent") -> Array:
    """Heat flux (or current density) at the particles.

    Parameters
    ----------
    solution : Solution
        Of a conductive scene.
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
    moduli = solution.discretisation.moduli
    if not isinstance(moduli, ConductiveModuli):
        raise TypeError("flux is recovered from conductive solutions only")
    if rule not in ("consistent", "hotter"):
        raise ValueError(f"unknown flux rule {rule!r}; known: consistent, hotter")
    result = np.zeros((2, solution.discretisation.lattice.count))
    for pair in _pairs(solution):
        flow = pair.factor * (moduli.conductivity[pair.index] * pair.weight / pair.length)
        flow = flow * pair.difference[0]
        share = np.where(pair.difference[0] > 0, 1.0, 0.0) if rule == "hotter" else 0.5
        result -= np.outer(pair.normal, share * flow)
    if (ends := _ends(solution)) is not None:
        o, slope = ends.offset, ends.strains[0]
        part = np.where(slope > 0, 1.0, 0.0) if rule == "hotter" else 0.5
        flow = part * ends.weight * moduli.conductivity[o] * slope
        ends.add(-flow * solution.discretisation.family.normal[o].T, result)
    return _aside(solution, result.T)


def strain_energy_density(solution: Solution) -> Array:
    """Macroelastic energy density W of each particle (Eq. 11), shape (N,), J/m³.

    Each bond gives half its energy to either end; one that ends at the surface as much as if it
    were whole, so that a homogeneous strain has its density right up to the edge. In conduction
    the macro-potential of Eq. 115.
    """
    moduli = solution.discretisation.moduli
    result = np.zeros(solution.discretisation.lattice.count)
    for pair in _pairs(solution):
        if isinstance(moduli, ConductiveModuli):
            density = moduli.conductivity[pair.index] * (pair.difference[0] / pair.length) ** 2
        else:
            s, gamma = _stretch(pair, solution.spacing)
            density = moduli.normal[pair.index] * s**2 + moduli.shear[pair.index] * gamma**2
            density = density * pair.length
        result += 0.25 * pair.weight * pair.factor * density
    if (ends := _ends(solution)) is not None:
        o = ends.offset
        if isinstance(moduli, ConductiveModuli):
            density = moduli.conductivity[o] * ends.strains[0] ** 2
        else:
            density = moduli.normal[o] * ends.strains[0] ** 2
            if len(ends.strains) == 2:
                density += moduli.shear[o] * ends.strains[1] ** 2
            density *= solution.discretisation.family.length[o]
        ends.add(0.25 * ends.weight * density, result)
    return _aside(solution, result)


def damage(solution: Solution) -> Array:
    """Share of each particle's family that is cut or broken (Eq. 105), shape (N,); see
    `solver.bonds.damage`. NaN at parts that were set aside.
    """
    return _aside(solution, bond_room.damage(solution.discretisation.bonds))


def displacement_gradient(solution: Solution) -> Array:
    """∂u_i/∂x_j by weighted least squares over the bonds that exist, shape (N, 2, 2).

    Exact for linear fields in every family that is not degenerate.
    """
    _elastic(solution)
    count = solution.discretisation.lattice.count
    moment, slope = np.zeros((count, 2, 2)), np.zeros((count, 2, 2))
    for pair in _pairs(solution):
        weight = pair.weight * (pair.factor > 0)
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


def macrorotation(solution: Solution) -> Array:
    """½ (∂u2/∂x1 − ∂u1/∂x2), shape (N,), rad: what θ tends to as δ → 0 (Eq. 85)."""
    gradient = displacement_gradient(solution)
    return 0.5 * (gradient[:, 1, 0] - gradient[:, 0, 1])
