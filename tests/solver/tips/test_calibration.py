"""A calibrated tip: symmetric, positive, blind to what no tip disturbs, alike at all spacings."""

import numpy as np
import pytest

from solver.material import Family, calibrate
from solver.material.tensors import ElasticTensor
from solver.tips import TipCalibrationError, calibrated_tip, calibration
from solver.tips.calibration import _calibrated, homogeneous

PAPER = np.array([[1.0, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])
PLACE, DIRECTION = np.array([0.3, -0.2]), np.array([0.6, 0.8])


def of(spacing=1.0, place=PLACE, direction=DIRECTION, scale=1.0):
    family = Family(2, spacing)
    moduli = calibrate(family, ElasticTensor(scale * PAPER), "lattice")
    return calibrated_tip(family, moduli, place, direction)


def test_it_leaves_rigid_motions_and_the_stress_along_the_crack_alone():
    tip, matrix = of()
    np.testing.assert_array_equal(tip.matrix, tip.matrix.T)
    away = tip.cells - PLACE
    a, b = DIRECTION
    along = np.linalg.solve(PAPER, [a * a, b * b, a * b])
    count = len(away)
    turn = np.concatenate([-away[:, 1], away[:, 0], np.ones(count)])
    for state in (homogeneous(away, along, 3)[:, 0], turn, np.repeat([1.0, 2.0, 0.0], count)):
        assert np.abs(matrix @ state).max() < 1e-9 * np.abs(matrix).max() * np.abs(state).max()
    # Not any stress: a shear along the crack loads its faces.
    across = np.linalg.solve(PAPER, [-2 * a * b, 2 * a * b, a * a - b * b])
    assert np.abs(matrix @ homogeneous(away, across, 3)).max() > 1e-3 * np.abs(matrix).max()
    low, high = tip.stretch
    assert 0.3 < low < 1.0 < high < 3.0


def test_it_is_made_once_for_all_spacings_units_and_the_opposite_tip():
    _calibrated.cache_clear()
    tip, matrix = of()
    fine, small = of(spacing=0.01, scale=1e9)
    wanted = matrix * 1e9 / 0.01**2
    np.testing.assert_allclose(small, wanted, atol=1e-6 * np.abs(wanted).max())
    np.testing.assert_array_equal(fine.cells, tip.cells)
    other, image = of(place=-PLACE, direction=-DIRECTION)
    assert _calibrated.cache_info().misses == 1
    np.testing.assert_array_equal(other.cells, -tip.cells)
    # The point image of a state answers with the image of its forces.
    state = np.random.default_rng(1).normal(size=(3, len(tip.cells)))
    sign = np.array([[-1.0], [-1.0], [1.0]])
    forces = (matrix @ state.ravel()).reshape(3, -1)
    found = (image @ (sign * state).ravel()).reshape(3, -1)
    np.testing.assert_allclose(found, sign * forces, atol=1e-9 * np.abs(forces).max())


def test_a_tip_on_a_border_has_one_calibration_from_either_side():
    _calibrated.cache_clear()
    one, _ = of(place=np.array([0.1, 0.5]), direction=np.array([1.0, 0.0]))
    two, _ = of(place=np.array([0.1, -0.5]), direction=np.array([1.0, 0.0]))
    assert _calibrated.cache_info().misses == 1
    np.testing.assert_array_equal(one.cells, two.cells + np.array([0, 1]))


@pytest.mark.parametrize("poisson", [1 / 3])
def test_without_rotations(poisson):
    family = Family(2, 1.0)
    moduli = calibrate(family, ElasticTensor.isotropic(1.0, poisson), "lattice")
    tip, _ = calibrated_tip(family, moduli, PLACE, DIRECTION)
    assert tip.matrix.shape == (2 * len(tip.cells),) * 2


def test_that_there_is_none_is_found_once(monkeypatch):
    monkeypatch.setattr(calibration, "_MOST", 1.0001)
    _calibrated.cache_clear()
    said = []
    for spacing in (1.0, 0.1):
        with pytest.raises(TipCalibrationError) as told:
            of(spacing=spacing)
        said.append(str(told.value))
    assert _calibrated.cache_info().misses == 1
    assert said[0] == said[1]
    assert "would have to change" in said[0]
    _calibrated.cache_clear()
