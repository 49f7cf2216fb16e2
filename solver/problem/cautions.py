"""What a scene asks that the model answers less well than it seems: sentences for its result.

Nothing here changes a solution. Each sentence says what is meant, where, and by how much. Results
carry them (`warnings`); the logger ``solver`` is told too, at level INFO, for who runs many scenes
and keeps no result.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np
import shapely
from scipy import ndimage

from ..arrays import Array, Mask
from ..bonds import Bonds, Surface
from ..bonds.ended import SHORTEST
from ..errors import SceneError
from ..geometry import Crack, Lattice
from ..geometry.outline import INNER
from ..material import Moduli

# Part of a cell that is left over and nobody sees.
_WHOLE = 1e-3
# Share of a body's area by which its cells may differ from it.
_AREA = 0.01
# Share of the largest opening or slip of a crack below which an overlap is an error of the lattice,
# and of the strain between neighbours.
_OVERLAP, _STRAINED = 0.02, 0.05
# Share of the particles whose bonds end at edges that lie on one if a row of them does.
_IN_ROWS = 0.1
# Share of the bonds that may be missing without a word.
_MISSING = 0.03
# Share of what acts that a particle held by itself may carry without a word.
_CARRIES = 1e-3
# What thin members come to (m = 5, two cells thick, measured in bending).
_THIN: dict[str, str] = {"extrapolated": "-17 %", "volume": "+25 %", "none": "+156 %"}

_LOGGER = logging.getLogger("solver")


def told(sentences: tuple[str, ...]) -> tuple[str, ...]:
    """The same sentences, told to whoever listens."""
    for sentence in sentences:
        _LOGGER.info("%s", sentence)
    return sentences


def left_over(lattice: Lattice, surface: Surface) -> tuple[str, ...]:
    """Says so if the body is not a whole number of cells."""
    spacing = lattice.spacing
    x0, y0, x1, y1 = lattice.region.bounds
    across = np.array([x1 - x0, y1 - y0]) / spacing
    straight = lattice.straight
    odd = [
        bool(all(straight[2 * k : 2 * k + 2]) and abs(across[k] - np.rint(across[k])) > _WHOLE)
        for k in (0, 1)
    ]
    try:
        area = lattice.region.outline(spacing / 16).area / spacing**2
    except SceneError:
        return ()
    off = lattice.count / area - 1.0
    drawn = f"{across[0]:.5g} × {across[1]:.5g} cells"
    if surface == "extrapolated":
        if not any(odd):
            return ()
        return (
            f"the body is {drawn}, not a whole number of them: its particles stand for "
            f"{off:+.2%} of its area; bonds end, and loads act, where its edges are",
        )
    if not any(odd) and abs(off) <= _AREA:
        return ()
    return (
        f"the body is {drawn}, and is solved as whole ones, {off:+.2%} of its area: "
        f"surface={surface!r} lets it end with its outermost cells",
    )


def on_edges(bonds: Bonds) -> tuple[str, ...]:
    """Says so if particles lie on an interface or in rows on edges, where bonds have no length.

    Round and oblique edges run close to one particle in so many: their places average out. Of a
    row along an edge all err to the same side.
    """
    ended = bonds.ended
    if ended is None:
        return ()
    short = ended.length < SHORTEST * bonds.lattice.spacing
    inner = ended.outline.face[ended.edge] == INNER
    found: list[str] = []
    for where, what, least in (
        (inner, "an interface between two materials", 0.0),
        (ended.outline.face[ended.edge] == 0, "an edge of the body", _IN_ROWS),
    ):
        count = len(np.unique(ended.particle[where & short]))
        if count and count > least * len(np.unique(ended.particle[where])):
            found.append(
                f"{count} particles lie on {what}, or within {SHORTEST:g} cells of it: it seems up "
                f"to that much farther out than it is (shift the lattice with the scene's phase, "
                f"or the spacing)"
            )
    return tuple(found)


def missing_bonds(bonds: Bonds, held: Mask, damaged: bool) -> tuple[str, ...]:
    """Says how much is missing at free edges and cracks that no treatment makes up for in full.

    A skin of one horizon is softer than the solid. What of a body's energy is missing was measured
    as 0.6 to 1.25 times the missing share of its bonds, on plates whole, slotted, cracked and
    holed, of 20 to 80 cells with m = 3 and 5. The volume method stiffens what is left along edges
    as across them: bars, holed plates and cantilevers of 10 to 40 cells came out stiffer by 0.05 to
    0.85 times the share, with an edge crack softer by 0.5 to 1.3 times it.

    Parameters
    ----------
    held : ndarray of bool, shape (N,)
    damaged : bool
        Whether single bonds are broken: those are missing on purpose.
    """
    if bonds.treatment == "extrapolated" or held.all():
        return ()
    weight = bonds.family.weight
    missing = np.zeros(bonds.lattice.count)
    # Of held ones nothing counts, and where a layer is held those are nearly all.
    short = bonds.short[~held[bonds.short]]
    missing[short] = weight @ ~bonds.exist(short)
    if not damaged:
        cut = bonds.exist(bonds.special) & (bonds.strengths == 0.0)
        missing[bonds.special] += weight @ cut
        if bonds.ended is not None:
            # Those that end at an interface are there.
            np.subtract.at(missing, bonds.ended.particle, weight[bonds.ended.offset])
    share = missing[~held].sum() / (weight.sum() * (~held).sum())
    if share <= _MISSING:
        return ()
    if bonds.treatment == "volume":
        return (
            f"{share:.1%} of the bonds of free particles are missing at edges and cracks, and "
            f"surface='volume' makes up for them in the mean alone: bodies came out stiffer by up "
            f"to 0.85 times that share, cracked ones softer by up to 1.3 times it (measured); it "
            f"falls like the horizon over the body's size; 'extrapolated' ends bonds at edges",
        )
    return (
        f"surface='none' leaves out {share:.1%} of the bonds of free particles, at edges and "
        f"cracks: the body carries less by about that share (0.6 to 1.25 times it, measured); it "
        f"falls like the horizon over the body's size; 'volume' and 'extrapolated' make up for it",
    )


def chiral_edges(bonds: Bonds, moduli: Moduli, held: Mask) -> tuple[str, ...]:
    """Says so if edges cut families of a chiral solid whose single bonds may give energy away.

    The family as a whole stores energy where its parts need not: what is left of it at an edge may
    be soft or unstable. Measured on a small orthotropic plate with turns of 0.3: displacements
    ten times too large with ``none``, and up to three times with ``volume``.
    """
    chiral = "s+γ" in moduli.strains and not moduli.non_negative
    if not chiral or bonds.treatment == "extrapolated" or held[bonds.short].all():
        return ()
    return (
        f"single bonds of this chiral solid store negative energy: at free edges and "
        f"surface={bonds.treatment!r} displacements may be several times too large; bonds that end "
        f"there (surface='extrapolated') keep families whole",
    )


def thin_layers(lattice: Lattice, prescribed: Mask, m: float) -> tuple[str, ...]:
    """Says so if prescribed particles lie less than a horizon deep.

    A particle by itself is a point and no layer (`points_held`).

    Parameters
    ----------
    prescribed : ndarray of bool, shape (N,)
        Particles of which something is prescribed that the horizon has to reach through.
    """
    if not prescribed.any() or prescribed.all():
        return ()
    grid, free = np.zeros((2, *lattice.shape), dtype=bool)
    grid[lattice.mask], free[lattice.mask] = prescribed, ~prescribed
    deep = ndimage.distance_transform_edt(~free)
    labels, count = ndimage.label(grid, structure=np.ones((3, 3)))
    depth = ndimage.maximum(deep, labels, np.arange(1, count + 1))
    several = np.bincount(labels[lattice.mask], minlength=count + 1)[1:] > 1
    thin = np.nonzero((depth < np.floor(m) - 1e-9) & several)[0]
    if not len(thin):
        return ()
    worst = thin[np.argmin(depth[thin])]
    x, y = lattice.middle((labels == worst + 1)[lattice.mask])
    more = f" (and in {len(thin) - 1} other places)" if len(thin) > 1 else ""
    return (
        f"what is prescribed about ({x:.4g}, {y:.4g}){more} lies {depth[worst]:.2g} cell(s) deep, "
        f"less than the horizon of {m:g}: bonds of free particles reach past it, and it holds "
        f"them less firmly than a boundary",
    )


def alone(lattice: Lattice, prescribed: Mask) -> Mask:
    """Those of some particles, shape (N,), that have none of the others beside them."""
    grid = np.zeros(lattice.shape, dtype=np.int8)
    grid[lattice.mask] = prescribed
    beside = ndimage.convolve(grid, np.ones((3, 3), dtype=np.int8), mode="constant")
    return np.asarray(prescribed & (beside[lattice.mask] == 1))


def points_held(
    lattice: Lattice, single: Mask, exerted: Array, loads: Sequence[Array]
) -> tuple[str, ...]:
    """Says so if a particle that is held by itself carries anything to speak of.

    Holding a body that is in equilibrium by itself it carries nothing, and is no fault.

    Parameters
    ----------
    single : ndarray of bool, shape (N,)
        See `alone`.
    exerted : ndarray, shape (components, N)
        What supports exert on each; forces alone, no couples.
    loads : sequence of ndarray, shape (components, n)
        All that acts.
    """
    size = np.linalg.norm(np.nan_to_num(exerted), axis=0)
    acting = sum(float(np.linalg.norm(load, axis=0).sum()) for load in loads)
    whole = max(0.5 * (size.sum() + acting), np.finfo(np.float64).tiny)
    worst = int(np.argmax(np.where(single, size, -1.0)))
    if size[worst] <= _CARRIES * whole:
        return ()
    x, y = lattice.places[worst]
    count = int((single & (size > _CARRIES * whole)).sum())
    more = f" (and {count - 1} others)" if count > 1 else ""
    return (
        f"the single particle held at ({x:.4g}, {y:.4g}){more} carries {size[worst] / whole:.2g} "
        f"of what acts: at a point its field grows without bound as the spacing falls, so that "
        f"the answer near it, and what it holds back, depend on the spacing",
    )


def thin_members(lattice: Lattice, m: float, surface: Surface) -> tuple[str, ...]:
    """Says so if parts of the body are thinner than two horizons."""
    mask = lattice.mask
    thin = _thin(mask, m)
    if not thin.any():
        return ()
    cells = tuple(int(np.ptp(np.nonzero(mask.any(axis=axis))[0])) + 1 for axis in (0, 1))
    if m >= max(cells):
        return (
            f"the horizon of {m:g} cells is longer than the body, {cells[0]} × {cells[1]} cells: "
            f"no particle has even a third of its family, and the answer is all surface "
            f"(surface={surface!r}); take m well below {min(cells)}, or a smaller spacing",
        )
    # As thick as the disc that still passes; far from thin parts nothing tells.
    rows, columns = np.nonzero(thin)
    reach = int(3 * m) + 2
    near = tuple(slice(max(0, i.min() - reach), i.max() + reach + 1) for i in (rows, columns))
    across, least = int(np.ceil(2 * m)) - 1, thin[near]
    while across > 1 and (left := _thin(mask[near], 0.5 * across) & thin[near]).any():
        across, least = across - 1, left
    labels, _ = ndimage.label(thin, structure=np.ones((3, 3)))
    x, y = lattice.middle((labels == labels[near][least].min())[lattice.mask])
    plural = "cell" if across == 1 else "cells"
    return (
        f"a member about ({x:.4g}, {y:.4g}) is {across} {plural} thick, less than two "
        f"horizons ({2 * m:g}): its stiffness is off (two cells thick by {_THIN[surface]} in "
        f"bending with surface={surface!r}); take a smaller spacing or horizon",
    )


def _thin(mask: Mask, m: float) -> Mask:
    """Parts of a body, but its corners, that discs of one horizon do not fill."""
    core = _core(mask, m)
    if not core.any():
        return mask.copy()
    away = ndimage.distance_transform_edt(~core)
    # A corner of 60° is two horizons away from what a disc of one horizon fills.
    thin = mask & (away > 2.0 * m)
    return np.asarray(thin | _necks(mask & (away >= m), mask & (away < m)))


def _core(mask: Mask, m: float) -> Mask:
    """Cells in or beside which a disc of one horizon fits.

    Its centre is that of a cell, a half nearer to the edge than to the next empty cell's centre, or
    a corner of four: a member of five cells is told from one of six.
    """
    core = np.asarray(ndimage.distance_transform_edt(mask) - 0.5 >= m - 1e-9)
    corner = mask[:-1, :-1] & mask[1:, :-1] & mask[:-1, 1:] & mask[1:, 1:]
    middle = ndimage.distance_transform_edt(corner) >= m - 1e-9
    rows, columns = mask.shape
    for j in (0, 1):
        for i in (0, 1):
            core[j : rows - 1 + j, i : columns - 1 + i] |= middle
    return core


def _necks(left: Mask, filled: Mask) -> Mask:
    """What discs of one horizon do not fill, and what they fill meets on more than one side.

    A corner meets it on one side; a neck, however short, on two, and so does the ligament between
    a hole and an edge.
    """
    around = np.ones((3, 3), dtype=bool)
    labels, _ = ndimage.label(left, structure=around)
    found = np.zeros_like(left)
    for number, window in enumerate(ndimage.find_objects(labels), 1):
        rows, columns = (slice(max(0, part.start - 1), part.stop + 1) for part in window)
        mine = labels[rows, columns] == number
        beside = ndimage.binary_dilation(mine, around) & filled[rows, columns]
        _, sides = ndimage.label(beside, structure=around)
        if sides > 1:
            found[rows, columns] |= mine
    return found


def overlaps(bonds: Bonds, cracks: Sequence[Crack], displacement: Array) -> tuple[str, ...]:
    """Says so if the faces of a crack have moved into each other.

    What the faces have moved apart is the difference between the nearest particles on both sides,
    less what the solid between them is strained by, as that on either side.

    Parameters
    ----------
    cracks : sequence of Crack
        In the coordinates of the bonds' lattice.
    displacement : ndarray, shape (2, N), m
    """
    lattice = bonds.lattice
    if not len(bonds.special) or not cracks:
        return ()
    number, points = lattice.number(), lattice.points
    rows, columns = lattice.rows_columns
    ends = np.concatenate([np.array(crack.segments) for crack in cracks])
    owner = np.repeat(np.arange(len(cracks)), [len(crack.segments) for crack in cracks])
    tree = shapely.STRtree(shapely.linestrings(ends))
    u = np.nan_to_num(displacement)
    closed, where, whose, size, strained = [], [], [], 0.0, 0.0
    half = bonds.family.size // 2
    for o, (dx, dy) in enumerate(bonds.family.offsets[:half]):
        if abs(dx) + abs(dy) != 1:
            continue
        p = bonds.special[bonds.strengths[o] == 0]
        q = number[rows[p] + dy, columns[p] + dx]
        p, q = p[q >= 0], q[q >= 0]
        lines = shapely.linestrings(np.stack([points[p], points[q]], axis=1))
        pair, piece = tree.query(lines, predicate="intersects")
        p, q = p[pair], q[pair]
        # The solid on either side, one particle further.
        before, after = (
            number[rows[r] + sign * dy, columns[r] + sign * dx] for r, sign in ((p, -1), (q, 1))
        )
        strain = 0.5 * np.where(before >= 0, u[:, p] - u[:, before], 0.0)
        strain = strain + 0.5 * np.where(after >= 0, u[:, after] - u[:, q], 0.0)
        apart = u[:, q] - u[:, p] - strain
        along = ends[piece, 1] - ends[piece, 0]
        normal = np.array([-along[:, 1], along[:, 0]]) / np.hypot(*along.T)
        normal *= np.sign(normal[0] * dx + normal[1] * dy)
        closed.append(-(normal * apart).sum(axis=0))
        where.append(0.5 * (points[p] + points[q]))
        whose.append(owner[piece])
        size = max(size, float(np.abs(apart).max(initial=0.0)))
        strained = max(strained, float(np.abs(strain).max(initial=0.0)))
    if not closed:
        return ()
    overlap, place, crack = (np.concatenate(part) for part in (closed, where, whose))
    bad = overlap > max(_OVERLAP * size, _STRAINED * strained)
    said = []
    for k in np.unique(crack[bad]):
        mine = bad & (crack == k)
        worst = np.nonzero(mine)[0][np.argmax(overlap[mine])]
        x, y = place[worst] + lattice.shift
        said.append(
            f"the faces of the crack through {cracks[k].drawn} overlap by up to "
            f"{overlap[worst]:.3g} m ({overlap[worst] / lattice.spacing:.2g} cells) at "
            f"({x:.4g}, {y:.4g}), on {mine.sum() / (crack == k).sum():.0%} of it: faces do not "
            f"touch in this model, a crack that closes would carry pressure"
        )
    return tuple(said)
