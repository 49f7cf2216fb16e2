"""The judges of the hard cases agree with dense algebra, and each kind of check can fail."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cmverify.cases.common import bond_energies, materials
from cmverify.cases.hard import (
    CASES,
    bodies,
    broken,
    conduction,
    damage,
    lattices,
    mechanisms,
    poisson,
    random_tensors,
    refusals,
)
from cmverify.judge.verdict import judge
from solver import ElasticTensor, Family, UniformShear
from solver.material import calibrate, representable
from solver.material.symbol import symbol

few = settings(derandomize=True, deadline=None, max_examples=15)


def failed(case_name: str, method: str, measurement, n: int) -> set[str]:
    """Quantities of which a check fails."""
    (case,) = (c for c in CASES if c.name == case_name)
    return {v.quantity for v in judge(case, {method: {n: measurement}}) if not v.passed}


# ---- the judges themselves ----------------------------------------------------------------------


@few
@given(
    st.integers(0, 10**6),
    st.tuples(st.floats(-3.1, 3.1), st.floats(-3.1, 3.1)),
    st.sampled_from([2, 3.5]),
)
def test_the_energy_of_a_wave_is_the_symbol(seed, k, m):
    voigt = np.random.default_rng(seed).normal(size=(3, 3))
    solid = ElasticTensor(voigt @ voigt.T + 0.5 * np.eye(3))
    family = Family(m, 1.0)
    moduli = calibrate(family, solid, "lattice", UniformShear())
    found = bond_energies.energy_of_wave(family, moduli, np.array(k))
    wanted = symbol(family, moduli, np.array(k))
    np.testing.assert_allclose(found.conj(), wanted, atol=1e-11 * np.abs(wanted).max())


@pytest.mark.parametrize(("nu", "unstable"), [(0.36, False), (0.40, True)])
def test_instability_of_a_wave(nu, unstable):
    family = Family(5)
    moduli = calibrate(family, ElasticTensor.isotropic(1.0, nu, "strain"))
    # The worst waves lie along the axes at about 0.91 rad per cell.
    assert bond_energies.is_unstable(family, moduli, np.array([0.91, 0.0])) == unstable


@pytest.mark.parametrize("law", [None, UniformShear()])
def test_the_energy_of_a_strain_is_the_tensor(law):
    voigt, family = materials.TENSORS["Fig. 2"], Family(3)
    moduli = calibrate(family, ElasticTensor(voigt), "lattice", law)
    whole = bond_energies.energy_of_strain(family, moduli)
    condensed = whole[:3, :3] - np.outer(whole[:3, 3], whole[3, :3]) / whole[3, 3]
    np.testing.assert_allclose(condensed, voigt, atol=1e-12)
    assert not bond_energies.is_unstable(family, moduli, np.zeros(2))
    inverted = type(moduli)(-moduli.normal, moduli.shear)
    assert bond_energies.is_unstable(family, inverted, np.zeros(2))


@few
@given(st.integers(0, 10**6), st.sampled_from([2, 3]))
def test_linear_program_agrees_with_the_solver_on_existence(seed, m):
    factor = np.random.default_rng(seed).normal(size=(3, 3))
    voigt = factor @ factor.T + 0.3 * np.eye(3)
    if voigt[2, 2] > voigt[0, 1]:
        found = bond_energies.non_negative_moduli_exist(Family(m), voigt)
        assert found == representable(Family(m), ElasticTensor(voigt))


def test_pivots_count_negative_eigenvalues():
    generator = np.random.default_rng(1)
    from scipy import sparse

    factor = generator.normal(size=(40, 40))
    matrix = factor + factor.T + np.diag(generator.normal(scale=30.0, size=40))
    wanted = int((np.linalg.eigvalsh(matrix) < 0).sum())
    assert 0 < wanted < 40
    assert broken._negative_pivots(sparse.csc_array(matrix)) == wanted


def test_remedies_are_read_from_messages():
    read = bond_energies.named_remedy
    assert read("… Use calibration='lattice' (stable, margin 1).") == {"calibration": "lattice"}
    found = read("… Use calibration='positive', law=UniformShear() at m = 4 (stable, margin 1).")
    assert found == {"calibration": "positive", "law": UniformShear(), "m": 4}
    assert read("Use finite elements for this solid.") is None


def test_random_tensors_are_positive_definite_and_favour_no_sign():
    tensors = [t for _, t in zip(range(100), random_tensors.tensors(), strict=False)]
    assert min(np.linalg.eigvalsh(t)[0] for t in tensors) > 0
    assert 0 < sum(t[2, 2] < t[0, 1] for t in tensors) < 100


# ---- each kind of check sees what it is for -----------------------------------------------------


@pytest.mark.parametrize("index", [0, 3, 6])
def test_one_percent_of_stiffness_is_seen(index):
    row = poisson.ROWS[index]
    wrong = replace(row.solid, distortion=1.01)
    seen = failed("hard-poisson", row.method.name, bodies.measure(wrong, 24), 24)
    assert {"displacement", "quartic"} <= seen


def test_one_percent_of_conductivity_is_seen():
    wrong = replace(conduction.CONDUCTORS[0], distortion=1.01)
    seen = failed("hard-conduction", wrong.name, conduction.measure(wrong, 24), 24)
    assert {"cubic m = 3", "cubic m = 5", "cubic m = 7", "exponential"} <= seen


def test_what_is_not_refused_fails():
    fine = replace(refusals.REFUSALS[0], voigt=lambda: materials.TENSORS["silicon"])
    seen = failed("hard-refusals", f"bond/lattice {fine.name}", refusals.refuse(fine, 24), 24)
    assert {"refused", "confirmed", "advice"} <= seen


def test_a_refusal_in_other_words_fails():
    other = replace(refusals.REFUSALS[0], says="passes through zero")
    assert refusals.refuse(other, 24).quantities["refused"] == 0


def test_a_sound_body_has_no_mechanism():
    sound = mechanisms.Loose("fragment", broken.at_random(0.0), "left free", alone=False)
    found = mechanisms.treat(sound, 24)
    seen = failed("hard-mechanisms", "bond/lattice fragment", found, 24)
    assert {"refused", "load refused", "wrongly set aside"} <= seen


def test_energy_sees_one_percent():
    scene = broken.scene(ElasticTensor.isotropic(1.0, 0.2), 16, broken.at_random(0.3))
    solution = scene.solve(tolerance=1e-12)
    assert broken.energy_defect(solution) < 1e-11
    wrong = replace(solution, unknowns=1.01 * solution.unknowns)
    assert broken.energy_defect(wrong) == pytest.approx(0.01, rel=1e-6)


def test_damage_that_is_refused_has_a_negative_direction():
    body = next(b for b in damage.BODIES if b.spared is False)
    found = damage.solve(body, 20).quantities
    assert found["refused"] == 1
    assert found["negative"] > 0
    assert found["misjudged"] == 0


@pytest.fixture
def softened(monkeypatch):
    """The solver is given a C11 that is 1 % too large, from the `first` solve on."""
    solve, calls = bodies.solve, []

    def start(first: int = 0):
        def wrong(voigt, *args, **others):
            calls.append(voigt)
            given = np.array(voigt)
            if len(calls) > first:
                given[0, 0] *= 1.01
            return solve(given, *args, **others)

        monkeypatch.setattr(bodies, "solve", wrong)

    return start


def test_one_percent_is_seen_on_every_lattice(softened):
    softened()
    found = lattices.fit(lattices.SETTINGS[0], 24)
    assert {"displacement", "rotation"} <= failed("hard-lattices", "bond/lattice m = 2", found, 24)


def test_one_percent_is_seen_between_units(softened):
    unit = lattices.UNITS[0]
    assert not failed("hard-units", f"bond/lattice {unit.name}", lattices.rescale(unit, 24), 24)
    softened(first=1)
    found = lattices.rescale(unit, 24)
    assert "change" in failed("hard-units", f"bond/lattice {unit.name}", found, 24)


def test_one_percent_is_seen_in_random_tensors(softened, monkeypatch):
    monkeypatch.setattr(random_tensors, "COUNTS", {14: 3})
    softened()
    found = random_tensors.population("lattice", 14)
    assert failed("hard-random", "bond/lattice", found, 14) == {"field"}


def test_one_percent_is_seen_in_what_refusals_recommend(softened):
    softened(first=1)
    refusal = next(r for r in refusals.REFUSALS if r.remedy)
    found = refusals.refuse(refusal, 24)
    assert failed("hard-refusals", f"bond/lattice {refusal.name}", found, 24) == {"field"}


def test_refusals_that_nothing_confirms_are_counted(monkeypatch):
    monkeypatch.setattr(random_tensors, "COUNTS", {14: 6})
    monkeypatch.setattr(bond_energies, "non_negative_moduli_exist", lambda *_: True)
    found = random_tensors.population("positive", 14)
    assert "unexplained" in failed("hard-random", "bond/positive", found, 14)


def test_a_difference_from_the_factorisation_is_seen(monkeypatch):
    direct = broken.direct_solution
    monkeypatch.setattr(broken, "direct_solution", lambda d: 1.01 * direct(d))
    found = damage.solve(damage.BODIES[0], 20)
    assert failed("hard-damage", "bond/lattice stress ν = 0.2", found, 20) == {"difference"}


def test_a_missed_negative_direction_is_seen(monkeypatch):
    monkeypatch.setattr(broken, "negative_directions", lambda d: 1)
    found = damage.solve(damage.BODIES[0], 20)
    assert failed("hard-damage", "bond/lattice stress ν = 0.2", found, 20) == {"misjudged"}
