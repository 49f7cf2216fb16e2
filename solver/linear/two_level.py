"""Two-level preconditioner: Chebyshev smoothing on the lattice, a correction on coarse hats.

One application is a symmetric V-cycle, smooth – correct – smooth, with

* Chebyshev polynomials of the block-Jacobi-scaled operator as smoother (Adams et al., J. Comput.
  Phys. 188, 2003). Where no bond modulus is negative, each bond's energy is at most twice the
  sum of what its two ends would have alone, so λ_max(D⁻¹K) ≤ 2 rigorously, surfaces and damage
  included; elsewhere the bound is estimated;
* the Galerkin correction on bilinear hats that are split along cracks (`solver.linear.coarse`), its
  matrix factorised by SuperLU.

Nonlocal operators are only mildly ill-conditioned (the horizon, not the spacing, is the smallest
wave that the lattice resolves), which is why two levels do even for a million particles.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import eigvalsh_tridiagonal
from scipy.sparse.linalg import LinearOperator, splu

from ..arrays import Array, Float
from ..errors import NegativeCurvatureError
from ..operators import BondOperator, kernels
from .coarse import Hats
from .coarse_grid import CoarseGrid
from .smoother import RATIO, Smoother, size_of

# Distance of coarse nodes by unknowns a particle: with two products of smoothing the best
# balance of set-up and iterations from 4 to 12 cells. In conduction the coarse matrix is cheap
# and anisotropy stronger, so nodes are closer. Larger lattices coarsen more, so that the
# factorisation stays small beside the products.
_COARSENING = {1: 6, 2: 8, 3: 8}
LARGEST_COARSE = 60_000
# Determinant of a diagonal block over the power of its size from which on cofactors invert it.
_SOUND = 1e-6
# Steps of Lanczos that find the largest eigenvalue to 11 % or closer (of what 80 steps find: bodies
# of 120 to 5,000 particles, four solids, m = 3 and 5), what it is taken above that, and the share
# of it that is left of a Krylov space which is the whole one. Beyond the bound the V-cycle stays
# positive up to 1.2 times as much (1.25 with one product); beyond that iterations may not converge,
# which is told.
_LANCZOS, _ABOVE, _EXHAUSTED = 8, 1.2, 1e-10
# `_COARSENING` where one preconditioner serves hundreds of solves: closer nodes cost set-up and
# leave waves so short that one product of smoothing, on a narrower interval, gains as much as two
# (a/60, m = 5: 3.5 iterations of two products a solve, with nodes at 8 cells 3.7 of four). Up to
# so many unknowns: factors grow faster than products.
_CLOSE, _CLOSE_RATIO, _CLOSE_MOST = {2: 5, 3: 5}, 4.0, 150_000
# Coarse functions can be dependent in narrow bodies; their null directions carry no residual.
_REGULARISATION = 1e-11


class BlockJacobi(LinearOperator):
    """Inverse of the diagonal blocks.

    Raises
    ------
    NegativeCurvatureError
        If a block is not positive definite.
    """

    def __init__(self, operator: BondOperator) -> None:
        super().__init__(operator.dtype, operator.shape)
        self.operator = operator
        bulk = block_inverses(operator, operator.bulk_blocks, None)
        #: Inverses, shapes (phases, c, c) and (c, c, d), see `kernels.block_scale`.
        self.bulk: Array = np.ascontiguousarray(np.moveaxis(bulk, 2, 0))
        self.own: Array = block_inverses(operator, operator.own_blocks, operator.own)

    def _matvec(self, x: Array) -> Array:
        c = self.operator.components
        residual = np.ascontiguousarray(np.asarray(x, dtype=np.float64).reshape(c, -1))
        out = np.empty_like(residual)
        kernels.block_scale(self.operator.segments, self.bulk, self.own, residual, out)
        return out.ravel()

    def _adjoint(self) -> BlockJacobi:
        return self


def block_inverses(operator: BondOperator, blocks: Array, which: NDArray[np.int64] | None) -> Array:
    """Inverses of symmetric blocks (n, c, c) as (c, c, n).

    Parameters
    ----------
    operator : BondOperator
        Whose they are.
    blocks : ndarray, shape (n, c, c), Pa
    which : ndarray of int, shape (n,), optional
        Positions among the active particles, to name a bad one; None for those of the bulk.

    Raises
    ------
    NegativeCurvatureError
        If a block is not positive definite.
    """
    if not len(blocks):
        return np.zeros((operator.components, operator.components, 0))
    found = np.empty((operator.components, operator.components, len(blocks)))
    doubtful = _invert(np.ascontiguousarray(np.moveaxis(blocks, 0, 2)), found)
    if not len(doubtful):
        return found
    values, vectors = np.linalg.eigh(blocks[doubtful])
    with np.errstate(invalid="ignore", divide="ignore"):
        relative = values[:, 0] / np.abs(values).max(axis=1)
    if not relative.min() > 1e-12:
        where = "a bulk particle"
        if which is not None:
            worst = doubtful[np.argmin(relative)]
            x, y = operator.bonds.lattice.places[operator.active[which[worst]]]
            where = f"the particle at ({x:.4g}, {y:.4g})"
        raise NegativeCurvatureError(
            f"{where} is a mechanism: the stiffness of its own bonds is singular or negative "
            f"(too few bonds are left). Hold it or remove it"
        )
    # einsum keeps a fixed order of sums, whatever BLAS does.
    found[:, :, doubtful] = np.einsum("pij,pj,pkj->ikp", vectors, 1.0 / values, vectors)
    return found


def _invert(blocks: Array, out: Array) -> NDArray[np.int64]:
    """Inverses of symmetric blocks (c, c, n) by cofactors; returns those that are left.

    What is left is not positive definite, or nearly not: the smallest eigenvalue is at least
    det/|λ|_max^(c − 1).
    """
    c = len(blocks)
    # Of size one each, or cubes of stiffnesses could leave the range of numbers; a power of two
    # changes no digit.
    size = np.ldexp(1.0, np.frexp(np.abs(blocks).max(axis=(0, 1)))[1])
    blocks = blocks / size
    if c == 1:
        minors, cofactors = [blocks[0, 0]], np.ones_like(blocks)
    elif c == 2:
        (a, b), (_, d) = blocks
        minors, cofactors = [a, a * d - b * b], np.array([[d, -b], [-b, a]])
    else:
        (a, b, e), (_, d, f), (_, _, g) = blocks
        cofactors = np.array(
            [
                [d * g - f * f, e * f - b * g, b * f - d * e],
                [e * f - b * g, a * g - e * e, b * e - a * f],
                [b * f - d * e, b * e - a * f, a * d - b * b],
            ]
        )
        minors = [
            a,
            cofactors[2, 2],
            a * cofactors[0, 0] + b * cofactors[0, 1] + e * cofactors[0, 2],
        ]
    norm = np.sqrt((blocks * blocks).sum(axis=(0, 1)))
    with np.errstate(invalid="ignore", divide="ignore"):
        np.divide(cofactors, minors[-1] * size, out=out)
        sound = minors[-1] > _SOUND * norm**c
    for minor in minors[:-1]:
        sound &= minor > 0.0
    return np.nonzero(~sound)[0]


class TwoLevel(LinearOperator):
    """V-cycle of Chebyshev smoothing and a split-hat coarse correction.

    Parameters
    ----------
    operator : BondOperator
        Symmetric positive definite. For an indefinite body hand over its companion, see
        `solver.analyses.statics`.
    coarsening : int, optional
        Distance of the coarse nodes in lattice cells; by default 8 (6 in conduction), more for
        lattices whose coarse matrix would exceed 60,000 unknowns. In strongly anisotropic solids
        nodes are closer across the strong axis, see `CoarseGrid.of`.
    degree : int
        Chebyshev degree, products a sweep; one V-cycle costs 2 × degree products.
    regularisation : float
        Relative shift of the coarse diagonal.
    previous : TwoLevel, optional
        Of the same body before some bonds broke: hats are split anew along what broke, and only
        the coarse entries that feel it are computed again.
    coarse : csc_array, optional
        The Galerkin matrix, where it is known (from a checkpoint).
    precision : type
        Of the V-cycle, see `solver.linear.smoother`.
    ratio : float
        See `solver.linear.smoother.Smoother`.

    Raises
    ------
    NegativeCurvatureError
        If a particle's own stiffness is not positive definite.
    """

    def __init__(
        self,
        operator: BondOperator,
        coarsening: int | None = None,
        degree: int = 2,
        regularisation: float = _REGULARISATION,
        previous: TwoLevel | None = None,
        coarse: sparse.csc_array | None = None,
        precision: type[np.floating] = np.float32,
        ratio: float = RATIO,
    ) -> None:
        super().__init__(operator.dtype, operator.shape)
        begun = perf_counter()
        self.operator, self.degree = operator, int(degree)
        self._ratio, self._precision = ratio, precision
        self.jacobi = BlockJacobi(operator)
        grid: CoarseGrid | None = None
        if previous is not None:
            coarsening, grid = previous.hats.coarsening, previous.hats.grid
        elif coarsening is None:
            coarsening, grid = _grid(operator)
        self.hats: Hats = Hats(operator, coarsening, grid)
        self._regularisation = regularisation
        known = changed = None
        if previous is not None:
            known = previous.hats, previous.coarse
            changed = changed_particles(previous.operator, operator)
        #: Galerkin matrix of the hats without the surface's nodes.
        self.coarse: sparse.csc_array = (
            self.hats.galerkin(known, changed) if coarse is None else coarse
        )
        #: Galerkin matrix of the surface's nodes, which the bonds do not change.
        self.ended = self.hats.ended()
        whole = self.coarse if self.ended is None else (self.coarse + self.ended).tocsc()
        self._solve = _factorise(whole, regularisation)
        self.largest = self._largest_eigenvalue()
        self._smoother = self._smoother_of(operator, self.jacobi.own)
        self._down = self.hats.restrict.rounded(precision)
        self._up = self.hats.prolong.rounded(precision)
        #: Wall time of the set-up, s.
        self.seconds = perf_counter() - begun

    def updated(self, operator: BondOperator) -> TwoLevel:
        """The preconditioner of the same body after some of its bonds changed.

        Falls back to a new one where the unknowns or the moduli are not the same.
        """
        return TwoLevel(
            operator,
            self.hats.coarsening,
            self.degree,
            self._regularisation,
            self if same_unknowns(self.operator, operator) else None,
            precision=self._precision,
            ratio=self._ratio,
        )

    def following(self, operator: BondOperator) -> TwoLevel:
        """This coarse grid with the smoother of the same body after some of its bonds broke.

        Costs next to nothing, and serves nearly as well as one brought up to date. It is positive:
        what has lost bonds is softer than the coarse matrix says. Its bound of the eigenvalues is
        kept: an estimate, beside surface's nodes, of the body before its bonds broke. Products are
        written to arrays of its own.

        Parameters
        ----------
        operator : BondOperator
            Of the body now; where its unknowns or moduli are others, or moduli are negative, this
            preconditioner is handed back as it is.

        Raises
        ------
        NegativeCurvatureError
            If a particle has too few bonds left.
        """
        built = self.operator
        if not built.moduli.non_negative or not same_unknowns(built, operator):
            return self
        own = np.empty((*self.jacobi.own.shape[:2], len(operator.own)))
        at = np.minimum(np.searchsorted(operator.own, built.own), len(operator.own) - 1)
        same = operator.own[at] == built.own
        same &= (operator.diagonal[:, at] == built.diagonal).all(axis=0)
        if operator.ended_stiffness is not built.ended_stiffness:
            same[:] = False
        own[:, :, at[same]] = self.jacobi.own[:, :, same]
        other = np.ones(len(operator.own), dtype=bool)
        other[at[same]] = False
        blocks, which = operator.own_blocks[other], operator.own[other]
        own[:, :, other] = block_inverses(operator, blocks, which)
        found = copy(self)
        found.operator = operator
        found._smoother = self._smoother_of(operator, own)
        return found

    def _smoother_of(self, operator: BondOperator, own: Array) -> Smoother:
        bulk, most = self.jacobi.bulk, self.largest
        return Smoother(operator, bulk, own, most, self.degree, self._precision, self._ratio)

    def _largest_eigenvalue(self) -> float:
        """Largest λ(D⁻¹K): a rigorous bound without negative moduli, else a safe estimate.

        The bound does not hold where blocks give way to the surface's nodes.
        """
        if self.operator.moduli.non_negative and self.operator.ended_stiffness is None:
            return 2.0
        # A deterministic start with components along everything.
        return max(2.0, _ABOVE * largest_ritz(self.operator, self.jacobi, _LANCZOS))

    def _correction(self, residual: Float) -> Float:
        """The coarse grid's answer to a residual, on the hats."""
        shape = self.operator.components, self.hats.count
        forces = self._down(residual, out=np.empty(shape, dtype=residual.dtype))
        found = self._smoother.unit * self._solve(forces.astype(np.float64).ravel())
        found[np.abs(found) < kernels.NEGLIGIBLE * np.abs(found).max()] = 0.0
        return found.reshape(shape).astype(residual.dtype)

    def _matvec(self, residual: Array) -> Array:
        given = np.ascontiguousarray(residual, dtype=np.float64)
        given = given.reshape(self.operator.components, -1)
        unit = size_of(given)
        if not unit:
            return np.zeros(given.size)
        smoother = self._smoother
        smoother.start(given, unit)
        smoother.sweep()
        self._up(self._correction(smoother.leave()), out=smoother.step)
        smoother.correct()
        smoother.sweep()
        return smoother.answer(given, unit)

    def _adjoint(self) -> TwoLevel:
        return self


def for_many(
    operator: BondOperator,
    coarsening: int | None = None,
    coarse: sparse.csc_array | None = None,
) -> TwoLevel:
    """A preconditioner that serves so many solves that each of them counts, not its set-up.

    In conduction, whose nodes are close as it is, and in large bodies the usual one.

    Parameters
    ----------
    operator, coarsening, coarse
        See `TwoLevel`.

    Raises
    ------
    NegativeCurvatureError
        If a particle's own stiffness is not positive definite.
    """
    close = _CLOSE.get(operator.components)
    if close is None or operator.shape[0] > _CLOSE_MOST:
        return TwoLevel(operator, coarsening, coarse=coarse)
    coarsening = coarsening or close
    return TwoLevel(operator, coarsening, degree=1, coarse=coarse, ratio=_CLOSE_RATIO)


def _grid(operator: BondOperator) -> tuple[int, CoarseGrid]:
    """Distance of nodes and grid: the usual ones, coarser for large lattices."""
    coarsening = _COARSENING[operator.components]
    while True:
        grid = CoarseGrid.of(operator, coarsening)
        if operator.shape[0] <= LARGEST_COARSE * grid.cells:
            return coarsening, grid
        coarsening += 1


def largest_ritz(operator: LinearOperator, jacobi: LinearOperator, steps: int) -> float:
    """Largest λ(D⁻¹K) of a Krylov space, from below: Lanczos in the product of D.

    Parameters
    ----------
    operator, jacobi : LinearOperator
        K, symmetric, and D⁻¹, symmetric and positive.
    steps : int
    """
    force = np.cos(1.7 * np.arange(operator.shape[0]))
    move, before = jacobi.matvec(force), np.zeros_like(force)
    diagonal: list[float] = []
    beside: list[float] = []
    for _ in range(steps):
        # `force` is D times `move`, whose size in D becomes one.
        size = float(np.sqrt(max(force @ move, 0.0)))
        if diagonal and size <= _EXHAUSTED * max(diagonal):
            break
        force, move = force / size, move / size
        image = operator.matvec(move)
        diagonal.append(float(move @ image))
        beside.append(size)
        force, before = image - diagonal[-1] * force - size * before, force
        move = jacobi.matvec(force)
    return float(eigvalsh_tridiagonal(diagonal, beside[1:])[-1])


def same_unknowns(one: BondOperator, other: BondOperator) -> bool:
    """Whether two operators act on the same unknowns of the same lattice, with the same moduli."""
    fixed = (one.identity_rows is None) == (other.identity_rows is None)
    if fixed and one.identity_rows is not None and other.identity_rows is not None:
        fixed = np.array_equal(one.identity_rows, other.identity_rows)
    return bool(
        fixed
        and np.array_equal(one.bonds.lattice.mask, other.bonds.lattice.mask)
        and np.array_equal(one.active, other.active)
        and np.array_equal(one.blocks, other.blocks)
    )


def changed_particles(one: BondOperator, other: BondOperator) -> NDArray[np.int64]:
    """Positions among the active particles of those whose bond factors differ."""
    differs = np.zeros(one.bonds.lattice.count, dtype=bool)
    both = np.union1d(one.bonds.special, other.bonds.special)
    a, b = one.bonds.strengths_of(both), other.bonds.strengths_of(both)
    differs[both] = (a != b).any(axis=0)
    return np.nonzero(differs[one.active])[0]


def _factorise(matrix: sparse.csc_array, regularisation: float) -> Callable[[Array], Array]:
    """Solver of the coarse matrix."""
    diagonal = np.abs(matrix.diagonal())
    shift = regularisation * np.maximum(diagonal, diagonal.max())
    factors = splu(
        (matrix + sparse.diags_array(shift)).tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    solve: Callable[[Array], Array] = factors.solve
    return solve
