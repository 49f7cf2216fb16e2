"""What the damaged bodies share: a clamped square under body force, some of its bonds gone.

The solver is judged by a sparse factorisation of the assembled matrix and by the energy of the
bonds, summed one by one from their stretch and shear: twice it is the work of the load.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cmverify.case import Array

if TYPE_CHECKING:
    from solver import Discretisation, Solution
    from solver.geometry import Lattice
    from solver.material import Family, Material

Mask = NDArray[np.bool_]
Broken = Callable[["Lattice", "Family"], Mask]
M = 3
SEED = 2022


def scene(
    material: Material,
    n: int,
    broken: Broken,
    m: float = M,
    load: Callable[[Array, Array], Array] | None = None,
    **settings: Any,
) -> Any:
    """Square of side 1 at spacing 1/n, clamped (or cold) in its outer layer, loaded inside."""
    from solver import ElasticTensor, Load, Scene, Support, rectangle

    if isinstance(material, ElasticTensor):
        support = Support.layer(cells=m + 0.5, displacement=(0.0, 0.0), rotation=0.0)
        act = Load.body_force(load or force)
    else:
        support = Support.layer(cells=m + 0.5, temperature=0.0)
        act = Load.source(load or (lambda x, y: 1.0 + x - 2 * y**2))
    return Scene(
        region=rectangle(1.0, 1.0),
        spacing=1.0 / n,
        m=m,
        material=material,
        supports=[support],
        loads=[act],
        surface="none",
        broken=broken,
        **settings,
    )


def force(x: Array, y: Array) -> Array:
    """A body force without symmetry, (n, 2)."""
    return np.stack([1.0 + y, 0.5 - x**2], axis=-1)


def at_random(share: float, seed: int = SEED) -> Broken:
    """Every bond broken with this probability."""

    def broken(lattice: Lattice, family: Family) -> Mask:
        size = (family.size // 2, lattice.count)
        return np.random.default_rng(seed).random(size) < share

    return broken


def direct_solution(discretisation: Discretisation) -> Array:
    """Unknowns of the active particles by a sparse factorisation, (components, active)."""
    from scipy.sparse.linalg import splu

    from solver.operators.assembled import to_csr

    operator = discretisation.operator
    matrix = to_csr(operator).tocsc()
    return splu(matrix).solve(discretisation.right_hand_side()).reshape(operator.components, -1)


def negative_directions(discretisation: Discretisation) -> int:
    """Independent displacements (or temperatures) of negative energy, rotations adjusting.

    By Sylvester's law of inertia: the pivots of a symmetric elimination have the signs of the
    eigenvalues. Rotations of negative stiffness account for one negative pivot each.
    """
    from solver.operators.assembled import to_csr

    operator = discretisation.operator
    matrix = to_csr(operator).tocsc()
    negative = _negative_pivots(matrix)
    if operator.components < 3:
        return negative
    count = len(operator.active)
    return negative - _negative_pivots(matrix[2 * count :, 2 * count :])


def _negative_pivots(matrix: Any) -> int:
    from scipy.sparse.linalg import splu

    factors = splu(
        matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    if not np.array_equal(factors.perm_r, factors.perm_c):
        raise ArithmeticError("the elimination left the diagonal: its pivots tell no inertia")
    return int((factors.U.diagonal() < 0).sum())


def energy_defect(solution: Solution) -> float:
    """|2 E − W| / |W|: energy of the bonds that are left against the work of the load."""
    d = solution.discretisation
    lattice, family, moduli = d.lattice, d.family, d.moduli
    number = lattice.number()
    rows, columns = lattice.rows_columns
    fields = solution.unknowns
    aside: Mask = np.asarray(np.isnan(fields).any(axis=0))  # loose parts strain nothing
    assert d.scene.broken is not None
    gone = np.asarray(d.scene.broken(lattice, family))
    total = 0.0
    for o in range(family.size // 2):
        dx, dy = family.offsets[o]
        other = number[rows + dy, columns + dx]
        here = np.nonzero((other >= 0) & ~gone[o])[0]
        here = here[~(aside[here] | aside[other[here]])]
        there = other[here]
        jump = (fields[:, there] - fields[:, here]) / family.length[o]
        # Conduction: an unordered pair stores ½ k g² α Δv², g the jump over the length.
        density = 0.5 * family.weight[o] * family.cell_area**2
        if len(fields) == 1:
            total += density * moduli.conductivity[o] * (jump[0] ** 2).sum()  # type: ignore[attr-defined]
            continue
        stretch = family.normal[o] @ jump[:2]
        shear = family.tangent[o] @ jump[:2]
        if len(fields) == 3:
            shear = shear - 0.5 * (fields[2, here] + fields[2, there]) / family.spacing
        bond = moduli.normal[o] * stretch**2 + moduli.shear[o] * shear**2  # type: ignore[attr-defined]
        total += density * family.length[o] * bond.sum()
    work = float((d.load * np.nan_to_num(fields)).sum()) * family.cell_area
    return abs(2 * total - work) / abs(work)
