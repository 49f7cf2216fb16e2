"""Lowest eigenpairs of K x = λ M x, and proofs that none is missing.

K is a bond operator (or its displacements alone, rotations condensed), M diagonal with zeros where
unknowns carry no mass. The block method LOBPCG (Knyazev, SIAM J. Sci. Comput. 23, 2001; SciPy's)
minimises xᵀK x / xᵀM x: massless rotations follow at no cost, multiple eigenvalues come with all
their vectors because the block has room for them (a single-vector Lanczos loses copies), and the
two-level preconditioner makes about twenty iterations do on any lattice. It needs some care:

* motions without strain are known beforehand: they are constraints, and never sought;
* it does not notice a pencil that is not positive: `definite` looks for negative curvature first,
  by preconditioned conjugate gradients, whose curvatures turn negative with the lowest Ritz value;
* it says nothing of what it has not found: `below` counts eigenvalues by the inertia of a
  factorisation (Sylvester), `missing` searches what is left with other starting vectors.

Whoever calls this pins BLAS to one thread: reductions must not depend on the number of threads.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse
from scipy.linalg import eigh
from scipy.sparse.linalg import LinearOperator, lobpcg, splu

from ..arrays import Array, Mask
from ..errors import ConvergenceError, NegativeCurvatureError
from .krylov import Task, conjugate_gradients

# Eigenvalues over the size of K's entries below which a motion counts as one without strain: far
# above rounding, far below the first mode of a body of thousands of cells.
ZERO = 1e-13
# Rounding of K x, over the size of K's entries and of x: no residual falls below.
_ROUNDING = 20 * np.finfo(float).eps
# Iterations of each round: pairs are judged between rounds. The two-level method needs two or
# three of them; each restart loses directions of search, so that slow ones get longer rounds.
_ROUNDS = (14, 7, 7, 14, 28, 56, 112, 224, 448)
# Of the search for missing pairs: vectors, and rounds of five iterations at most.
_SEARCH, _SEARCH_ROUNDS = 3, 8
# Block iterations that the two-level method usually takes: the first guess of how long it will be.
_USUAL = 21
# Residual over λ at which the search knows its lowest value well enough to compare.
_KNOWN = 0.05


@dataclass(frozen=True)
class Pencil:
    """K x = λ M x.

    Attributes
    ----------
    stiffness : LinearOperator, (n, n)
        Symmetric.
    mass : ndarray, shape (n,)
        Diagonal of M, zero or positive; of size one.
    preconditioner : LinearOperator, (n, n)
        Near the inverse of K, symmetric positive definite.
    rigid : ndarray, shape (n, r)
        Motions that strain nothing, linearly independent.
    fixed : ndarray of bool, shape (n,), optional
        Unknowns that stay zero.
    scale : float
        Size of K's entries.
    """

    stiffness: LinearOperator
    mass: Array
    preconditioner: LinearOperator
    rigid: Array
    scale: float
    fixed: Mask | None = None

    @property
    def size(self) -> int:
        """Number of unknowns n."""
        return len(self.mass)

    def residual(self, values: Array, vectors: Array) -> Array:
        """|K x − λ M x| / (λ |M x|) of every pair, shape (k,)."""
        found = np.empty(len(values))
        for k, value in enumerate(values):
            x = np.ascontiguousarray(vectors[:, k])
            inert = value * self.mass * x
            size = float(np.linalg.norm(inert)) or 1.0
            found[k] = np.linalg.norm(self.stiffness.matvec(x) - inert) / size
        return found

    def attainable(self, values: Array, vectors: Array) -> Array:
        """What rounding leaves of `residual`, shape (k,)."""
        inert = np.linalg.norm(self.mass[:, None] * vectors, axis=0) * np.abs(values)
        return _ROUNDING * self.scale * np.linalg.norm(vectors, axis=0) / np.maximum(inert, 1e-300)

    def operators(self) -> tuple[LinearOperator, LinearOperator, LinearOperator]:
        """K over its scale, M and the preconditioner clear of rigid motions, as LOBPCG wants."""
        mass, scale, fixed = self.mass, self.scale, self.fixed
        rigid = self.normalised()

        def inert(x: Array) -> Array:
            return mass[:, None] * x.reshape(len(mass), -1)

        def correct(r: Array) -> Array:
            r = r.ravel()
            if rigid.shape[1]:
                r = r - mass * (rigid @ (rigid.T @ r))
            x = scale * self.preconditioner.matvec(r)
            if rigid.shape[1]:
                x -= rigid @ (rigid.T @ (mass * x))
            if fixed is not None:
                x[fixed] = 0.0
            return x

        shape = (self.size, self.size)
        return (
            LinearOperator(
                shape,
                matvec=lambda x: self.stiffness.matvec(np.ascontiguousarray(x.ravel())) / scale,
                dtype=np.float64,
            ),
            LinearOperator(
                shape, matvec=lambda x: inert(x).ravel(), matmat=inert, dtype=np.float64
            ),
            LinearOperator(shape, matvec=correct, dtype=np.float64),
        )

    def normalised(self) -> Array:
        """Rigid motions with Rᵀ M R = 1."""
        if not self.rigid.shape[1]:
            return self.rigid
        gram = self.rigid.T @ (self.mass[:, None] * self.rigid)
        return np.asarray(np.linalg.solve(np.linalg.cholesky(gram), self.rigid.T).T)

    def start(self, count: int, seed: int) -> Array:
        """Random vectors, the same every time, shape (n, count)."""
        x = np.random.default_rng(seed).standard_normal((self.size, count))
        if self.fixed is not None:
            x[self.fixed] = 0.0
        return x


@dataclass(frozen=True)
class Eigenpairs:
    """Lowest pairs, ascending, rigid motions left out.

    Attributes
    ----------
    values : ndarray, shape (k,)
    vectors : ndarray, shape (n, k)
        Mᵀ-normalised: xᵀ M x = 1.
    residuals : ndarray, shape (k,)
        |K x − λ M x| / (λ |M x|).
    iterations : int
        Block iterations, 0 for a dense solve.
    """

    values: Array
    vectors: Array
    residuals: Array
    iterations: int

    def first(self, count: int) -> Eigenpairs:
        """The first pairs."""
        return replace(
            self,
            values=self.values[:count],
            vectors=self.vectors[:, :count],
            residuals=self.residuals[:count],
        )


def guards(count: int) -> int:
    """Vectors beyond the wanted ones, so that a multiple eigenvalue is not cut in two."""
    return max(3, count // 5)


def definite(pencil: Pencil) -> None:
    """Look for a direction of negative energy.

    A random force is solved for. Conjugate gradients go through directions of positive energy
    only as long as all Ritz values are positive, and a negative eigenvalue, alone beside those of
    the preconditioned operator, shows among them after a few iterations.

    Raises
    ------
    NegativeCurvatureError
        With ``.args[1]`` a vector that is rich in it.
    """
    stiffness, _, inverse = pencil.operators()
    force = pencil.mass * pencil.start(1, seed=5)[:, 0]
    rigid = pencil.normalised()
    force = force - pencil.mass * (rigid @ (rigid.T @ force))
    # To a residual that rounding of singular systems does not reach.
    conjugate_gradients(stiffness, inverse, Task(force, np.zeros_like(force), 1e-6, 200))


class _Meter:
    """Tells how far a search has come: its iterations, of those that its convergence promises.

    Parameters
    ----------
    progress : callable, optional
        Told the share that is done.
    block : int
        Vectors that are sought at once.
    """

    def __init__(self, progress: Callable[[float], None] | None, block: int) -> None:
        self.progress, self.block = progress, block
        self.corrected, self.expected = 0, float(_USUAL * block)

    def watched(self, correct: LinearOperator) -> LinearOperator:
        """The preconditioner, counted: it corrects every vector once an iteration."""
        if self.progress is None:
            return correct

        def counted(r: Array) -> Array:
            self.corrected += 1
            if self.corrected % self.block == 0:
                self.tell()
            return np.asarray(correct.matvec(r))

        return LinearOperator(correct.shape, matvec=counted, dtype=np.float64)

    def tell(self) -> None:
        """The share; the last hundredth is left for what comes after."""
        assert self.progress is not None
        self.progress(min(0.99, self.corrected / self.expected))

    def expect(self, residual: float, aim: float) -> None:
        """Expect as many iterations as the residual, falling as it has, takes to its aim."""
        if 0.0 < residual < 1.0 and 0.0 < aim < 1.0:
            self.expected = self.corrected * max(1.0, float(np.log(aim) / np.log(residual)))


def lowest(
    pencil: Pencil,
    count: int,
    tolerance: float,
    guess: Array | None = None,
    progress: Callable[[float], None] | None = None,
) -> Eigenpairs:
    """The `count` lowest pairs above the rigid motions, and the guards', by LOBPCG.

    Parameters
    ----------
    pencil : Pencil
        Positive but for its rigid motions.
    count : int
        At most a fifth of the unknowns with mass.
    tolerance : float
        Of |K x − λ M x| / (λ |M x|) of the wanted ones; where rounding leaves more (large
        bodies: λ is a small part of K's entries) that is taken.
    guess : ndarray, shape (n, k), optional
        First vectors, filled up with random ones.
    progress : callable, optional
        Told the share that is done, by what convergence promises.

    Returns
    -------
    Eigenpairs
        More than `count`: the guards are there, less accurate.

    Raises
    ------
    ConvergenceError
        If the wanted pairs do not converge.
    """
    stiffness, inert, correct = pencil.operators()
    block = count + guards(count)
    vectors = pencil.start(block, seed=0)
    if guess is not None:
        vectors[:, : guess.shape[1]] = guess
    rigid = pencil.normalised() if pencil.rigid.shape[1] else None
    meter = _Meter(progress, block)
    correct = meter.watched(correct)
    spent, aim = 0, 1e-7
    found = Eigenpairs(np.zeros(0), vectors, np.zeros(0), 0)
    for most in _ROUNDS:
        values, vectors, steps = _lobpcg(stiffness, vectors, inert, correct, rigid, aim, most)
        spent += steps
        values = values * pencil.scale
        residuals = pencil.residual(values, vectors)
        found = Eigenpairs(values, vectors, residuals, spent)
        if values[0] <= ZERO * pencil.scale:
            return found
        enough = np.maximum(tolerance, pencil.attainable(values, vectors))
        if (residuals <= enough)[:count].all():
            return found
        meter.expect(float(residuals[:count].max()), float(enough[:count].min()))
        # Absolute, over the scale: converged columns rest while the others go on.
        aim = 0.3 * float((enough * values)[:count].min()) / pencil.scale
    raise ConvergenceError(
        f"modes stopped at a relative residual of {found.residuals[:count].max():.2e} after "
        f"{spent} block iterations; {tolerance:.1e} was asked for"
    )


def _lobpcg(
    stiffness: LinearOperator,
    vectors: Array,
    inert: LinearOperator,
    correct: LinearOperator,
    rigid: Array | None,
    tolerance: float,
    steps: int,
) -> tuple[Array, Array, int]:
    """SciPy's driver, quiet and ascending; also says how many iterations it took."""
    with warnings.catch_warnings():
        # That it has not converged is judged by residuals, not by its own words.
        warnings.simplefilter("ignore", UserWarning)
        values, vectors, history = lobpcg(
            stiffness,
            vectors,
            B=inert,
            M=correct,
            Y=rigid,
            tol=tolerance,
            maxiter=steps,
            largest=False,
            retResidualNormsHistory=True,
        )
    order = np.argsort(values, kind="stable")
    return values[order], vectors[:, order], max(len(history) - 2, 1)


def missing(pencil: Pencil, found: Eigenpairs, count: int) -> tuple[Array, int]:
    """Search what `found` leaves for a value below the `count`-th: vectors (n, k), iterations.

    Three vectors from another start, kept clear of all that was found, go down until their lowest
    value is known well enough to lie above, or lies below: then a pair was missed.
    """
    stiffness, inert, correct = pencil.operators()
    known = np.column_stack([pencil.rigid, found.vectors])
    known = replace(pencil, rigid=known).normalised()
    vectors, limit = pencil.start(_SEARCH, seed=11), found.values[count - 1]
    steps = 0
    for _ in range(_SEARCH_ROUNDS):
        values, vectors, more = _lobpcg(stiffness, vectors, inert, correct, known, 1e-12, 5)
        steps += more
        values = values * pencil.scale
        if values[0] < limit * (1 - 1e-9):
            return vectors[:, values < limit * (1 - 1e-9)], steps
        if pencil.residual(values[:1], vectors[:, :1])[0] < _KNOWN:
            break
    return vectors[:, :0], steps


def below(matrix: sparse.csr_array, mass: Array, value: float) -> int:
    """Number of eigenvalues of K x = λ M x below a value, by Sylvester's law of inertia.

    The negative pivots of K − σ M are as many as its negative eigenvalues. Those of K's massless
    block are no modes and are subtracted (Haynsworth).

    Parameters
    ----------
    matrix : csr_array, (n, n)
        K. For small bodies: the factors of a nonlocal matrix are nearly full.
    mass : ndarray, shape (n,)
    value : float
        No eigenvalue itself.

    Raises
    ------
    ConvergenceError
        If the factorisation is not accurate enough to be counted.
    """
    massless = np.nonzero(mass == 0.0)[0]
    count = _negative_pivots(sparse.csc_array(matrix - sparse.diags_array(value * mass)))
    if len(massless):
        count -= _negative_pivots(sparse.csc_array(matrix[massless][:, massless]))
    return count


def _negative_pivots(matrix: sparse.csc_array) -> int:
    factors = splu(
        matrix,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    trial = np.cos(1.3 * np.arange(matrix.shape[0]))
    error = np.linalg.norm(factors.solve(matrix @ trial) - trial) / np.linalg.norm(trial)
    if not (np.array_equal(factors.perm_r, factors.perm_c) and error < 1e-3):
        raise ConvergenceError("the inertia of this matrix cannot be counted: its pivots are tiny")
    return int((factors.U.diagonal() < 0).sum())


def dense(matrix: sparse.csr_array, mass: Array, count: int | None = None) -> tuple[Array, Array]:
    """Lowest eigenvalues (all, unless told) of a small pencil and their vectors, shape (n, k).

    Massless unknowns are condensed.

    Raises
    ------
    NegativeCurvatureError
        If the massless block is singular.
    """
    full = matrix.toarray()
    heavy, light = np.nonzero(mass > 0)[0], np.nonzero(mass == 0)[0]
    reduced = full[np.ix_(heavy, heavy)]
    follow = np.zeros((0, len(heavy)))
    if len(light):
        try:
            follow = -np.linalg.solve(full[np.ix_(light, light)], full[np.ix_(light, heavy)])
        except np.linalg.LinAlgError as error:
            raise NegativeCurvatureError(
                "a rotation of this body has no stiffness: it cannot be condensed"
            ) from error
        reduced = reduced + full[np.ix_(heavy, light)] @ follow
    root = 1.0 / np.sqrt(mass[heavy])
    reduced = root[:, None] * (0.5 * (reduced + reduced.T)) * root
    most = len(heavy) if count is None else min(count, len(heavy))
    values, own = eigh(reduced, subset_by_index=(0, most - 1))
    own = root[:, None] * own
    vectors = np.zeros((len(mass), len(values)))
    vectors[heavy] = own
    vectors[light] = follow @ own
    return values, vectors
