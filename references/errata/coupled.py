"""Eqs. 173-181: conduction of a damaged body, thermal expansion, bending micromoduli."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from references.errata import cloud, heat_cloud, pairs, tensors
from references.errata.algebra import COS, HORIZON, SIN, THICKNESS, circle_integral, names
from references.errata.expression import evaluate
from references.errata.model import Entry, Form, Verdict

_KN, _KT, _LAM, _RISE = sp.symbols("kn kt Lam T", real=True)
_A = sp.symbols("A11 A22 A12", real=True)
_CHI = sp.symbols("x1 x2", real=True)
_MICRO, _BEND = sp.symbols("k31 k32", real=True), sp.symbols("E31 E32", real=True)
_XI = sp.Symbol("xi", positive=True)


def _conductivity_names() -> dict[str, Any]:
    return names("rl rr")


def _inverse_resistivity() -> tuple[sp.Matrix]:
    rl, rr = sp.symbols("rl rr", real=True)
    return (sp.diag(rl, rr).inv(),)


# A pair with both physics ------------------------------------------------------------------------
_PLACES = ([0, 1, 2, 4, 5, 6], [3, 7])


def _placed(matrix: np.ndarray) -> np.ndarray:
    """A pair's matrix at its unknowns among u1, u2, theta, phi of both points."""
    places = _PLACES[0] if len(matrix) == 6 else _PLACES[1]
    total = np.zeros((8, 8))
    total[np.ix_(places, places)] = matrix
    return total


def _pair_matrices() -> tuple[np.ndarray, np.ndarray]:
    own, other = cloud.pair_matrices(0, 1), heat_cloud.pair_matrices(0, 1)
    text = "xi/2*(R.T @ B.T @ D @ B @ R*alpha*dvq*dvp)"
    return (
        evaluate(text, own, exact=False),
        evaluate("1/2*(l.T @ l*D*alpha*dvq*dvp)", other, exact=False),
    )


def _coupled_names() -> dict[str, Any]:
    mechanical, electrical = _pair_matrices()
    return {
        "Lm": _placed,
        "Le": _placed,
        "Kpq": mechanical,
        "Ke": electrical,
        "both": lambda f: np.stack([f(0), f(1)]),
    }


def _coupled() -> tuple[np.ndarray]:
    """Second derivative of the pair's energies by all eight unknowns, broken and whole."""
    mechanical, electrical = _pair_matrices()
    whole = np.zeros((8, 8))
    for i in range(8):
        for j in range(8):
            for matrix, places in zip((mechanical, electrical), _PLACES, strict=True):
                if i in places and j in places:
                    whole[i, j] += matrix[places.index(i), places.index(j)]
    return (np.stack([np.zeros((8, 8)), whole]),)


def _matrix_names() -> dict[str, Any]:
    return {
        "over_pairs": cloud.assembled,
        "over_electric_pairs": heat_cloud.assembled,
    }


# Thermal expansion -------------------------------------------------------------------------------
def _thermal_actions() -> tuple[Any, Any]:
    """Actions of the strain less that of free expansion, both as Cauchy-Born strains of a bond."""
    stretch, shear = tensors.bond_strains()
    strains = (tensors.E11, tensors.E22, tensors.E12)
    mechanical = {e: e - a * _RISE for e, a in zip(strains, _A, strict=True)}
    return (
        _LAM * _KN * stretch.subs(mechanical, simultaneous=True),
        _LAM * _KT * shear.subs(mechanical, simultaneous=True),
    )


def _thermal_names() -> dict[str, Any]:
    stretch, shear = tensors.bond_strains()
    expansion = sp.Matrix([[_A[0], _A[2]], [_A[2], _A[1]]])
    n, t = sp.Matrix([COS, SIN]), sp.Matrix([-SIN, COS])
    return names(
        "kn kt Lam T", st=stretch, g=shear, aT=(n.T * expansion * n)[0],
        nAt=(n.T * expansion * t)[0],
    )  # fmt: skip


@cache
def _left_behind() -> dict[str, float]:
    """Largest shear of a freely expanding bond over its mean strain, expansions 1 and 2."""
    values = {_A[0]: 1.0, _A[1]: 2.0, _A[2]: 0.0}
    shear = _thermal_names()["nAt"].subs(values)
    psi = np.linspace(0, np.pi, 361)
    found = sp.lambdify((COS, SIN), shear)(np.cos(psi), np.sin(psi))
    return {"share": 100 * float(np.max(np.abs(found))) / 1.5}


# Polar solids ------------------------------------------------------------------------------------
@cache
def _bending() -> tuple[Any, Any]:
    """Micromoduli for which the curvature energy of a horizon is half of chi E chi."""
    law = _MICRO[0] * COS**2 + _MICRO[1] * SIN**2
    curvature = _CHI[0] * COS + _CHI[1] * SIN
    radial = sp.integrate(_XI * _XI / 2, (_XI, 0, HORIZON))
    energy = THICKNESS / 2 * radial * circle_integral(sp.expand(law * curvature**2))
    system = [sp.diff(energy, x, 2) - e for x, e in zip(_CHI, _BEND, strict=True)]
    found = sp.solve(system, _MICRO, dict=True)[0]
    return found[_MICRO[0]], found[_MICRO[1]]


def _couple_stress() -> tuple[sp.Matrix]:
    energy = sum(e * x**2 for e, x in zip(_BEND, _CHI, strict=True)) / 2
    return (sp.Matrix([sp.diff(energy, x) for x in _CHI]),)


def _bending_names() -> dict[str, Any]:
    return names("k31 k32 E31 E32 psi n", E=sp.diag(*_BEND), x=sp.Matrix(_CHI))


def _bending_law() -> tuple[Any]:
    psi, n = sp.symbols("psi n", real=True)
    share = sp.cos(psi) ** n
    return (share * _MICRO[0] + (1 - share) * _MICRO[1],)


def _dilation() -> tuple[Any]:
    """What couples a dilation to the points' rotation: second derivative of the pair energy."""
    e, t, k = sp.symbols("e t kt", real=True)
    own, other = sp.Matrix([0, 0]), e * _XI * sp.Matrix([COS, SIN])
    u1, u2, _, u1q, u2q, _ = pairs.MOTIONS
    motion = {u1: own[0], u2: own[1], u1q: other[0], u2q: other[1], pairs.MOTIONS[2]: t,
              pairs.MOTIONS[5]: t, pairs.XI: _XI}  # fmt: skip
    shear = pairs.measures()[1].subs(motion, simultaneous=True)
    energy = sp.expand(k / 2 * shear**2)
    return (sp.simplify(sp.diff(energy, e, t)),)


@cache
def _coupling_number() -> dict[str, float]:
    """N^2 = (C66 - C12)/(2 C66 - C12) of an isotropic solid in plane stress: nu = -1, 0.2."""
    nu = sp.Symbol("nu")
    c66, c12 = 1 / (2 * (1 + nu)), nu / (1 - nu**2)
    number = sp.simplify((c66 - c12) / (2 * c66 - c12))
    return {"most": float(sp.limit(number, nu, -1)), "usual": float(number.subs(nu, 0.2))}


@cache
def _longer() -> dict[str, float]:
    """What the actual length takes off a bond's gauge: slope of Eq. 119's 1/length^2 at s = 0."""
    s = sp.Symbol("s")
    along = circle_integral(COS**4) / circle_integral(COS**2)
    return {"off": -float(sp.diff((1 + s) ** -2, s).subs(s, 0)), "share": 100 * float(along)}


_R, _D, _I = Verdict.RIGHT, Verdict.DEFINITION, Verdict.INCOMPLETE

ENTRIES = [
    Entry("173", "electric conductivity of bone", _D, (Form("Matrix([[1/rl, 0], [0, 1/rr]])"),),
          _inverse_resistivity, _conductivity_names, "inverse of the resistivity tensor"),
    Entry("174", "coupled stiffness of a pair", _D,
          (Form("both(lambda mu: mu*(Lm(Kpq) + Le(Ke)))"),), _coupled, _coupled_names,
          "second derivative of a pair's energies, broken (mu = 0) and whole",
          ("L as what places a pair's matrix among its eight unknowns: right; as a factor on one "
           "side, like the L of Eq. 37, it could not give a square matrix",), exact=False),
    Entry("175", "stiffness and conductance of a pair", Verdict.UNSAID,
          (Form("over_pairs(lambda R, B, D, xi, alpha, dvp, dvq: "
                "xi/2*(R.T @ B.T @ D @ B @ R*alpha*dvq*dvp))"),
           Form("over_electric_pairs(lambda l, D, alpha, dvp, dvq: "
                "1/2*(l.T @ l*D*alpha*dvq*dvp))")),
          lambda: (cloud.energy_hessian(), heat_cloud.conductance()), _matrix_names,
          "second derivatives of a random cloud's energies: Eqs. 37 and 132 without their L",
          ("D_T in K^e as the thermal conductance: not meant",
           "D_T as Lam k_e of Eq. 119: right"), exact=False),
    Entry("176", "thermal expansion of a bond", _I,
          (Form("Lam*kn*(st - aT*T)"),
           Form("Lam*kt*g", "Lam*kt*(g - nAt*T)", off="Lam*kt*nAt*T")),
          _thermal_actions, _thermal_names, "the strain less that of free expansion, in a bond",
          ("alpha_T as n.A.n, with f_t of Eq. 9 left as it is: f_n right, but a freely expanding "
           "anisotropic body is not free of stress",
           "isotropic expansion: n.A.t vanishes, right as printed"),
          "expansions of 1 and 2 along the axes leave bonds with a shear of {share:.0f} % of the "
          "mean expansion", _left_behind),
    Entry("177", "couple of a polar solid", _R, (Form("Lam*kb*chi"), Form("Lam*kb*(tq - t)/xi")),
          lambda: (pairs.actions()[2],) * 2, pairs.bond_names, "as Eq. 10"),
    Entry("178", "couple stress", _D, (Form("E*x"),), _couple_stress, _bending_names,
          "derivative of half of chi E chi"),
    Entry("179", "angular law of k_b", _D, (Form("k32 + (k31 - k32)*cos(psi)**n"),),
          _bending_law, _bending_names, "k31 along axis 1, k32 across it"),
    Entry("180", "bending micromodulus, axis 1", _R, (Form("3*(3*E31 - E32)/(pi*h*delta**3)"),),
          lambda: _bending()[:1], _bending_names, "curvature energy of a horizon, n = 2"),
    Entry("181", "bending micromodulus, axis 2", _R, (Form("3*(3*E32 - E31)/(pi*h*delta**3)"),),
          lambda: _bending()[1:], _bending_names, "curvature energy of a horizon, n = 2"),
    Entry("Sect. 5 (piezoresistivity)", "k_e as a function of a deformation measure", Verdict.OPEN,
          (), tuple,
          needs="the measure and the law: conductivity or resistivity linear in the stretch, over "
          "which length",
          effect="a gauge a of the bonds shows as {share:.0f} % of it along a uniaxial strain; the "
          "actual length in Eqs. 118 and 119 takes {off:.0f} off a", measure=_longer),
    Entry("Sect. 5 (chirality)", "k_n, k_t, k_b are said to include chiral effects", _I,
          (Form("knt", "0", off="knt"),), _dilation, lambda: names("knt"),
          "what couples a dilation to the points' rotation, in any bond",
          ("through k_b or the angles of k_n, k_t: the coupling vanishes bond by bond",
           "with a cross term k_nt s gamma, which Eq. 4 does not have: possible"),
          "a chiral lattice turns under pressure, this model does not",
          harmless=("-(0)", "2*(0)")),
    Entry("Sect. 5 (couple stress)", "couple-stress elasticity as a case of the model", _I,
          (Form("2/3"),), lambda: (sp.nsimplify(_coupling_number()["most"]),), names,
          "largest coupling number N^2 = (C66 - C12)/(2 C66 - C12), isotropic solids in plane "
          "stress; Sum k_t fixes the Cosserat modulus at C66 - C12",
          ("a Cosserat solid with Eq. 178: right",
           "couple stress proper, where rotations follow displacements: N = 1, out of reach"),
          "N^2 is {usual:.3f} at nu = 0.2 and never above {most:.3f}", _coupling_number),
]  # fmt: skip
