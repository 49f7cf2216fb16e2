"""Energies of single bonds against the operator, and against the kernels' own Python."""

import numpy as np

from solver import ElasticTensor, ExpansionTensor, Load, PolarTensor
from solver.fracture import bond_kernels
from solver.fracture.breaking import Breakable
from tests.solver.fracture.strip import scene

BODY = scene().discretise()
BONDS = Breakable(BODY, np.full(BODY.family.size, 2.0))


def field(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(3, BODY.lattice.count))


def arguments(grid):
    return grid, BONDS._segments, BONDS._steps


def test_compiled_energies_are_those_of_python():
    grid = BONDS._grid(0, field(1)).copy()
    compiled, plain = np.zeros_like(BONDS.strengths), np.zeros_like(BONDS.strengths)
    for tension in (True, False):
        rest = BONDS._load, BONDS.strengths, tension
        bond_kernels.bond_energies(*arguments(grid), *rest, compiled)
        bond_kernels.bond_energies.py_func(*arguments(grid), *rest, plain)
        np.testing.assert_allclose(compiled, plain, rtol=1e-12, atol=1e-14)
        assert (compiled >= 0).all()


def test_compiled_energies_of_polar_and_heated_bonds_are_those_of_python():
    body = scene(
        material=PolarTensor(ElasticTensor.isotropic(1.0, 0.2), np.eye(2)),
        loads=[Load.temperature(lambda x, y: x * y, ExpansionTensor([[0.3, 0.1], [0.1, -0.2]]))],
    ).discretise(constrained=True)
    bonds = Breakable(body, np.full(body.family.size, 2.0))
    grid = bonds._grid(0, field(1)).copy()
    other = bonds._grid(1, field(2)).copy()
    assert bonds.free.any()
    compiled, plain = np.zeros_like(bonds.strengths), np.zeros_like(bonds.strengths)
    for free in (bonds.free, bonds.free[:, :, :0]):
        places = free, bonds._segments, bonds._steps
        rest = bonds._load, bonds.strengths, True
        bond_kernels.rich_energies(grid, *places, *rest, compiled)
        bond_kernels.rich_energies.py_func(grid, *places, *rest, plain)
        np.testing.assert_allclose(compiled, plain, rtol=1e-12, atol=1e-14)
        sums = np.zeros((2, len(bonds._segments)))
        rest = bonds._segments, bonds._steps, bonds._stored, bonds.strengths
        bond_kernels.rich_work(grid, free, other, bonds.free, *rest, sums[0])
        bond_kernels.rich_work.py_func(grid, free, other, bonds.free, *rest, sums[1])
        np.testing.assert_allclose(sums[0], sums[1], rtol=1e-12)
    # Bond by bond as all together.
    single = bonds.energy_of(field(1), np.arange(bonds.strengths.size))
    np.testing.assert_allclose(single.sum(), bonds.stored(field(1)), rtol=1e-12)


def test_work_of_two_fields_is_symmetric_and_the_stored_energy_of_one():
    u, v = field(1), field(2)
    np.testing.assert_allclose(BONDS.stored(u, v), BONDS.stored(v, u), rtol=1e-12)
    single = BONDS.energy_of(u, np.arange(BONDS.strengths.size)[BONDS.strengths.ravel() > 0])
    np.testing.assert_allclose(single.sum(), BONDS.stored(u), rtol=1e-12)


def test_shortened_bonds_bear_nothing_under_tension_only():
    squeezed = np.zeros((3, BODY.lattice.count))
    squeezed[:2] = -0.1 * BODY.lattice.points.T
    assert not BONDS.utilisation(squeezed).any()
    stretched = BONDS.utilisation(-squeezed).copy()
    assert (stretched[(BONDS.strengths > 0) & ~BONDS.kept] > 0).all()
