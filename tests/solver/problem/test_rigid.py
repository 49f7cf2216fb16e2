"""Every part of a body must be held; the error says which motion is left free."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import ConductivityTensor, Crack, ElasticTensor, Family, Scene, SceneError, Support
from solver.bonds import Bonds
from solver.geometry import Lattice
from solver.material.physics import ELASTICITY
from solver.problem.rigid import free_motions, parts, rigid_motions
from tests.solver.bodies import Cells, block, exact, masks
from tests.solver.bonds.test_bonds import pair_factors

POLAR, CENTRAL = ElasticTensor.isotropic(1.0, 0.2), ElasticTensor.isotropic(1.0, 1 / 3)
CONDUCTOR = ConductivityTensor.isotropic(1.0)


def discretise(material, *supports, region=None, **options):
    region = block(10, 8) if region is None else region
    return Scene(region, 1.0, material, supports, m=2, **options).discretise()


def joined(bonds):
    """Label of every particle, found by spreading along the bonds that exist."""
    label = np.arange(bonds.lattice.count)
    while True:
        before = label.copy()
        for (p, q), factor in pair_factors(bonds).items():
            if factor:
                label[p] = label[q] = min(label[p], label[q])
        if np.array_equal(label, before):
            return label


@exact
@given(masks(), st.sampled_from([1, 2, 1.5]), st.booleans())
def test_parts_are_what_bonds_join(mask, m, cracked):
    mask[2:4, 1:6] = True
    family = Family(m, 1.0, "partial")
    cracks = [Crack((0.0, 3.0), (7.0, 3.1)), Crack((4.1, -1.0), (4.0, 9.0))] if cracked else []
    bonds = Bonds(Lattice(Cells(mask), 1.0, family.reach), family, cracks)
    count, labels = parts(bonds)
    wanted = joined(bonds)
    assert count == len(np.unique(wanted)) == len(np.unique(labels))
    # The same partition, whatever the numbers.
    assert len(set(zip(labels.tolist(), wanted.tolist(), strict=True))) == count


# ---- which motion -------------------------------------------------------------------------------


@pytest.mark.parametrize("material", [POLAR, CENTRAL])
@pytest.mark.parametrize(
    ("supports", "free", "blocked"),
    [
        ([], ["along 1", "along 2", "rotation"], []),
        # Rollers on a vertical edge stop the rotation too.
        ([Support.where(lambda x, y: x < 1, u1=0.0)], ["along 2"], ["along 1", "rotation"]),
        ([Support.where(lambda x, y: y < 1, u2=0.0)], ["along 1"], ["along 2", "rotation"]),
        # A single point is a hinge.
        (
            [Support.where(lambda x, y: (x == 4.5) & (y == 3.5), displacement=0.0)],
            ["rotation"],
            [],
        ),
    ],
)
def test_the_error_names_the_free_motion(material, supports, free, blocked):
    with pytest.raises(SceneError, match="rigid motion of the body") as caught:
        discretise(material, *supports)
    message = str(caught.value)
    for name in free:
        assert name in message
    for name in blocked:
        assert f"translation {name}" not in message
        assert f"{name}," not in message
    assert "80 particles" in message


def test_rollers_on_two_edges_hold():
    for material in (POLAR, CENTRAL):
        discretise(
            material,
            Support.where(lambda x, y: x < 1, u1=0.0),
            Support.where(lambda x, y: y < 1, u2=0.0),
        )


def test_a_prescribed_rotation_holds_a_hinge():
    discretise(POLAR, Support.where(lambda x, y: (x < 1) & (y < 1), displacement=0.0, rotation=0.0))
    # Without shear stiffness there is no rotation to hold.
    with pytest.raises(SceneError, match="rotation"):
        discretise(
            CENTRAL, Support.where(lambda x, y: (x < 1) & (y < 1), displacement=0.0, rotation=0.0)
        )


def test_a_body_of_any_size_and_unit():
    scene = Scene(
        block(40, 40, 1e-7),
        1e-7,
        POLAR,
        [Support.where(lambda x, y: y < 1e-7, displacement=0.0)],
        m=2,
    )
    scene.discretise()


def test_a_floating_temperature():
    with pytest.raises(SceneError, match=r"no temperature is prescribed on the body .80 particles"):
        discretise(CONDUCTOR)
    discretise(CONDUCTOR, Support.where(lambda x, y: (x < 1) & (y < 1), temperature=0.0))


# ---- fragments ----------------------------------------------------------------------------------

LEFT = {"displacement": 0.0, "rotation": 0.0}
ACROSS = Crack((6.0, -1.0), (6.0, 9.0))


def test_a_part_cut_off_must_be_held_itself():
    left = Support.where(lambda x, y: x < 2, **LEFT)
    right = Support.where(lambda x, y: x > 9, **LEFT)
    with pytest.raises(SceneError, match=r"the part about \(8, 4\) \(32 particles\)"):
        discretise(POLAR, left, cracks=[ACROSS])
    discretise(POLAR, left, right, cracks=[ACROSS])
    with pytest.raises(SceneError, match=r"no temperature .* the part about \(8, 4\)"):
        discretise(CONDUCTOR, Support.where(lambda x, y: x < 2, temperature=0.0), cracks=[ACROSS])


def test_a_crack_that_leaves_a_ligament_leaves_one_part():
    left = Support.where(lambda x, y: x < 2, **LEFT)
    discretise(POLAR, left, cracks=[Crack((6.0, -1.0), (6.0, 7.0))])


def test_a_fragment_inside():
    left = Support.where(lambda x, y: x < 1, **LEFT)
    island = Crack((6, 3), (8, 3), (8, 5), (6, 5), (6, 2.5))
    with pytest.raises(SceneError, match=r"the part about \(7, 4\) \(4 particles\)"):
        discretise(POLAR, left, cracks=[island])
    held = Support.where(lambda x, y: (abs(x - 7) < 1) & (abs(y - 4) < 1), **LEFT)
    discretise(POLAR, left, held, cracks=[island])


def test_bodies_apart():
    mask = np.ones((6, 15), dtype=bool)
    mask[:, 5:9] = False
    left = Support.where(lambda x, y: x < 2, **LEFT)
    with pytest.raises(SceneError, match=r"the part about \(12, 3\) \(36 particles\)"):
        discretise(POLAR, left, region=Cells(mask))
    # A gap narrower than the horizon is a gap.
    mask[:, 6:9] = True
    with pytest.raises(SceneError, match=r"the part about \(10.5, 3\) \(54 particles\)"):
        discretise(POLAR, left, region=Cells(mask))


def test_bodies_that_touch_at_a_corner_without_a_bond_are_two():
    mask = np.zeros((4, 4), bool)
    mask[:2, :2] = mask[2:, 2:] = True
    family = Family(1, 1.0, "full")  # four neighbours, no diagonals
    assert parts(Bonds(Lattice(Cells(mask), 1.0, 1), family))[0] == 2


@pytest.mark.filterwarnings("error")
def test_a_point_that_has_no_rotation_does_not_turn():
    """Of a lone particle without shear stiffness two motions are left, and none is nothing."""
    point = np.zeros((1, 2))
    free = np.zeros((2, 1), dtype=bool)
    said = "translation along 1, translation along 2"
    assert free_motions(point, free, ELASTICITY) == said
    assert free_motions(point, ~free, ELASTICITY) == ""
    assert free_motions(point, np.zeros((3, 1), dtype=bool), ELASTICITY) == f"{said}, rotation"
    mask = np.ones((6, 6), dtype=bool)
    mask[:2] = False
    mask[0, 0] = True
    lattice = Lattice(Cells(mask), 1.0, 3)
    bonds = Bonds(lattice.centred, Family(1, 1.0), [], "none")
    found = rigid_motions(bonds, np.zeros((2, lattice.count), dtype=bool), ELASTICITY)
    assert len(found) == 3 + 2
    assert np.abs(found).max(axis=(1, 2)).min() > 0.1
