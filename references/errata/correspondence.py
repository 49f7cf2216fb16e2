"""Eqs. 58-78: macromoduli from micromoduli and back, isotropy, turned materials."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from references.errata import tensors
from references.errata.algebra import COS, HORIZON, SIN, THICKNESS, family, names, turned
from references.errata.model import Entry, Form, Verdict
from references.errata.tensors import MACRO, MICRO, MODULI, axial_law, shear_law

_C11, _C22, _C12, _C66, _C16, _C26 = MODULI
_XI, _ST, _G = sp.symbols("xi st g", real=True)
_ISOTROPIC = {_C22: _C11, _C12: _C11 - 2 * _C66, _C16: sp.Integer(0), _C26: sp.Integer(0)}


@cache
def macro_from_micro() -> tuple[Any, ...]:
    """C1111, C2222, C1122, C1212, C1112, C2212 of a full horizon, as derivatives of its energy."""
    energy, (e1, e2, e12) = tensors.horizon_energy(), (tensors.E11, tensors.E22, tensors.E12)
    return (
        sp.diff(energy, e1, 2),
        sp.diff(energy, e2, 2),
        sp.diff(energy, e1, e2),
        sp.diff(energy, e12, 2) / 4,
        sp.diff(energy, e1, e12) / 2,
        sp.diff(energy, e2, e12) / 2,
    )


@cache
def micromoduli() -> dict[Any, Any]:
    """The linear system solved."""
    system = [a - b for a, b in zip(macro_from_micro(), MODULI, strict=True)]
    solution: dict[Any, Any] = sp.solve(system, MICRO, dict=True)[0]
    return solution


def isotropic(value: Any) -> Any:
    """A function of the moduli in an isotropic body; angles drop out of what is right."""
    angle = sp.Symbol("psi", real=True)
    special = sp.expand(sp.sympify(value).subs(_ISOTROPIC))
    return sp.simplify(special.subs({COS: sp.cos(angle), SIN: sp.sin(angle)}))


def _micro(law: Any) -> Any:
    return law(tuple(micromoduli()[k] for k in MICRO))


@cache
def _isotropic_moduli() -> tuple[Any, Any]:
    return isotropic(_micro(axial_law)), isotropic(_micro(shear_law))


def _symbols() -> dict[str, Any]:
    return names("C11 C22 C12 C66 C16 C26 K11 K22 K12 K66 K16 K26 xi st g nu")


def _pair_energies(kn: Any, kt: Any) -> tuple[Any, Any]:
    return _XI / 2 * kn * _ST**2, _XI / 2 * kt * _G**2


def _special_names() -> dict[str, Any]:
    known = _symbols()
    known.update({str(k): isotropic(v) for k, v in micromoduli().items()})
    return known


def _poisson_limits() -> tuple[Any, Any]:
    """Where C1212 = C1111/3: plane stress, plane strain."""
    nu = sp.Symbol("nu")
    shear = 1 / (2 * (1 + nu))
    axial = (1 / (1 - nu**2), (1 - nu) / ((1 + nu) * (1 - 2 * nu)))
    return tuple(sp.solve(sp.numer(sp.together(shear - a / 3)), nu)[-1] for a in axial)


def _angle_names() -> dict[str, Any]:
    zeta = sp.Rational(1, 3)
    own = (sp.Matrix([sp.cos(zeta), sp.sin(zeta)]), sp.Matrix([-sp.sin(zeta), sp.cos(zeta)]))
    return names(
        a1=own[0], a2=own[1], e1=sp.Matrix([1, 0]), e2=sp.Matrix([0, 1]), zeta=zeta,
        Arg=sp.arg, quarter=sp.pi / 4,
    )  # fmt: skip


@cache
def _turned_laws() -> tuple[Any, Any]:
    """k_n and k_t of an orthotropic solid that stands at zeta, from its tensor turned there."""
    z1, z2 = sp.Rational(12, 13), sp.Rational(5, 13)
    own = {_C16: 0, _C26: 0}
    # turned() gives components in axes turned by psi, so the material turns by minus that.
    here = turned(MACRO.subs(own)).subs({COS: z1, SIN: -z2}, simultaneous=True)
    constants = dict(
        zip(MODULI, (here[0, 0], here[1, 1], here[0, 1], here[2, 2], here[0, 2], here[1, 2]),
            strict=True)
    )  # fmt: skip
    return tuple(_micro(law).subs(constants, simultaneous=True) for law in (axial_law, shear_law))


def _turned_names() -> dict[str, Any]:
    z1, z2 = sp.Rational(12, 13), sp.Rational(5, 13)
    known = names(
        cz=COS * z1 + SIN * z2,
        sz=SIN * z1 - COS * z2,
    )
    known.update({str(k): v.subs({_C16: 0, _C26: 0}) for k, v in micromoduli().items()})
    return known


def lattice_error() -> dict[str, float]:
    """Largest error of the uniaxial energy over the material's turns, Fig. 4's solid, by m."""
    tensor = np.array([[1, 0.2, 0.1], [0.2, 1, 0.2], [0.1, 0.2, 1 / 3]])
    values = dict(zip(MODULI, (1.0, 1.0, 0.2, 1 / 3, 0.1, 0.2), strict=True))
    values |= {THICKNESS: 1.0, HORIZON: 1.0}
    laws = [sp.lambdify((COS, SIN), _micro(law).subs(values)) for law in (axial_law, shear_law)]
    zeta = np.linspace(0, np.pi, 91)
    found = {}
    for m in (2, 3, 4, 5):
        xi, alpha = family(m)
        length = np.hypot(*xi.T)
        c, s = xi.T / length
        cz, sz = np.cos(zeta)[:, None], np.sin(zeta)[:, None]
        kn, kt = (law(c * cz + s * sz, s * cz - c * sz) for law in laws)
        energy = np.sum(alpha * length / 4 * (kn * c**4 + kt * (c * s) ** 2), axis=1) / m**3
        strain = np.concatenate([cz**2, sz**2, -2 * cz * sz], axis=1)
        exact = 0.5 * np.einsum("zi,ij,zj->z", strain, tensor, strain)
        found[f"m{m}"] = float(100 * np.max(np.abs(energy / exact - 1)))
    return found


_R = Verdict.RIGHT
_UNIT = "h*pi*delta**3/192"
_SCALE = "(pi*h*delta**3)"
_BAR = (
    "as extracted, without a fraction bar: the energy is (pi h delta^3)^2 times too small or large",
    "over pi h delta^3, as Eqs. 65-70 and 71-72 have it: right. Eqs. 73-76 all lose the same bar, "
    "so the text extraction is the likely cause",
)


def _macro(number: str, which: int, form: str) -> Entry:
    return Entry(number, f"macromodulus {MODULI[which]}", _R, (Form(f"{_UNIT}*{form}"),),
                 lambda: (macro_from_micro()[which],), _symbols,
                 "second derivative of the energy of a full horizon")  # fmt: skip


def _inverse(number: str, which: int, form: str) -> Entry:
    return Entry(number, f"micromodulus {MICRO[which]}", _R, (Form(f"{form}/{_SCALE}"),),
                 lambda: (micromoduli()[MICRO[which]],), _symbols,
                 "Eqs. 58-63 solved (for a full disc; the sum over a lattice differs)")  # fmt: skip


def _energy(number: str, title: str, form: str, truth: Any) -> Entry:
    right = form.replace("*pi*h*delta**3", "/(pi*h*delta**3)")
    return Entry(number, title, Verdict.LOST, (Form(form, right, ratio="(pi*h*delta**3)**2"),),
                 truth, _symbols, "|xi|/2 k (measure)^2 with the micromoduli of Eqs. 65-70", _BAR,
                 "off by (pi h delta^3)^2; the brackets are right")  # fmt: skip


ENTRIES = [
    _macro("58", 0, "(19*K11 + 3*K22 + 12*K66 + 2*K12)"),
    _macro("59", 1, "(3*K11 + 19*K22 + 12*K66 + 2*K12)"),
    _macro("60", 2, "(K11 + K22 + 4*K66 + 6*K12)"),
    _macro("61", 3, "(3*K11 + 3*K22 + 12*K66 + 2*K12)"),
    _macro("62", 4, "4*(3*K16 + K26)"),
    _macro("63", 5, "4*(K16 + 3*K26)"),
    Entry("64", "scale of the macromoduli", _R, (Form("h*pi*delta**3/192"),),
          lambda: (sp.diff(macro_from_micro()[2], MICRO[0]),), _symbols,
          "derivative of C1122 by K1111"),
    _inverse("65", 0, "12*(C11 - C66)"),
    _inverse("66", 1, "12*(C22 - C66)"),
    _inverse("67", 4, "6*(3*C16 - C26)"),
    _inverse("68", 5, "6*(3*C26 - C16)"),
    _inverse("69", 2, "12*(3*C12 - C66)"),
    _inverse("70", 3, "3*(8*C66 - C11 - C22 - 2*C12)"),
    Entry("71", "axial micromodulus of an isotropic solid", _R,
          (Form("K11"), Form("K22"), Form(f"12*(C11 - C66)/{_SCALE}")),
          lambda: (_isotropic_moduli()[0],) * 3, _special_names,
          "Eqs. 48 and 65-70 in an isotropic body: the angle drops out", harmless=("K22", "K11")),
    Entry("72", "shear micromodulus of an isotropic solid", _R,
          (Form("K66"), Form("(K11 - K12)/2"), Form(f"12*(3*C66 - C11)/{_SCALE}")),
          lambda: (_isotropic_moduli()[1],) * 3, _special_names,
          "Eqs. 49 and 65-70 in an isotropic body: the angle drops out"),
    Entry("Sect. 2.2.1 (after 72)", "when k_t is not negative", Verdict.WRONG,
          (Form("C11/3 - C66", "C66 - C11/3", ratio="-1"),),
          lambda: (_isotropic_moduli()[1] * sp.pi * THICKNESS * HORIZON**3 / 36,), _symbols,
          "the margin of the condition against k_t of Eq. 72",
          ("C1212 <= C1111/3, as printed: k_t is negative there",
           "C1212 >= C1111/3: right, and what the limits of Poisson's ratio that follow say"),
          "none in numbers: the limits nu <= 1/3 and 1/4 that follow are right"),
    Entry("Sect. 2.2.1 (Poisson's ratio)", "limits of Poisson's ratio for k_t >= 0", _R,
          (Form("1/3"), Form("1/4")), _poisson_limits, _symbols,
          "C1212 = C1111/3 in plane stress and plane strain"),
    Entry("Sect. 2.2.1 (central forces)", "where the model is Silling's", _R, (Form("3*C66"),),
          lambda: (sp.solve(_isotropic_moduli()[1], _C11)[0],), _symbols, "k_t = 0"),
    _energy("73", "axial energy of a pair", "6*st**2*xi*pi*h*delta**3*((C11 - C66)*c**4"
            " + (C22 - C66)*s**4 + (4*C12 + 6*C66 - C11 - C22)*s**2*c**2"
            " + 2*(3*C16 - C26)*c**3*s + 2*(3*C26 - C16)*c*s**3)",
            lambda: _pair_energies(_micro(axial_law), 0)[:1]),
    _energy("74", "shear energy of a pair", "3/2*g**2*xi*pi*h*delta**3*(4*(C11 + C22 - 6*C12)"
            "*s**2*c**2 + (8*C66 - C11 - C22 - 2*C12)*(c**2 - s**2)**2"
            " - 16*(C16 - C26)*(c**3*s - c*s**3))",
            lambda: _pair_energies(0, _micro(shear_law))[1:]),
    _energy("75", "axial energy of a pair, isotropic", "6*pi*h*delta**3*st**2*xi*(C11 - C66)",
            lambda: _pair_energies(*_isotropic_moduli())[:1]),
    _energy("76", "shear energy of a pair, isotropic", "6*pi*h*delta**3*g**2*xi*(3*C66 - C11)",
            lambda: _pair_energies(*_isotropic_moduli())[1:]),
    Entry("Sect. 2.2.1 (before 77)", "angle of the material axes", Verdict.WRONG,
          (Form("Arg(a1.dot(e1) + I*a2.dot(e2))", "Arg(a1.dot(e1) + I*a1.dot(e2))",
                off="quarter - zeta"),),
          lambda: (sp.Rational(1, 3),), _angle_names,
          "axes turned by a known angle",
          ("as printed: pi/4 for every turn below a right angle, both products being its cosine",
           "reference and material axes exchanged: the same", "a1.e2 in the second place: right"),
          "a program that follows it turns every material by 45 degrees"),
    Entry("77", "k_n of a turned orthotropic solid", _R,
          (Form("K11*cz**4 + K22*sz**4 + 2*K12*sz**2*cz**2 + 4*K66*sz**2*cz**2"),),
          lambda: _turned_laws()[:1], _turned_names,
          "the micromoduli of the turned tensor, at psi"),
    Entry("78", "k_t of a turned orthotropic solid", _R,
          (Form("K11*sz**2*cz**2 + K22*sz**2*cz**2 - 2*K12*sz**2*cz**2 + K66*(cz**2 - sz**2)**2"),),
          lambda: _turned_laws()[1:], _turned_names,
          "the micromoduli of the turned tensor, at psi"),
]  # fmt: skip
