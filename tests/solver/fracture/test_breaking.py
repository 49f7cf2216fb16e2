"""Which bonds are overloaded: energies of single bonds against their definition."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    ExpansionTensor,
    Family,
    Load,
    PolarTensor,
    Scene,
    SceneError,
    Support,
    recovery,
)
from solver.fracture.breaking import Breakable, critical_energies, next_batch
from tests.solver.bodies import block, few
from tests.solver.fracture.one_bond_at_a_time import utilisation

STIFF = ElasticTensor([[3.0, 0.8, 0.2], [0.8, 2.0, 0.1], [0.2, 0.1, 1.1]])
POLAR = PolarTensor(STIFF, [[0.7, 0.2], [0.2, 0.4]])
HELD = Support.where(lambda x, y: y < 1, displacement=(0.0, 0.0), rotation=0.0)


def scene(**options):
    given = {"m": 2, "supports": [HELD], "cracks": [Crack((-1, 3), (3, 3))]} | options
    return Scene(block(7, 6), 1.0, given.pop("material", STIFF), **given)


def random_field(parts, seed):
    return np.random.default_rng(seed).standard_normal(parts.prescribed.shape)


@few
@given(st.integers(0, 10**6), st.sampled_from(["none", "volume"]), st.booleans())
def test_energies_follow_their_definition(seed, surface, tension_only):
    parts = scene(surface=surface).discretise()
    critical = np.random.default_rng(seed).uniform(0.5, 2.0, parts.family.size // 2)
    bonds = Breakable(parts, np.tile(critical, 2), tension_only=tension_only)
    field = random_field(parts, seed)
    mine = bonds.utilisation(field)
    np.testing.assert_allclose(
        mine, utilisation(parts, field, critical, tension_only), rtol=1e-12, atol=1e-14
    )
    # One per cent of toughness is seen.
    more = Breakable(parts, np.tile(1.01 * critical, 2), tension_only=tension_only)
    assert more.utilisation(field).max() == pytest.approx(mine.max() / 1.01, rel=1e-12)


@few
@given(st.integers(0, 10**6), st.sampled_from([STIFF, POLAR]))
def test_stored_energy_is_that_of_the_operator_and_of_recovery(seed, material):
    held = Support.where(lambda x, y: (x < 2) & (y < 1), displacement=(0, 0))
    parts = scene(supports=[held], material=material).discretise()
    field = random_field(parts, seed)
    field[parts.prescribed] = 0.0
    bonds = Breakable(parts, np.ones(parts.family.size))
    x = field[:, parts.operator.active]
    expected = 0.5 * float((x * parts.operator.product(x)).sum()) * parts.family.cell_area
    assert bonds.stored(field) == pytest.approx(expected, rel=1e-12)
    everything = np.arange(bonds.strengths.size)[bonds.strengths.ravel() > 0]
    assert bonds.energy_of(field, everything).sum() == pytest.approx(expected, rel=1e-12)


def test_what_a_polar_bond_is_loaded_by():
    """w of Eq. 4: w_χ counts with w_s and w_γ, the axial criterion knows w_s alone."""
    parts, plain = (scene(material=material).discretise() for material in (POLAR, STIFF))
    tough = np.full(parts.family.size, 2.0)
    field = random_field(parts, 3)
    polar, elastic = (Breakable(p, tough, tension_only=False) for p in (parts, plain))
    found, without = polar.utilisation(field).copy(), elastic.utilisation(field).copy()
    o, p, q = polar.ends(np.nonzero((polar.strengths > 0).ravel())[0])
    chi = (field[2, q] - field[2, p]) / parts.family.spacing / parts.family.length[o]
    more = 0.5 * parts.family.length[o] * parts.moduli.bending[o] * chi**2 / 2.0
    more *= polar.strengths[o, p] * ~polar.kept[o, p]
    np.testing.assert_allclose((found - without)[o, p], more, atol=1e-12)
    assert more.max() > 0.1
    axial = [Breakable(p, tough, criterion="axial") for p in (parts, plain)]
    np.testing.assert_array_equal(*(bonds.utilisation(field) for bonds in axial))


@few
@given(
    st.integers(0, 10**6),
    st.sampled_from(["none", "volume"]),
    st.sampled_from([1.3, lambda x, y: 0.3 + x - 2 * y]),
)
def test_only_mechanical_strain_loads_bonds(seed, surface, change):
    """Any field beyond free expansion loads bonds as it does alone, whatever the temperature."""
    rng = np.random.default_rng(seed)
    a, b, c = rng.normal(size=3)
    free = [
        Support.where(lambda x, y: (x < 1) & (y < 1), displacement=(0.0, 0.0)),
        Support.where(lambda x, y: (abs(x - 4.5) < 0.1) & (y < 1), u2=0.0),
    ]
    hot = scene(
        supports=free,
        surface=surface,
        cracks=[],
        loads=[Load.temperature(change, ExpansionTensor([[a, c], [c, b]]))],
    )
    expanded = hot.solve(tolerance=1e-13).unknowns
    parts = hot.discretise(constrained=True)
    plain = scene(supports=free, surface=surface, cracks=[]).discretise()
    tough = rng.uniform(0.5, 2.0, parts.family.size // 2)
    warm, cold = (Breakable(p, np.tile(tough, 2), tension_only=False) for p in (parts, plain))
    beyond = random_field(parts, seed)
    wanted = cold.utilisation(beyond).copy()
    found = warm.utilisation(expanded + beyond)
    np.testing.assert_allclose(found, wanted, atol=1e-9 * wanted.max())
    assert warm.stored(expanded + beyond) == pytest.approx(cold.stored(beyond), rel=1e-9)
    # Expansion alone loads nothing, however large, and its total strain would have.
    assert warm.utilisation(expanded).max() < 1e-18 * max(1.0, cold.utilisation(expanded).max())
    assert cold.utilisation(expanded).max() > 1e-3


def test_stored_energy_in_a_homogeneous_strain_is_the_continuums():
    strain = np.array([1e-3, -2e-4, 4e-4])
    whole = Support.layer(
        cells=9,
        displacement=lambda x, y: np.stack(
            [strain[0] * x + strain[2] / 2 * y, strain[2] / 2 * x + strain[1] * y], axis=-1
        ),
        rotation=0.0,
    )
    parts = Scene(block(30, 30), 1.0, STIFF, m=2, supports=[whole], surface="none").discretise()
    bonds = Breakable(parts, np.ones(parts.family.size))
    x, y = parts.lattice.points.T
    field = np.zeros((3, len(x)))
    field[0] = strain[0] * x + strain[2] / 2 * y
    field[1] = strain[2] / 2 * x + strain[1] * y
    inner = (abs(x - 15) < 10) & (abs(y - 15) < 10)
    each = bonds.energy_of(field, np.arange(bonds.strengths.size)).reshape(bonds.strengths.shape)
    energy = each[:, inner].sum() / inner.sum()
    assert energy == pytest.approx(0.5 * strain @ STIFF.voigt @ strain, rel=1e-10)


def test_bonds_of_zones_and_between_held_particles_are_kept():
    parts = scene().discretise()
    bonds = Breakable(parts, np.ones(parts.family.size), no_fail=(lambda x, y: x > 5,))
    load = bonds.utilisation(random_field(parts, 1))
    x, y = parts.lattice.points.T
    every = np.arange(load.size)[bonds.strengths.ravel() > 0]
    _, p, q = bonds.ends(every)
    kept = (x[p] > 5) | (x[q] > 5) | ((y[p] < 1) & (y[q] < 1))
    assert (load.ravel()[every[kept]] == 0).all()
    bonds.tension_only = False
    load = bonds.utilisation(random_field(parts, 1))
    assert (load.ravel()[every[~kept]] > 0).all()


def test_ties_go_together():
    load = np.array([[1.0, 3.0, 3.0 * (1 - 1e-8), 0.5], [2.0, 2.9, 0.0, 1.1]])
    batch, values = next_batch(load, 1.0, 1)
    assert batch.tolist() == [1, 2]
    np.testing.assert_array_equal(values, load.ravel()[[1, 2]])
    assert next_batch(load, 1.0, 3)[0].tolist() == [1, 2, 5]
    assert next_batch(load, 1.0, 100)[0].tolist() == [0, 1, 2, 4, 5, 7]
    assert not len(next_batch(load, 4.0, 3)[0])
    assert not len(next_batch(np.zeros((2, 2)), 0.0, 3)[0])


def test_toughness_that_is_none_is_refused():
    family = Family(2)
    good = np.ones(family.size)
    for bad in (good[:-1], -good, np.where(np.arange(family.size) == 1, 2.0, 1.0), good * np.inf):
        with pytest.raises(SceneError, match="critical"):
            critical_energies(bad, family)
    np.testing.assert_array_equal(critical_energies(2.0, family), np.full(family.size // 2, 2.0))


def test_bonds_with_negative_stiffness_need_another_criterion():
    soft = ElasticTensor.isotropic(1.0, 0.45)
    parts = scene(material=soft).discretise()
    with pytest.raises(SceneError, match="negative shear stiffness"):
        Breakable(parts, np.ones(parts.family.size))
    bonds = Breakable(parts, np.ones(parts.family.size), criterion="axial")
    field = random_field(parts, 3)
    load = bonds.utilisation(field)
    assert load.max() > 0
    # A field of rotations alone stretches nothing.
    field[:2] = 0.0
    assert not bonds.utilisation(field).any()
    with pytest.raises(SceneError, match="criterion must be"):
        Breakable(parts, 1.0, criterion="shear")


def test_conduction_does_not_break():
    heated = Scene(
        block(7, 6),
        1.0,
        ConductivityTensor.isotropic(1.0),
        m=2,
        supports=[Support.where(lambda x, y: y < 1, temperature=0.0)],
    )
    with pytest.raises(SceneError, match="elastic"):
        Breakable(heated.discretise(), 1.0)


def test_energy_density_of_recovery_sums_to_the_stored_energy():
    pulled = Support.where(lambda x, y: y > 5, displacement=(0.0, 1e-3), rotation=0.0)
    solution = scene(supports=[HELD, pulled]).solve()
    bonds = Breakable(solution.discretisation, 1.0)
    total = recovery.strain_energy_density(solution).sum() * solution.spacing**2
    assert bonds.stored(solution.unknowns) == pytest.approx(total, rel=1e-12)
