"""The audit's own derivations beside the closed forms of `references.analytic`."""

import numpy as np
import pytest
import sympy as sp

from references.analytic import lekhnitskii, tetrachiral
from references.errata import blocks, conductivity, crack_tip, cuts, disc, materials


@pytest.mark.parametrize("load", [(1.0, 0.0), (0.0, 1.0), (0.7, -1.3)])
@pytest.mark.parametrize("omega", [-3.0, -0.4, 0.0, 1.1, 2.9])
def test_strohs_crack_tip_is_lekhnitskiis(load, omega):
    x, y = 0.3 * np.cos(omega), 0.3 * np.sin(omega)
    own = crack_tip.tip_displacement(crack_tip.TENSOR, 0.3, omega, np.array(load))
    other = lekhnitskii.crack_tip_displacement(crack_tip.TENSOR, x, y, *load)
    assert own == pytest.approx(other, rel=1e-12)


@pytest.mark.parametrize("across", [True, False])
def test_crack_closure_is_the_energy_release_rate(across):
    compliance = materials._bone_compliance(across)
    other = lekhnitskii.energy_release_rate(np.linalg.inv(compliance), 5e6, 0.0)
    assert materials.closure(5e6, compliance) == pytest.approx(other, rel=1e-10)


@pytest.mark.parametrize(("kn", "kt", "tan"), [(3.0, 1.0, 0.5), (1.0, 4.0, 0.2)])
def test_the_block_lattice_twice(kn, kt, tan):
    own = blocks.lattice_stiffness().subs({blocks._KN: kn, blocks._KT: kt, blocks._TAN: tan})
    other = tetrachiral.effective_voigt(kn, kt, np.arctan(tan))
    assert np.array(own, dtype=float) == pytest.approx(other, rel=1e-12)


def test_frames_of_eq_109_symbolically():
    """The roots multiply to S22/S11, so the printed form is the Sih-Paris-Irwin modulus."""
    s11, s22, b1, b2, a = sp.symbols("S11 S22 b1 b2 a", positive=True)
    mu1, mu2 = a + sp.I * b1, -a + sp.I * b2
    product = mu1 * mu2 * sp.conjugate(mu1 * mu2)
    printed = s11 / 2 * sp.im(-(mu1 + mu2) * sp.conjugate(mu1) * sp.conjugate(mu2))
    irwin = -s22 / 2 * sp.im((mu1 + mu2) / (mu1 * mu2))
    assert sp.simplify((printed - irwin).subs(s22, s11 * sp.expand(product))) == 0


def test_the_printed_disc_has_another_solution():
    found = disc.solution_as_printed()
    assert disc.balance(found) == 0
    x1, x2 = sp.symbols("x1 x2", real=True)
    rim = {x1: sp.Rational(3, 5), x2: sp.Rational(-4, 5)}
    printed = disc.field(sp.Rational(1, 5))
    assert sp.simplify((found - printed).subs(rim)) == 0
    assert disc.balance(printed, ((4, sp.Rational(17, 10)), (sp.Rational(17, 10), 1))) == 0


def test_one_per_cent_in_a_derivation_fails_its_proof():
    """Each of these forms against a truth that is 1 % off."""
    for entry in (*cuts.ENTRIES[5:8], *conductivity.ENTRIES[-2:], *blocks.ENTRIES[2:4]):
        for form, truth in zip(entry.forms, entry.truth(), strict=True):
            with pytest.raises(AssertionError):
                form.check(entry.names(), sp.Rational(101, 100) * truth, entry.exact)
