"""Natural modes: closed forms, dense solvers, scaling, and what is refused."""

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import eigh, null_space

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    InadmissibleMaterialError,
    Load,
    MechanismError,
    NegativeCurvatureError,
    Scene,
    SceneError,
    Support,
    disc,
    modes,
    polygon,
    rectangle,
    threads,
)
from solver.analyses import modes as module
from solver.operators.assembled import to_csr
from solver.operators.mass import inertia
from solver.problem import Discretisation
from solver.problem.rigid import rigid_motions
from tests.solver.bodies import FIG_7, Cells, block, few, masks

POSITIVE, CENTRAL = ElasticTensor.isotropic(1.0, 0.2), ElasticTensor.isotropic(1.0, 1 / 3)
INDEFINITE = ElasticTensor.isotropic(1.0, 0.4)
SQUARE = rectangle(1.0, 1.0)


def plate(n=10, material=POSITIVE, region=SQUARE, **options):
    options = {"m": 3, "surface": "extrapolated", "density": 1.0, **options}
    return Scene(region=region, spacing=1.0 / n, material=material, **options)


def iterate(monkeypatch):
    """Small bodies by the method of large ones."""
    monkeypatch.setattr(module, "_DENSE", 0)
    monkeypatch.setattr(module, "_DENSE_CONDENSED", 0)


def both(scene):
    """Bonds, prescribed unknowns, physics."""
    d = Discretisation.of(scene, free=True)
    return d.bonds, d.prescribed, scene.physics


def dense(scene):
    """Every eigenvalue over the density, on the null space of the massless rows."""
    d = Discretisation.of(scene, free=True)
    matrix = to_csr(d.operator).toarray()
    free = np.ones(len(matrix), bool)
    if d.operator.identity_rows is not None:
        free = ~d.operator.identity_rows.ravel()
    c = d.operator.components
    mass = inertia(d.volumes, d.operator.active, scene.physics, c)
    matrix, mass = matrix[np.ix_(free, free)], mass.ravel()[free]
    basis = null_space(matrix[mass == 0]) if (mass == 0).any() else np.eye(len(mass))
    return eigh(basis.T @ matrix @ basis, basis.T @ (mass[:, None] * basis), eigvals_only=True)


@pytest.mark.parametrize("more", [0.0, 0.4])
def test_lame_mode_of_a_free_square_converges_at_second_order(more):
    """u = (sin πx cos πy, −cos πx sin πy) about the centre: ω = π √((C11 − C12)/ρ)."""
    voigt = POSITIVE.voigt
    exact = np.pi * np.sqrt((voigt[0, 0] - voigt[0, 1]) / 2.0)
    errors = []
    for n in (10, 20):
        found = modes.solve(plate(n + more, density=2.0), 8)
        x, y = np.pi * found.points.T
        lame = np.stack([np.sin(x) * np.cos(y), -np.cos(x) * np.sin(y)], axis=-1)
        overlap = np.einsum("knd,nd,n->k", found.shapes, lame, found.mass)
        norm = np.einsum("nd,n->", lame**2, found.mass)
        mode = int(np.argmax(np.abs(overlap)))
        assert overlap[mode] ** 2 / norm > 0.99
        errors.append(abs(found.frequencies[mode] / exact - 1))
    assert errors[1] < 6e-3
    assert 1.6 < np.log2(errors[0] / errors[1]) < 2.6


@pytest.mark.parametrize(
    ("material", "surface"),
    [
        (POSITIVE, "extrapolated"),
        (POSITIVE, "none"),
        (CENTRAL, "volume"),
        (CENTRAL, "extrapolated"),
        (INDEFINITE, "volume"),
        (INDEFINITE, "extrapolated"),
    ],
)
def test_iterations_find_what_a_dense_solver_finds(material, surface, monkeypatch):
    # Condensing takes an inner solve for every product: a smaller body.
    scene = plate(8 if material is not INDEFINITE else 6, material, surface=surface)
    exact = modes.solve(scene, 9)
    assert exact.statistics["method"] == "dense"
    iterate(monkeypatch)
    found = modes.solve(scene, 9)
    assert "LOBPCG" in found.statistics["method"]
    assert found.frequencies == pytest.approx(exact.frequencies, rel=1e-9)
    assert found.rigid == exact.rigid == 3
    assert found.residuals.max() < 1e-8
    mass = found.mass[:, None]
    gram = np.einsum("ind,jnd->ij", found.shapes, mass * exact.shapes)
    # Subspaces of multiple modes agree: the overlaps of the nine with the nine are orthogonal.
    assert gram @ gram.T == pytest.approx(np.eye(9), abs=1e-6)


@few
@given(masks(), st.sampled_from([POSITIVE, CENTRAL]), st.sampled_from(["none", "volume"]))
def test_random_bodies(mask, material, surface):
    """Ragged, in several parts: each part's rigid motions are counted, hinges refused."""
    mask[1:4, 1:5] = True
    scene = Scene(Cells(mask), 1.0, material, m=2, surface=surface, loose="drop", density=1.0)
    values = dense(scene)
    zeros = int((np.abs(values) < 1e-9).sum())
    rigid = len(rigid_motions(*both(scene)))
    if zeros > rigid:
        with pytest.raises(MechanismError, match="strains no bond"):
            modes.solve(scene, 4)
        return
    found = modes.solve(scene, 4)
    assert found.rigid == rigid == zeros
    assert found.frequencies**2 == pytest.approx(values[zeros : zeros + 4], rel=1e-8)


@few
@given(st.floats(0.1, 10.0), st.floats(0.1, 10.0), st.floats(0.1, 10.0))
def test_units(stiffer, larger, heavier):
    """ω scales as √(E/ρ)/L, shapes as 1/√mass."""
    base = modes.solve(plate(6), 5)
    region = rectangle(larger, larger)
    material = ElasticTensor(stiffer * POSITIVE.voigt)
    scene = plate(6 / larger, material, region, density=heavier)
    found = modes.solve(scene, 5)
    factor = np.sqrt(stiffer / heavier) / larger
    assert found.frequencies == pytest.approx(factor * base.frequencies, rel=1e-9)
    assert np.einsum("knd,n->k", found.shapes**2, found.mass) == pytest.approx(1.0)
    assert found.mass.sum() == pytest.approx(heavier * larger**2)


def test_rigid_motions_are_counted():
    def rigid(*supports, **options):
        return modes.solve(plate(12, supports=supports, **options), 2).rigid

    left = Support.where(lambda x, y: x < -0.4, u1=0.0)
    assert rigid() == rigid(material=CENTRAL) == rigid(surface="volume") == 3
    assert rigid(left) == 1
    assert rigid(Support.edge(lambda x, y: x < -0.499, u1=0.0)) == 1
    assert rigid(Support.edge(lambda x, y: x < -0.499, displacement=0.0)) == 0
    assert rigid(Support.where(lambda x, y: x < -0.4, displacement=0.0)) == 0
    split = {"cracks": [Crack((0.0, -1.0), (0.0, 1.0))], "surface": "volume"}
    assert rigid(**split) == 6
    assert rigid(left, **split) == 4


def test_both_parts_of_a_split_body_vibrate_alike(monkeypatch):
    iterate(monkeypatch)
    split = plate(16, cracks=[Crack((0.0, -1.0), (0.0, 1.0))], surface="volume")
    found = modes.solve(split, 6)
    assert found.frequencies[::2] == pytest.approx(found.frequencies[1::2], rel=1e-10)


def test_clamped_edge_converges_at_second_order():
    """Between spacings, against the layer's first order: the edge is held where it is."""
    first = [
        modes.solve(plate(n, supports=[Support.edge(displacement=0.0)]), 1).frequencies[0]
        for n in (6, 12, 24)
    ]
    order = np.log2((first[1] - first[0]) / (first[2] - first[1]))
    assert 1.7 < order < 2.4
    assert abs(first[2] / first[1] - 1) < 0.012


def test_same_bits_for_any_number_of_threads(monkeypatch):
    iterate(monkeypatch)
    # Or so small a body would keep to one thread both times.
    monkeypatch.setattr(threads, "_WORK", 1)
    before, found = numba.get_num_threads(), []
    try:
        for count in (1, numba.config.NUMBA_NUM_THREADS):
            numba.set_num_threads(count)
            found.append(modes.solve(plate(16, ElasticTensor(FIG_7)), 4))
    finally:
        numba.set_num_threads(before)
    assert np.array_equal(found[0].frequencies, found[1].frequencies)
    assert np.array_equal(found[0].unknowns, found[1].unknowns)


def test_loads_and_values_of_supports_play_no_part():
    held = Support.edge(lambda x, y: x < -0.499, displacement=0.0)
    moved = Support.edge(lambda x, y: x < -0.499, displacement=(0.1, 0.0))
    pulled = Load.stress((1.0, 0.0, 0.0), where=lambda x, y: x > 0.499)
    one = modes.solve(plate(8, supports=[held]), 3)
    other = modes.solve(plate(8, supports=[moved], loads=[pulled]), 3)
    assert np.array_equal(one.frequencies, other.frequencies)


def test_fields_and_summary():
    found = modes.solve(plate(6), 2)
    assert set(found.fields()) == {
        "mode 1 displacement", "mode 1 rotation", "mode 2 displacement", "mode 2 rotation"
    }  # fmt: skip
    assert found.fields()["mode 2 displacement"].shape == (36, 2)
    summary = found.summary()
    assert summary["rigid"] == 3
    assert len(summary["frequencies"]) == 2
    assert np.isnan(modes.solve(plate(6, CENTRAL), 2).rotations).all()


@pytest.mark.parametrize(
    ("scene", "count", "words"),
    [
        (plate(density=None), 3, "density"),
        (plate(), 0, "positive integer"),
        (plate(), 2.5, "positive integer"),
        (plate(4), 30, "30 modes are asked for, but this body has 29"),
        (plate(80), 301, "too many"),
        (Scene(SQUARE, 0.1, ConductivityTensor.isotropic(1.0)), 3, "elastic"),
    ],
    ids=["no density", "none", "no integer", "all", "many", "heat"],
)
def test_refused_before_any_work(scene, count, words):
    with pytest.raises(SceneError, match=words):
        modes.solve(scene, count)


@pytest.mark.parametrize("density", [0.0, -1.0, np.nan, np.inf, True, "water"])
def test_no_such_density(density):
    with pytest.raises(SceneError, match="density"):
        plate(density=density)


def test_as_many_modes_as_there_are():
    found = modes.solve(plate(4), 29)
    assert found.frequencies.shape == (29,)


@pytest.mark.parametrize("iterated", [False, True])
def test_an_unstable_body_is_refused_by_name(iterated, monkeypatch):
    """Free corners of nearly incompressible solids, by dense and by iterative solvers."""
    if iterated:
        iterate(monkeypatch)
    scene = plate(12, ElasticTensor.isotropic(1.0, 0.45))
    with pytest.raises(NegativeCurvatureError, match=r"unstable.*moves most at.*volume"):
        modes.solve(scene, 3)


def test_nearly_incompressible_solids_vibrate_with_the_volume_method():
    assert (
        modes.solve(plate(12, ElasticTensor.isotropic(1.0, 0.45), surface="volume"), 3).rigid == 3
    )


def test_an_unstable_solid_is_refused():
    with pytest.raises(InadmissibleMaterialError):
        modes.solve(plate(material=ElasticTensor.isotropic(1.0, 0.45, plane="strain")), 3)


def test_a_hinge_is_refused_by_name():
    """Two halves on a single bond: each turns about its end."""

    def broken(lattice, family):
        x, y = lattice.places.T
        half = family.offsets[: family.size // 2]
        crosses = np.array([(x < 4) != (x + dx < 4) for dx, _ in half])
        kept = np.array([(y < 1) & (dy == 0) for _, dy in half])
        return crosses & ~kept

    halves = Scene(
        block(8, 4), 1.0, CENTRAL, m=1.5, area_rule="full", surface="none", density=1.0,
        broken=broken,
    )  # fmt: skip
    with pytest.raises(MechanismError, match="strains no bond"):
        modes.solve(halves, 3)


def test_notched_and_holed_bodies_vibrate():
    body = polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]) - disc(0.2, (0.5, 0.5))
    found = modes.solve(plate(14, region=body), 4)
    assert found.rigid == 3
    assert found.mass.sum() == pytest.approx(3 - np.pi * 0.04, rel=1e-3)
