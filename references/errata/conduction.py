"""Eqs. 111-167: pair potentials of conduction and microconductivities."""

from __future__ import annotations

import math

import numpy as np
import sympy as sp

from references.errata.model import (
    COS,
    HORIZON,
    SIN,
    THICKNESS,
    Entry,
    circle_integral,
    differs,
    require,
    vanishes,
)

_T, _TP = sp.symbols("T T'")
_XI, _K = sp.symbols("xi k", positive=True)
_K1, _K2, _K12 = sp.symbols("k11 k22 k12", real=True)
_Z1, _Z2 = sp.symbols("zeta1 zeta2", real=True)
_SCALE = sp.pi * THICKNESS * HORIZON**2


def _pair_action() -> None:
    eta = sp.symbols("eta_T")
    energy = _K * (eta / _XI) ** 2 / 2
    vanishes(sp.diff(energy, eta) - _K * eta / _XI**2, "Eq. 113")
    # Balance, Eqs. 116-117: an unordered pair carries the whole w_T.
    pair = _K * ((_TP - _T) / _XI) ** 2 / 2
    vanishes(-sp.diff(pair, _T) - _K * (_TP - _T) / _XI**2, "heat that enters x")


def _electric_action() -> None:
    phi, phi_p = sp.symbols("phi phi'")
    field = -(phi_p - phi) / _XI
    entering = -sp.diff(_K * field**2 / 2, phi)  # what balances the source at x, Eq. 121
    vanishes(entering - _K * (phi_p - phi) / _XI**2, "Eq. 120, last member")
    vanishes(entering + _K * field / _XI, "Eq. 120, middle member with a minus sign")
    differs(entering - _K * field / _XI, "Eq. 120, middle member as printed")


def _assembled_conductance() -> None:
    row = sp.Matrix([[-1, 1]]) / _XI
    ordered = row.T * row * _K / 2
    assembled = ordered + ordered.extract([1, 0], [1, 0])
    energy = _K * ((_TP - _T) / _XI) ** 2 / 2
    vanishes(assembled - sp.hessian(energy, [_T, _TP]), "K_T of Eq. 132")


def _turned_conductivity() -> None:
    k11, k22, k12 = sp.symbols("K11 K22 K12", real=True)
    tensor = sp.Matrix([[k11, k12], [k12, k22]])
    turn = sp.Matrix([[COS, -SIN], [SIN, COS]])
    gradient = sp.Matrix([_Z1, _Z2])
    flux = -tensor * gradient
    turned = turn.T * tensor * turn
    norm = {COS: sp.cos(sp.Symbol("psi")), SIN: sp.sin(sp.Symbol("psi"))}
    residual = (turn.T * flux + turned * (turn.T * gradient)).subs(norm).applyfunc(sp.simplify)
    vanishes(residual, "flux in turned axes is minus D times the gradient")
    differs(turn.T * flux - turned * (turn.T * gradient), "Eq. 138 without the minus sign")


def law(a: sp.Expr, b: sp.Expr, mixed: sp.Expr | int = 0) -> sp.Expr:
    """Eq. 142, corrected."""
    return a * COS**2 + b * SIN**2 + 2 * mixed * SIN * COS


def _off_axis() -> None:
    k11, k22, k12 = sp.symbols("K11 K22 K12", real=True)
    axis = sp.Matrix([COS, SIN])
    off_axis = (axis.T * sp.Matrix([[k11, k12], [k12, k22]]) * axis)[0]
    vanishes(off_axis - law(k11, k22, k12), "Eq. 141")


def _printed_law() -> None:
    right = law(_K1, _K2, _K12)
    differs(right - law(_K1, _K1, _K12), "Eq. 142 with k11 twice")
    vanishes(right.subs({COS: 0, SIN: 1}) - _K2, "a bond along axis 2 conducts with k22")
    require(not law(_K1, _K1, _K12).subs({COS: 0, SIN: 1}).has(_K2), "k22 is absent as printed")


def horizon_energy(micro: sp.Expr) -> sp.Expr:
    """Eq. 144: 1/2 h int xi dxi int (k/2) g^2 dpsi."""
    g = _Z1 * COS + _Z2 * SIN
    radial = sp.integrate(_XI / 2, (_XI, 0, HORIZON))
    return sp.expand(THICKNESS / 2 * radial * circle_integral(micro * g**2))


def _horizon_energy() -> None:
    factor = THICKNESS * HORIZON**2 * sp.pi / 32
    first = _Z1**2 * (3 * _K1 + _K2) + 4 * _K12 * _Z1 * _Z2
    energy = horizon_energy(law(_K1, _K2, _K12))
    vanishes(energy - factor * (first + _Z2**2 * (_K1 + 3 * _K2)), "Eq. 145 with 3 k22")
    differs(energy - factor * (first + _Z2**2 * (_K1 + _K2)), "Eq. 145 as printed")


def _macro_energy(tensor: tuple[sp.Expr, sp.Expr, sp.Expr]) -> sp.Expr:
    k11, k22, k12 = tensor
    return (k11 * _Z1**2 + 2 * k12 * _Z1 * _Z2 + k22 * _Z2**2) / 2


def _micro_macro() -> None:
    k11, k22, k12 = sp.symbols("K11 K22 K12", real=True)
    unit = sp.pi * THICKNESS * HORIZON**2 / 16
    macro = (unit * (3 * _K1 + _K2), unit * (_K1 + 3 * _K2), 2 * unit * _K12)
    vanishes(horizon_energy(law(_K1, _K2, _K12)) - _macro_energy(macro), "Eqs. 149-152")
    micro = {
        _K1: 2 * (3 * k11 - k22) / _SCALE,
        _K2: 2 * (3 * k22 - k11) / _SCALE,
        _K12: 8 * k12 / _SCALE,
    }
    energy = horizon_energy(law(_K1, _K2, _K12)).subs(micro)
    vanishes(energy - _macro_energy((k11, k22, k12)), "Eqs. 153-155")
    isotropic = micro[_K1].subs(k22, k11)
    vanishes(isotropic - 4 * k11 / _SCALE, "Eq. 156")


def _principal_angle() -> None:
    def principal(tensor: tuple[float, float, float], zeta: float) -> tuple[float, float]:
        k11, k22, k12 = tensor
        c, s = math.cos(zeta), math.sin(zeta)
        return (
            k11 * c * c + k22 * s * s + 2 * k12 * s * c,
            k11 * s * s + k22 * c * c - 2 * k12 * s * c,
        )

    for tensor in ((5.0, 1.0, 2.0), (1.0, 5.0, 2.0), (1.0, 5.0, -2.0), (3.0, 2.0, -1.0)):
        k11, k22, k12 = tensor
        small, large = np.linalg.eigvalsh(np.array([[k11, k12], [k12, k22]]))
        first, second = principal(tensor, 0.5 * math.atan2(2 * k12, k11 - k22))
        require(abs(first - large) + abs(second - small) < 1e-12, "atan2 gives the major axis")
        first, _ = principal(tensor, 0.5 * math.atan(2 * k12 / (k11 - k22)))
        expected = large if k11 > k22 else small
        require(abs(first - expected) < 1e-12, "tan^-1 gives the minor axis where K11 < K22")


def _principal_axes_law() -> None:
    k11, k22, zeta, psi = sp.symbols("K11 K22 zeta psi", real=True)  # principal values, angle
    c, s = sp.cos(zeta), sp.sin(zeta)
    general = law(
        2 * (3 * (k11 * c**2 + k22 * s**2) - (k11 * s**2 + k22 * c**2)),
        2 * (3 * (k11 * s**2 + k22 * c**2) - (k11 * c**2 + k22 * s**2)),
        8 * (k11 - k22) * s * c,
    ).subs({COS: sp.cos(psi), SIN: sp.sin(psi)})
    a, b = 2 * (3 * k11 - k22), 2 * (3 * k22 - k11)
    own = a * sp.cos(psi - zeta) ** 2 + b * sp.sin(psi - zeta) ** 2
    vanishes(sp.expand(sp.expand_trig(general - own)).rewrite(sp.exp), "Eq. 157 against Eq. 142")


def cosine_constants(power: int) -> tuple[sp.Expr, sp.Expr]:
    """k11 and k22 of Eq. 163 for an even exponent, times pi h delta^2, by K11 and K22.

    k22 = 4 [(n+1) K22 - K11]/n and k11 = k22 + 8 pi (n+2)/(2 n W_n) (K11 - K22) with
    W_n = 2 pi (n-1)!!/n!!.
    """
    k11, k22 = sp.symbols("K11 K22", real=True)
    n = sp.Integer(power)
    mean = 2 * sp.pi * sp.factorial2(n - 1) / sp.factorial2(n)
    second = 4 * ((n + 1) * k22 - k11) / n
    first = second + 4 * sp.pi * (n + 2) / (n * mean) * (k11 - k22)
    return sp.expand(first), sp.expand(second)


def _cosine_law() -> None:
    k11, k22 = sp.symbols("K11 K22", real=True)
    for power in (2, 4, 12, 34):
        first, second = cosine_constants(power)
        cosine = second / _SCALE + (first - second) / _SCALE * COS**power
        macro = _macro_energy((k11, k22, sp.Integer(0)))
        vanishes(horizon_energy(cosine) - macro, f"closed constants, n = {power}")
        vanishes(second.subs(k11, (power + 1) * k22), "k22 = 0 at the ratio n + 1")


def _cosine_four() -> None:
    k11, k22 = sp.symbols("K11 K22", real=True)
    first, second = cosine_constants(4)
    vanishes(first - (7 * k11 - 3 * k22), "Eq. 164")
    vanishes(second - (5 * k22 - k11), "Eq. 165")


def _cosine_twelve() -> None:
    k11, k22 = sp.symbols("K11 K22", real=True)
    first, second = cosine_constants(12)
    vanishes(first - (991 * k11 - 595 * k22) / 99, "Eq. 166 over 99")
    vanishes(second - (13 * k22 - k11) / 3, "Eq. 167 over 3")
    isotropic = (991 * k11 - 595 * k22).subs(k22, k11)
    differs(isotropic - 4 * k11, "Eq. 166 as printed misses Eq. 156 in an isotropic body")
    differs((13 * k22 - k11).subs(k22, k11) - 4 * k11, "Eq. 167 as printed misses Eq. 156")


ENTRIES = [
    Entry(
        "111-117",
        "pair potential and balance of heat",
        "f_T = k (T' - T)/|xi|^2, int f_T dx' + omega = rho c dT/dt",
        "as printed; an unordered pair carries k g^2/2, without |xi|",
        "confirmed",
        "minus the derivative of the pair potential by T",
        _pair_action,
    ),
    Entry(
        "120",
        "electric pair action",
        "f_J = k_e e/|xi| = k_e (phi' - phi)/|xi|^2",
        "f_J = -k_e e/|xi| = k_e (phi' - phi)/|xi|^2 with e = -(phi' - phi)/|xi| of Eq. 118",
        "wrong",
        "with the middle member sources drain current",
        _electric_action,
    ),
    Entry(
        "128-132",
        "assembled conductance",
        "K_T = sum over ordered pairs of 1/2 [l^T D_T l alpha dv dv]",
        "as printed: no |xi|, unlike Eq. 37",
        "confirmed",
        "both orders of a pair together are the Hessian of k g^2/2",
        _assembled_conductance,
    ),
    Entry(
        "138",
        "Fourier's law in turned axes",
        "q' = D' zeta'",
        "q' = -D' zeta'",
        "wrong",
        "Eqs. 136 and 140 fix the sign",
        _turned_conductivity,
    ),
    Entry(
        "141",
        "off-axis conductivity",
        "K11 cos^2 + K22 sin^2 + 2 K12 sin cos",
        "as printed",
        "confirmed",
        "n . D n",
        _off_axis,
    ),
    Entry(
        "142",
        "angular law of the microconductivity",
        "k = k11 cos^2 + k11 sin^2 + 2 k12 sin cos",
        "k = k11 cos^2 + k22 sin^2 + 2 k12 sin cos",
        "wrong",
        "as printed every body without k12 is isotropic",
        _printed_law,
    ),
    Entry(
        "145",
        "thermal potential of the full horizon",
        "... + zeta_2^2 (k11 + k22)",
        "... + zeta_2^2 (k11 + 3 k22); Xi_T = pi/32 (Eq. 147) as printed",
        "wrong",
        "an isotropic body would conduct half along axis 2; Eqs. 149-151 use the right form",
        _horizon_energy,
    ),
    Entry(
        "149-156",
        "micro- and macroconductivities",
        "K12 = 2 C_T k12, k11 = 2 (3 K11 - K22)/(pi h delta^2), k12 = 8 K12/(pi h delta^2)",
        "as printed",
        "confirmed",
        "put into the potential of the horizon they return the tensor",
        _micro_macro,
    ),
    Entry(
        "157-161",
        "microconductivity in principal axes",
        "k = k11 cos^2(psi - zeta) + k22 sin^2(psi - zeta)",
        "as printed",
        "confirmed",
        "the same function of the angle as the corrected Eq. 142 with Eqs. 153-155",
        _principal_axes_law,
    ),
    Entry(
        "162",
        "angle of the principal axes",
        "zeta = 1/2 tan^-1[2 K12/(K11 - K22)]",
        "zeta = 1/2 atan2(2 K12, K11 - K22)",
        "wrong",
        "where K11 < K22 the printed angle is the minor axis, so Eq. 163 gets the ratio upside "
        "down and a negative k11; K11 = K22 divides by zero",
        _principal_angle,
    ),
    Entry(
        "163",
        "cos^n law of the microconductivity",
        "non-negative for K11/K22 <= n + 1",
        "as printed; k22 = 4 [(n+1) K22 - K11]/(n pi h delta^2), "
        "k11 = k22 + 4 (n+2) (K11 - K22)/(n W_n h delta^2), W_n = 2 pi (n-1)!!/n!!",
        "confirmed",
        "closed constants for every even n, checked for n = 2, 4, 12, 34",
        _cosine_law,
    ),
    Entry(
        "164-165",
        "cos^4 law",
        "k11 = (7 K11 - 3 K22)/(pi h delta^2), k22 = (5 K22 - K11)/(pi h delta^2)",
        "as printed",
        "confirmed",
        "from the closed constants",
        _cosine_four,
    ),
    Entry(
        "166-167",
        "cos^12 law",
        "k11 = (991 K11 - 595 K22)/(pi h delta^2), k22 = (13 K22 - K11)/(pi h delta^2)",
        "k11 = (991 K11 - 595 K22)/(99 pi h delta^2), k22 = (13 K22 - K11)/(3 pi h delta^2)",
        "wrong",
        "an isotropic body would conduct 99 and 3 times too much",
        _cosine_twelve,
    ),
]
