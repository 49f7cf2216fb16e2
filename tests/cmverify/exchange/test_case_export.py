"""A case in plain files says the problem that the solver solves."""

import json

import numpy as np
import pytest

from cmverify.cases import registry
from cmverify.exchange.case_export import FORMAT, pose_of, write_case
from cmverify.exchange.statement import ABSOLUTE, L2, L2_STRAINED, LARGEST, NORMS, Target

POSED = [
    (case, pose) for case in registry.all_cases() for pose in case.poses[:1]
]  # one problem a case; more of them are the same code


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Files of the plate with a hole, at 12 cells."""
    folder = tmp_path_factory.mktemp("hole")
    case = registry.get("hole-tractions-anisotropic")
    paths = write_case(case, case.poses[0], 12, folder)
    return folder, paths


def test_every_kind_of_case_poses_a_problem():
    names = {case.name for case, _ in POSED}
    kinds = {"elastic-patch", "disc-exponential", "hole-tractions-isotropic", "crack-tip-I", "lamb"}
    assert kinds | {"free-plates"} <= names


@pytest.mark.parametrize(("case", "pose"), POSED, ids=[case.name for case, _ in POSED])
def test_statements_speak_of_what_the_case_judges(case, pose):
    # As coarse as leaves particles free.
    statement = pose.state(max(12, min(20, case.method(pose.method).coarsest)))
    assert statement.targets[0].needed
    for target in statement.targets:
        assert target.quantity in case.quantities
        assert np.isfinite(target.reference).all()
        assert target.error(target.reference) == pytest.approx(0.0, abs=1e-15)
        if target.norm == ABSOLUTE:
            assert target.error(target.reference + 1.0) == pytest.approx(1.0)
        elif target.line:
            assert target.error(target.reference + np.array([0.0, 3.0])) == pytest.approx(3.0)
        else:
            assert target.error(1.01 * target.reference) == pytest.approx(0.01)
    bounded = {check.quantity for check in case.checks if check.method == pose.method}
    assert bounded & {target.quantity for target in statement.targets}


def test_the_files_say_their_format_and_each_other(written):
    folder, paths = written
    said = json.loads((folder / "case.json").read_text(encoding="utf-8"))
    assert said["format"] == FORMAT
    assert all(path.is_file() for path in paths)
    reference = np.load(folder / "reference.npz")
    for entry in said["judged"]:
        assert list(reference[entry["key"]].shape) == entry["shape"]
        assert entry["error"] in NORMS
    assert said["material"]["matrix"][0][0] == pytest.approx(1.0)


def test_the_boundary_closes_and_its_loads_are_in_equilibrium(written):
    edge = np.load(written[0] / "boundary.npz")
    weights, normals, points = edge["weights"], edge["normals"], edge["points"]
    assert weights @ normals == pytest.approx([0.0, 0.0], abs=1e-12)
    # Green: the area within, of the square less the hole's polygon.
    area = 0.5 * np.sum(weights * np.einsum("ki,ki->k", points, normals))
    assert area == pytest.approx(1.0 - np.pi * 0.04, rel=2e-3)
    force = weights[:, None] * edge["traction"][:, :2]
    assert force.sum(axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)
    moment = points[:, 0] @ force[:, 1] - points[:, 1] @ force[:, 0]
    assert abs(moment) < 1e-3 * np.abs(force).sum()
    # The hole is free; what acts on the plate's sides is the closed form's stress there.
    hole = edge["ring"] == 1
    assert not edge["traction"][hole].any()
    assert edge["traction"][~hole].any()


def test_particles_carry_the_same_load_and_bonds_join_near_ones(written):
    particles, edge = (np.load(written[0] / f"{n}.npz") for n in ("particles", "boundary"))
    cell = 1.0 / 144
    # Of those whose side pulls them to the right.
    right = particles["points"][:, 0] > 0.45
    pulled = cell * particles["load"][right, 0].sum()
    side = edge["points"][:, 0] > 0.4999
    assert pulled == pytest.approx(edge["weights"][side] @ edge["traction"][side, 0], rel=0.1)
    bonds = np.load(written[0] / "bonds.npz")
    i, j = bonds["i"], bonds["j"]
    assert i.min() >= 0
    assert j.min() >= 0
    apart = np.hypot(*(particles["points"][i] - particles["points"][j]).T)
    assert apart.max() <= 5.5 / 12 + 1e-12
    assert apart.min() == pytest.approx(1 / 12)
    assert len(np.unique(np.sort([i, j], axis=0), axis=1).T) == len(i)


def test_values_held_on_the_edge_are_those_of_the_closed_form(tmp_path):
    case = registry.get("disc-exponential")
    write_case(case, case.poses[0], 10, tmp_path)
    edge = np.load(tmp_path / "boundary.npz")
    x, y = edge["points"].T
    assert edge["value_T"] == pytest.approx(np.exp(x - 2 * y) * np.cos(y))


def test_what_is_not_posed_is_refused_by_name():
    with pytest.raises(ValueError, match="poses none"):
        pose_of(registry.get("particle-counts"), None)
    with pytest.raises(ValueError, match="no problem 'star'; it has 'mild 30°'"):
        pose_of(registry.get("free-plates"), "star")


def test_files_that_hold_one_solid_are_not_written_of_two(tmp_path):
    case = registry.get("bimaterial-disc")
    with pytest.raises(ValueError, match="of several solids"):
        write_case(case, case.poses[0], 10, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_norms_see_one_per_cent_and_rigid_motions_where_they_should():
    points = np.random.default_rng(1).normal(size=(20, 2))
    u = np.stack([points[:, 0], 0 * points[:, 1]], axis=-1)
    turned = u + [0.3, 0.1] + 0.2 * np.stack([-points[:, 1], points[:, 0]], axis=-1)
    assert NORMS[L2_STRAINED](points, turned, u) < 1e-12 < NORMS[L2](points, turned, u)
    assert NORMS[LARGEST](None, np.array([1.0, 2.02]), np.array([1.0, 2.0])) == pytest.approx(0.01)
    with pytest.raises(ValueError, match="vanishes"):
        NORMS[LARGEST](None, np.ones(2), np.array([0.0, 1.0]))


def test_a_target_with_places_that_do_not_fit_is_refused():
    with pytest.raises(ValueError, match="places"):
        Target("T", "temperature", "K", np.ones(3), points=np.ones((4, 2)))
    with pytest.raises(ValueError, match="no norm"):
        Target("T", "temperature", "K", np.ones(3), norm="largest")
