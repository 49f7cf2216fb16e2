"""Exact reference for fracture of small bodies: one bond at a time, everything anew.

Written apart from the engine it judges (`solver.fracture`): no kernels of bonds, no incremental
bonds, no preconditioner, no warm start. After each break the scene is discretised with its
`broken` bonds, the dense stiffness is factorised, and every bond's energy is computed from the
definition.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from solver.arrays import Array
from solver.errors import MechanismError, SceneError
from solver.fracture.breaking import TIE, Critical, critical_energies
from solver.material import ElasticModuli
from solver.operators.assembled import to_csr
from solver.problem import Discretisation
from solver.scene import Scene

# Dense stiffness matrices beyond this are no small models.
_LARGEST = 6_000


@dataclass(frozen=True)
class Event:
    """Bonds that broke at once: one, or several whose loads tie.

    Attributes
    ----------
    factor : float
        Load factor.
    bonds : frozenset of (int, int)
        Half offset and particle of origin of each.
    """

    factor: float
    bonds: frozenset[tuple[int, int]]


def grow_singly(
    scene: Scene, toughness: Critical | ArrayLike, events: int, tension_only: bool = True
) -> list[Event]:
    """The first breaks of a body whose load rises from event to event.

    At every event the most loaded bond breaks (with those that tie with it) and the body finds a
    new equilibrium at the same load, until no bond is overloaded.

    Parameters
    ----------
    scene : Scene
        Elastic and small.
    toughness : object with ``energies(family)``, or array of shape (family size,)
    events : int
        How many breaks to follow at most; fewer if the body comes apart.
    tension_only : bool

    Returns
    -------
    list of Event

    Raises
    ------
    SceneError
        If the body has more than 6,000 unknowns.
    """
    parts = replace(scene, loose="drop").discretise(sharp_tips=False)
    if parts.operator.shape[0] > _LARGEST:
        raise SceneError(f"an exact run is for at most {_LARGEST} unknowns")
    critical = critical_energies(toughness, parts.family)
    broken = np.zeros((len(critical), parts.lattice.count), dtype=bool)
    found: list[Event] = []
    factor = 0.0
    while len(found) < events:
        load = utilisation(parts, _equilibrium(parts), critical, tension_only)
        largest = float(load.max(initial=0.0))
        if largest <= 0.0:
            break
        factor = max(factor, 1.0 / np.sqrt(largest))
        bonds = np.argwhere(load >= largest * (1 - TIE))
        broken[tuple(bonds.T)] = True
        found.append(Event(factor, frozenset((int(o), int(p)) for o, p in bonds)))
        damaged = replace(scene, broken=lambda lattice, family: broken.copy(), loose="drop")
        try:
            parts = damaged.discretise()
        except MechanismError:
            break
    return found


def _equilibrium(parts: Discretisation) -> Array:
    matrix = to_csr(parts.operator).toarray()
    return parts.field(np.linalg.solve(matrix, parts.right_hand_side()))


def utilisation(parts: Discretisation, field: Array, critical: Array, tension_only: bool) -> Array:
    """f w / w_c of every bond, shape (half, N), from Eqs. 1, 2 and 4."""
    moduli, family, lattice = parts.moduli, parts.family, parts.lattice
    assert isinstance(moduli, ElasticModuli)
    number, (rows, columns) = lattice.number(), lattice.rows_columns
    held = np.logical_and.reduce(parts.prescribed, axis=0)
    result = np.zeros((len(critical), lattice.count))
    for o, (dx, dy) in enumerate(family.offsets[: len(critical)]):
        q = number[rows + dy, columns + dx]
        factor = parts.bonds.strength(o)
        for p in np.nonzero((q >= 0) & (factor > 0))[0]:
            if held[p] and held[q[p]]:
                continue
            eta = field[:2, q[p]] - field[:2, p]
            turn = 0.0
            if len(field) == 3:
                turn = 0.5 * (field[2, p] + field[2, q[p]]) / family.spacing
            s = float(eta @ family.normal[o]) / family.length[o]
            gamma = float(eta @ family.tangent[o]) / family.length[o] - turn
            if s < 0 and tension_only:
                continue
            w = 0.5 * family.length[o] * (moduli.normal[o] * s**2 + moduli.shear[o] * gamma**2)
            result[o, p] = factor[p] * w / critical[o]
    return result
