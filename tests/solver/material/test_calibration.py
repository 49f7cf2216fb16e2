"""Calibration: the lattice sums make the tensor; the paper's constants make the integral."""

import re

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import linprog

from solver import (
    CalibrationError,
    ChiralTensor,
    ConductivityTensor,
    Cosine,
    ElasticTensor,
    Family,
    Fourfold,
    PolarTensor,
    TwoHarmonic,
    UniformShear,
)
from solver.material import (
    ChiralModuli,
    ConductiveModuli,
    ElasticModuli,
    PolarModuli,
    bond_weights,
    calibrate,
    calibrated,
    effective_tensor,
    representable,
    stretch_rows,
)
from tests.solver.bodies import DISC, FIG_7, conductivities, exact, few, voigts

HORIZONS = [2, 3, 4, 5, 7, 4.5]
families = st.builds(
    Family,
    st.sampled_from(HORIZONS),
    st.sampled_from([1.0, 0.01]),
    st.sampled_from(["full", "partial", "exact"]),
    # At m = 2 a conical family has eight neighbours in four directions: too few for six moduli.
    st.sampled_from(["constant", "gaussian"]),
)


def relative(found, wanted):
    return np.abs(found - wanted).max() / np.abs(wanted).max()


# ---- bending of polar solids ---------------------------------------------------------------------


@few
@given(families, conductivities(), st.sampled_from(["lattice", "positive"]))
def test_sums_of_k_b_are_the_bending_stiffness(family, bending, calibration):
    """½ Σ α Λ |ξ| Δv k_b n nᵀ = E, and nothing else of the solid knows of it."""
    solid = ElasticTensor.isotropic(2.4, 0.2)
    moduli = calibrate(family, PolarTensor(solid, bending), calibration)
    assert isinstance(moduli, PolarModuli)
    weight = 0.5 * family.weight * family.length * family.spacing**2 * moduli.bending
    found = np.einsum("o,oi,oj->ij", weight, family.normal, family.normal)
    assert relative(found, bending) < 1e-10
    assert relative(effective_tensor(family, moduli.curvature), bending) < 1e-10
    assert relative(effective_tensor(family, moduli), solid.voigt) < 1e-10
    plain = calibrate(family, solid, calibration)
    np.testing.assert_array_equal(moduli.normal, plain.normal)
    np.testing.assert_array_equal(moduli.shear, plain.shear)
    if calibration == "positive":
        assert moduli.bending.min() >= 0


# ---- chiral solids -------------------------------------------------------------------------------


@few
@given(
    st.builds(Family, st.sampled_from([3, 5, 4.5]), st.sampled_from([1.0, 0.01])),
    st.sampled_from([ElasticTensor.isotropic(2.4, 0.2).voigt, FIG_7]),
    st.lists(st.floats(-0.3, 0.3), min_size=3, max_size=3),
)
def test_sums_of_k_nt_are_the_turns_of_a_chiral_solid(family, voigt, turn):
    """C, C', c and 4 μ_c from the bonds one by one, and the rotation of least energy."""
    solid = ChiralTensor(voigt, turn)
    moduli = calibrate(family, solid)
    assert isinstance(moduli, ChiralModuli)
    weight = bond_weights(family, solid)
    stretch, shear = stretch_rows(family.angle)
    pair = np.array([[moduli.normal, moduli.cross], [moduli.cross, moduli.shear]])
    # Each bond's strains of (ε11, ε22, 2ε12, φ): φ shears it by −1.
    one = np.stack([np.vstack([stretch, 0 * weight]), np.vstack([shear, -1 + 0 * weight])])
    energy = np.einsum("o,abo,aio,bjo->ij", weight, pair, one, one)
    assert relative(energy[:3, :3], solid.unturned) < 1e-10
    assert energy[3, 3] == pytest.approx(4 * solid.cosserat_modulus)
    assert np.abs(energy[3, :3] + solid.coupling).max() < 1e-10 * np.abs(energy).max()
    found = -energy[3, :3] / energy[3, 3]
    np.testing.assert_allclose(found, turn, atol=1e-10)
    assert relative(effective_tensor(family, moduli), voigt) < 1e-10
    # The form of two strains is that of three squares.
    squares = np.stack([one[0], one[1], one[0] + one[1]])
    same = np.einsum("o,ao,aio,ajo->ij", weight, moduli.stiffness, squares, squares)
    assert relative(same, energy) < 1e-12
    least = np.linalg.eigvalsh(np.moveaxis(pair, 2, 0)).min()
    assert moduli.non_negative == bool(least >= 0) or abs(least) < 1e-12 * np.abs(pair).max()
    whole = moduli.absolute()
    assert whole.non_negative or (whole.cross**2 - whole.normal * whole.shear).max() < 1e-12 * (
        np.abs(pair).max() ** 2
    )


def test_without_k_nt_a_dilation_turns_nothing():
    """Whatever k_n and k_t are: Σ w k_t v_γ·(1, 1, 0) = 0, bond by bond."""
    _, shear = stretch_rows(np.linspace(0, np.pi, 7))
    np.testing.assert_allclose(shear[0] + shear[1], 0.0, atol=1e-16)


def test_four_neighbours_are_the_tetrachiral_blocks():
    """m = 1: the bonds of the block lattice itself, its normals turned by β."""
    from references.analytic.tetrachiral import effective_turn, effective_voigt

    normal, shear, beta = 3.0, 1.0, 0.4
    c, s = np.cos(beta), np.sin(beta)
    solid = ChiralTensor(effective_voigt(normal, shear, beta), effective_turn(normal, shear, beta))
    family = Family(1, 1.0, "full")
    moduli, weight = calibrate(family, solid), 2 * bond_weights(family, solid)
    np.testing.assert_allclose(weight * moduli.normal, normal * c * c + shear * s * s)
    np.testing.assert_allclose(weight * moduli.shear, normal * s * s + shear * c * c)
    np.testing.assert_allclose(weight * moduli.cross, (normal - shear) * s * c)
    assert moduli.non_negative


@pytest.mark.parametrize("calibration", ["continuum", "positive"])
def test_chiral_solids_have_the_lattice_calibration_alone(calibration):
    solid = ChiralTensor(ElasticTensor.isotropic(2.4, 0.2), [0.2, 0.2, 0.0])
    with pytest.raises(CalibrationError, match="lattice calibration only"):
        calibrated(Family(3, 1.0), solid, calibration)


@exact
@given(st.floats(0.4, 2.5), st.floats(0.1, 3.0))
def test_the_papers_bending_micromoduli(ratio, delta):
    """Eqs. 179–181 with n = 2, which the integral over the horizon's disc makes right."""
    first, second = ratio, 1.0
    family = Family(4, delta / 4)
    solid = PolarTensor(ElasticTensor.isotropic(2.4, 0.2), np.diag([first, second]))
    # cos² along the material's axis 1 whichever is the stiffer.
    moduli = calibrate(family, solid, "continuum", Cosine(2, axis=0.0))
    k31 = 3 * (3 * first - second) / (np.pi * delta**3)
    k32 = 3 * (3 * second - first) / (np.pi * delta**3)
    wanted = k32 + (k31 - k32) * np.cos(family.angle) ** 2
    np.testing.assert_allclose(moduli.bending, wanted, rtol=1e-11)
    # The smallest even exponent by default: no k_b is negative.
    assert calibrate(family, solid, "continuum").bending.min() > -1e-12 * k31


# ---- the sums, written out again ----------------------------------------------------------------


def summed_energy(family, moduli, strain):
    """Energy per volume of a particle in a homogeneous strain (or gradient), its rotation free.

    Half of every bond's energy is the particle's; the best rotation is the least one.
    """
    energy = stiffness = coupling = 0.0
    for o, (i, j) in enumerate(family.offsets):
        xi = family.spacing * np.array([i, j])
        size = np.hypot(*xi)
        n, t = xi / size, np.array([-xi[1], xi[0]]) / size
        weight = 0.5 * family.weight[o] * family.spacing**2
        if isinstance(moduli, ConductiveModuli):
            energy += weight * 0.5 * moduli.conductivity[o] * (n @ strain) ** 2
            continue
        e = np.array([[strain[0], strain[2] / 2], [strain[2] / 2, strain[1]]])
        s, gamma = n @ e @ n, t @ e @ n
        energy += weight * 0.5 * size * (moduli.normal[o] * s**2 + moduli.shear[o] * gamma**2)
        stiffness += weight * size * moduli.shear[o]
        coupling += weight * size * moduli.shear[o] * gamma
    return energy - (0.5 * coupling**2 / stiffness if stiffness else 0.0)


@few
@given(families, st.integers(0, 10**6), st.tuples(*[st.floats(-1, 1)] * 3))
def test_effective_tensor_is_the_energy_of_a_homogeneous_strain(family, seed, strain):
    rng = np.random.default_rng(seed)
    half = family.size // 2
    normal, shear, k = (np.tile(rng.uniform(0.1, 1, half), 2) for _ in range(3))
    moduli = ElasticModuli(normal, shear)
    tensor, e = effective_tensor(family, moduli), np.array(strain)
    scale = family.spacing**3 * family.m**3
    assert 0.5 * e @ tensor @ e == pytest.approx(
        summed_energy(family, moduli, e), rel=1e-10, abs=1e-12 * scale
    )
    conductive = ConductiveModuli(k)
    g = e[:2]
    assert 0.5 * g @ effective_tensor(family, conductive) @ g == pytest.approx(
        summed_energy(family, conductive, g), rel=1e-10, abs=1e-12 * scale
    )


# ---- lattice ------------------------------------------------------------------------------------


@exact
@given(families, voigts(), st.sampled_from([None, TwoHarmonic(), UniformShear()]))
def test_lattice_calibration_is_exact_for_any_elastic_tensor(family, voigt, law):
    moduli = calibrate(family, ElasticTensor(voigt), "lattice", law)
    assert relative(effective_tensor(family, moduli), voigt) < 1e-12


@exact
@given(families, conductivities(), st.sampled_from([None, TwoHarmonic(), Cosine(4), Cosine(12)]))
def test_lattice_calibration_is_exact_for_any_conductivity(family, matrix, law):
    moduli = calibrate(family, ConductivityTensor(matrix), "lattice", law)
    assert relative(effective_tensor(family, moduli), matrix) < 1e-12


@pytest.mark.parametrize("m", [3, 4.5, 5, 7])
def test_lattice_calibration_with_the_conical_influence(m):
    family = Family(m, 0.1, "partial", "conical")
    moduli = calibrate(family, ElasticTensor(FIG_7), "lattice")
    assert relative(effective_tensor(family, moduli), FIG_7) < 1e-12


@pytest.mark.parametrize("angle", [0.0, 0.5])
def test_cosine_laws_make_orthotropic_solids(angle):
    solid = ElasticTensor.orthotropic(3.0, 1.0, 0.7, 0.2).rotated(angle)
    moduli = calibrate(Family(5), solid, "lattice", Cosine(4))
    assert relative(effective_tensor(Family(5), moduli), solid.voigt) < 1e-12


def test_fourfold_law_makes_square_solids_only():
    square = ElasticTensor([[2, 0.5, 0], [0.5, 2, 0], [0, 0, 0.6]])
    for calibration in ("lattice", "continuum"):
        moduli = calibrate(Family(5), square, calibration, Fourfold(2))
        error = relative(effective_tensor(Family(5), moduli), square.voigt)
        assert error < (1e-12 if calibration == "lattice" else 0.1)
    with pytest.raises(CalibrationError, match=r"Fourfold law .* lacks its symmetry"):
        calibrate(Family(5), ElasticTensor.orthotropic(3.0, 1.0, 0.7, 0.2), "lattice", Fourfold(2))


def test_a_modulus_wrong_by_one_per_cent_is_seen():
    family = Family(5)
    moduli = calibrate(family, ElasticTensor(FIG_7), "lattice")
    off = ElasticModuli(1.01 * moduli.normal, moduli.shear)
    assert relative(effective_tensor(family, off), FIG_7) > 1e-3
    conductive = calibrate(family, ConductivityTensor(DISC), "lattice")
    off_k = ConductiveModuli(1.01 * conductive.conductivity)
    assert relative(effective_tensor(family, off_k), DISC) == pytest.approx(0.01)


def test_opposite_bonds_are_equal_to_the_last_bit():
    for calibration in ("lattice", "continuum", "positive"):
        moduli = calibrate(Family(5), ElasticTensor(FIG_7), calibration)
        for values in (moduli.normal, moduli.shear):
            half = len(values) // 2
            np.testing.assert_array_equal(values[:half], values[half:])


def test_a_mixed_shear_law_is_replaced_unless_it_was_asked_for():
    # C66 − C12 is small beside the anisotropy: the two-harmonic k_t takes both signs.
    solid = ElasticTensor([[140, 3, 0], [3, 10, 0], [0, 0, 5]])
    family = Family(3)
    asked = calibrate(family, solid, "lattice", TwoHarmonic())
    assert asked.shear.min() < 0 < asked.shear.max()
    chosen = calibrate(family, solid, "lattice")
    assert np.ptp(chosen.shear) < 1e-12 * chosen.shear.max()
    for moduli in (asked, chosen):
        assert relative(effective_tensor(family, moduli), solid.voigt) < 1e-12


# ---- Cauchy's symmetry --------------------------------------------------------------------------


def test_one_third_in_plane_stress_has_no_shear_stiffness():
    for family in (Family(3), Family(5, 0.01), Family(4.5, 1.0, "exact")):
        moduli = calibrate(family, ElasticTensor.isotropic(E=2e11, nu=1 / 3), "lattice")
        assert not moduli.has_shear
        np.testing.assert_array_equal(moduli.shear, 0.0)


def test_anisotropic_cauchy_solid_has_no_shear_stiffness():
    solid = ElasticTensor([[3, 0.8, 0.2], [0.8, 2, -0.1], [0.2, -0.1, 0.8]])
    moduli = calibrate(Family(4), solid, "lattice")
    assert not moduli.has_shear
    assert relative(effective_tensor(Family(4), moduli), solid.voigt) < 1e-12


def test_almost_one_third_keeps_its_shear():
    moduli = calibrate(Family(3), ElasticTensor.isotropic(E=1.0, nu=0.3333), "lattice")
    assert moduli.has_shear


# ---- the paper's constants (h = 1) --------------------------------------------------------------


@exact
@given(voigts(), st.sampled_from([3, 5, 4.5]))
def test_continuum_two_harmonic_constants_are_eqs_65_to_70(voigt, m):
    family = Family(m, 0.1)
    c11, c22, c12, c66, c16, c26 = voigt[[0, 1, 0, 2, 0, 1], [0, 1, 1, 2, 2, 2]]
    scale = np.pi * family.horizon**3
    k1111, k2222 = 12 * (c11 - c66) / scale, 12 * (c22 - c66) / scale
    k1112, k2212 = 6 * (3 * c16 - c26) / scale, 6 * (3 * c26 - c16) / scale
    k1122 = 12 * (3 * c12 - c66) / scale
    k1212 = 3 * (8 * c66 - c11 - c22 - 2 * c12) / scale
    c, s = family.normal.T
    normal = (
        k1111 * c**4
        + k2222 * s**4
        + (2 * k1122 + 4 * k1212) * c**2 * s**2
        + 4 * (k1112 * c**2 + k2212 * s**2) * c * s
    )
    shear = (
        (k1111 + k2222 - 2 * k1122) * c**2 * s**2
        + k1212 * (c**2 - s**2) ** 2
        - 2 * (k1112 - k2212) * c * s * (c**2 - s**2)
    )
    moduli = calibrate(family, ElasticTensor(voigt), "continuum")
    atol = 1e-11 * np.abs(normal).max()
    np.testing.assert_allclose(moduli.normal, normal, atol=atol)
    np.testing.assert_allclose(moduli.shear, shear, atol=atol)


@exact
@given(conductivities(), st.sampled_from([3, 5, 4.5]))
def test_continuum_two_harmonic_conduction_is_eqs_153_to_155(matrix, m):
    family = Family(m, 0.1)
    scale = np.pi * family.horizon**2
    k11, k22, k12 = matrix[0, 0], matrix[1, 1], matrix[0, 1]
    c, s = family.normal.T
    wanted = (2 * (3 * k11 - k22) * c**2 + 2 * (3 * k22 - k11) * s**2 + 16 * k12 * c * s) / scale
    moduli = calibrate(family, ConductivityTensor(matrix), "continuum", TwoHarmonic())
    np.testing.assert_allclose(moduli.conductivity, wanted, atol=1e-12 * np.abs(wanted).max())


@pytest.mark.parametrize("n", [2, 4, 6, 12, 34])
@pytest.mark.parametrize("angle", [0.0, 0.6])
def test_continuum_cosine_constants_in_closed_form(n, angle):
    # With I_n = ∫cosⁿ = 2π (n−1)!!/n!! over the circle, K₁ = (δ²/4)(k₂ π + (k₁−k₂) I_{n+2}) and
    # K₂ = (δ²/4)(k₂ π + (k₁−k₂)(I_n − I_{n+2})), I_{n+2} = I_n (n+1)/(n+2).
    big, small = 3.0, 1.0
    family = Family(5, 0.1)
    circle = 2 * np.pi * np.prod(np.arange(1, n, 2) / np.arange(2, n + 1, 2))
    quarter = family.horizon**2 / 4
    difference = (big - small) * (n + 2) / (n * circle * quarter)
    k2 = ((n + 1) * small - big) / (n * np.pi * quarter)
    material = ConductivityTensor.orthotropic(big, small, angle)
    moduli = calibrate(family, material, "continuum", Cosine(n))
    wanted = k2 + difference * np.cos(family.angle - angle) ** n
    np.testing.assert_allclose(moduli.conductivity, wanted, atol=1e-11 * np.abs(wanted).max())
    scale = np.pi * family.horizon**2
    if n == 4:
        # Eqs. 164 and 165.
        assert k2 == pytest.approx((5 * small - big) / scale)
        assert k2 + difference == pytest.approx((7 * big - 3 * small) / scale)
    if n == 12:
        # Eq. 167 has 13 K₂ − K₁ over π h δ² without the factor 1/3 that the moments give.
        assert k2 == pytest.approx((13 * small - big) / 3 / scale)


def test_conical_influence_scales_the_paper_s_constants():
    # Ξ is a quarter of the constant Λ's in elasticity (π/1536 to π/384), a third in conduction.
    plain, conical = Family(5), Family(5, 1.0, "full", "conical")
    places = [np.flatnonzero((plain.offsets == o).all(axis=1))[0] for o in conical.offsets]
    solid, conductor = ElasticTensor(FIG_7), ConductivityTensor(DISC)
    for name in ("normal", "shear"):
        one = getattr(calibrate(plain, solid, "continuum"), name)[places]
        np.testing.assert_allclose(
            getattr(calibrate(conical, solid, "continuum"), name), 4 * one, rtol=1e-10
        )
    one = calibrate(plain, conductor, "continuum").conductivity[places]
    other = calibrate(conical, conductor, "continuum").conductivity
    np.testing.assert_allclose(other, 3 * one, rtol=1e-10, atol=1e-12 * one.max())


def test_continuum_calibration_on_the_paper_s_lattice():
    # Measured with m = 5, partial areas and n = 34 (measured); not what was asked for.
    moduli = calibrate(Family(5), ConductivityTensor(DISC), "continuum", Cosine(34))
    found = effective_tensor(Family(5), moduli)
    np.testing.assert_allclose(found, [[4.63, 1.88], [1.88, 0.96]], atol=5e-3)


@pytest.mark.parametrize("physics", ["elastic", "conductive"])
def test_continuum_calibration_is_right_as_the_lattice_gets_fine(physics):
    if physics == "elastic":
        material, wanted = ElasticTensor(FIG_7), FIG_7
    else:
        wanted = np.array([[2.0, 0.4], [0.4, 1.0]])
        material = ConductivityTensor(wanted)
    errors = []
    for m in (5, 40):
        family = Family(m, 1.0, "exact")
        moduli = calibrate(family, material, "continuum", TwoHarmonic())
        errors.append(relative(effective_tensor(family, moduli), wanted))
    assert errors[1] < 2e-3
    assert errors[1] < errors[0] / 10


# ---- positive -----------------------------------------------------------------------------------


def decoupling(family, moduli):
    """Moment that a homogeneous strain exerts on the particles, relative to the shear stiffness."""
    weight = bond_weights(family, ElasticTensor(np.eye(3)))
    moment = stretch_rows(family.angle)[1] @ (weight * moduli.shear)
    return np.abs(moment).max() / (weight * np.abs(moduli.normal)).sum()


@exact
@given(families, voigts(floor=0.3))
def test_positive_elastic_moduli_are_exact_or_do_not_exist(family, voigt):
    assume(voigt[2, 2] > voigt[0, 1])
    try:
        moduli = calibrate(family, ElasticTensor(voigt), "positive")
    except CalibrationError:
        # Ask linear programming for any non-negative moduli, with the sums of `summed_energy`.
        v, g = stretch_rows(family.angle)
        weight = bond_weights(family, ElasticTensor(voigt))
        pairs = np.triu_indices(3)
        rows = np.hstack([weight * v[pairs[0]] * v[pairs[1]], weight * g[pairs[0]] * g[pairs[1]]])
        rows = np.vstack([rows, np.hstack([np.zeros_like(g), weight * g])])
        target = np.concatenate([voigt[pairs], np.zeros(3)])
        # Weights of 1e-7 would be beneath what a linear programme takes for zero.
        rows /= np.abs(rows).max()
        program = linprog(np.zeros(rows.shape[1]), A_eq=rows, b_eq=target, bounds=(0, None))
        assert program.status == 2  # infeasible
        return
    assert moduli.non_negative
    assert relative(effective_tensor(family, moduli), voigt) < 1e-12
    assert decoupling(family, moduli) < 1e-13


@exact
@given(st.sampled_from([3, 4, 5, 7, 4.5]), st.floats(1, 40), st.floats(0, 3))
def test_positive_conduction_is_exact(m, ratio, angle):
    family, material = Family(m), ConductivityTensor.orthotropic(ratio, 1.0, angle)
    if not representable(family, material):
        with pytest.raises(CalibrationError, match="no non-negative bond moduli"):
            calibrate(family, material, "positive")
        return
    moduli = calibrate(family, material, "positive")
    assert moduli.non_negative
    assert relative(effective_tensor(family, moduli), material.matrix) < 1e-12


def test_positive_is_the_law_itself_where_the_law_is_positive_and_exact():
    # Exact areas at a large m: the continuum law nearly has the moments already.
    family = Family(7, 1.0, "exact")
    solid = ElasticTensor.isotropic(1.0, 0.1)
    smooth = calibrate(family, solid, "continuum")
    assert smooth.non_negative
    moduli = calibrate(family, solid, "positive")
    assert relative(moduli.normal, smooth.normal) < 0.05
    assert relative(moduli.shear, smooth.shear) < 0.05


def test_positive_needs_c66_at_least_c12():
    with pytest.raises(CalibrationError, match=r"at any m.*C66 − C12.*< 0.*lattice"):
        calibrated(Family(5), ElasticTensor.isotropic(1.0, 0.4), "positive")


def test_the_error_names_an_m_that_will_do():
    # A ratio of 60 at 0.3 rad: a small family has no bond near the principal axis.
    material = ConductivityTensor.orthotropic(60.0, 1.0, 0.3)
    with pytest.raises(CalibrationError, match=r"exist at m = \d+") as caught:
        calibrated(Family(2), material, "positive")
    m = int(re.search(r"exist at m = (\d+)", str(caught.value))[1])
    assert m > 2
    assert not any(representable(Family(k), material) for k in range(2, m))
    assert calibrate(Family(m), material, "positive").non_negative


def test_the_error_says_that_no_m_will_do():
    # C66 > C12, and yet outside the cone of non-negative bonds: linear programming over 720
    # directions finds nothing either, so no horizon can help.
    voigt = np.array([[2.25, -1.05, 0.87], [-1.05, 0.96, -0.28], [0.87, -0.28, 1.45]])
    psi = np.pi * np.arange(720) / 720
    v, g = stretch_rows(psi)
    pairs = np.triu_indices(3)
    rows = np.hstack([v[pairs[0]] * v[pairs[1]], g[pairs[0]] * g[pairs[1]]])
    rows = np.vstack([rows, np.hstack([np.zeros_like(g), g])])
    target = np.concatenate([voigt[pairs], np.zeros(3)])
    program = linprog(np.zeros(rows.shape[1]), A_eq=rows, b_eq=target, bounds=(0, None))
    assert program.status == 2  # infeasible
    with pytest.raises(CalibrationError, match="nor at any m ≤ 14"):
        calibrated(Family(3), ElasticTensor(voigt), "positive")


def test_carbon_epoxy_has_positive_moduli():
    solid = ElasticTensor([[140, 3, 0], [3, 10, 0], [0, 0, 5]])
    moduli = calibrate(Family(3), solid, "positive")
    assert moduli.non_negative
    assert relative(effective_tensor(Family(3), moduli), solid.voigt) < 1e-12


def test_unknown_calibration():
    with pytest.raises(ValueError, match="unknown calibration 'exact'"):
        calibrate(Family(3), ElasticTensor(FIG_7), "exact")


def test_one_third_in_plane_stress_has_positive_moduli():
    for family in (Family(3), Family(5, 0.01), Family(4.5, 1.0, "exact")):
        moduli = calibrate(family, ElasticTensor.isotropic(E=2e11, nu=1 / 3), "positive")
        assert not moduli.has_shear


def test_the_disc_conductor_has_positive_moduli_at_two_cells():
    # [[5, 2], [2, 1]] = (1, 0)(1, 0)ᵀ + (2, 1)(2, 1)ᵀ: two bonds of the family make it.
    moduli = calibrate(Family(2), ConductivityTensor(DISC), "positive")
    assert relative(effective_tensor(Family(2), moduli), DISC) < 1e-12


def test_default_laws():
    family = Family(3)
    one, other = (calibrate(family, ElasticTensor(FIG_7), law=law) for law in (None, TwoHarmonic()))
    np.testing.assert_array_equal(one.stiffness, other.stiffness)
    one, other = (calibrate(family, ConductivityTensor(DISC), law=law) for law in (None, Cosine()))
    np.testing.assert_array_equal(one.stiffness, other.stiffness)
