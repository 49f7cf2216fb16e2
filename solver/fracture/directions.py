"""Critical bond energies for which cuts in every direction of the lattice cost what they should.

What a straight cut with the normal ν costs depends on the direction ψ of its bonds only,

    G(ν) = Σ_ψ M_ψ |cos(ψ − ν)|,   M_ψ = Σ w_c α Λ |ξ| Δx² over half the bonds along ψ,

so it has a cusp where the cut runs along a bond (ν ⟂ ψ), and in between it is an arc
A cos(ν − φ). Values G_i at the cusps determine the arcs, and the jump of slope there is 2 M_ψ:

    2 M_i = (G_(i+1) − G_i cos Δ_i)/sin Δ_i + (G_(i−1) − G_i cos Δ_(i−1))/sin Δ_(i−1)

with the angles Δ to the neighbouring directions. Any positive G_i with non-negative M_i can
thus be had exactly: as many directions as the family has.

No bond energies whatever make G constant: over the widest gap Δ without a bond it is an arc, whose
least variation is 1/cos(Δ/2) − 1. At m = 5 the gap beside a row is atan(1/5) and this 0.49 %, at
m = 7 0.25 %, and less than 0.1 % need m = 12.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import nnls

from ..arrays import Array, Indices
from ..material import Family

# Least M of a direction, relative to what the mean energy would give: a bond without toughness
# has broken before it is loaded.
_LEAST = 1e-3


def directions(family: Family) -> tuple[Array, Indices]:
    """Directions of bonds in [0, π), ascending, and the number of its own for each half offset.

    Returns
    -------
    angle : ndarray, shape (directions,), rad
    member : ndarray of int, shape (family size / 2,)
    """
    offsets = family.offsets[: family.size // 2]
    rays = offsets // np.gcd(offsets[:, 0], offsets[:, 1])[:, None]
    primitive, member = np.unique(rays, axis=0, return_inverse=True)
    angle = np.mod(np.arctan2(primitive[:, 1], primitive[:, 0]), np.pi)
    order = np.argsort(angle)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    return angle[order], place[member.reshape(-1)]


def least_variation(family: Family) -> float:
    """Largest over smallest cost of a cut, less one, that no bond energies can undercut."""
    angle, _ = directions(family)
    gap = np.diff(angle, append=angle[0] + np.pi).max()
    return float(1 / np.cos(0.5 * gap) - 1)


def levelled(family: Family, cost: Callable[[Array], Array]) -> Array:
    """w_c for which a cut along any direction of bonds costs `cost`, J/m⁶, (family size,).

    Where that would take a negative w_c, which is where `cost` varies faster than any cut can
    (G + G″ < 0), the nearest non-negative ones by relative least squares.

    Parameters
    ----------
    family : Family
    cost : callable
        Directions of cuts (rad) → fracture energies, J/m², positive.
    """
    half = family.size // 2
    angle, member = directions(family)
    mass = np.bincount(member, family.weight[:half] * family.length[:half] * family.cell_area)
    # A direction whose bonds all lie where the influence function vanishes holds nothing.
    there = mass > 0
    angle, wanted = angle[there], cost(angle[there])
    after = np.diff(angle, append=angle[0] + np.pi)
    before = np.roll(after, 1)
    slopes = (np.roll(wanted, -1) - wanted * np.cos(after)) / np.sin(after)
    slopes += (np.roll(wanted, 1) - wanted * np.cos(before)) / np.sin(before)
    found = 0.5 * slopes
    least = _LEAST * wanted.mean() * 0.25 * (after + before)
    if np.any(found < least):
        # Cuts along the bonds; sin: the normals are perpendicular to them.
        matrix = np.abs(np.sin(angle[:, None] - angle)) / wanted[:, None]
        found = least + nnls(matrix, 1.0 - matrix @ least)[0]
    energies = np.zeros(len(mass))
    energies[there] = found / mass[there]
    if not there.all():
        energies[~there] = energies[there].mean()
    return np.tile(energies[member], 2)
