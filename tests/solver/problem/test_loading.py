"""What is prescribed and what acts, laid on the lattice: resultants, units, and who is refused."""

import numpy as np
import pytest

from solver import Crack, ElasticTensor, Load, Scene, SceneError, Support, rectangle
from solver.geometry import Lattice
from solver.material import calibrated
from solver.problem import Discretisation, loading

SOLID = ElasticTensor.isotropic(1.0, 0.2)
HELD = Support.where(lambda x, y: x < -0.7, displacement=0.0)


def laid(region=None, **options):
    settings = {"m": 2, "supports": [HELD], **options}
    scene = Scene(rectangle(2.0, 1.0) if region is None else region, 0.1, SOLID, **settings)
    family = scene.family()
    lattice = Lattice(scene.region, scene.spacing, family.reach)
    return scene, lattice, calibrated(family, SOLID, "lattice", None)


def test_rotations_are_prescribed_in_units_of_length():
    """θ enters the equations as θ Δx."""
    turned = Support.where(lambda x, y: x > 0.8, displacement=(0.01, 0.0), rotation=0.3)
    prescribed, values = loading.prescribed_values(*laid(supports=[HELD, turned]))
    assert prescribed[:2].sum() == 2 * (prescribed[0]).sum()
    assert set(np.unique(values[2])) == {0.0, 0.3 * 0.1}
    assert prescribed[2].sum() == prescribed[0].sum() - 30


def test_a_later_support_wins():
    other = Support.where(lambda x, y: x < -0.85, u1=0.5)
    _, values = loading.prescribed_values(*laid(supports=[HELD, other]))
    assert sorted(set(values[0])) == [0.0, 0.5]
    assert not values[1].any()


def test_body_loads_add_up_and_couples_are_forces_at_a_length():
    given = laid(loads=[Load.body_force((2.0, -1.0)), Load.couple(3.0)])
    found = loading.body_loads(*given, None) * 0.01
    np.testing.assert_allclose(found.sum(axis=1), [4.0, -2.0, 6.0 / 0.1], rtol=1e-12)


@pytest.mark.parametrize("surface", ["none", "volume", "extrapolated"])
def test_what_acts_on_an_edge_arrives_whole(surface):
    """On its nodes where bonds end there, on the nearest particles where none does."""
    pull = Load.stress((0.3, 0.0, 0.2), where=rectangle(0.2, 2.0, (1.0, 0.0)))
    body = Discretisation.of(laid(loads=[pull], surface=surface)[0])
    total = body.load.sum(axis=1)[:2]
    if body.nodal_load is not None:
        total = total + body.nodal_load.sum(axis=1)[:2]
        assert not body.load.any()
    np.testing.assert_allclose(total * 0.01, [0.3, 0.2], rtol=1e-12)


def test_cracks_follow_the_lattice():
    far = rectangle(2.0, 1.0, (3e6, -5e5))
    crack = Crack((3e6 - 0.5, -5e5), (3e6 + 0.5, -5e5))
    _, lattice, _ = laid(far, supports=())
    (moved,) = loading.centred_cracks([crack], lattice)
    np.testing.assert_allclose(np.ptp(moved.points, axis=0), [1.0, 0.0], atol=1e-9)
    assert np.abs(moved.points).max() < 2.0


def test_a_support_of_nothing_is_refused():
    nowhere = Support.where(lambda x, y: x > 9.0, displacement=0.0)
    with pytest.raises(SceneError, match="holds no particle"):
        loading.prescribed_values(*laid(supports=[nowhere]))
