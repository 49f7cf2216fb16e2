"""Shifted operators: the same matrix as K + σ M, and one preconditioner for neighbouring σ."""

import numpy as np
import pytest

from solver import (
    ConductivityTensor,
    ConvergenceError,
    Crack,
    ElasticTensor,
    Scene,
    Support,
    UniformShear,
    rectangle,
)
from solver.linear.shifted import Shifted
from solver.operators.assembled import to_csr
from solver.problem import Discretisation
from solver.problem.rigid import parts

SOLIDS = {
    "conductive": (ConductivityTensor([[5.0, 2.0], [2.0, 1.0]]), None, "lattice"),
    "positive": (ElasticTensor.isotropic(1.0, 0.2), None, "lattice"),
    "central": (ElasticTensor.isotropic(1.0, 1 / 3), UniformShear(), "lattice"),
    "indefinite": (ElasticTensor.isotropic(1.0, 0.4), None, "lattice"),
}


def body(solid, n=9, surface="volume", cracks=()):
    material, law, calibration = SOLIDS[solid]
    rollers = []
    if solid != "conductive":
        rollers = [Support.where(lambda x, y: x < -0.4, u1=0.0)]
    scene = Scene(
        region=rectangle(1.0, 0.8, angle=0.2),
        spacing=1 / n,
        m=2 if n < 20 else 3,
        material=material,
        law=law,
        calibration=calibration,
        surface=surface,
        supports=rollers,
        cracks=cracks,
    )
    return Discretisation.of(scene, free=True)


def mass_of(found):
    shares = found.volumes[found.operator.active]
    mass = np.tile(shares, (found.operator.components, 1))
    if found.operator.components == 3:
        mass[2] = 0.0
    return mass


@pytest.mark.parametrize("surface", ["volume", "extrapolated"])
@pytest.mark.parametrize("solid", SOLIDS)
def test_a_shifted_operator_is_the_matrix_plus_a_diagonal(solid, surface):
    found = body(solid, surface=surface)
    operator, mass = found.operator, mass_of(found)
    wanted = to_csr(operator).toarray() + np.diag(3.7 * mass.ravel())
    shifted = operator.shifted(3.7 * mass)
    made = shifted @ np.eye(operator.shape[0])
    free = np.ones(operator.shape[0], dtype=bool)
    if operator.identity_rows is not None:
        free = ~operator.identity_rows.ravel()
    scale = np.abs(wanted).max()
    np.testing.assert_allclose(made[free][:, free], wanted[free][:, free], atol=1e-13 * scale)
    np.testing.assert_allclose(made, made.T, atol=1e-13 * scale)
    blocks = shifted.block_diagonal
    size = len(operator.active)
    for a in range(operator.components if surface == "volume" else 0):
        at = a * size + np.arange(size)
        np.testing.assert_allclose(blocks[:, a, a][free[at]], np.diag(made)[at][free[at]])
    # The operator itself is as it was.
    np.testing.assert_allclose(
        (operator @ np.eye(operator.shape[0])), to_csr(operator).toarray(), atol=1e-13 * scale
    )


def test_the_bulk_has_one_diagonal():
    found = body("conductive", n=16)
    mass = mass_of(found)
    inner = np.setdiff1d(np.arange(mass.shape[1]), found.operator.own)
    mass[0, inner[3]] *= 1.1
    with pytest.raises(ValueError, match="differs between particles of the bulk"):
        found.operator.shifted(mass)


@pytest.mark.parametrize("solid", SOLIDS)
def test_solutions_for_many_shifts_with_few_preconditioners(solid):
    found = body(solid, n=56)
    solver = Shifted(found.operator, found.stability.kind, mass_of(found))
    scale = float(np.abs(found.operator.bulk).max())
    rng = np.random.default_rng(1)
    for share in (1.0, 0.7, 1e-3, 1.6e-3, 0.6e-3):
        rhs = rng.standard_normal(found.operator.shape[0])
        if found.operator.identity_rows is not None:
            rhs[found.operator.identity_rows.ravel()] = 0.0
        x = solver.solve(share * scale, rhs, np.zeros_like(rhs), 1e-10)
        left = rhs - solver.matrix(share * scale).matvec(x)
        assert np.linalg.norm(left) <= 1e-10 * np.linalg.norm(rhs)
    assert solver.built == 2
    assert solver.iterations < 5 * 60


def test_each_part_keeps_its_heat_however_loose_the_solve():
    found = body("conductive", n=20, cracks=[Crack((-1.0, 0.0), (1.0, 0.0))])
    count, labels = parts(found.bonds)
    assert count == 2
    mass = mass_of(found)
    solver = Shifted(found.operator, "positive", mass, labels)
    rhs = np.where(labels == 0, np.cos(5 * found.lattice.points[:, 0]), 0.0)
    x = solver.solve(0.5, rhs, np.zeros_like(rhs), 1e-2)
    stored = np.bincount(labels, 0.5 * mass[0] * x)
    # No heat is made but by rounding of what flows: twice the diagonal stands for |K| |x|.
    rounding = np.finfo(float).eps * 2 * (found.operator.diagonal.ravel() * np.abs(x)).sum()
    assert rounding < 1e-10
    assert stored[0] == pytest.approx(rhs.sum(), abs=rounding)
    assert stored[1] == 0.0


def test_stopping_short_is_an_error():
    found = body("conductive", n=20)
    solver = Shifted(found.operator, "positive", mass_of(found))
    rhs = np.cos(np.arange(found.operator.shape[0]))
    with pytest.raises(ConvergenceError, match="stopped at a relative residual"):
        solver.solve(1e-3, rhs, np.zeros_like(rhs), 1e-12, limit=2)
