"""What is prescribed and what acts, laid on the lattice: resultants, units, and who is refused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import Crack, ElasticTensor, Load, Scene, SceneError, Support, polygon, rectangle
from solver.geometry import Lattice
from solver.material import calibrated
from solver.problem import Discretisation, loading
from tests.solver.bodies import few

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


@few
@given(st.floats(0.2, 0.8), st.floats(-0.2, 0.2), st.floats(-1, 1), st.floats(-1, 1))
def test_loads_in_a_cusp_keep_their_moment(angle, turn, s1, s2):
    """The nearest particle may be many cells away: alone it lost a tenth of the moment."""
    half = np.tan(0.5 * angle)
    c, s = np.cos(turn), np.sin(turn)
    corners = [(-1.5, 0.0), (1.0, -2.5 * half), (1.0, 2.5 * half)]
    body = polygon([(c * x - s * y, s * x + c * y) for x, y in corners])
    held = Support.where(lambda x, y: c * x + s * y > 0.2, displacement=0.0)
    stress = np.array([s1, s2, 0.3])
    upper = Load.stress(stress, where=lambda x, y: (c * y > s * x) & (c * x + s * y < 0))
    scene = laid(body, supports=[held], loads=[upper], surface="extrapolated", m=3)[0]
    parts = Discretisation.of(scene)
    nodes = parts.bonds.ended.outline.nodes + parts.lattice.centred.shift
    places = np.concatenate([parts.lattice.places, nodes])
    force = 0.01 * np.concatenate([parts.load[:2], parts.nodal_load[:2]], axis=1)
    # The upper edge from the tip to the middle, with the normal (−sin, cos) of its slope.
    ends = np.array([(-1.5, 0.0), (0.0, 1.5 * half)]) @ np.array([(c, s), (-s, c)])
    along = ends[1] - ends[0]
    f1, f2 = np.array([[stress[0], stress[2]], [stress[2], stress[1]]]) @ [-along[1], along[0]]
    x, y = ends.mean(axis=0)
    np.testing.assert_allclose(force.sum(axis=1), [f1, f2], atol=1e-9)
    moment = (places[:, 0] * force[1] - places[:, 1] * force[0]).sum()
    assert moment == pytest.approx(x * f2 - y * f1, abs=1e-9)
