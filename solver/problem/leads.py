"""Leads: small regions in which a current is given, or a potential, or both follow from a metal.

A lead outside the body feeds nothing, two that touch are one, and a current into particles whose
potential is prescribed is lost: none of these is what was meant, and each is refused by name.
"""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from ..arrays import Mask
from ..errors import SceneError
from ..geometry import Lattice, Region, Where, select
from .description import Description

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
    x, y = lattice.places[mask].mean(axis=0)
    return f"({x:.4g}, {y:.4g})"
