"""Rotations condensed out: against the Schur complement, and negative curvature by name."""

import numpy as np
import pytest

from solver import ElasticTensor, Family, NegativeCurvatureError, Scene, Support, rectangle
from solver.geometry import Lattice
from solver.linear import Condensed
from solver.operators.assembled import to_csr


def _scene(nu: float, share: float, m: float = 3) -> Scene:
    def random(lattice: Lattice, family: Family) -> np.ndarray:
        return np.random.default_rng(2).random((family.size // 2, lattice.count)) < share

    return Scene(
        region=rectangle(1.0, 1.0), spacing=1 / 12, m=m, surface="none",
        material=ElasticTensor.isotropic(1.0, nu), broken=random,
        supports=[Support.where(lambda x, y: abs(x) > 0.4, displacement=lambda x, y: np.stack(
            [0.1 * x, 0 * y], axis=-1))],
    )  # fmt: skip


def test_operator_is_the_schur_complement() -> None:
    operator = _scene(0.45, 0.1).discretise().operator
    dense = to_csr(operator).toarray()
    n = 2 * len(operator.active)
    schur = dense[:n, :n] - dense[:n, n:] @ np.linalg.solve(dense[n:, n:], dense[n:, :n])
    if operator.identity_rows is not None:
        # Identity rows stay identity rows.
        fixed = operator.identity_rows[:2].ravel()
        schur[fixed] = schur[:, fixed] = 0.0
        schur[fixed, fixed] = operator.identity_scale
    condensed = Condensed(operator)
    found = np.column_stack([condensed.matvec(e) for e in np.eye(n)])
    assert np.abs(found - schur).max() <= 1e-11 * np.abs(schur).max()


def test_damaged_saddle_agrees_with_a_direct_solve() -> None:
    scene = _scene(0.45, 0.1)
    problem, solution = scene.discretise(), scene.solve(1e-10)
    assert solution.statistics.method.startswith("CG on condensed")
    exact = np.linalg.solve(to_csr(problem.operator).toarray(), problem.right_hand_side())
    found = solution.unknowns[:, problem.operator.active].ravel()
    free = (
        ~problem.operator.identity_rows.ravel()
        if problem.operator.identity_rows is not None
        else slice(None)
    )
    assert np.linalg.norm((found - exact)[free]) <= 1e-8 * np.linalg.norm(exact)


def test_damage_that_makes_the_condensed_energy_negative_is_named() -> None:
    # Most bonds gone at m = 3 and nu = 0.49: dense inertia shows more negative eigenvalues than
    # rotations, and the solver must say so instead of returning a number.
    scene = _scene(0.49, 0.5)
    operator = scene.discretise().operator
    spectrum = np.linalg.eigvalsh(to_csr(operator).toarray())
    rotations = (
        int((~operator.identity_rows[2]).sum())
        if operator.identity_rows is not None
        else len(operator.active)
    )
    assert (spectrum < 0).sum() > rotations
    with pytest.raises(NegativeCurvatureError, match="non-positive energy"):
        scene.solve(1e-8)
