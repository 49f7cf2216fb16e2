"""The calibrated stiffness of a tip: made once for a solid, a family, a direction and a place."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from ..arrays import Array, Indices
from ..blas import one_thread
from ..material import ElasticModuli, Family, Influence, effective_tensor
from .patch import Patch, TipCalibrationError
from .update import best_forces, changed, stretch

# Weight of forces over the displacement's error, of 1e-2 … 1e-6 the largest from which on smaller
# ones gain little: the bonds' energies then change by factors of 0.5 to 1.8 along rows, and of 0.1
# to 4 wherever a tip may lie and point.
_MU = 1e-3
# Least and greatest change of energies that is let pass; beyond lies no calibration but a trick.
_LEAST, _MOST = 0.1, 10.0
# Share of a cell, and of a unit vector, within which tips are the same.
_SAME = 1e-7


@dataclass(frozen=True, eq=False)
class CalibratedTip:
    """What is added to the operator around a tip.

    Attributes
    ----------
    cells : ndarray of int, shape (t, 2)
        Columns and rows of its particles from the one in whose cell the tip lies.
    strengths, left : ndarray, shape (family size, t)
        Of their bonds, and what is left, in cells, of those that end at the crack, zero of others:
        a tip whose surroundings have others is another tip.
    matrix : ndarray, shape (components t, components t)
        Added stiffness, component by component, over the largest modulus and the spacing.
    stretch : pair of float
        Least and greatest factor by which the energy of a state of its bonds changes.
    """

    cells: Indices
    strengths: Array
    left: Array
    matrix: Array
    stretch: tuple[float, float]

    def inverted(self) -> CalibratedTip:
        """That of the tip on the other side of the origin, with the opposite direction."""
        count, half = len(self.cells), len(self.strengths) // 2
        # u(x) → −u(−x), θ(x) → θ(−x)
        sign = np.ones(len(self.matrix))
        sign[2 * count :] = -1.0
        return CalibratedTip(
            -self.cells,
            np.roll(self.strengths, half, axis=0),
            np.roll(self.left, half, axis=0),
            sign[:, None] * self.matrix * sign,
            self.stretch,
        )


def calibrated_tip(
    family: Family, moduli: ElasticModuli, place: Array, direction: Array
) -> tuple[CalibratedTip, Array]:
    """The calibrated tip of a crack, and its matrix in a body.

    Parameters
    ----------
    family : Family
    moduli : ElasticModuli
    place : ndarray, shape (2,)
        The tip, in cells from the centre of the particle in whose cell it lies.
    direction : ndarray, shape (2,)
        Unit vector in which the crack would advance along itself.

    Returns
    -------
    CalibratedTip, ndarray of shape (components t, components t)

    Raises
    ------
    TipCalibrationError
        If no positive change serves.
    """
    spacing, largest = family.spacing, float(np.abs(moduli.stiffness).max())
    over = bool(direction[1] < -_SAME or (abs(direction[1]) <= _SAME and direction[0] < 0))
    sign = -1.0 if over else 1.0
    digits = int(-np.log10(_SAME))
    there = sign * np.asarray(place)
    # A tip on a border lies in the cell below it, and to its left, whichever way it points.
    shift = np.where(there < _SAME - 0.5, 1, 0)
    found = _calibrated(
        (family.m, family.area_rule, family.influence),
        tuple((moduli.normal / largest).round(12)),
        tuple((moduli.shear / largest).round(12)),
        (*(there + shift).round(digits), *(sign * np.asarray(direction)).round(digits + 2)),
    )
    if isinstance(found, str):
        raise TipCalibrationError(found)
    tip = replace(found, cells=found.cells - shift)
    if over:
        tip = tip.inverted()
    return tip, tip.matrix * (largest * spacing)


@lru_cache(maxsize=128)
def _calibrated(
    of_family: tuple[float, Any, Influence],
    normal: tuple[float, ...],
    shear: tuple[float, ...],
    where: tuple[float, ...],
) -> CalibratedTip | str:
    """For a spacing and a largest modulus of one; or why there is none, which takes as long."""
    m, area_rule, influence = of_family
    family = Family(m, 1.0, area_rule, influence)
    moduli = ElasticModuli(np.array(normal), np.array(shear))
    place, direction = np.array(where[:2]), np.array(where[2:])
    with one_thread():
        direction /= np.hypot(*direction)
        along = np.linalg.solve(
            effective_tensor(family, moduli), moduli.uniaxial(direction[None])[0]
        )
        try:
            return _of(Patch.of(family, moduli, place, direction), place, along)
        except TipCalibrationError as error:
            return str(error)


def _of(patch: Patch, place: Array, along: Array) -> CalibratedTip:
    """`along` is the strain (Voigt) of a stress along the crack."""
    c, count, _ = patch.plain.shape
    size = len(patch.bonds)

    def at_tip(values: Array) -> Array:
        return values[:, patch.at].reshape(size, -1)

    plain, response = at_tip(patch.plain), at_tip(patch.moved)
    still = homogeneous(patch.cells - place, along, c)
    forces = best_forces(
        patch.moved[:2].reshape(2 * count, size),
        (patch.plain - patch.exact)[:2].reshape(2 * count, 2),
        plain,
        patch.bonds,
        still,
        _MU,
    )
    if forces is None:
        raise TipCalibrationError("the bonds around it store negative energy")
    states = np.column_stack([plain - response @ forces, still])
    change = changed(patch.bonds, states, np.pad(forces, ((0, 0), (0, still.shape[1]))))
    if change is None:
        raise TipCalibrationError(
            "no positive change of its bonds answers its fields, as where a particle lies close to "
            "the crack"
        )
    low, high = stretch(patch.bonds, change)
    if low < _LEAST or high > _MOST:
        raise TipCalibrationError(
            f"its bonds' energies would have to change by factors of {low:.2g} to {high:.2g}"
        )
    return CalibratedTip(patch.cells, patch.strengths, patch.left, change, (low, high))


def homogeneous(away: Array, strain: Array, components: int) -> Array:
    """A uniform strain (Voigt) as a state of particles, shape (components t, 1)."""
    found = np.zeros((components, len(away)))
    x, y = away.T
    e11, e22, shear = strain
    found[0], found[1] = e11 * x + 0.5 * shear * y, 0.5 * shear * x + e22 * y
    return found.reshape(-1, 1)
