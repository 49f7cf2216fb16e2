"""Lowest eigenvalues of K x = λ M x, and the elastic ones among them."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import LinearOperator, eigsh

from references.linear import factorise

# of a plane body or lattice in one piece
RIGID_MOTIONS = 3
# below this many unknowns a dense eigensolver is as quick and leaves no doubt
_DENSE = 600
# of the diagonals' ratio: far below the first elastic eigenvalue, far above rounding
_SHIFT = 1e-6


def smallest_eigenpairs(
    stiffness: csr_matrix, mass: csr_matrix, count: int, shift: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The lowest eigenvalues of K x = λ M x and vectors, by shift and invert.

    Parameters
    ----------
    stiffness, mass : sparse (n, n)
        Symmetric, K ≥ 0, M > 0.
    count : int
    shift : float
        Negative, so that K − shift M is positive definite even with rigid motions.

    Notes
    -----
    Lanczos starts from a fixed vector: the same call gives the same digits.
    """
    factors = factorise(stiffness - shift * mass)
    inverse = LinearOperator(stiffness.shape, matvec=factors.solve, dtype=float)
    start = np.random.default_rng(0).standard_normal(stiffness.shape[0])
    values, vectors = eigsh(
        stiffness, count, M=mass, sigma=shift, OPinv=inverse, v0=start, tol=1e-13
    )
    ascending = np.argsort(values)
    return values[ascending], vectors[:, ascending]


def elastic_part(values: NDArray[np.float64], rigid: int) -> NDArray[np.float64]:
    """√λ of ascending eigenvalues without the first ``rigid`` ones, checked to be rigid.

    Raises
    ------
    FloatingPointError
        If one of the first is not small beside the first elastic one, or that is not positive:
        the eigensolver lost a motion or found one too many.
    """
    if rigid and abs(values[rigid - 1]) > 1e-6 * values[rigid]:
        raise FloatingPointError("a free body has three rigid motions; one was lost")
    if not values[rigid] > 0:
        raise FloatingPointError("an elastic eigenvalue is not positive")
    return np.asarray(np.sqrt(values[rigid:]))


def elastic_pairs(
    stiffness: csr_matrix, mass: csr_matrix, count: int, rigid: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """As :func:`elastic_frequencies`, with the mass-normalised vectors, shape (n, count).

    By the sparse solver: for more unknowns than modes.
    """
    scale = stiffness.diagonal().sum() / mass.diagonal().sum()
    values, vectors = smallest_eigenpairs(stiffness, mass, count + rigid, -_SHIFT * scale)
    return elastic_part(values, rigid), vectors[:, rigid:]


def elastic_frequencies(
    stiffness: csr_matrix,
    mass: csr_matrix,
    count: int,
    rigid: int,
    shift: float = _SHIFT,
    dense: bool = True,
) -> NDArray[np.float64]:
    """Lowest elastic circular frequencies √λ of K x = λ M x, rad/s.

    Parameters
    ----------
    stiffness, mass : sparse (n, n)
    count : int
    rigid : int
        Rigid motions, left out.
    shift : float
        Of the sparse solver, over the ratio of the matrices' diagonals.
    dense : bool
        Small problems by a dense solver. False: sparse wherever possible, which with another
        shift is a second computation of the same numbers.

    Raises
    ------
    ValueError
        If more modes are asked for than there are.
    """
    size = stiffness.shape[0]
    wanted = count + rigid
    if count < 1 or wanted > size:
        raise ValueError(f"{count} elastic modes asked for, {max(size - rigid, 0)} exist")
    if (dense and size <= _DENSE) or wanted >= size - 1:
        values = eigh(
            stiffness.toarray(), mass.toarray(), eigvals_only=True, subset_by_index=[0, wanted - 1]
        )
    else:
        scale = stiffness.diagonal().sum() / mass.diagonal().sum()
        values, _ = smallest_eigenpairs(stiffness, mass, wanted, -shift * scale)
    return elastic_part(values, rigid)
