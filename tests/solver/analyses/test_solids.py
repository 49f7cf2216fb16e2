"""Solids as scene files name them."""

import numpy as np
import pytest

from solver import ConductivityTensor, ExpansionTensor, SceneError
from solver.analyses.solids import heated


def test_values_lie_along_turned_axes():
    conductor, expansion = heated((3.0, 1.0), (2e-5, -1e-5), 30.0)
    along = np.array([np.cos(np.pi / 6), np.sin(np.pi / 6)])
    across = np.array([-along[1], along[0]])
    assert isinstance(conductor, ConductivityTensor)
    assert isinstance(expansion, ExpansionTensor)
    for matrix, first, second in ((conductor.matrix, 3, 1), (expansion.matrix, 2e-5, -1e-5)):
        np.testing.assert_allclose(matrix @ along, first * along, rtol=1e-12)
        np.testing.assert_allclose(matrix @ across, second * across, rtol=1e-12)


@pytest.mark.parametrize("wrong", [0.0, -1.0, np.inf, np.nan])
def test_no_conductivity_is_refused(wrong):
    for pair in ((wrong, 1.0), (1.0, wrong)):
        with pytest.raises(SceneError, match="conductivities must be positive and finite"):
            heated(pair, (0.0, 0.0), 0.0)


@pytest.mark.parametrize("wrong", [np.inf, np.nan])
def test_no_expansion_is_refused(wrong):
    with pytest.raises(SceneError, match="coefficients of expansion must be finite"):
        heated((1.0, 1.0), (wrong, 0.0), 0.0)
