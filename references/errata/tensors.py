"""Eqs. 40-57: stress and strain in turned axes, strains of a bond, energy of a horizon."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from references.errata.algebra import (
    COS,
    HORIZON,
    SIN,
    THICKNESS,
    circle_integral,
    names,
    stiffness_symbols,
    turned,
)
from references.errata.model import Entry, Form, Verdict

MACRO = stiffness_symbols()
MODULI = (MACRO[0, 0], MACRO[1, 1], MACRO[0, 1], MACRO[2, 2], MACRO[0, 2], MACRO[1, 2])
MICRO = sp.symbols("K11 K22 K12 K66 K16 K26", real=True)
E11, E22, E12 = sp.symbols("e11 e22 e12", real=True)
_XI = sp.Symbol("xi", positive=True)
_STRAIN = sp.Matrix([[E11, E12], [E12, E22]])
_STRESS = sp.Matrix(2, 2, sp.symbols("t11 t12 t12 t22", real=True))
FRAME = sp.Matrix([[COS, SIN], [-SIN, COS]])


def _voigt(tensor: sp.Matrix, shear: int) -> sp.Matrix:
    return sp.Matrix([tensor[0, 0], tensor[1, 1], shear * tensor[0, 1]])


def _symbols() -> dict[str, Any]:
    return names(
        "C11 C22 C12 C66 C16 C26 K11 K22 K12 K66 K16 K26 e11 e22 e12",
        xi=_XI,
        C=MACRO,
        strain=_voigt(_STRAIN, 2),
        stress=_voigt(_STRESS, 1),
        Qs=_turning(1),
        Qe=_turning(2),
        eps=_STRAIN,
        n=sp.Matrix([COS, SIN]),
        t=sp.Matrix([-SIN, COS]),
        m=sp.Symbol("n_other"),
    )


#: Micromoduli and strains of no symmetry, where integrals are wanted for many forms.
_SOLID = dict(zip((*MICRO, E11, E22, E12), map(sp.Rational, (7, 5, 3, 2, 11, 13, 17, 19, 23)),
                  strict=True))  # fmt: skip


def _numbers() -> dict[str, Any]:
    laws = [law(MICRO).subs(_SOLID) for law in (axial_law, shear_law)]
    strains = [strain.subs(_SOLID) for strain in bond_strains()]
    return names(
        law_n=laws[0],
        law_t=laws[1],
        st=strains[0],
        g=strains[1],
        angular=laws[0] * strains[0] ** 2 + laws[1] * strains[1] ** 2,
        circle=cache(circle_integral),
        radial=lambda power: sp.integrate(_XI**power, (_XI, 0, HORIZON)),
    )


def _turning(shear: int) -> sp.Matrix:
    """Voigt components (shear: 1 stress, 2 engineering strain) in axes turned by psi."""
    a, b, d = sp.symbols("a b d", real=True)
    local = FRAME * sp.Matrix([[a, d / shear], [d / shear, b]]) * FRAME.T
    matrix: sp.Matrix = _voigt(local, shear).jacobian(sp.Matrix([a, b, d]))
    return matrix


def bond_strains() -> tuple[Any, Any]:
    """Stretch and shear of a bond in a homogeneous strain, Eqs. 1-2 without rotation."""
    eta = _STRAIN * sp.Matrix([COS, SIN])
    return sp.expand(eta[0] * COS + eta[1] * SIN), sp.expand(-eta[0] * SIN + eta[1] * COS)


@cache
def off_axis() -> tuple[Any, Any]:
    """C1111 and C1212 in axes turned by psi."""
    here = turned(MACRO)
    return here[0, 0], here[2, 2]


def _with(constants: tuple[Any, ...], law: Any) -> Any:
    return law.subs(dict(zip(MODULI, constants, strict=True)), simultaneous=True)


def axial_law(constants: tuple[Any, ...]) -> Any:
    """The off-axis modulus C1111 with other constants (11, 22, 12, 66, 16, 26): Eq. 48."""
    return _with(constants, off_axis()[0])


def shear_law(constants: tuple[Any, ...]) -> Any:
    """The off-axis modulus C1212 with other constants: Eq. 49."""
    return _with(constants, off_axis()[1])


@cache
def horizon_energy() -> Any:
    """W of Eq. 11 in a homogeneous strain, with the laws of Eqs. 48 and 49 and Lam = 1."""
    stretch, shear = bond_strains()
    pair = axial_law(MICRO) * stretch**2 + shear_law(MICRO) * shear**2
    radial = sp.integrate(_XI * _XI / 2, (_XI, 0, HORIZON))
    return sp.expand(THICKNESS / 2 * radial * circle_integral(pair))


def macro_energy() -> Any:
    """Strain energy density of the continuum."""
    strain = _voigt(_STRAIN, 2)
    return sp.expand((strain.T * MACRO * strain)[0] / 2)


def _stress() -> sp.Matrix:
    """Stress as the energy's derivative by the strains (each shear strain stands twice)."""
    return sp.Matrix([sp.diff(macro_energy(), e) / k for e, k in ((E11, 1), (E22, 1), (E12, 2))])


def _inverse() -> sp.Matrix:
    return _turning(2) * _turning(1).T


def engineering_reading() -> dict[str, float]:
    """How many times too small k_t would be if gamma were the engineering shear of Eq. 44."""
    isotropic, paper = (1.0, 1.0, 0.25, 0.375, 0.0, 0.0), (1.0, 0.8, 0.2, 1 / 3, 0.1, 1 / 6)
    low, high = _shear_ratios(paper)
    return {"isotropic": _shear_ratios(isotropic)[0], "low": low, "high": high}


def _shear_ratios(moduli: tuple[float, ...]) -> tuple[float, float]:
    stretch, shear = bond_strains()
    macro, laws = macro_energy().subs(dict(zip(MODULI, moduli, strict=True))), []
    for factor in (1, 2):
        pair = axial_law(MICRO) * stretch**2 + shear_law(MICRO) * (factor * shear) ** 2
        energy = sp.Poly(circle_integral(pair) - 2 * macro, E11, E22, E12)
        micro = sp.solve(energy.coeffs(), MICRO)
        laws.append(sp.lambdify((COS, SIN), shear_law(tuple(micro[k] for k in MICRO))))
    psi = np.linspace(0, np.pi, 181)
    ratio = laws[0](np.cos(psi), np.sin(psi)) / laws[1](np.cos(psi), np.sin(psi))
    return float(np.min(ratio)), float(np.max(ratio))


_R, _D = Verdict.RIGHT, Verdict.DEFINITION
_AXIAL = "{0}11*c**4 + {0}22*s**4 + 2*{0}12*s**2*c**2 + 4*{0}66*s**2*c**2 + 4*{0}16*c**3*s"
_AXIAL += " + 4*{0}26*c*s**3"
_SHEAR = "{0}11*s**2*c**2 + {0}22*s**2*c**2 - 2*{0}12*s**2*c**2"
_SHEAR += " - 2*({0}16 - {0}26)*(c**3*s - c*s**3) + {0}66*(c**2 - s**2)**2"


def _entry(number: str, title: str, form: str, truth: Any, how: str, verdict: Any = _R) -> Entry:
    return Entry(number, title, verdict, (Form(form),), truth, _symbols, how)


ENTRIES = [
    Entry("Sect. 2.2 (before 40)", "indices of Hooke's law", Verdict.NOTATION,
          (Form("C_ijkl*e_hk", "C_ijkl*e_kl", ratio="e_hk/e_kl"),),
          lambda: (sp.Symbol("C_ijkl", real=True) * sp.Symbol("e_kl", real=True),),
          lambda: names("C_ijkl e_hk e_kl"), "the free and summed indices of a product must match",
          ("sum over k, l: right; h stands on one side only and l on the other",)),
    _entry("40", "Hooke's law", "C*strain", lambda: (_stress(),),
           "stress is the energy's derivative"),
    _entry("41", "Hooke's law in components",
           "Matrix([[C11, C12, C16], [C12, C22, C26], [C16, C26, C66]])*Matrix([e11, e22, 2*e12])",
           lambda: (_stress(),), "stress is the energy's derivative"),
    _entry("42", "Hooke's law in turned axes", "Qs*C*Qs.T*(Qe*strain)",
           lambda: (_turning(1) * _stress(),), "stress and strain turned as tensors"),
    _entry("43", "turned stress", "Matrix([[c**2, s**2, 2*c*s], [s**2, c**2, -2*c*s], "
           "[-c*s, c*s, c**2 - s**2]])", lambda: (_turning(1),), "a tensor in turned axes"),
    _entry("44", "turned engineering strain", "Matrix([[c**2, s**2, c*s], [s**2, c**2, -c*s], "
           "[-2*c*s, 2*c*s, c**2 - s**2]])", lambda: (_turning(2),), "a tensor in turned axes"),
    Entry("45", "turned stiffness", _R, (Form("Qs*C*Qs.T"), Form("Qe*Qs.T")),
          lambda: (turned(MACRO), sp.eye(3)), _symbols,
          "C_ijkl with four direction cosines; Qe^-1 = Qs^T"),
    _entry("46", "off-axis axial modulus", _AXIAL.format("C"), lambda: off_axis()[:1],
           "C_ijkl with four direction cosines"),
    _entry("47", "off-axis shear modulus", _SHEAR.format("C"), lambda: off_axis()[1:],
           "C_ijkl with four direction cosines"),
    _entry("48", "angular law of k_n", _AXIAL.format("K"), lambda: (axial_law(MICRO),),
           "the off-axis modulus with micromoduli", _D),
    _entry("49", "angular law of k_t", _SHEAR.format("K"), lambda: (shear_law(MICRO),),
           "the off-axis modulus with micromoduli", _D),
    _entry("50", "strain energy density", "1/2*(C11*e11**2 + C22*e22**2 + 2*C12*e11*e22"
           " + 4*C66*e12**2 + 4*C16*e12*e11 + 4*C26*e12*e22)", lambda: (macro_energy(),),
           "half of strain times stress"),
    Entry("51", "energy of the bonds of a point", Verdict.NOTATION,
          (Form("h/4*radial(2)*(law_n*st**2 + law_t*g**2)",
                "h/4*radial(2)*circle(law_n*st**2 + law_t*g**2)",
                off="h/4*radial(2)*(angular - circle(angular))"),),
          lambda: (horizon_energy().subs(_SOLID),), _numbers,
          "half of the pair energies, |xi| d|xi| dpsi each",
          ("with the d psi that the inner integral needs and the print leaves out: right",),
          "none: the limits of the inner integral say what is meant"),
    Entry("52", "stretch of a bond", Verdict.LOST,
          (Form("m.subs(m, eps_mn)", "(n.T*eps*n)[0]", off="eps_mn - (n.T*eps*n)[0]"),
           Form("(n.T*eps*n)[0]")), lambda: (bond_strains()[0],) * 2,
          lambda: _symbols() | {"eps_mn": sp.Symbol("eps_mn", real=True)},
          "Eq. 1 with the displacements of a homogeneous strain",
          ("eps_mn, as extracted: m is not defined", "eps_nn, as the last member says: right"),
          harmless=("m.subs(eps_mn, eps_mn)",)),
    Entry("53", "shear of a bond", Verdict.UNSAID, (Form("(n.T*eps*t)[0]"),),
          lambda: (bond_strains()[1],), _symbols,
          "Eq. 2 with the displacements of a homogeneous strain, no rotation",
          ("the tensor component: right", "the third component of Q_eps eps (Eq. 44), to which the "
           "text points: twice that"),
          "with the shear of Eq. 44 k_t would come out {isotropic:.2f} times too small in an "
          "isotropic body; in the paper's anisotropic one between {low:.2f} and {high:.2f} "
          "times, by direction",
          engineering_reading),
    Entry("54", "strains of a bond, written out", _R,
          (Form("e11*c**2 + e22*s**2 + 2*e12*c*s"),
           Form("e12*(c**2 - s**2) + (e22 - e11)*c*s")), bond_strains, _symbols,
          "Eqs. 1-2 with the displacements of a homogeneous strain"),
    _entry("55", "energy of a full horizon",
           "h*pi*delta**3/384*(e11**2*(19*K11 + 3*K22 + 12*K66 + 2*K12)"
           " + e22**2*(3*K11 + 19*K22 + 12*K66 + 2*K12)"
           " + 2*e11*e22*(K11 + K22 + 4*K66 + 6*K12)"
           " + 4*e12**2*(3*K11 + 3*K22 + 12*K66 + 2*K12)"
           " + 16*e11*e12*(3*K16 + K26) + 16*e22*e12*(K16 + 3*K26))",
           lambda: (horizon_energy(),), "pair energies integrated over the horizon"),
    _entry("56", "scale of the horizon", "delta**3*(pi/384)", lambda: (_scale(),),
           "coefficient of e11^2 K11 over 19 h; another influence changes the number only", _D),
    _entry("57", "its number", "pi/384", lambda: (_scale() / HORIZON**3,),
           "as Eq. 56, with Lam = 1"),
]  # fmt: skip


def _scale() -> Any:
    return (
        sp.Poly(horizon_energy(), E11, MICRO[0]).coeff_monomial(E11**2 * MICRO[0])
        / 19
        / (THICKNESS)
    )
