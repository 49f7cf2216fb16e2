"""Angular laws: what functions of the bond's direction they hold."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import (
    CalibrationError,
    ConductivityTensor,
    Cosine,
    ElasticTensor,
    Family,
    Fourfold,
    TwoHarmonic,
    UniformShear,
)
from solver.material import assess, calibrate
from tests.solver.bodies import DISC, FIG_7, conductivities, exact, rotate_4, voigts

PSI = np.linspace(-3.0, 3.0, 13)


@exact
@given(voigts(), st.floats(-3.2, 3.2))
def test_two_harmonic_basis_is_that_of_the_off_axis_moduli(voigt, psi):
    # Eqs. 46–49: with the tensor's own entries as coefficients, in the order 𝒦1111, 𝒦2222,
    # 𝒦1122, 𝒦1212, 𝒦1112, 𝒦2212, k_n is Ĉ1111(ψ) and k_t is Ĉ1212(ψ).
    entries = voigt[[0, 1, 0, 2, 0, 1], [0, 1, 1, 2, 2, 2]]
    normal, shear = TwoHarmonic().elastic(np.array([psi]), ElasticTensor(voigt))
    turned = rotate_4(voigt, -psi)
    assert entries @ normal[:, 0] == pytest.approx(turned[0, 0], abs=1e-13)
    assert entries @ shear[:, 0] == pytest.approx(turned[2, 2], abs=1e-13)


@exact
@given(conductivities(), st.floats(-3.2, 3.2))
def test_two_harmonic_conduction_is_the_off_axis_conductivity(matrix, psi):
    basis = TwoHarmonic().conductive(np.array([psi]), ConductivityTensor(matrix), extended=False)
    turned = ConductivityTensor(matrix).rotated(-psi).matrix
    found = [matrix[0, 0], matrix[1, 1], matrix[0, 1]] @ basis[:, 0]
    assert found == pytest.approx(turned[0, 0], abs=1e-13)


@pytest.mark.parametrize("law", [TwoHarmonic(), UniformShear(), Cosine(4, axis=0.3), Fourfold(4)])
def test_laws_do_not_tell_a_bond_from_its_mirror_image(law):
    solid = ElasticTensor.orthotropic(3.0, 1.0, 0.7, 0.2)
    for here, there in zip(law.elastic(PSI, solid), law.elastic(PSI + np.pi, solid), strict=True):
        np.testing.assert_allclose(here, there, atol=1e-13)


@pytest.mark.parametrize("law", [TwoHarmonic(), UniformShear(), Cosine(6, axis=0.3), Fourfold(8)])
def test_degree_bounds_every_harmonic(law):
    solid = ElasticTensor.orthotropic(3.0, 1.0, 0.7, 0.2)
    count = 64
    psi = 2 * np.pi * np.arange(count) / count
    for basis in law.elastic(psi, solid):
        spectrum = np.abs(np.fft.rfft(basis, axis=1))
        assert spectrum[:, law.degree + 1 :].max(initial=0.0) < 1e-12 * count


def test_uniform_shear_has_one_shear_modulus():
    normal, shear = UniformShear().elastic(PSI, ElasticTensor(FIG_7))
    assert normal.shape == shear.shape == (6, len(PSI))
    np.testing.assert_array_equal(shear, np.outer([0, 0, 0, 0, 0, 1], np.ones_like(PSI)))
    np.testing.assert_array_equal(normal[5], 0.0)


@pytest.mark.parametrize(
    ("ratio", "n"),
    # K1/K2 ≤ n + 1 (text after Eq. 163), n even and at least 2.
    [(1.0, 2), (2.9, 2), (3.0, 2), (3.01, 4), (5.0, 4), (13.0, 12), (13.1, 14), (33.97, 34)],
)
def test_the_default_exponent_is_the_smallest_that_stays_non_negative(ratio, n):
    assert Cosine().exponent(ConductivityTensor.orthotropic(ratio, 1.0, 0.4)) == n
    assert Cosine(6).exponent(ConductivityTensor.orthotropic(ratio, 1.0)) == 6


def test_the_disc_needs_n_34():
    # Eigenvalues 3 ± 2√2: their ratio is 33.97.
    assert Cosine().exponent(ConductivityTensor(DISC)) == 34


def test_cosine_basis():
    material = ConductivityTensor.orthotropic(4.0, 1.0, 0.4)
    basis = Cosine(4).conductive(PSI, material, extended=True)
    c, s = np.cos(PSI - 0.4), np.sin(PSI - 0.4)
    np.testing.assert_allclose(basis, [np.ones_like(c), c**4, c**3 * s], atol=1e-14)
    assert len(Cosine(4).conductive(PSI, material, extended=False)) == 2
    turned = Cosine(4, axis=0.0).conductive(PSI, material, extended=False)
    np.testing.assert_allclose(turned[1], np.cos(PSI) ** 4, atol=1e-14)


def test_fourfold_has_square_symmetry():
    solid = ElasticTensor.isotropic(1.0, 0.3)
    law = Fourfold(6, axis=0.2)
    for here, there in zip(
        law.elastic(PSI, solid), law.elastic(PSI + np.pi / 2, solid), strict=True
    ):
        even = [0, 1, 3, 4]
        np.testing.assert_allclose(here[even], there[even], atol=1e-13)


@pytest.mark.parametrize("n", [1, 3, 0, -2, 2.5])
def test_exponents_are_even(n):
    with pytest.raises(ValueError, match="even integer"):
        Cosine(n)
    with pytest.raises(ValueError, match="even integer"):
        Fourfold(n)


def test_cosine_laws_need_a_material_axis():
    solid = ElasticTensor(FIG_7)
    for law in (Cosine(4), Fourfold(4)):
        with pytest.raises(CalibrationError, match="not orthotropic"):
            law.elastic(PSI, solid)


def test_laws_of_elasticity_are_refused_in_conduction():
    for law in (Fourfold(2), UniformShear()):
        with pytest.raises(CalibrationError, match="Cosine"):
            law.conductive(PSI, ConductivityTensor(DISC), extended=False)


@pytest.mark.parametrize("n", [2, 4, 8])
@pytest.mark.parametrize("constants", [(3.0, 1.0, 0.4, 0.2), (1.0, 3.0, 0.1, 0.3)])
def test_a_cosine_law_turns_with_the_solid(n, constants):
    c11, c22, c12, c66 = constants
    solid = ElasticTensor(np.array([[c11, c12, 0.0], [c12, c22, 0.0], [0.0, 0.0, c66]]))
    family, law = Family(3, 1.0), Cosine(n)
    before, after = (
        calibrate(family, material, law=law) for material in (solid, solid.rotated(np.pi / 2))
    )
    index = {tuple(offset): o for o, offset in enumerate(family.offsets)}
    turned = [index[(-j, i)] for i, j in family.offsets]
    scale = np.abs(before.normal).max()
    np.testing.assert_allclose(after.normal[turned], before.normal, atol=1e-9 * scale)
    np.testing.assert_allclose(after.shear[turned], before.shear, atol=1e-9 * scale)
    assert assess(family, after).kind == assess(family, before).kind
