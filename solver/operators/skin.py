"""The skin: what a lattice has too much or too little of along the edge of a body.

Bonds that end at the surface represent the body by its intersections with the lattice's lines:
chords of every bond direction, each standing for a strip of the width of the lines' distance.
Where lines cross the edge this is as accurate as the trapezoidal rule is. But lines that run
*along* an edge (a row of particles, say) represent it by whole strips: unless the edge lies just
between two of them, the body is up to half a strip too thick or too thin there for the bonds of
that direction, and error is of first order: on edges parallel to the lattice, and where a circle
touches a row.

The cure is a membrane on the surface's nodes. On a free edge the stress is uniaxial along the
edge, so what lacks is a layer of thickness e and Young's modulus E_τ of that direction (a
conductor's 1/(K⁻¹)_ττ): energy ½ e E_τ ε_ττ² a length, negative where there is too much. With a
bump Φ about a point of the edge, smooth enough that the trapezoidal rule is exact inside the body,

    e = Σ_o share_o (∫_B Φ dA − Σ_lines of o width_o ∫_{line ∩ B} Φ dl) / ∫_edge Φ ds,

where share_o is the part that bonds of direction o have in the energy of that uniaxial stress. In
a homogeneous uniaxial state the membrane's forces are just what the ends of bonds leave over.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array, Indices, Mask
from ..compiled import kernel
from ..geometry import Outline
from ..material import Family, Moduli, effective_tensor

_OPTIONS: Any = {"nogil": True}

# Standard deviation of the bump Φ, cells: the trapezoidal rule's error for lines one cell apart is
# exp(−2 π² 1.2²), one in 10¹².
_BUMP = 1.2
# Reach of the bump in standard deviations.
_REACH = 6.0
# Lines in a cell for the true area.
_FINE = 48
# Turn (rad) from one edge to the next that makes a corner: there a bump sees a straight edge on.
_CORNER = 0.6
# A chain turns no further than this (rad) on either side, so that its straight ends stay apart.
_BEND = 1.2
# Radius of curvature (cells) below which the bump would see round the curve: no membrane there,
# the whole of it from twice that on.
_TIGHT = 5.0
# Length (cells) from which on an edge of a crack's face bears a membrane: not beside its tip.
_LONG = 1.5
# Cells (and shares) within which edges are straight, and see the same.
_STRAIGHT = 1e-10
# Distance (cells) within which a line of particles lies on the edge.
_ON_EDGE = 1e-7
# Thickness (cells) that is rounding, or the little by which a line on the very edge lies inside.
_NONE = 1e-6


@dataclass(frozen=True)
class _Directions:
    """Bond directions: those of primitive offsets, with what is common to their multiples."""

    step: Indices
    of: Indices

    @classmethod
    def of_family(cls, family: Family) -> _Directions:
        half = family.offsets[: family.size // 2]
        primitive = half // np.gcd(*half.T)[:, None]
        step, of = np.unique(primitive, axis=0, return_inverse=True)
        return cls(step, of.ravel())


def shares(
    family: Family, moduli: Moduli, along: Array, factors: Array | None = None
) -> tuple[Array, Array]:
    """Shares of the half offsets in the energy of a uniaxial state, and its modulus.

    Parameters
    ----------
    along : ndarray, shape (e, 2)
        Unit vectors τ.
    factors : ndarray, shape (e, family size / 2), optional
        On the moduli, edge by edge.

    Returns
    -------
    share : ndarray, shape (e, family size / 2)
        Sums to 1 for every edge.
    modulus : ndarray, shape (e,)
        E_τ = 1/(S)_ττ, Pa, or 1/(K⁻¹)_ττ, W/(m K).
    """
    half = family.size // 2
    weight = (family.weight * family.cell_area * moduli.pair_length(family))[:half]
    stress = moduli.uniaxial(along)
    if factors is None:
        strain = stress @ np.linalg.inv(effective_tensor(family, moduli))
    else:
        own = [effective_tensor(family, moduli.scaled(np.tile(f, 2))) for f in factors]
        strain = np.linalg.solve(np.array(own), stress[:, :, None])[:, :, 0]
    # Each strain of each bond in that state, (strains, e, half).
    found = np.einsum("ei,aio->aeo", strain, moduli.homogeneous(family.normal[:half].T))
    energy = weight * np.einsum("ao,aeo->eo", moduli.stiffness[:, :half], found**2)
    if factors is not None:
        energy *= factors
    return energy / energy.sum(axis=1, keepdims=True), 1.0 / (strain * stress).sum(axis=1)


def thickness(
    outline: Outline,
    family: Family,
    moduli: Moduli,
    edges: Indices,
    factors: Array | None = None,
) -> Array:
    """e E_τ of some edges of the outline, shape (len(edges),), N/m (or W/K) per unit thickness.

    Zero on the faces of cracks along rows, and beside tips. `factors` on the moduli, (edges of the
    outline, family size / 2).
    Of a body of several phases each edge has its own phase's.
    """
    result = np.zeros(len(edges))
    if outline.phase is not None and len(moduli.each) > 1:
        for phase, own_moduli in enumerate(moduli.each):
            mine = outline.phase[edges] == phase
            result[mine] = thickness(outline, family, own_moduli, edges[mine], factors)
        return result
    own = np.nonzero(skinned(outline, family)[edges])[0]
    if not len(own):
        return result
    along = (
        outline.nodes[outline.edges[edges[own], 1]] - outline.nodes[outline.edges[edges[own], 0]]
    )
    along /= np.hypot(*along.T)[:, None]
    at = None if factors is None else factors[edges[own]]
    share, modulus = shares(family, moduli, along, at)
    result[own] = _lacking(outline, family, edges[own], share) * family.spacing * modulus
    return result


def skinned(outline: Outline, family: Family) -> Mask:
    """Edges along which a membrane may be: of the body, and of faces of cracks away from tips."""
    return np.asarray(outline.edged | (outline.length > _LONG * family.spacing))


def layers(outline: Outline, family: Family, moduli: Moduli, edges: Indices) -> Array:
    """The same of interfaces, whose state is not uniaxial: e k of every strain, (strains, edges).

    What lacks is a layer of the bonds along the edge, with each of their strains: stretch (or
    gradient) along it, and shear, without which the couples that bonds across exert on its nodes
    would not balance.
    """
    result = np.zeros((len(moduli.strains), len(edges)))
    if len(moduli.each) > 1:
        assert outline.phase is not None
        for phase, own in enumerate(moduli.each):
            mine = outline.phase[edges] == phase
            result[:, mine] = layers(outline, family, own, edges[mine])
        return result
    if not len(edges):
        return result
    half = family.size // 2
    weight = (family.weight * family.cell_area * moduli.pair_length(family))[:half]
    along = outline.nodes[outline.edges[edges, 1]] - outline.nodes[outline.edges[edges, 0]]
    along /= np.hypot(*along.T)[:, None]
    parallel = (along @ family.normal[:half].T) ** 4
    for place, stiffness in enumerate(moduli.stiffness):
        strain = result[place]
        share = parallel * (weight * stiffness[:half])
        total = share.sum(axis=1)
        some = np.nonzero(total)[0]
        share = share[some] / total[some, None]
        strain[some] = _lacking(outline, family, edges[some], share, place == 0) * total[some]
    return result * family.spacing


def _lacking(
    outline: Outline, family: Family, edges: Indices, share: Array, short: bool = True
) -> Array:
    """Thickness (cells) that lacks along edges, weighted by shares of half offsets that sum to 1.

    With `short` less is taken from short edges than is too much there.
    """
    h = family.spacing
    directions = _Directions.of_family(family)
    first = outline.nodes[outline.edges[edges, 0]]
    last = outline.nodes[outline.edges[edges, 1]]
    summed = np.zeros((len(edges), len(directions.step)))
    for place, direction in enumerate(directions.of):
        summed[:, direction] += share[:, place]
    round_enough = np.clip((_radius(outline, edges) / h - _TIGHT) / _TIGHT, 0.0, 1.0)
    chains, length = _chains(outline, edges, _BUMP * _REACH * h)
    # Who owns the edge has the line of particles on it: the body, or the hole whose rim it is.
    owned = np.ones(len(edges), bool) if outline.owned is None else outline.owned[edges]
    outside = np.where(owned, _ON_EDGE, -_ON_EDGE)[:, None] * outline.outward[edges]
    centres, chains_in_cells = 0.5 * (first + last) / h + outside, chains / h + outside[:, None]
    one, back = _alike(centres, chains_in_cells, length, summed)
    lack = _lack(
        centres[one],
        chains_in_cells[one],
        length[one],
        directions.step.astype(np.float64),
        0.5,
        summed[one],
        _BUMP,
        _BUMP * _REACH,
        _FINE,
    )[back]
    # Half a strip at most lacks anywhere. On short edges what is too much could take more stiffness
    # than their nodes have.
    lack[np.abs(lack) < _NONE] = 0.0
    # Beside a notch or hole of a few cells the bump would see the corners behind.
    steps = np.hypot(*(chains[:, 1:] - chains[:, :-1]).transpose(2, 0, 1))
    steps[np.arange(chains.shape[1] - 1) >= (length - 1)[:, None]] = 0.0
    lack[steps.sum(axis=1) < _TIGHT * h] = 0.0
    least = -0.5 * np.minimum(1.0, outline.length[edges] / (2.0 * h)) if short else -0.5
    return np.asarray(round_enough * np.clip(lack, least, 0.5))


def _alike(
    centres: Array, chains: Array, counts: Indices, shares: Array
) -> tuple[Indices, Indices]:
    """One of all edges that see the same, and which of those each edge is like.

    Along a straight edge what is seen repeats as the lattice does.
    """
    ends = chains[:, 0], chains[np.arange(len(chains)), counts - 1]
    along = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]).T)[:, None]
    away = chains - centres[:, None]
    off = np.abs(away[..., 0] * along[:, None, 1] - away[..., 1] * along[:, None, 0])
    off[np.arange(chains.shape[1]) >= counts[:, None]] = 0.0
    # Bent ones are like no other.
    own = np.where(off.max(axis=1) < _STRAIGHT, -1, np.arange(len(chains)))
    seen = np.column_stack([(centres + 0.25) % 1.0, along, shares, own])
    _, one, back = np.unique(
        np.rint(seen / _STRAIGHT), axis=0, return_index=True, return_inverse=True
    )
    return one, back.ravel()


def _radius(outline: Outline, edges: Indices) -> Array:
    """Radius of curvature at some edges, from the turns at their ends; corners do not count."""
    ends = outline.nodes[outline.edges]
    angle = np.arctan2(*(ends[:, 1] - ends[:, 0]).T[::-1])
    here = np.arange(len(outline.edges))
    _, following = outline.neighbours(here >= 0)
    after = following[outline.edges[here, 1]]
    after = np.where(outline.edged[after] == outline.edged[here], after, -1)
    turn = np.where(after >= 0, (angle[after] - angle[here] + np.pi) % (2 * np.pi) - np.pi, 0.0)
    turn[np.abs(turn) > _CORNER] = 0.0
    sharpest = np.zeros(len(outline.face))
    length = outline.length
    curvature = np.abs(turn) / (0.5 * (length[here] + length[after]))
    np.maximum.at(sharpest, here, curvature)
    np.maximum.at(sharpest, after[after >= 0], curvature[after >= 0])
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / sharpest[edges])


def _chains(outline: Outline, edges: Indices, reach: float) -> tuple[Array, Indices]:
    """Points of the smooth curve about the middle of each edge, shape (e, points, 2), and counts.

    A chain ends at corners and beyond `reach`; there its last edge goes straight on.
    """
    before, following = outline.neighbours(np.ones(len(outline.edges), dtype=bool))
    ends = outline.nodes[outline.edges]
    angle = np.arctan2(*(ends[:, 1] - ends[:, 0]).T[::-1])
    middle = 0.5 * (ends[edges, 0] + ends[edges, 1])

    def walk(ahead: bool) -> Indices:
        """Edges on one side of each, the next one first, (e, steps), −1 beyond the last."""
        found: list[Indices] = []
        current = edges.copy()
        bend, going = np.zeros(len(edges)), np.ones(len(edges), dtype=bool)
        while True:
            away = ends[current, int(ahead)] - middle
            going &= np.hypot(*away.T) < reach
            node = outline.edges[current, int(ahead)]
            after = np.where(going, (following if ahead else before)[node], -1)
            going &= (after >= 0) & (after != edges)
            going &= outline.edged[after] == outline.edged[current]
            for earlier in found:
                going &= after != earlier
            turn = (angle[after] - angle[current] + np.pi) % (2 * np.pi) - np.pi
            bend += np.where(going, np.abs(turn), 0.0)
            going &= (np.abs(turn) <= _CORNER) & (bend <= _BEND)
            if not going.any():
                return np.array(found, dtype=np.int64).reshape(-1, len(edges)).T
            found.append(np.where(going, after, -1))
            current = np.where(going, after, current)

    back, forth = walk(False), walk(True)
    # On a small hole both come to the same edges.
    again = (forth[:, :, None] == back[:, None]).any(axis=2)
    forth = np.where(again, -1, forth)
    ring = np.column_stack([back[:, ::-1], edges, forth])
    ring = np.take_along_axis(ring, np.argsort(ring < 0, axis=1, kind="stable"), axis=1)
    length = (ring >= 0).sum(axis=1) + 1
    points = np.zeros((len(edges), int(length.max()), 2))
    points[:, 0] = ends[ring[:, 0], 0]
    points[:, 1:] = ends[ring[:, : length.max() - 1], 1]
    points[np.arange(points.shape[1]) >= length[:, None]] = 0.0
    return points, length


@kernel(**_OPTIONS)
def _line(
    centre: Array, chain: Array, count: int, point: Array, direction: Array, sigma: float
) -> float:
    """∫ Φ over the part of a line to the left of a chain, lengths in cells."""
    root = math.sqrt(2.0) * sigma
    full = math.sqrt(2.0 * math.pi) * sigma
    # Foot of the bump's centre on the line, and the distance from it.
    foot = (centre[0] - point[0]) * direction[0] + (centre[1] - point[1]) * direction[1]
    away = (centre[0] - point[0]) * direction[1] - (centre[1] - point[1]) * direction[0]
    factor = math.exp(-0.5 * (away / sigma) ** 2)
    total, last, leaves, met = 0.0, -1e300, False, False
    # On which side of the line the chain's points are decides where it crosses: each point is
    # judged once, so that a line through a point is counted once. The outer edges go straight on.
    side = 0.0
    for k in range(count - 1):
        ex, ey = chain[k + 1, 0] - chain[k, 0], chain[k + 1, 1] - chain[k, 1]
        cross = direction[0] * ey - direction[1] * ex
        ax, ay = chain[k, 0] - point[0], chain[k, 1] - point[1]
        start = direction[0] * ay - direction[1] * ax
        if k == 0:
            side = -cross if cross != 0.0 else start
        after = direction[0] * (ay + ey) - direction[1] * (ax + ex)
        if k < count - 2:
            # As the next edge will compute it.
            bx, by = chain[k + 1, 0] - point[0], chain[k + 1, 1] - point[1]
            after = direction[0] * by - direction[1] * bx
        elif cross != 0.0:
            after = cross
        crossed = (side >= 0.0) != (after >= 0.0)
        side = after
        if not crossed or cross == 0.0:
            continue
        at = (ax * ey - ay * ex) / cross
        part = 0.5 * full * (1.0 + math.erf((at - foot) / root))
        out = cross > 0.0
        total += part if out else -part
        if at > last:
            last, leaves = at, out
        met = True
    if met:
        if not leaves:
            total += full
    else:
        # The whole line on one side: the left, where the nearest edge says so.
        best, inside = 1e300, False
        px, py = point[0] + foot * direction[0], point[1] + foot * direction[1]
        for k in range(count - 1):
            ex, ey = chain[k + 1, 0] - chain[k, 0], chain[k + 1, 1] - chain[k, 1]
            size = ex * ex + ey * ey
            bx, by = px - chain[k, 0], py - chain[k, 1]
            where = (bx * ex + by * ey) / size
            if k > 0:
                where = max(where, 0.0)
            if k < count - 2:
                where = min(where, 1.0)
            distance = (bx - where * ex) ** 2 + (by - where * ey) ** 2
            if distance < best:
                best, inside = distance, ex * by - ey * bx >= 0.0
        total = full if inside else 0.0
    return factor * total


@kernel(**_OPTIONS)
def _lack(
    centres: Array,
    chains: Array,
    counts: Indices,
    steps: Array,
    origin: float,
    share: Array,
    sigma: float,
    reach: float,
    fine: int,
) -> Array:
    """Thickness that lacks at every centre, cells."""
    result = np.zeros(len(centres))
    for e in range(len(centres)):
        centre, chain, count = centres[e], chains[e], counts[e]
        # True area under the bump, and the bump's integral along the edge, by fine lines across
        # the edge's own direction.
        middle = count // 2
        ex = chain[middle, 0] - chain[middle - 1, 0]
        ey = chain[middle, 1] - chain[middle - 1, 1]
        size = math.hypot(ex, ey)
        across = np.array([ey / size, -ex / size])
        point = np.empty(2)
        area = 0.0
        number = math.ceil(reach * fine)
        for k in range(-number, number):
            # Between the fine lines, so that none runs through a node.
            shift = (k + 0.5) / fine
            point[0] = centre[0] + shift * ex / size
            point[1] = centre[1] + shift * ey / size
            area += _line(centre, chain, count, point, across, sigma) / fine
        edge = math.sqrt(2.0 * math.pi) * sigma
        lack = 0.0
        for d in range(len(steps)):
            if share[e, d] == 0.0:
                continue
            length = math.hypot(steps[d, 0], steps[d, 1])
            direction = steps[d] / length
            # Lines of this direction lie 1/length apart; one runs through the origin.
            offset = (origin - centre[0]) * direction[1] - (origin - centre[1]) * direction[0]
            width = 1.0 / length
            low = math.floor((-reach - offset) / width)
            high = math.ceil((reach - offset) / width)
            found = 0.0
            for k in range(low, high + 1):
                shift = offset + k * width
                point[0] = centre[0] + shift * direction[1]
                point[1] = centre[1] - shift * direction[0]
                found += width * _line(centre, chain, count, point, direction, sigma)
            lack += share[e, d] * (area - found) / edge
        result[e] = lack
    return result
