"""Chiral solids: bonds with a cross term k_nt s γ, and the rotations of the tetrachiral blocks.

The blocks of Sect. 2.4 turn when their lattice is dilated, by r·ε beside the displacement's own
rotation. k_n, k_t and k_b cannot say that (no bond is sheared in a dilation), and the paper's
homogenised solid has the lattice's stiffness without it: its rotations are those of the
displacement. With k_nt the sums over bonds make r, too (`solver.material.calibration`), and the
stress stays that of C.

Judged: random solids in displacements of second degree, which bonds reproduce exactly, and the
rotations of 25 × 25 blocks, free at their edges, that forces pull apart and together. Solids
without k_nt stand beside them.
"""

from __future__ import annotations

from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from cmverify.case import Array, Case, Check, Level, Measurement, Method
from cmverify.cases.common import adapters
from cmverify.cases.polar import quadratic
from cmverify.faults.changes import result, scaled
from cmverify.faults.fault import Fault
from cmverify.judge.norms import relative_l2

M = 3
#: Cells of the patch test's side, blocks of the lattice's, and those within which is "inside".
CELLS, BLOCKS, INSIDE = 14, 25, 8.5
#: Of the forces, N/m³.
FORCE = 1e6
SEED = 21


def patch(scale: float, n: int) -> Measurement:
    """A random chiral solid in equilibrium; `scale` on the turns that are expected, for tests."""
    from solver import ChiralTensor, Scene, Support, recovery, rectangle

    rng = np.random.default_rng(SEED)
    root = rng.normal(size=(3, 3))
    solid = ChiralTensor(root @ root.T + np.diag([3.0, 3.0, 4.0]), rng.uniform(-0.5, 0.5, 3))
    q, slope = quadratic(solid.voigt, rng), rng.normal(size=(2, 2))

    def displacement(x: Array, y: Array) -> Array:
        curved = np.stack([x * x, x * y, y * y], axis=-1) @ q.T
        return np.asarray(np.stack([x, y], axis=-1) @ slope.T + curved)

    def strain(x: Any, y: Any) -> Array:
        (a, b, c), (d, e, f) = q
        return np.stack([
            slope[0, 0] + 2 * a * x + b * y,
            slope[1, 1] + e * x + 2 * f * y,
            slope[0, 1] + slope[1, 0] + (b + 2 * d) * x + (2 * c + e) * y,
        ])  # fmt: skip

    def rotation(x: Any, y: Any, of: float = 1.0) -> Array:
        (_, b, c), (d, e, _) = q
        own = 0.5 * (slope[1, 0] - slope[0, 1] + (2 * d - b) * x + (e - 2 * c) * y)
        return np.asarray(own + of * np.tensordot(solid.turn, strain(x, y), 1))

    solution = Scene(
        rectangle(1.0, 1.0),
        1.0 / n,
        solid,
        [Support.layer(M + 0.5, displacement=displacement, rotation=rotation)],
        m=M,
    ).solve(tolerance=1e-13)
    x, y = solution.points.T
    inside = np.maximum(abs(x), abs(y)) < 0.5 - (M + 1.0) / n
    stress = recovery.stress(solution)[inside]
    found = np.stack([stress[:, 0, 0], stress[:, 1, 1], stress[:, 0, 1], stress[:, 1, 0]])
    wanted = (solid.voigt @ strain(x, y))[[0, 1, 2, 2]][:, inside]
    return Measurement(
        solution.statistics.unknowns,
        {
            "displacement": relative_l2(solution.displacement, displacement(x, y)),
            "rotation": relative_l2(solution.rotation, rotation(x, y, scale)),
            "stress": relative_l2(found, wanted),
        },
        statistics=adapters.solver_statistics(solution.statistics),
    )


class Moved(NamedTuple):
    """Displacements (k, 2) and rotations (k,) at the blocks' centroids, row by row."""

    displacement: Array
    rotation: Array


def pull(side: float) -> Any:
    """Forces that pull the middle apart and press the halves together, without a resultant."""

    def force(x: Array, y: Array) -> Array:
        return FORCE * np.stack([np.sin(np.pi * x / side), np.sin(np.pi * y / side)], axis=-1)

    return force


def unmoved(points: Array, displacement: Array, rotation: Array) -> Moved:
    """The same less its mean rigid motion."""
    (x, y), one = points.T, np.ones(len(points))
    rigid = np.vstack([np.column_stack([one, 0 * one, -y]), np.column_stack([0 * one, one, x])])
    motion = np.linalg.lstsq(rigid, displacement.T.ravel(), rcond=None)[0]
    left = displacement.T.ravel() - rigid @ motion
    return Moved(left.reshape(2, -1).T, rotation - motion[2])


@cache
def blocks() -> Moved:
    """The block lattice under the forces."""
    from scipy.sparse.linalg import splu

    from references.lattice.blocks import BlockLattice, paper_cell, spring_interface

    cell = paper_cell()
    lattice = BlockLattice(cell, BLOCKS, BLOCKS)
    stiffness = lattice.assemble(spring_interface(cell)).tocsc()
    load = np.zeros((BLOCKS**2, 3))
    load[:, :2] = pull(BLOCKS * cell.pitch)(*lattice.centroids.T) * cell.pitch**2
    middle = BLOCKS**2 // 2
    free = np.ones((BLOCKS**2, 3), dtype=bool)
    free[middle, :2] = free[middle + 5, 1] = False
    at = np.nonzero(free.ravel())[0]
    found = np.zeros(3 * BLOCKS**2)
    found[at] = splu(stiffness[at][:, at]).solve(load.ravel()[at])
    moved = found.reshape(-1, 3)
    return unmoved(lattice.centroids, moved[:, :2], moved[:, 2])


def solid(chiral: bool) -> Any:
    """The homogenised lattice, with its blocks' turns or without."""
    from references.analytic.tetrachiral import effective_turn, effective_voigt
    from references.lattice.blocks import paper_cell
    from solver import ChiralTensor, ElasticTensor

    cell = paper_cell()
    normal, shear, _ = cell.springs
    voigt = effective_voigt(normal, shear, cell.angle)
    if not chiral:
        return ElasticTensor(voigt)
    return ChiralTensor(voigt, effective_turn(normal, shear, cell.angle))


def bonds(chiral: bool, n: int) -> tuple[Moved, Any]:
    """The same of bonds, n (an odd multiple of the blocks) cells a side, and the solution."""
    from references.lattice.blocks import paper_cell
    from solver import Load, Scene, Support, rectangle

    pitch = paper_cell().pitch
    side, h, each = BLOCKS * pitch, BLOCKS * pitch / n, n // BLOCKS
    solution = Scene(
        rectangle(side, side),
        h,
        solid(chiral),
        [
            Support.where(lambda x, y: np.hypot(x, y) < 0.1 * h, u1=0.0, u2=0.0),
            Support.where(lambda x, y: np.hypot(x - 5 * pitch, y) < 0.1 * h, u2=0.0),
        ],
        [Load.body_force(pull(side))],
        m=M,
        surface="extrapolated",
    ).solve()
    place = np.round(solution.points / h + 0.5 * (n - 1)).astype(int)
    at = np.nonzero(((place - (each - 1) // 2) % each == 0).all(axis=1))[0]
    at = at[np.lexsort(place[at].T)]
    found = unmoved(solution.points[at], solution.displacement[at], solution.rotation[at])
    return found, solution


def turning(scale: float, n: int) -> Measurement:
    """Rotations beside the blocks'; `scale` on the blocks' own, for tests."""
    from references.lattice.blocks import BlockLattice, paper_cell

    wanted = blocks()
    cell = paper_cell()
    centroids = BlockLattice(cell, BLOCKS, BLOCKS).centroids
    inside = np.abs(centroids).max(axis=1) < INSIDE * cell.pitch
    found, solution = bonds(True, n)
    plain, _ = bonds(False, n)
    rotation = scale * wanted.rotation
    return Measurement(
        solution.statistics.unknowns,
        {
            "rotation": relative_l2(found.rotation[inside], rotation[inside]),
            "rotation, all": relative_l2(found.rotation, rotation),
            "displacement": relative_l2(found.displacement, wanted.displacement),
            "without k_nt": relative_l2(plain.rotation[inside], rotation[inside]),
        },
        adapters.solver_seconds(solution.statistics),
        adapters.solver_statistics(solution.statistics),
    )


@cache
def warm_up() -> None:
    """Compile the kernels."""
    patch(1.0, 10)


SOURCE = (
    "the block lattice itself; measured with half as much again (fine bonds tend to the "
    "homogenised solid, which is 1.1e-3 from 25 blocks a side)"
)

CASES = (
    Case(
        name="chiral-patch",
        title="Points of a chiral solid that turn when it is strained, exactly",
        section="Sect. 5",
        equations=(),
        tags=("polar", "chiral", "elasticity"),
        shows=(
            "A random solid whose points turn by r·ε beside its displacement's rotation: bonds "
            "with a cross term k_nt s γ reproduce strain, rotation and stress of second-degree "
            "displacements to rounding."
        ),
        methods=(
            Method("bond/lattice", "bond", partial(patch, 1.0), dict.fromkeys(Level, (CELLS,)),
                   warm_up),
        ),
        checks=tuple(
            Check("bond/lattice", quantity, {CELLS: bound}, exact=True,
                  source="rounding: sums over the lattice are exact for these states")
            for quantity, bound in (("displacement", 1e-11), ("rotation", 1e-11), ("stress", 1e-10))
        ),
        quantities={
            "displacement": "displacement, relative L2",
            "rotation": "rotations ω + r·ε, relative L2",
            "stress": "stress C ε, relative L2",
        },
        primary="rotation",
        featured="bond/lattice",
        length="L",
        timed=False,
    ),
    Case(
        name="chiral-blocks",
        title="Rotations of the tetrachiral lattice's blocks",
        section="Sect. 2.4",
        equations=("Eq. 85", "Eq. 86"),
        tags=("polar", "chiral", "elasticity"),
        shows=(
            "Forces dilate a free square of 25 × 25 blocks, and the blocks turn. Bonds with the "
            "cross term turn as they do; without it (k_n and k_t alone, the paper's homogenised "
            "solid) they move alike and turn otherwise."
        ),
        methods=(
            Method("bond/extrapolated", "bond", partial(turning, 1.0),
                   {Level.QUICK: (25,), Level.STANDARD: (25, 75), Level.PAPER: (25, 75, 125)},
                   warm_up),
        ),
        checks=(
            Check("bond/extrapolated", "rotation", {25: 6.7e-3, 75: 1.1e-3, 125: 1.7e-3},
                  source=SOURCE),
            Check("bond/extrapolated", "rotation, all", {25: 3.3e-2, 75: 3.2e-3, 125: 2e-3},
                  source=SOURCE),
            Check("bond/extrapolated", "displacement", {25: 6.9e-3, 75: 1.2e-3, 125: 1.7e-3},
                  source=SOURCE),
        ),
        quantities={
            "rotation": "rotations within 17 × 17 blocks, relative L2",
            "rotation, all": "rotations of all blocks, relative L2",
            "displacement": "displacements, relative L2",
            "without k_nt": "rotations of bonds without k_nt, relative L2 (shown)",
        },
        primary="rotation",
        featured="bond/extrapolated",
        length="L",
    ),
)  # fmt: skip

T = "references.analytic.tetrachiral"
FAULTS = (
    Fault("k_nt missing", "solver.material.moduli.ChiralModuli.stiffness",
          result(lambda k: np.stack([k[0] + k[2], k[1] + k[2], 0 * k[2]])), "polar"),
    Fault("k_nt + 1 %", "solver.material.moduli.ChiralModuli.stiffness",
          result(lambda k: np.stack([k[0] - 0.01 * k[2], k[1] - 0.01 * k[2], 1.01 * k[2]])),
          "polar"),
    Fault("Cosserat modulus of chiral solids + 1 %",
          "solver.material.tensors.ChiralTensor.cosserat_modulus", scaled(1.01), "polar"),
    Fault("turns of blocks + 2 %", f"{T}.effective_turn", scaled(1.02), "closed forms"),
)  # fmt: skip
