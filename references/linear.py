"""Sparse symmetric systems with prescribed unknowns."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import SuperLU, splu

# of the load; refinement leaves 1e-12 or less on the meshes of this package
_RESIDUAL = 1e-9


def factorise(matrix: csr_matrix) -> SuperLU:
    """Factorise a symmetric matrix without pivoting off the diagonal.

    Minimum degree on A + Aᵀ keeps the fill of a symmetric matrix several times below that of
    SuperLU's default, which is meant for unsymmetric ones.

    Raises
    ------
    MemoryError
        If SuperLU cannot hold the factors.
    FloatingPointError
        If the matrix is singular.
    """
    try:
        return splu(
            matrix.tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except MemoryError as error:
        # SuperLU counts its fill with 32 bits, whatever memory there is
        raise MemoryError(
            f"{matrix.shape[0]} unknowns are too many for SuperLU: use a coarser mesh, or FEniCSx"
            " on several processes (references.fenicsx.bridge)"
        ) from error
    except RuntimeError as error:
        raise FloatingPointError(f"the finite-element matrix is singular ({error})") from error


def solve_with_prescribed(
    matrix: csr_matrix, load: NDArray[np.float64], values: NDArray[np.float64]
) -> tuple[NDArray[np.float64], int]:
    """Solve K u = f where ``values`` prescribes u (NaN: free).

    One step of iterative refinement takes the factorisation's rounding out; what is left of the
    residual must be small, which a nearly singular matrix does not allow.

    Returns
    -------
    solution : (n,) float array
    unknowns : int
        Number of free unknowns.

    Raises
    ------
    FloatingPointError
        If the solution is not finite or does not satisfy the equations (a singular matrix).
    """
    free = np.isnan(values)
    solution = np.where(free, 0.0, values)
    matrix = matrix.tocsr()
    reduced = matrix[free][:, free]
    right = load[free] - (matrix @ solution)[free]
    factors = factorise(reduced)
    found = factors.solve(right)
    found += factors.solve(right - reduced @ found)
    if not np.isfinite(found).all():
        raise FloatingPointError("the finite-element matrix is singular")
    residual = np.linalg.norm(right - reduced @ found)
    if residual > _RESIDUAL * np.linalg.norm(right):
        raise FloatingPointError(
            "the finite-element matrix is nearly singular: the solution leaves"
            f" {residual / np.linalg.norm(right):.1e} of the load as residual"
        )
    solution[free] = found
    return solution, int(free.sum())
