"""Mechanisms: what damage leaves without stiffness, and what is done about it.

Three kinds are found, in this order:

* parts that no support holds (fragments cut off);
* particles whose own few bonds cannot fix them (one bond left, or none);
* motions of several particles that strain no bond (a fragment on a hinge): the lowest mode of
  K x = λ D x has λ = 0.

A scene either refuses them or sets them aside: a part that can move freely carries no load, so
taking it out of the equations changes nothing for the rest. Its fields are NaN.
"""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, lobpcg

from ..arrays import Mask
from ..blas import one_thread
from ..bonds import Bonds
from ..errors import MechanismError
from ..linear import TwoLevel
from ..operators import BondOperator
from ..operators.assembled import to_csr
from .constraints import Constraints
from .rigid import unheld

# Smallest own stiffness of a particle, relative to its largest.
_SINGULAR = 1e-9
# λ of a sound body is about (horizon/size)² / 10, above 1e-7 even for thousands of cells.
_ZERO_ENERGY = 1e-10


def slack_particles(operator: BondOperator) -> NDArray[np.int64]:
    """Numbers of active particles whose own bonds leave them a motion without stiffness.

    The sign is not judged: negative rotation stiffness is no slackness. Each unknown is measured
    by what the bulk has for it: a solid whose bonds hardly resist shear (ν near 1/3) hardly
    resists rotations anywhere, and no particle of it is slack for that.
    """
    blocks = operator.own_blocks
    if not len(blocks):
        return np.zeros(0, dtype=np.int64)
    bulk = np.abs(np.einsum("pii->pi", operator.bulk_blocks))
    unit = np.sqrt(np.maximum(bulk, np.finfo(np.float64).tiny))[operator.phase[operator.own]]
    blocks = blocks / (unit[:, :, None] * unit[:, None])
    # |λ|_min ≥ |det| / |λ|_max^(c − 1): eigenvalues are for blocks of which this leaves it open.
    norm = np.linalg.norm(blocks, axis=(1, 2))
    bound = np.abs(np.linalg.det(blocks)) / np.maximum(norm, 1.0) ** (blocks.shape[1] - 1)
    if bound.min() > 10 * _SINGULAR * max(float(norm.max()), 1.0):
        return np.zeros(0, dtype=np.int64)
    sizes = np.abs(np.linalg.eigvalsh(blocks))
    slack = sizes.min(axis=1) <= _SINGULAR * max(float(sizes.max()), 1.0)
    return operator.active[operator.own[slack]]


def zero_energy_particles(operator: BondOperator) -> NDArray[np.int64]:
    """Numbers of the particles that take part in a motion without energy, or an empty array.

    Positive operators only: the lowest mode is found by LOBPCG with the two-level method.
    """
    size = operator.shape[0]
    if size < 30:
        matrix = to_csr(operator).toarray()
        values, vectors = np.linalg.eigh(matrix)
        values = values / values[-1]
    else:
        diagonal = np.einsum("pii->ip", operator.block_diagonal).ravel()
        start = np.random.default_rng(0).standard_normal((size, 6))
        scale = LinearOperator(
            operator.shape,
            matvec=lambda x: diagonal * x.ravel(),
            dtype=np.float64,
            matmat=lambda x: diagonal[:, None] * x,
        )
        # Reductions must not depend on BLAS's threads.
        with warnings.catch_warnings(), one_thread():
            # It warns of modes above the lowest that have not converged; only zeros matter.
            warnings.simplefilter("ignore", UserWarning)
            values, vectors = lobpcg(
                operator,
                start,
                B=scale,
                M=TwoLevel(operator, regularisation=1e-7),
                tol=1e-9,
                maxiter=60,
                largest=False,
            )
    taken = np.zeros(len(operator.active), dtype=bool)
    for mode in vectors[:, values <= _ZERO_ENERGY].T:
        motion = np.abs(mode.reshape(operator.components, -1)).max(axis=0)
        taken |= motion > 1e-3 * motion.max()
    return operator.active[taken]


def find(
    bonds: Bonds,
    operator: BondOperator,
    prescribed: Mask,
    damaged: bool,
    positive: bool,
    constraints: Constraints | None = None,
    free: bool = False,
) -> tuple[NDArray[np.int64], str]:
    """Particles that cannot carry load, and why; an empty array if all can.

    Parameters
    ----------
    bonds, operator, prescribed
        See `solver.scene.Discretisation`.
    damaged : bool
        Whether single bonds are broken: only then are hinges looked for (cracks, too, may leave
        slack particles).
    positive : bool
        Whether the operator is (taken to be) positive; otherwise its companion is searched.
    constraints : Constraints, optional
        Slaves are among the prescribed.
    free : bool
        Whether parts may move: then only particles are looked for that few bonds cannot fix.
    """
    loose = [] if free else unheld(bonds, prescribed, operator.moduli.physics, constraints)
    if loose:
        members = np.logical_or.reduce([part for part, _ in loose])
        return np.nonzero(members & ~prescribed.all(axis=0))[0], "; ".join(
            sentence for _, sentence in loose[:3]
        )
    none = np.zeros(0, dtype=np.int64)
    points = bonds.lattice.places
    cut = len(bonds.special) and ((bonds.strengths == 0) & bonds.exist(bonds.special)).any()
    slack = slack_particles(operator) if damaged or cut or free else none
    if len(slack):
        x, y = points[slack[0]]
        return slack, (
            f"{len(slack)} particle(s), the first at ({x:.4g}, {y:.4g}), have too few bonds left "
            f"to be held by them"
        )
    # A conductor has no hinges: with positive bonds no field but a level is free of energy.
    network = operator.components == 1 and operator.moduli.non_negative
    if damaged and not free and not network and len(operator.active):
        hinged = zero_energy_particles(operator if positive else operator.companion())
        if len(hinged):
            x, y = points[hinged].mean(axis=0)
            return hinged, (
                f"{len(hinged)} particles about ({x:.4g}, {y:.4g}) can move without straining "
                f"any bond (a hinge)"
            )
    return none, ""


def without(bonds: Bonds, broken: Mask | None, particles: NDArray[np.int64]) -> Mask:
    """`broken` with all bonds of `particles` added, shape (family size / 2, N)."""
    lattice, family = bonds.lattice, bonds.family
    half = family.size // 2
    gone = np.zeros(lattice.shape, dtype=bool)
    rows, columns = lattice.rows_columns
    gone[rows[particles], columns[particles]] = True
    result = np.zeros((half, lattice.count), dtype=bool) if broken is None else broken.copy()
    for o, (dx, dy) in enumerate(family.offsets[:half]):
        result[o] |= gone[rows, columns] | gone[rows + dy, columns + dx]
    return result


def refuse(sentence: str) -> MechanismError:
    """The error for a scene that does not allow loose parts."""
    return MechanismError(
        f"{sentence}. Add supports, or let the scene set such parts aside (loose='drop')"
    )
