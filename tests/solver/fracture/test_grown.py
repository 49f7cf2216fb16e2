"""What results of growing cracks hand out, whatever stands beside them."""

import numpy as np

from solver.fracture.grown import Grown
from solver.fracture.quench import Quenched
from solver.fracture.sensed import Sensed
from tests.solver.fracture.test_quench import GIVEN, PLATE, run


def test_points_cells_and_stress_are_the_cracks_own():
    found = run(PLATE, **GIVEN, G1=0.05, no_fail=lambda x, y: y < -0.5, max_solves=3)
    np.testing.assert_array_equal(found.points, found.growth.points)
    np.testing.assert_array_equal(found.cells.corners, found.growth.cells.corners)
    np.testing.assert_array_equal(found.stressed.unknowns, found.growth.unknowns)
    assert issubclass(Quenched, Grown)
    assert issubclass(Sensed, Grown)
