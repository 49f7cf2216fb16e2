"""Tips of a scene's cracks that are calibrated, and those that cannot be.

A tip is calibrated (`solver.tips`) if what lies around it is what it was calibrated for: every
particle of it is free, and has the bonds that it would have at the end of a straight crack in an
endless body. So edges, held particles, other cracks and kinks nearer than some nine cells (at
m = 5) leave it as it is drawn, which is told in the result.
"""

from __future__ import annotations

from typing import Any, Literal, Protocol, get_args

import numpy as np

from ..arrays import Array, Indices, Mask
from ..errors import SceneError
from ..geometry.exact import CELL
from ..material import ElasticModuli, Stability
from ..operators import BondOperator, TipStiffness
from ..tips import SIZE, TipCalibrationError, calibrated_tip

Tip = Literal["drawn", "calibrated"]

# Cells from a tip within which no particle may lie on the crack.
_ON = 1e-5
# Cells by which what is left of bonds that end may differ between tips that are alike.
_LEFT = 1e-3


class Tipped(Protocol):
    """What of a scene is asked here."""

    @property
    def tip(self) -> Tip: ...
    @property
    def surface(self) -> str: ...
    @property
    def physics(self) -> Any: ...
    @property
    def cracks(self) -> Any: ...
    @property
    def loads(self) -> Any: ...
    @property
    def inclusions(self) -> Any: ...
    @property
    def thickness(self) -> Any: ...
    @property
    def factors(self) -> Any: ...
    @property
    def broken(self) -> Any: ...


def check_tip(scene: Tipped) -> None:
    """Refuse what tips cannot be calibrated in.

    Raises
    ------
    SceneError
    """
    if scene.tip not in get_args(Tip):
        raise SceneError(f"tip must be 'drawn' or 'calibrated', not {scene.tip!r}")
    if scene.tip == "drawn":
        return
    named = (
        (scene.physics.name != "elasticity", "elastic bodies only"),
        (not scene.cracks, "bodies with cracks: the scene has none"),
        (
            scene.surface != "extrapolated",
            "surface='extrapolated' only: with other treatments the faces err by more than the tip",
        ),
        (bool(scene.inclusions), "bodies of one solid only, not those with inclusions"),
        (callable(scene.thickness), "bodies of one thickness only"),
        (scene.factors is not None, "sound bonds only, not those with factors of their own"),
        (scene.broken is not None, "sound bonds only, not bodies with broken ones"),
        (
            any(load.strain is not None for load in scene.loads),
            "bodies that no temperature strains",
        ),
    )
    for refused, what in named:
        if refused:
            raise SceneError(f"tips of cracks are calibrated (tip='calibrated') in {what}")


def require_static(
    scene: Tipped, sharp_tips: bool, constrained: bool, stability: Stability
) -> None:
    """Refuse calibrated tips where cracks grow, where bodies move, and in unstable bonds.

    Raises
    ------
    SceneError
    """
    if scene.tip == "drawn":
        return
    if not sharp_tips:
        raise SceneError(
            "a calibrated tip stays where it is: with fracture, whose cracks grow, use tip='drawn'"
        )
    if not constrained:
        raise SceneError("calibrated tips (tip='calibrated') are known to statics only")
    if stability.kind == "indefinite":
        raise SceneError(
            "tips of cracks are calibrated (tip='calibrated') in solids whose shear bonds are not "
            "negative: this one has C66 < C12"
        )


def calibrate(scene: Tipped, operator: BondOperator, prescribed: Mask) -> tuple[str, ...]:
    """Add to the operator what calibrated tips do; returns which are left and why, a line each."""
    if scene.tip == "drawn":
        return ()
    bonds = operator.bonds
    if type(operator.moduli) is not ElasticModuli:
        raise SceneError(
            "tips of cracks are calibrated (tip='calibrated') in Cauchy solids, neither polar nor "
            "chiral ones"
        )
    lattice, cracks = bonds.lattice, bonds.cracks
    number = lattice.number()
    held: Mask = np.asarray(prescribed.any(axis=0))
    found: list[TipStiffness | str] = []
    places: list[tuple[float, float]] = []
    for piece, end in zip(*np.nonzero(cracks.tips), strict=True):
        tip, other = cracks.pieces[piece, end], cracks.pieces[piece, 1 - end]
        direction = (tip - other) / np.hypot(*(tip - other))
        base = np.rint(tip / CELL)
        x, y = cracks.frame.metres(tip[None])[0] + lattice.shift
        places.append((x, y))
        found.append(_calibrated(operator, number, held, base, tip / CELL - base, direction))
    # Tips that share particles are both left: which came first is no matter of the body's.
    known = [tip for tip in found if isinstance(tip, TipStiffness)]
    shared = np.bincount(np.concatenate([[0], *(tip.particles for tip in known)])[1:])
    used: list[TipStiffness] = []
    told: list[str] = []
    for (x, y), made in zip(places, found, strict=True):
        why = made if isinstance(made, str) else "another tip is within its reach"
        if isinstance(made, TipStiffness) and (shared[made.particles] == 1).all():
            used.append(made)
        else:
            told.append(f"the crack's tip at ({x:.4g}, {y:.4g}) is not calibrated: {why}")
    operator.calibrate_tips(used)
    return tuple(told)


def loaded(operator: BondOperator, load: Array) -> tuple[str, ...]:
    """Says so if loads act on particles around calibrated tips, whose fields know none.

    Parameters
    ----------
    load : (components, N) array
        What acts on particles.
    """
    count = sum(bool(load[:, tip.particles].any()) for tip in operator.tips)
    if not count:
        return ()
    return (
        f"loads act on particles around {count} calibrated tip(s): what was calibrated are a tip's "
        f"fields without loads; a force that is spread over the body matters little there, one at "
        f"the tip does",
    )


def _calibrated(
    operator: BondOperator,
    number: Indices,
    held: Mask,
    base: Array,
    place: Array,
    direction: Array,
) -> TipStiffness | str:
    """What is added at a tip in the cell `base`, or why nothing is."""
    bonds, moduli = operator.bonds, operator.moduli
    if _on_crack(place, direction, bonds.family.reach):
        return "it runs through particles"
    assert type(moduli) is ElasticModuli
    try:
        known, matrix = calibrated_tip(bonds.family, moduli, place, direction)
    except TipCalibrationError as error:
        return str(error)
    column, row = (known.cells + base.astype(np.int64)).T
    inside = (column >= 0) & (row >= 0)
    inside &= (row < number.shape[0]) & (column < number.shape[1])
    at = np.where(inside, number[row * inside, column * inside], -1)
    if (at < 0).any() or held[at].any():
        return "an edge or a held particle is within its reach"
    left = bonds.lengths_left(at) / bonds.family.spacing
    same = np.array_equal(bonds.strengths_of(at), known.strengths)
    # Cut by the same bonds is not alike: what they end at may be another crack, or bent.
    if not same or np.abs(left - known.left).max() > _LEFT:
        return "an edge, a bend or another crack is within a horizon of its reach"
    order = np.argsort(at)
    where = (np.arange(moduli.components)[:, None] * len(at) + order).ravel()
    return TipStiffness(at[order], matrix[np.ix_(where, where)])


def _on_crack(place: Array, direction: Array, reach: int) -> bool:
    """Whether a particle within reach, or at the end of its bonds, lies on a crack with this tip.

    Such a particle belongs to one face by a rule: tips that are each other's images would differ.
    """
    most = SIZE + reach
    away = int(np.ceil(most)) + 1
    cells = np.indices((2 * away + 1,) * 2).reshape(2, -1).T - away - place
    behind = cells @ direction
    beside = cells @ np.array([-direction[1], direction[0]])
    near = np.hypot(*cells.T) <= most
    return bool((near & (behind <= _ON) & (np.abs(beside) <= _ON)).any())
