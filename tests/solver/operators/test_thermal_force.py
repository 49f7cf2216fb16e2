"""Thermal forces as a matrix: those of the eigenstrain, and in equilibrium whatever the field."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import (
    ElasticTensor,
    ExpansionTensor,
    Load,
    PolarTensor,
    Scene,
    SceneError,
    Support,
    rectangle,
)
from solver.operators.thermal_force import thermal_force
from tests.solver.bodies import FIG_7, few

SOLIDS = {
    "anisotropic": ElasticTensor(FIG_7),
    "central": ElasticTensor.isotropic(1.0, 1 / 3),
    "polar": PolarTensor(ElasticTensor.isotropic(1.0, 0.2), np.eye(2)),
}


def body(solid, surface="volume", loads=()):
    corner = Support.where(lambda x, y: x < -0.4, displacement=0.0, rotation=0.0)
    scene = Scene(rectangle(1.0, 0.8), 0.1, solid, [corner], loads, m=2, surface=surface)
    return scene.discretise(constrained=True)


@few
@given(st.sampled_from(list(SOLIDS)), st.sampled_from(["none", "volume"]), st.integers(0, 10**6))
def test_it_is_what_temperatures_exert(solid, surface, seed):
    a, b, c = np.random.default_rng(seed).normal(size=3)
    expansion = ExpansionTensor([[a, c], [c, b]])
    hot = Load.temperature(lambda x, y: np.sin(7 * x) + y**3, expansion)
    parts = body(SOLIDS[solid], surface, [hot])
    x, y = parts.lattice.places.T
    force = thermal_force(parts.bonds, parts.moduli, expansion)
    found = (force @ (np.sin(7 * x) + y**3)).reshape(parts.load.shape)
    np.testing.assert_allclose(found, parts.load, atol=1e-12 * np.abs(parts.load).max())
    # Rigid motions draw no heat.
    still = np.stack([-y, x, 0.1 + 0 * x])[: parts.moduli.components]
    scale = np.abs(force).max()
    assert np.abs(force.T @ still.ravel()).max() < 1e-13 * scale
    assert np.abs(force).max() > 0


def test_bonds_that_end_at_the_surface_are_refused():
    parts = body(SOLIDS["anisotropic"], "extrapolated")
    with pytest.raises(SceneError, match="known to whole bonds only"):
        thermal_force(parts.bonds, parts.moduli, ExpansionTensor.isotropic(1.0))
