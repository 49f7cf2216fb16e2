"""The border that the free masters of constraints make about a body's operator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..linear import Border
from ..operators import BondOperator
from .discretisation import Discretisation


def border(parts: Discretisation) -> Border:
    """What the free masters add to the equations of a body; see `constraints`.

    Values of `parts` are û on the slaves.
    """
    constraints = parts.constraints
    assert constraints is not None
    lattice, operator = parts.lattice, parts.operator
    # The same body with the slaves among its unknowns, but what was set aside.
    opened = parts.prescribed & ~(constraints.slaves & ~np.isnan(parts.values))
    whole = BondOperator(parts.bonds, operator.moduli, opened)
    slaved = np.where(constraints.slaves, np.nan_to_num(parts.values), 0.0)
    free = replace(parts, operator=whole, prescribed=opened, constraints=None)

    def rows(field: Array) -> Array:
        """K u of a field that is zero but on the slaves, on all particles."""
        found = np.zeros((operator.components, lattice.count))
        found[:, whole.active] = whole.product(field[:, whole.active], masked=True)
        return found

    force = np.zeros((operator.components, lattice.count))
    elsewhere = replace(free, values=np.where(opened, parts.values, 0.0))
    given = elsewhere.right_hand_side().reshape(operator.components, -1)
    if whole.identity_rows is not None:
        given[whole.identity_rows] = 0.0
    force[:, whole.active] = given
    force -= rows(slaved)
    coupling = np.zeros((operator.shape[0], constraints.count))
    stiffness = np.zeros((constraints.count, constraints.count))
    for column in range(constraints.count):
        unit = np.zeros(constraints.count)
        unit[column] = 1.0
        image = rows(constraints.field(unit))
        stiffness[:, column] = constraints.project(image)
        felt = image[:, operator.active]
        if operator.identity_rows is not None:
            felt[operator.identity_rows] = 0.0
        coupling[:, column] = felt.ravel()
    return Border(coupling, 0.5 * (stiffness + stiffness.T), constraints.project(force))
