"""Eqs. 136-167: Fourier's law, micro- and macroconductivities, cosine laws."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from references.errata.algebra import COS, HORIZON, SIN, THICKNESS, circle_integral, names
from references.errata.model import Entry, Form, Verdict

_Z1, _Z2 = sp.symbols("z1 z2", real=True)
_K1, _K2, _K12 = MICRO = sp.symbols("k11 k22 k12", real=True)
_M1, _M2, _M12 = MACRO = sp.symbols("K11 K22 K12", real=True)
_TENSOR = sp.Matrix([[_M1, _M12], [_M12, _M2]])
_GRADIENT = sp.Matrix([_Z1, _Z2])
_AXIS = sp.Matrix([COS, SIN])
_XI = sp.Symbol("xi", positive=True)
# An angle of the material with rational cosine and sine.
_CZ, _SZ = sp.Rational(12, 13), sp.Rational(5, 13)


def _potential() -> Any:
    return sp.expand((_GRADIENT.T * _TENSOR * _GRADIENT)[0] / 2)


def flux() -> sp.Matrix:
    """Minus the potential's gradient by the temperature gradient."""
    return sp.Matrix([-sp.diff(_potential(), z) for z in (_Z1, _Z2)])


def _turn() -> sp.Matrix:
    """Its transpose takes components to axes turned by psi."""
    return sp.Matrix([[COS, -SIN], [SIN, COS]])


def law(constants: tuple[Any, ...]) -> Any:
    """The off-axis conductivity n . D n with other constants (11, 22, 12): Eq. 142, corrected."""
    a, b, mixed = constants
    return sp.expand((_AXIS.T * sp.Matrix([[a, mixed], [mixed, b]]) * _AXIS)[0])


def horizon_potential(micro: Any) -> Any:
    """Half of the pair potentials k g^2/2 of a full horizon, over areas |xi| d|xi| dpsi."""
    g = (_AXIS.T * _GRADIENT)[0]
    radial = sp.integrate(_XI / 2, (_XI, 0, HORIZON))
    return sp.expand(THICKNESS / 2 * radial * circle_integral(micro * g**2))


@cache
def macro_from_micro() -> tuple[Any, Any, Any]:
    """K11, K22, K12 of a full horizon."""
    energy = horizon_potential(law(MICRO))
    return sp.diff(energy, _Z1, 2), sp.diff(energy, _Z2, 2), sp.diff(energy, _Z1, _Z2)


@cache
def micro_from_macro() -> dict[Any, Any]:
    """The linear system solved."""
    system = [a - b for a, b in zip(macro_from_micro(), MACRO, strict=True)]
    solution: dict[Any, Any] = sp.solve(system, MICRO, dict=True)[0]
    return solution


@cache
def cosine_constants(power: int) -> tuple[Any, Any]:
    """k11 and k22 of Eq. 163 for principal conductivities K11, K22."""
    energy = horizon_potential(_K2 + (_K1 - _K2) * COS**power)
    system = [sp.diff(energy, z, 2) - k for z, k in ((_Z1, _M1), (_Z2, _M2))]
    solution = sp.solve(system, [_K1, _K2], dict=True)[0]
    return sp.expand(solution[_K1]), sp.expand(solution[_K2])


def _names() -> dict[str, Any]:
    return names(
        "z1 z2 k11 k22 k12 K11 K22 K12 psi zeta n",
        D=_TENSOR, zeta_=_GRADIENT, Q=_turn(), q=flux(), g=(_AXIS.T * _GRADIENT)[0],
        psi=sp.Symbol("psi", real=True),
    )  # fmt: skip


#: Microconductivities and gradients of no symmetry, where integrals are wanted for many forms.
_BODY = dict(zip((*MICRO, _Z1, _Z2), map(sp.Rational, (7, 5, 3, 11, 13)), strict=True))


def _numbers() -> dict[str, Any]:
    return names(
        **{str(symbol): value for symbol, value in _BODY.items()},
        g=((_AXIS.T * _GRADIENT)[0]).subs(_BODY),
        law=law(MICRO).subs(_BODY),
        circle=cache(circle_integral),
        radial=lambda power: sp.integrate(_XI**power, (_XI, 0, HORIZON)),
    )


def _turned_names() -> dict[str, Any]:
    """Principal values K11, K22 of a tensor that stands at zeta; components of that tensor."""
    turn = sp.Matrix([[_CZ, -_SZ], [_SZ, _CZ]])
    here = turn * sp.diag(_M1, _M2) * turn.T
    own = {_M12: 0}
    return names(
        cz=COS * _CZ + SIN * _SZ, sz=SIN * _CZ - COS * _SZ, c0=_CZ, s0=_SZ,
        T11=here[0, 0], T22=here[1, 1], T12=here[0, 1],
        k11=micro_from_macro()[_K1].subs(own), k22=micro_from_macro()[_K2].subs(own),
    )  # fmt: skip


def _turned_law() -> tuple[Any]:
    """Eq. 142 (corrected) with the micromoduli of the tensor that stands at zeta."""
    known = _turned_names()
    there = dict(zip(MACRO, (known["T11"], known["T22"], known["T12"]), strict=True))
    return (law(tuple(micro_from_macro()[k].subs(there, simultaneous=True) for k in MICRO)),)


_CASES = np.array([[5.0, 1.0, 2.0], [1.0, 5.0, 2.0], [1.0, 5.0, -2.0], [3.0, 2.0, -1.0]])


def _angle_names() -> dict[str, Any]:
    k11, k22, k12 = _CASES.T
    return {"K11": k11, "K22": k22, "K12": k12, "atan": np.arctan, "atan2": np.arctan2,
            "pi": np.pi, "array": np.array}  # fmt: skip


def _major_axis() -> tuple[np.ndarray]:
    """Angle of the eigenvector of the larger conductivity, in (-pi/2, pi/2]."""
    angles = []
    for k11, k22, k12 in _CASES:
        axis = np.linalg.eigh(np.array([[k11, k12], [k12, k22]]))[1][:, 1]
        angles.append(np.arctan2(axis[1], axis[0]))
    wrapped = np.array(angles)
    return (wrapped - np.pi * np.round(wrapped / np.pi),)


def _minor_axis() -> dict[str, float]:
    """Eq. 163 with n = 2 ... at the minor axis: k22 for the tensor (1, 5, 2)."""
    values = {THICKNESS: 1.0, HORIZON: 1.0, _M1: 3 - np.sqrt(8), _M2: 3 + np.sqrt(8)}
    return {"k11": float(cosine_constants(34)[0].subs(values)), "ratio": 17 + 12 * np.sqrt(2)}


def _conducted() -> dict[str, float]:
    """What an isotropic body conducts with the printed n = 12 constants, times what it should."""
    one = {_M1: 1, _M2: 1}
    first, second = (99 * cosine_constants(12)[0], 3 * cosine_constants(12)[1])
    energy = horizon_potential(second.subs(one) + (first - second).subs(one) * COS**12)
    return {"along": float(sp.diff(energy, _Z1, 2)), "across": float(sp.diff(energy, _Z2, 2))}


_R, _D, _W = Verdict.RIGHT, Verdict.DEFINITION, Verdict.WRONG
_UNIT, _SCALE = "pi*h*delta**2/16", "(pi*h*delta**2)"


def _entry(number: str, title: str, form: str, truth: Any, how: str, verdict: Any = _R,
           known: Any = _names) -> Entry:  # fmt: skip
    return Entry(number, title, verdict, tuple(Form(t) for t in form.split(" = ")), truth, known,
                 how)  # fmt: skip


def _macro(number: str, which: int, form: str) -> Entry:
    return _entry(number, f"macroconductivity {MACRO[which]}", form,
                  lambda: (macro_from_micro()[which],),
                  "second derivative of the potential of a full horizon")  # fmt: skip


def _micro(number: str, which: int, form: str) -> Entry:
    return _entry(number, f"microconductivity {MICRO[which]}", f"{form}/{_SCALE}",
                  lambda: (micro_from_macro()[MICRO[which]],),
                  "Eqs. 149-151 solved (for a full disc; the sum over a lattice differs)",
                  )  # fmt: skip


def _principal(number: str, which: int, form: str) -> Entry:
    return _entry(number, "microconductivity in principal axes", f"{form}/{_SCALE}",
                  lambda: (micro_from_macro()[MICRO[which]].subs(_M12, 0),),
                  "potential of a horizon with principal conductivities")  # fmt: skip


def _cosine(number: str, power: int, which: int, form: str, factor: int = 1) -> Entry:
    title = f"cosine law, n = {power}, k{which + 1}{which + 1}"
    printed = f"({form})/(pi*h*delta**2)"
    if factor == 1:
        return _entry(number, title, printed, lambda: (cosine_constants(power)[which],),
                      "potential of a horizon, both constants solved for")  # fmt: skip
    return Entry(number, title, _W,
                 (Form(printed, f"({form})/({factor}*pi*h*delta**2)", ratio=str(factor)),),
                 lambda: (cosine_constants(power)[which],), _names,
                 "potential of a horizon, both constants solved for",
                 ("as printed: an isotropic body does not give Eq. 156",
                  f"{factor} in the denominator: right",
                  "another thickness, horizon or influence function: Eqs. 164-165 fix them"),
                 "an isotropic body conducts {along:.1f} times along the axis and {across:.1f} "
                 "times across it what it should", _conducted)  # fmt: skip


ENTRIES = [
    _entry("136", "Fourier's law", "-D*zeta_", lambda: (flux(),), "minus the potential's gradient"),
    _entry("137", "Fourier's law in components",
           "-Matrix([[K11, K12], [K12, K22]])*Matrix([z1, z2])", lambda: (flux(),),
           "minus the potential's gradient"),
    Entry("138", "Fourier's law in turned axes", _W,
          (Form("Q.T*D*Q*(Q.T*zeta_)", "-Q.T*D*Q*(Q.T*zeta_)", ratio="-1"),),
          lambda: (_turn().T * flux(),), _names, "the flux in turned axes",
          ("zeta as the field, minus the gradient: the line below says Q^T grad T",
           "D_T negative: Eq. 140 makes it D in turned axes", "with the minus of Eq. 137: right"),
          "none in what follows: the sign is not used again"),
    _entry("139", "turning matrix", "Matrix([[c, -s], [s, c]])",
           lambda: (sp.Matrix.hstack(_AXIS, sp.Matrix([-SIN, COS])),), "turned axes in columns"),
    _entry("140", "turned conductivity", "Q.T*D*Q",
           lambda: (sp.Matrix(2, 2, lambda i, j: (_turn()[:, i].T * _TENSOR * _turn()[:, j])[0]),),
           "components along the turned axes"),
    _entry("141", "off-axis conductivity", "K11*c**2 + K22*s**2 + 2*K12*s*c",
           lambda: (law(MACRO),), "n . D n"),
    Entry("142", "angular law of the microconductivity", _W,
          (Form("k11*c**2 + k11*s**2 + 2*k12*s*c", "k11*c**2 + k22*s**2 + 2*k12*s*c",
                off="(k11 - k22)*s**2"),), lambda: (law(MICRO),), _names,
          "the off-axis conductivity with microconductivities",
          ("k11 twice, as printed: bonds along axis 2 would not conduct with k22, which the "
           "sentence below says", "k22 in the second place, as Eq. 144 has it: right"),
          "as printed every body without k12 is isotropic; Eqs. 144-155 use the right law"),
    _entry("143", "gradient of a bond", "z1*c + z2*s",
           lambda: ((_turn().T * _GRADIENT)[0],), "component along the bond"),
    _entry("144", "thermal potential of a full horizon",
           "h/4*radial(1)*circle(law*g**2)"
           " = h/4*radial(1)*circle((z1*c + z2*s)**2*(k11*c**2 + k22*s**2 + 2*k12*s*c))",
           lambda: (horizon_potential(law(MICRO)).subs(_BODY),) * 2, "half of the pair potentials",
           known=_numbers),
    Entry("145", "thermal potential, integrated", _W,
          (Form("h*pi*delta**2/32*(z1**2*(3*k11 + k22) + 4*k12*z1*z2 + z2**2*(k11 + k22))",
                "h*pi*delta**2/32*(z1**2*(3*k11 + k22) + 4*k12*z1*z2 + z2**2*(k11 + 3*k22))",
                off="-h*pi*delta**2/16*k22*z2**2"),),
          lambda: (horizon_potential(law(MICRO)),), _names, "Eq. 144 integrated",
          ("as printed: not symmetric in the two axes", "3 k22, as Eq. 151 has it: right"),
          "an isotropic body would conduct half along axis 2; Eqs. 149-155 use the right form"),
    _entry("146", "scale of the horizon", "delta**2*(pi/32)",
           lambda: (_scale(),), "coefficient of z1^2 k11 over 3 h", _D),
    _entry("147", "its number", "pi/32", lambda: (_scale() / HORIZON**2,), "as Eq. 146, Lam = 1"),
    _entry("148", "potential of the continuum",
           "1/2*(zeta_.T*(D*zeta_))[0] = 1/2*(K11*z1**2 + 2*K12*z1*z2 + K22*z2**2)",
           lambda: (-(_GRADIENT.T * flux())[0] / 2,) * 2, "half of minus gradient times flux"),
    _macro("149", 0, f"{_UNIT}*(3*k11 + k22)"),
    _macro("150", 2, f"2*({_UNIT})*k12"),
    _macro("151", 1, f"{_UNIT}*(k11 + 3*k22)"),
    _entry("152", "scale of the macroconductivities", _UNIT,
           lambda: (sp.diff(macro_from_micro()[0], _K2),), "derivative of K11 by k22"),
    _micro("153", 0, "2*(3*K11 - K22)"),
    _micro("154", 1, "2*(3*K22 - K11)"),
    _micro("155", 2, "8*K12"),
    _entry("156", "microconductivity of an isotropic body", f"4*K11/{_SCALE}",
           lambda: (micro_from_macro()[_K1].subs(_M2, _M1),), "both principal values alike"),
    _entry("157", "law in principal axes", "k11*cz**2 + k22*sz**2", _turned_law,
           "the microconductivities of the turned tensor, at psi", known=_turned_names),
    _principal("158", 0, "2*(3*K11 - K22)"),
    _principal("159", 1, "2*(3*K22 - K11)"),
    _entry("160", "first principal conductivity", "T11*c0**2 + T22*s0**2 + 2*T12*s0*c0",
           lambda: (_M1,), "a tensor with known principal values and axes", known=_turned_names),
    _entry("161", "second principal conductivity", "T11*s0**2 + T22*c0**2 - 2*T12*s0*c0",
           lambda: (_M2,), "a tensor with known principal values and axes", known=_turned_names),
    Entry("162", "angle of the principal axes", Verdict.INCOMPLETE,
          (Form("1/2*atan(2*K12/(K11 - K22))", "1/2*atan2(2*K12, K11 - K22)",
                off="pi/2*array([0, -1, 1, 0])"),), _major_axis, _angle_names,
          "eigenvector of the larger conductivity, four tensors",
          ("any branch, for Eqs. 157-161: right, they hold for either axis",
           "the principal value, for Eq. 163, which wants the major axis: the minor one where "
           "K11 < K22", "the quadrant of (K11 - K22, 2 K12): right"),
          "for the conductivities (1, 5; 2), the disc's turned, Eq. 163 gets the ratio {ratio:.1f} "
          "upside down: k11 h delta^2 = {k11:.1f}", _minor_axis, exact=False),
    _entry("163", "cosine law", "k22 + (k11 - k22)*cos(psi - zeta)**n",
           lambda: (_between(),), "k11 along the axis, k22 across it", _D),
    _cosine("164", 4, 0, "7*K11 - 3*K22"),
    _cosine("165", 4, 1, "5*K22 - K11"),
    _cosine("166", 12, 0, "991*K11 - 595*K22", 99),
    _cosine("167", 12, 1, "13*K22 - K11", 3),
]  # fmt: skip


def _scale() -> Any:
    potential = sp.Poly(horizon_potential(law(MICRO)), _Z1, _K1)
    return potential.coeff_monomial(_Z1**2 * _K1) / 3 / THICKNESS


def _between() -> Any:
    psi, zeta, n = sp.symbols("psi zeta n", real=True)
    share = sp.cos(zeta - psi) ** n
    return share * _K1 + (1 - share) * _K2
