"""Rotations in equilibrium: the condensed matrix, no torque left, and the next one guessed."""

import numpy as np
import pytest

from solver import Crack, ElasticTensor, Scene, Support, rectangle
from solver.linear.rotations import MasslessRotations
from solver.operators.assembled import to_csr
from solver.problem import Discretisation
from solver.problem.rigid import parts


def body(nu, surface, supports=(), cracks=()):
    scene = Scene(
        region=rectangle(1.0, 0.8, angle=0.2),
        spacing=0.1,
        m=2,
        material=ElasticTensor.isotropic(1.0, nu),
        surface=surface,
        supports=supports,
        cracks=cracks,
    )
    found = Discretisation.of(scene, free=True)
    _, labels = np.unique(parts(found.bonds)[1][found.operator.active], return_inverse=True)
    return found, labels


@pytest.mark.parametrize("surface", ["volume", "extrapolated"])
@pytest.mark.parametrize("nu", [0.2, 0.4])
def test_forces_and_rotations_are_the_condensed_ones(nu, surface):
    held = [Support.where(lambda x, y: x < -0.3, u1=0.0), Support.where(disc_at, rotation=0.0)]
    found, labels = body(nu, surface, held)
    operator = found.operator
    count = len(operator.active)
    rng = np.random.default_rng(0)
    u, moment = rng.standard_normal((2, count)), rng.standard_normal(count)
    u[operator.identity_rows[:2]] = 0.0
    moment[operator.identity_rows[2]] = 0.0
    matrix = to_csr(operator).toarray()
    theta = np.linalg.solve(
        matrix[2 * count :, 2 * count :], moment - matrix[2 * count :, : 2 * count] @ u.ravel()
    )
    wanted = matrix[: 2 * count] @ np.concatenate([u.ravel(), theta])
    wanted = np.where(operator.identity_rows[:2], 0.0, wanted.reshape(2, -1))
    solver = MasslessRotations(operator, found.stability.kind, 1e-11, labels)
    for _ in range(3):
        force, turned = solver(u, moment)
        np.testing.assert_allclose(turned, theta, atol=1e-9 * np.abs(theta).max())
        np.testing.assert_allclose(force, wanted, atol=1e-9 * np.abs(wanted).max())
        before = solver.inner
        solver.remember(turned)
    # Of the same field the rotations are known.
    solver(u, moment)
    assert solver.inner - before < 5


def disc_at(x, y):
    return np.hypot(x - 0.2, y) < 0.15


@pytest.mark.parametrize("nu", [0.2, 0.4])
def test_no_torque_is_left_however_loose_the_solve(nu):
    """Each part by itself: the forces' moment about the origin vanishes."""
    found, labels = body(nu, "volume", cracks=[Crack((-1.0, 0.0), (1.0, 0.0))])
    assert labels.max() == 1
    u = np.random.default_rng(1).standard_normal((2, len(labels)))
    solver = MasslessRotations(found.operator, found.stability.kind, 1e-2, labels)
    force, _ = solver(u)
    x, y = found.lattice.points.T
    torque = np.bincount(labels, x * force[1] - y * force[0])
    assert np.abs(torque).max() < 1e-12 * np.abs(force).sum()
    np.testing.assert_allclose(force.sum(axis=1), 0.0, atol=1e-12 * np.abs(force).sum())
