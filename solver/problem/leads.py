"""Leads: small regions in which a current is given, or a potential, or both follow from a metal.

A lead outside the body feeds nothing, two that touch are one, and a current into particles whose
potential is prescribed is lost: none of these is what was meant, and each is refused by name.

A lead on metal has one potential V up to its rim, wherever the rim lies between particles. A bond
to one of its particles therefore ends at the rim, as bonds end at a surface (`solver.bonds.ended`)
whose nodes are held: of its length |ξ| what lies outside is ℓ, and its energy is

    ½ (ℓ/|ξ|) k g² α Δv²,  g = (V − φ)/ℓ      =  |ξ|/ℓ times   ½ k ((V − φ)/|ξ|)² α Δv².

So its strength has the factor |ξ|/ℓ, for any treatment of surfaces, and for leads whose V is as yet
unknown. A bond that passes through the metal carries nothing from end to end: each end has its
own part, to V, which is added to another of its bonds to the lead. The lattice is then the one
whose body has a hole with a held edge in the lead's place, to rounding. Held particles without this
act like a lead that is smaller by a share of the horizon.
"""

from __future__ import annotations

import numpy as np
import shapely
from scipy import ndimage

from ..arrays import Array, Indices, Mask
from ..bonds import Bonds
from ..bonds.ended import SHORTEST
from ..errors import NoOutlineError, SceneError
from ..geometry import Lattice, Region, Where, select
from ..material import Moduli
from .description import Description

# Share of a length within which two are equal.
_TIE = 1e-9
# Share of a lead's area that may lie outside the body: rounding, and chords of curved edges.
_OUTSIDE = 0.01


def check(scene: Description, lattice: Lattice, prescribed: Mask) -> None:
    """Refuse leads that cannot be what was meant.

    Parameters
    ----------
    scene : Description
    lattice : Lattice
    prescribed : ndarray of bool, shape (components, N)
        Unknowns with given values; those of floating leads are none.

    Raises
    ------
    SceneError
        If a lead lies outside the body or sticks out of it, touches another, or feeds a current
        into particles of a prescribed potential.
    """
    feeding = [load.electrode for load in scene.loads if load.electrode is not None]
    holding = [support.electrode for support in scene.supports if support.electrode is not None]
    if not feeding and not holding:
        return
    masks = [_inside(where, scene, lattice) for where in (*feeding, *holding)]
    for mask in masks[: len(feeding)]:
        if (mask & prescribed.all(axis=0)).any():
            raise SceneError(
                f"the lead about {_middle(lattice, mask)} feeds a current into particles whose "
                f"potential is prescribed: it would be lost"
            )
    for i, mask in enumerate(masks):
        for j, other in enumerate(masks[:i]):
            # A current into a lead of metal: one lead, said in two parts.
            if j < len(feeding) <= i and np.array_equal(mask, other):
                continue
            if (_beside(lattice, mask) & other).any():
                raise SceneError(
                    f"the leads about {_middle(lattice, other)} and {_middle(lattice, mask)} "
                    f"touch: they need a cell between them"
                )


def rimmed(scene: Description, bonds: Bonds, moduli: Moduli) -> Bonds:
    """Bonds that end at the rims of the leads on metal.

    The rim of a lead that is given by a condition is not known: that of its particles' cells
    stands for it, and `cautions` says so.

    Raises
    ------
    SceneError
        If the body has inclusions.
    """
    lattice = bonds.lattice
    for support in scene.supports:
        where = support.electrode
        if where is None:
            continue
        if scene.inclusions:
            raise SceneError(
                "leads on metal (Support.lead) are not known in a body with inclusions: their "
                "rims would meet other conductors"
            )
        inside, metal = select(lattice, where), _drawn(where, scene.spacing / 16)
        if metal is None:
            metal = _cells(lattice, inside)
        else:
            metal = shapely.transform(metal, lambda points: points - lattice.shift)
        bonds = _rimmed(bonds, moduli, inside, metal)
    return bonds


def cautions(scene: Description, lattice: Lattice) -> tuple[str, ...]:
    """Says which leads on metal have a rim that is known to half a cell only."""
    found = []
    for support in scene.supports:
        where = support.electrode
        if where is None or _drawn(where, scene.spacing) is not None:
            continue
        mask = select(lattice, where)
        across = np.sqrt(mask.sum())
        found.append(
            f"the lead about {_middle(lattice, mask)} is given by a condition, {across:.2g} cells "
            f"across: the edges of its cells stand for its rim, which is known to half a cell, "
            f"its size to {1 / across:.0%} (a Region says where it is)"
        )
    return tuple(found)


def _drawn(where: Where, step: float) -> shapely.Geometry | None:
    """A lead's outline in the user's coordinates, if it has one."""
    if not isinstance(where, Region):
        return None
    try:
        return where.outline(step)
    except NoOutlineError:
        return None


def _cells(lattice: Lattice, mask: Mask) -> shapely.Geometry:
    """The cells of some particles, in the (centred) lattice's coordinates."""
    # Corners are whole numbers of cells: those of neighbours are the same bits.
    corner = np.rint(lattice.points[mask] / lattice.spacing - 0.5)
    low, high = corner * lattice.spacing, (corner + 1) * lattice.spacing
    return shapely.union_all(shapely.box(*low.T, *high.T))


def _rimmed(bonds: Bonds, moduli: Moduli, inside: Mask, metal: shapely.Geometry) -> Bonds:
    """The same with the rim of one lead, of some particles and with an outline."""
    lattice, family = bonds.lattice, bonds.family
    half = family.size // 2
    shapely.prepare(metal)
    points, number = lattice.points, lattice.number()
    rows, columns = lattice.rows_columns
    reach = float(family.length.max()) * (1 + _TIE)
    near = np.nonzero(~inside & (shapely.distance(shapely.points(points), metal) <= reach))[0]
    if not len(near):
        return bonds
    shortest, tie = SHORTEST * lattice.spacing, _TIE * lattice.spacing
    there = np.stack([number[rows[near] + dy, columns[near] + dx] for dx, dy in family.offsets])
    exists = bonds.strengths_of(near) != 0
    to_metal = exists & inside[there]
    # What a whole bond conducts per volt, per volume of a particle.
    conductance = family.weight * moduli.stiffness[0] / family.length**2
    factors = np.ones(there.shape)
    extra: list[tuple[Indices, Array]] = []
    host = np.where(to_metal.any(axis=0), to_metal.argmax(axis=0), -1)
    hosted = np.zeros(lattice.count, dtype=bool)
    hosted[near[host >= 0]] = True
    for o in range(family.size):
        at = np.nonzero(exists[o])[0]
        start, end = points[near[at]], points[there[o, at]]
        outside = shapely.difference(shapely.linestrings(np.stack([start, end], axis=1)), metal)
        # The part that begins at the particle ends where the metal begins; where rounding says
        # that a bond to a particle on the rim does not meet it, there.
        met = shapely.intersection(shapely.linestrings(np.stack([start, end], axis=1)), metal)
        length = shapely.distance(shapely.points(start), met)
        length = np.maximum(np.where(np.isnan(length), family.length[o], length), shortest)
        ends = to_metal[o, at]
        factors[o, at[ends]] = family.length[o] / length[ends]
        lost = family.length[o] - shapely.length(outside)
        through = ~ends & (lost > tie) & hosted[near[at]] & hosted[there[o, at]]
        factors[o, at[through]] = 0.0
        part = conductance[o] * family.length[o] / length[through]
        extra.append((at[through], part))
    for at, part in extra:
        np.add.at(factors, (host[at], at), part / conductance[host[at]])
    # The metal's ends of the same bonds.
    column = np.full(lattice.count, -1)
    metal_side = np.unique(there[to_metal])
    both = np.concatenate([near, metal_side])
    column[both] = np.arange(len(both))
    whole = np.ones((family.size, len(both)))
    whole[:, : len(near)] = factors
    for o in range(family.size):
        at = np.nonzero(to_metal[o])[0]
        whole[(o + half) % family.size, column[there[o, at]]] = factors[o, at]
    order = np.argsort(both)
    return bonds.times(both[order], whole[:, order])


def _inside(where: Where, scene: Description, lattice: Lattice) -> Mask:
    """Particles of a lead, shape (N,)."""
    mask = select(lattice, where)
    if not mask.any():
        raise SceneError("a lead lies outside the body, or holds no particle of it")
    if isinstance(where, Region):
        try:
            body = scene.region.outline(scene.spacing / 16)
            drawn = where.outline(scene.spacing / 16)
        except SceneError:  # a region that knows no edge of its own
            return mask
        outside = drawn.difference(body).area
        if outside > _OUTSIDE * drawn.area:
            raise SceneError(
                f"{outside / drawn.area:.0%} of the lead about {_middle(lattice, mask)} lies "
                f"outside the body"
            )
    return mask


def _beside(lattice: Lattice, mask: Mask) -> Mask:
    """These particles and their neighbours, diagonal ones too, shape (N,)."""
    grid = np.zeros(lattice.shape, dtype=bool)
    grid[lattice.rows_columns] = mask
    return np.asarray(ndimage.binary_dilation(grid, np.ones((3, 3)))[lattice.rows_columns])


def _middle(lattice: Lattice, mask: Mask) -> str:
    x, y = lattice.middle(mask)
    return f"({x:.4g}, {y:.4g})"
