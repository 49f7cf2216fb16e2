"""Reactions against loads, work and the continuum."""

import numpy as np
import pytest

from solver import ElasticTensor, Load, Scene, SceneError, Support, recovery, rectangle
from solver.reactions import reaction


def low(x, y):
    return y < -7


@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
def test_a_cantilever_bears_what_acts_on_it(surface):
    load = Load.body_force((0.3, 0.1), where=lambda x, y: y > 7)
    traction = Load.traction((0.0, 0.2), (4.0, -8.0), (4.0, 8.0))
    scene = Scene(
        rectangle(8, 16), 1.0, ElasticTensor.isotropic(1.0, 0.2), m=2, surface=surface,
        supports=[Support.where(low, displacement=(0, 0), rotation=0)], loads=[load, traction],
    )  # fmt: skip
    solution = scene.solve(tolerance=1e-12)
    found = reaction(solution, low, about=(0.0, 0.0))
    # 8 particles at y = 7.5; the traction over the edge of length 16 but for what held
    # particles feel.
    parts = solution.discretisation
    x, y = parts.lattice.points.T
    f = parts.load
    nodal = np.zeros((2, 1)) if parts.nodal_load is None else parts.nodal_load[:2]
    total = f[:2].sum(axis=1) + nodal.sum(axis=1)
    np.testing.assert_allclose(found.force, -total, atol=1e-8)
    moment = (x * f[1] - y * f[0]).sum()
    if parts.nodal_load is not None:
        at = parts.operator.ended_stiffness.ended.outline.nodes.T
        moment += (at[0] * nodal[1] - at[1] * nodal[0]).sum()
    assert found.moment == pytest.approx(-moment, rel=1e-6)
    assert total == pytest.approx([2.4, 0.8 + 3.2], rel=1e-6)


def test_a_moved_grip_does_the_work_that_is_stored():
    supports = [
        Support.where(low, displacement=(0, 0), rotation=0),
        Support.where(lambda x, y: y > 7, displacement=(0.1, 0.2), rotation=0),
    ]
    scene = Scene(rectangle(8, 16), 1.0, ElasticTensor.isotropic(1.0, 0.2), m=2, supports=supports)
    solution = scene.solve(tolerance=1e-12)
    force = reaction(solution, lambda x, y: y > 7).force
    stored = recovery.strain_energy_density(solution).sum()
    assert 0.5 * force @ [0.1, 0.2] == pytest.approx(stored, rel=1e-8)
    with pytest.raises(SceneError, match="no particle"):
        reaction(solution, lambda x, y: y > 99)
