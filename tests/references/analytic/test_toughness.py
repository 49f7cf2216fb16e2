"""Fracture energy of broken bonds: quadrature, closed constants and the printed equations."""

import numpy as np
import pytest

from references.analytic import toughness


def two_lobes(w, n):
    return lambda psi: w.across + (w.along - w.across) * np.cos(psi) ** n


@pytest.mark.parametrize(("n", "ratio"), [(2, 1.8), (4, 2.5), (8, 3.6), (32, 7.1)])
def test_constants_put_into_the_integral_return_both_energies(n, ratio):
    law = two_lobes(toughness.two_lobe_constants(ratio, 1.0, n, 0.3, 2.0), n)
    assert toughness.fracture_energy(law, 0.3, 2.0) == pytest.approx(ratio, rel=1e-7)
    turned = toughness.fracture_energy(lambda psi: law(psi + np.pi / 2), 0.3, 2.0)
    assert turned == pytest.approx(1.0, rel=1e-7)


def test_constants_of_equation_99():
    # G0 = 2106, G1 = 989 J/m² (bone), δ = 1: 3 (280 G0 − 187 G1)/186, 3 (128 G1 − 35 G0)/186
    found = toughness.two_lobe_constants(2106.0, 989.0, 8, 1.0)
    assert found == pytest.approx((1214211 / 186, 158646 / 186), rel=1e-12)


def test_fourfold_constants_return_both_energies():
    w = toughness.fourfold_constants(1.0, 1.15, 0.7)

    def law(psi):
        return w.across + (w.along - w.across) * np.cos(2 * psi) ** 4

    found = toughness.effective_energy(law, [0.0, np.pi / 4], 0.7)
    np.testing.assert_allclose(found, [1.0, 1.15], rtol=1e-12)


def test_the_collapsed_integral_is_equation_92():
    def law(psi):
        return 1.0 + np.cos(psi - 0.4) ** 6 + 0.3 * np.sin(2 * psi)

    whole = [toughness.fracture_energy(lambda psi, z=z: law(psi - z), 0.7) for z in (0.0, 0.9)]
    np.testing.assert_allclose(toughness.effective_energy(law, [0.0, 0.9], 0.7), whole, rtol=1e-7)


def test_bad_input_is_named():
    with pytest.raises(ValueError, match="horizon"):
        toughness.fracture_energy(np.cos, 0.0)
    with pytest.raises(ValueError, match="even"):
        toughness.two_lobe_constants(1.0, 1.0, 3, 1.0)
