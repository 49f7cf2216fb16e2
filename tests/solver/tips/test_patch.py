"""A patch is the body around the tip, whatever the spacing."""

import numpy as np

from solver.material import Family, calibrate
from solver.material.tensors import ElasticTensor
from solver.tips.patch import Patch, among

PAPER = np.array([[1.0, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])


def test_bonds_within_do_not_resist_rigid_motions_and_the_plain_error_is_the_tips():
    family = Family(2, 1.0)
    moduli = calibrate(family, ElasticTensor(PAPER), "lattice")
    place = np.array([0.3, -0.2])
    patch = Patch.of(family, moduli, place, np.array([0.6, 0.8]))
    count = len(patch.cells)
    x, y = (patch.cells - place).T
    one, none = np.ones(count), np.zeros(count)
    for rigid in ((one, none, none), (none, one, none), (-y, x, one)):
        assert np.abs(patch.bonds @ np.concatenate(rigid)).max() < 1e-12 * np.abs(patch.bonds).max()
    np.testing.assert_array_equal(patch.bonds, patch.bonds.T)
    np.testing.assert_allclose(
        among(family, moduli, patch.cells, 2 * patch.strengths), 2 * patch.bonds
    )
    error = np.linalg.norm((patch.plain - patch.exact)[:2], axis=(0, 1))
    assert error.max() < 0.05
    assert error.min() > 1e-4
    np.testing.assert_allclose(np.linalg.norm(patch.exact[:2], axis=(0, 1)), 1.0)
