"""Loose parts: found, refused by name, or set aside without changing the rest."""

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    Family,
    Load,
    MechanismError,
    Scene,
    SceneError,
    Support,
    recovery,
    rectangle,
)
from solver.bonds import Bonds
from solver.geometry import Lattice
from solver.operators import BondOperator
from solver.operators.assembled import to_csr
from solver.problem.mechanisms import slack_particles

Broken = Callable[[Lattice, Family], np.ndarray]


def _scene(broken: Broken | None = None, **changes: object) -> Scene:
    base = Scene(
        region=rectangle(1.0, 1.0),
        spacing=1 / 20,
        m=3,
        material=ElasticTensor.isotropic(1.0, 0.25),
        surface="none",
        supports=[
            Support.layer(
                cells=3.5,
                displacement=lambda x, y: np.stack([0.01 * x + 0.003 * y, -0.002 * y], axis=-1),
                rotation=-0.0015,
            )
        ],
        broken=broken,
    )
    return dataclasses.replace(base, **changes)  # type: ignore[arg-type]


def _around(inside: Callable[[np.ndarray], np.ndarray], keep: int) -> Broken:
    """Break every bond between inside and outside but `keep` of them."""

    def broken(lattice: Lattice, family: Family) -> np.ndarray:
        half = family.size // 2
        mask = np.zeros((half, lattice.count), dtype=bool)
        mine, number = inside(lattice.points), lattice.number()
        rows, columns = lattice.rows_columns
        for o, (dx, dy) in enumerate(family.offsets[:half]):
            neighbour = number[rows + dy, columns + dx]
            there = neighbour >= 0
            mask[o, there] = mine[there] != mine[neighbour[there]]
        kept = np.argwhere(mask)[:keep]
        mask[tuple(kept.T)] = False
        return mask

    return broken


def _block(points: np.ndarray) -> np.ndarray:
    return np.abs(points).max(axis=1) < 0.1


def _one(points: np.ndarray) -> np.ndarray:
    return (np.abs(points - 0.025) < 1e-9).all(axis=1)


@pytest.mark.parametrize(
    ("inside", "keep", "said", "aside"),
    [
        (_one, 0, "rigid motion of the part", 1),
        (_one, 1, "too few bonds", 1),
        (_block, 0, "rigid motion of the part", 16),
        (_block, 1, "a hinge", 16),
    ],
)
def test_each_kind_is_found_refused_and_set_aside(
    inside: Callable[[np.ndarray], np.ndarray], keep: int, said: str, aside: int
) -> None:
    scene = _scene(_around(inside, keep))
    with pytest.raises(MechanismError, match=said):
        scene.discretise()
    solution = dataclasses.replace(scene, loose="drop").solve(1e-12)
    loose = np.isnan(solution.displacement).any(axis=1)
    assert loose.sum() == aside
    # The rest is what it would be around a hole in the place of the loose part.
    cut_out = _scene(_around(inside, 0), loose="drop").solve(1e-12)
    rest = ~loose
    assert np.allclose(solution.displacement[rest], cut_out.displacement[rest], atol=1e-11)


def test_a_hinge_is_found_where_the_operator_is_indefinite() -> None:
    scene = _scene(_around(_block, 1), material=ElasticTensor.isotropic(1.0, 0.45))
    with pytest.raises(MechanismError, match="a hinge"):
        scene.discretise()
    solution = dataclasses.replace(scene, loose="drop").solve(1e-10)
    assert np.isnan(solution.displacement).any(axis=1).sum() == 16


def test_two_bonds_at_different_places_hold_a_block() -> None:
    def two(lattice: Lattice, family: Family) -> np.ndarray:
        mask = _around(_block, 0)(lattice, family)
        far = np.argwhere(mask)[[0, -1]]
        mask[tuple(far.T)] = False
        return mask

    solution = _scene(two).solve(1e-9)
    assert np.isfinite(solution.displacement).all()


def test_random_damage_agrees_with_a_direct_solve() -> None:
    def random(lattice: Lattice, family: Family) -> np.ndarray:
        return np.random.default_rng(4).random((family.size // 2, lattice.count)) < 0.3

    problem = _scene(random).discretise()
    solution = _scene(random).solve(1e-12)
    exact = np.linalg.solve(to_csr(problem.operator).toarray(), problem.right_hand_side())
    free = problem.operator.active
    assert np.allclose(solution.unknowns[:, free].ravel(), exact, rtol=0, atol=1e-12)


def test_slack_particles_are_those_with_an_eigenvalue_of_zero() -> None:
    """Most bodies are told sound by determinants alone: the rule stays the eigenvalues'."""
    seen = 0
    sound = _scene().discretise()
    family, nothing = sound.family, np.zeros_like(sound.prescribed)
    whole = Bonds(sound.lattice, family)
    there = np.stack([whole.strength(o) for o in range(family.size // 2)]) > 0
    for seed in range(9):
        broken = np.random.default_rng(seed).random(there.shape) < (0.3, 0.6, 0.9)[seed % 3]
        bonds = whole.breaking(*np.nonzero(broken & there))
        operator = BondOperator(bonds, sound.moduli, nothing)
        scale = np.sqrt(np.abs(np.einsum("pii->pi", operator.bulk_blocks)))[operator.phase]
        blocks = operator.block_diagonal / (scale[:, :, None] * scale[:, None])
        least = np.abs(np.linalg.eigvalsh(blocks)).min(axis=1)
        wanted = operator.active[least < 1e-9]
        np.testing.assert_array_equal(slack_particles(operator), wanted)
        seen += len(wanted) > 0
    assert 0 < seen < 9


def test_a_load_on_a_loose_part_is_refused() -> None:
    pulled = Load.body_force((1.0, 0.0), where=lambda x, y: np.maximum(abs(x), abs(y)) < 0.1)
    with pytest.raises(MechanismError, match="load"):
        _scene(_around(_block, 1), loose="drop", loads=[pulled]).discretise()


def test_a_conducting_fragment_floats() -> None:
    scene = _scene(
        _around(_block, 0), material=ConductivityTensor.isotropic(1.0),
        supports=[Support.layer(cells=3.5, temperature=lambda x, y: x)],
    )  # fmt: skip
    with pytest.raises(MechanismError, match="no temperature"):
        scene.discretise()
    # One bond is enough to set its level.
    held = dataclasses.replace(scene, broken=_around(_block, 1)).solve(1e-10)
    assert np.isfinite(held.temperature).all()


def test_a_body_cut_in_two_needs_supports_on_both_sides() -> None:
    below = Support.where(lambda x, y: y < -0.3, displacement=(0.0, 0.0), rotation=0.0)
    cracked = _scene(supports=[below], cracks=[Crack((-0.6, 0.0), (0.6, 0.0))])
    with pytest.raises(MechanismError, match="translation along 1, translation along 2, rotation"):
        cracked.discretise()


@pytest.mark.parametrize("conductive", [False, True])
def test_recovery_is_nan_only_where_parts_were_set_aside(conductive: bool) -> None:
    changes: dict[str, object] = {}
    if conductive:
        changes = {
            "material": ConductivityTensor.isotropic(1.0),
            "supports": [Support.layer(cells=3.5, temperature=lambda x, y: x)],
        }
    solution = _scene(_around(_one, 0), loose="drop", **changes).solve(1e-11)
    aside = np.isnan(solution.unknowns).any(axis=0)
    fields = [recovery.strain_energy_density(solution)]
    if conductive:
        fields += [recovery.flux(solution, "consistent"), recovery.flux(solution, "hotter")]
    else:
        fields += [recovery.stress(solution, "plane"), recovery.stress(solution, "family")]
        fields += [recovery.macrorotation(solution)]
    for field in fields:
        unknown = np.isnan(field.reshape(len(field), -1)).any(axis=1)
        assert np.array_equal(unknown, aside)


def test_one_function_for_two_values_is_not_confused() -> None:
    def pair(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.stack([x, y], axis=-1)

    support = Support.layer(cells=3.5, displacement=pair, rotation=pair)
    with pytest.raises(SceneError, match="one value a particle"):
        _scene(supports=[support]).discretise()


@pytest.mark.parametrize("apart", [1e-10, 1e-12, -1e-10])
def test_a_solid_that_hardly_resists_shear_is_no_mechanism(apart: float) -> None:
    tips = []
    for nu in (1 / 3, 1 / 3 - apart):
        scene = _scene(
            material=ElasticTensor.isotropic(1.0, nu),
            supports=[Support.where(lambda x, y: y < -0.35, displacement=0.0)],
            loads=[Load.body_force((0.0, 1.0), where=lambda x, y: y > 0.4)],
            cracks=[Crack((-0.6, 0.0), (0.0, 0.0))],
        )
        tips.append(scene.solve().displacement[:, 1].max())
    assert tips[1] == pytest.approx(tips[0], rel=1e-8)
