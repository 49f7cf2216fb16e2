import numpy as np
import pytest
from scipy.sparse import csr_matrix

from references.linear import solve_with_prescribed


def chain(number: int, ground: float) -> csr_matrix:
    """Springs in a row; ``ground`` holds the first mass."""
    k = 2 * np.eye(number) - np.eye(number, k=1) - np.eye(number, k=-1)
    k[0, 0], k[-1, -1] = 1 + ground, 1
    return csr_matrix(k)


def test_prescribed_values_and_loads() -> None:
    solution, unknowns = solve_with_prescribed(
        chain(4, 0.0), np.array([0.0, 0, 0, 2]), np.array([1.0, np.nan, np.nan, np.nan])
    )
    assert unknowns == 3
    assert np.allclose(solution, [1, 3, 5, 7], rtol=1e-14)


@pytest.mark.parametrize("ground", [0.0, 1e-17])
def test_singular_systems_are_refused(ground: float) -> None:
    with pytest.raises(FloatingPointError, match="singular"):
        solve_with_prescribed(chain(50, ground), np.eye(50)[49], np.full(50, np.nan))


def test_a_solution_that_leaves_a_residual_is_refused() -> None:
    """An eigenvalue below rounding: pivots differ from zero, the answer is 1e15 and means nothing.

    Without the check it comes back without a word.
    """
    rng = np.random.default_rng(0)
    q = np.linalg.qr(rng.standard_normal((40, 40)))[0]
    matrix = q @ np.diag(np.r_[1e-18, np.linspace(1, 2, 39)]) @ q.T
    with pytest.raises(FloatingPointError, match=r"nearly singular: .* of the load as residual"):
        solve_with_prescribed(csr_matrix((matrix + matrix.T) / 2), q[:, 0], np.full(40, np.nan))
