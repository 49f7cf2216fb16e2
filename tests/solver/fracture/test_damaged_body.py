"""Equilibria of a body that loses bonds: as solved afresh, with the energy that they set free."""

import numpy as np
import pytest

from solver.fracture.breaking import Breakable
from solver.fracture.damaged_body import Equilibrium
from solver.operators.assembled import to_csr
from tests.solver.fracture.strip import scene


@pytest.fixture
def body():
    built = scene().discretise()
    bonds = Breakable(built, np.ones(built.family.size))
    found = Equilibrium(built, bonds, tolerance=1e-11, max_iterations=2000)
    found.solve()
    return found


def fresh(body) -> np.ndarray:
    """Unknowns by a dense solve of the operator as it is now."""
    operator = body.operator
    rhs = -operator.coupling(np.where(body.prescribed, body.sound.values, 0.0)).ravel()
    x = np.linalg.solve(to_csr(operator).toarray(), rhs)
    return x.reshape(operator.components, -1)


def test_sound_body_is_solved_like_any_other(body):
    solution = scene().solve(tolerance=1e-11)
    np.testing.assert_allclose(body.unknowns, solution.unknowns, atol=1e-9)


def test_broken_bonds_change_the_answer_as_a_fresh_solve_has_it(body):
    bonds = body.breakable
    worst = np.argsort(bonds.utilisation(body.unknowns).ravel())[-4:]
    before = bonds.stored(body.unknowns)
    held = bonds.energy_of(body.unknowns, worst).sum()
    bonds.broken.add(worst, 0, 1.0, False)
    body.follow()
    step = body.solve()
    active = body.operator.active
    np.testing.assert_allclose(body.unknowns[:, active], fresh(body), atol=1e-8)
    # What is gone was held by the bonds, or set free by relaxing.
    after = bonds.stored(body.unknowns)
    assert before - after == pytest.approx(held + step.released, rel=1e-6)
    assert step.released > 0
