"""A patch around a tip: a disc of the lattice with the end of a straight crack in its middle.

Lengths are in cells and moduli in units of the largest, k: blocks of the operator are then those
of the body over k Δx, and the patch is the same at every spacing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from .. import threads
from ..arrays import Array, Indices
from ..bonds import Bonds
from ..geometry import Crack, Lattice, disc
from ..material import Family, Moduli, effective_tensor
from ..operators import BondOperator
from ..operators.assembled import to_csr
from .field import TipField

#: Cells within which the stiffness around a tip is changed.
SIZE = 4.0
# Cells from the tip to the layer in which its field is prescribed.
_FREE = 12.0


class TipCalibrationError(ValueError):
    """No positive change of the bonds around a tip was found."""


@dataclass(frozen=True, eq=False)
class Patch:
    """The discrete problem of both modes around a tip.

    Attributes
    ----------
    cells : ndarray of int, shape (t, 2)
        Columns and rows of the tip's particles from the one in whose cell the tip lies.
    strengths, left : ndarray, shape (family size, t)
        Of their bonds, and what is left of those that end at the crack, zero of others.
    plain, exact : ndarray, shape (components, N, 2)
        Computed and exact values of all free particles, by mode.
    moved : ndarray, shape (components, N, d)
        Values for unit forces at the tip's unknowns, component by component, d = components t.
    at : ndarray of int, shape (t,)
        The tip's particles among the N.
    bonds : ndarray, shape (d, d)
        What whole bonds among the tip's particles add to the operator.
    """

    cells: Indices
    strengths: Array
    left: Array
    plain: Array
    exact: Array
    moved: Array
    at: Indices
    bonds: Array

    @classmethod
    def of(cls, family: Family, moduli: Moduli, place: Array, direction: Array) -> Patch:
        """The patch of one tip.

        Parameters
        ----------
        family, moduli
            For a spacing of one.
        place : ndarray, shape (2,)
            The tip, in cells from the centre of the particle in whose cell it lies.
        direction : ndarray, shape (2,)
            Unit vector in which the crack would advance.
        """
        layer = family.reach + 0.5
        radius = _FREE + layer
        # Centres of particles are half-integer.
        tip = 0.5 + np.asarray(place)
        lattice = Lattice(
            disc(radius, (float(tip[0]), float(tip[1]))), 1.0, family.reach, (0.0, 0.0)
        )
        near = lattice.centred
        tip = tip - (np.asarray(near.shift) - np.asarray(lattice.shift))
        away = near.points - tip
        held = np.hypot(*away.T) > radius - layer
        mouth = tip - 2.0 * radius * direction
        crack = Crack((float(mouth[0]), float(mouth[1])), (float(tip[0]), float(tip[1])))
        bonds = Bonds(near, family, [crack], "extrapolated", held)
        c = moduli.components
        operator = BondOperator(bonds, moduli, np.tile(held, (c, 1)))
        displacement, rotation = TipField(effective_tensor(family, moduli), direction)(away)
        # Rotations times the spacing, which is one.
        field = np.concatenate([displacement, rotation[:, None]], axis=1)[:, :c]
        active = operator.active
        size = np.linalg.norm(field[:, :2, active], axis=(1, 2))
        field /= size[:, None, None]
        given = np.where(held, field, 0.0)
        with threads.suited(operator):
            loads = np.stack([-operator.coupling(values).ravel() for values in given], axis=1)
        at = np.nonzero(np.hypot(*away[active].T) <= SIZE)[0]
        unknowns = (np.arange(c)[:, None] * len(active) + at).ravel()
        unit = np.zeros((operator.shape[0], len(unknowns)))
        unit[unknowns, np.arange(len(unknowns))] = 1.0
        # Three thousand unknowns that all lie within a few horizons: dense factors are faster.
        try:
            factors = cho_factor(to_csr(operator).toarray(), lower=True, overwrite_a=True)
        except LinAlgError as error:
            raise TipCalibrationError("the body around it stores negative energy") from error
        found = cho_solve(factors, np.column_stack([loads, unit])).reshape(c, len(active), -1)
        particles = active[at]
        cells = np.rint(near.points[particles] - tip + place).astype(np.int64)
        return cls(
            cells,
            bonds.strengths_of(particles),
            bonds.lengths_left(particles),
            found[:, :, :2],
            np.moveaxis(field[:, :, active], 0, 2),
            found[:, :, 2:],
            at,
            among(family, moduli, cells, bonds.strengths_of(particles)),
        )


def among(family: Family, moduli: Moduli, cells: Indices, strengths: Array) -> Array:
    """Stiffness of the bonds that some particles, (t, 2) cells, have among themselves, (d, d)."""
    c, count = moduli.components, len(cells)
    scales, arm = moduli.scales(family.spacing), 0.5 * family.length
    here, there = (moduli.end_rows(scales, family.normal.T, end, arm) for end in (-1.0, 1.0))
    weight = family.weight * family.cell_area * moduli.pair_length(family) / family.length**2
    low = cells.min(axis=0) - family.reach
    number = np.full(tuple(cells.max(axis=0) + family.reach + 1 - low), -1)
    number[tuple((cells - low).T)] = np.arange(count)
    found = np.zeros((count, count, c, c))
    for o in range(family.size // 2):
        other = number[tuple((cells + family.offsets[o] - low).T)]
        bond = np.nonzero((other >= 0) & (strengths[o] > 0))[0]
        ends = bond, other[bond]
        rows = here[:, :, o], there[:, :, o]
        for i in (0, 1):
            for j in (0, 1):
                block = np.einsum(
                    "a,ai,aj->ij", weight[o] * moduli.stiffness[:, o], rows[i], rows[j]
                )
                # Of one offset no pair of particles comes twice.
                found[ends[i], ends[j]] += strengths[o, bond, None, None] * block
    return found.transpose(2, 0, 3, 1).reshape(c * count, c * count)
