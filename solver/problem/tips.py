"""Tips of a scene's cracks that are calibrated, and those that cannot be.

A tip is calibrated (`solver.tips`) if what lies around it is what it was calibrated for: every
particle of it is free, and has the bonds that it would have at the end of a straight crack in an
endless body. So edges, held particles, other cracks and kinks nearer than some nine cells (at
m = 5) leave it as it is drawn, which is told in the result.
"""

from __future__ import annotations

from typing import Any, Literal, Protocol, get_args

import numpy as np

from ..arrays import Array, Mask
from ..errors import SceneError
from ..geometry.exact import CELL
from ..material import ElasticModuli, Stability
from ..operators import BondOperator, TipStiffness
from ..tips import SIZE, TipCalibrationError, calibrated_tip

Tip = Literal["drawn", "calibrated"]

# Cells from a tip within which no particle may lie on the crack.
_ON = 1e-5


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
    bonds, moduli = operator.bonds, operator.moduli
    if type(moduli) is not ElasticModuli:
        raise SceneError(
            "tips of cracks are calibrated (tip='calibrated') in Cauchy solids, neither polar nor "
            "chiral ones"
        )
    lattice, cracks = bonds.lattice, bonds.cracks
    number = lattice.number()
    taken: Mask = np.asarray(prescribed.any(axis=0))
    found: list[TipStiffness] = []
    told: list[str] = []
    for piece, end in zip(*np.nonzero(cracks.tips), strict=True):
        tip, other = cracks.pieces[piece, end], cracks.pieces[piece, 1 - end]
        direction = (tip - other) / np.hypot(*(tip - other))
        base = np.rint(tip / CELL)
        place = tip / CELL - base
        x, y = cracks.frame.metres(tip[None])[0] + lattice.shift
        why = None
        if _on_crack(place, direction):
            why = "it runs through particles"
        else:
            try:
                known, matrix = calibrated_tip(bonds.family, moduli, place, direction)
            except TipCalibrationError as error:
                why = str(error)
        if why is None:
            column, row = (known.cells + base.astype(np.int64)).T
            inside = (column >= 0) & (row >= 0)
            inside &= (row < number.shape[0]) & (column < number.shape[1])
            at = np.where(inside, number[row * inside, column * inside], -1)
            if (at < 0).any() or taken[at].any():
                why = "an edge, a held particle or another tip is within its reach"
            elif not np.array_equal(bonds.strengths_of(at), known.strengths):
                why = "an edge, a bend or another crack is within a horizon of its reach"
        if why is not None:
            told.append(f"the crack's tip at ({x:.4g}, {y:.4g}) is not calibrated: {why}")
            continue
        taken = taken.copy()
        taken[at] = True
        order = np.argsort(at)
        count = len(at)
        where = (np.arange(moduli.components)[:, None] * count + order).ravel()
        found.append(TipStiffness(at[order], matrix[np.ix_(where, where)]))
    operator.calibrate_tips(found)
    return tuple(told)


def _on_crack(place: Array, direction: Array) -> bool:
    """Whether a particle within reach lies on a crack with this tip."""
    cells = np.indices((13, 13)).reshape(2, -1).T - 6 - place
    behind = cells @ direction
    beside = cells @ np.array([-direction[1], direction[0]])
    near = np.hypot(*cells.T) <= SIZE
    return bool((near & (behind <= _ON) & (np.abs(beside) <= _ON)).any())
