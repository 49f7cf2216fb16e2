"""Eqs. 1-22: measures of a bond, pair energy and actions, balance of momentum."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from references.errata.algebra import COS, SIN, names
from references.errata.model import Entry, Form, Verdict

MOTIONS = sp.symbols("u1 u2 t u1q u2q tq", real=True)
XI, KN, KT, KB, LAM = sp.symbols("xi kn kt kb Lam", real=True)
RHO, _DX = sp.symbols("rho dx", real=True)
_EN, _ET, _TURN = sp.symbols("en et turn", real=True)
_ST, _G, _CHI = sp.symbols("st g chi", real=True)


@cache
def measures() -> tuple[Any, Any, Any]:
    """Stretch, shear and curvature of a bond by what the words of Sect. 2 say they are.

    The relative elongation, the linearised turn of the bond less the mean rotation of the points
    (rotations interpolated along the bond), and the mean gradient of the rotation along it.
    """
    u1, u2, t, u1q, u2q, tq = MOTIONS
    e, a, bubble = sp.symbols("e a bubble", real=True)
    x, y = XI * COS + e * (u1q - u1), XI * SIN + e * (u2q - u2)
    stretch = sp.diff(x**2 + y**2, e).subs(e, 0) / (2 * XI**2)
    turn = (x * sp.diff(y, e) - y * sp.diff(x, e)).subs(e, 0) / XI**2
    mean = sp.integrate(t * (1 - a) + tq * a, (a, 0, 1))
    field = t * (1 - a) + tq * a + bubble * a * (1 - a)
    curvature = sp.integrate(sp.diff(field, a), (a, 0, 1)) / XI
    return stretch, sp.expand(turn - mean), sp.expand(curvature)


def pair_energy() -> Any:
    """Work done on a bond that is loaded in proportion by actions Lam k (measure)."""
    load = sp.Symbol("load")
    work: Any = 0
    for k, measure in zip((KN, KT, KB), measures(), strict=True):
        work += sp.integrate(LAM * k * measure * load, (load, 0, 1)) * measure * XI
    return work


@cache
def balance() -> tuple[Any, ...]:
    """Force (2) and moment that a bond brings to its first point: minus the energy's gradient."""
    return tuple(sp.expand(-sp.diff(pair_energy(), u)) for u in MOTIONS[:3])


def kinetic_density() -> Any:
    """Of a square cell of side dx that moves and turns."""
    x, y, rate, speed = sp.symbols("x y td ud", real=True)
    cell = (x, -_DX / 2, _DX / 2), (y, -_DX / 2, _DX / 2)
    square = (speed - rate * y) ** 2 + (rate * x) ** 2
    return sp.expand(sp.integrate(RHO * square / 2, *cell) / _DX**2)


def bond_names() -> dict[str, Any]:
    u1, u2, _, u1q, u2q, _ = MOTIONS
    stretch, shear, curvature = measures()
    return names(
        "u1 u2 t u1q u2q tq xi kn kt kb Lam rho dx en et turn b1 b2 c0 a1 a2 at ud td du1 du2 dt",
        st=stretch,
        g=shear,
        chi=curvature,
        eta_n=(u1q - u1) * COS + (u2q - u2) * SIN,
        eta_t=-(u1q - u1) * SIN + (u2q - u2) * COS,
        ws=LAM * KN * XI / 2 * stretch**2,
        wg=LAM * KT * XI / 2 * shear**2,
        wx=LAM * KB * XI / 2 * curvature**2,
        f1=balance()[0],
        varrho=RHO * _DX**2 / 6,
    )


def _loose_names() -> dict[str, Any]:
    """The measures as independent variables, for derivatives by them."""
    mean = sp.Symbol("mean", real=True)
    half = LAM * XI / 2
    return names(
        "xi kn kt kb Lam st g chi en et turn mean t tq",
        w_st=half * KN * _ST**2,
        w_en=half * KN * (_EN / XI) ** 2,
        w_g=half * KT * _G**2,
        w_et=half * KT * (_ET / XI - mean) ** 2,
        w_chi=half * KB * _CHI**2,
        w_turn=half * KB * (_TURN / XI) ** 2,
        w_t=half * KB * ((sp.Symbol("tq", real=True) - sp.Symbol("t", real=True)) / XI) ** 2,
    )


@cache
def actions() -> tuple[Any, Any, Any]:
    """f_n, f_t, m_b: what a bond brings to its first point along n, t and as a pure couple."""
    force1, force2, moment = balance()
    normal = force1 * COS + force2 * SIN
    tangent = -force1 * SIN + force2 * COS
    return normal, tangent, moment - tangent * XI / 2


def _conjugates() -> dict[int, tuple[Any, ...]]:
    mean = sp.Symbol("mean", real=True)
    return {
        5: (LAM * KN * _ST, LAM * KN * _EN / XI),
        6: (LAM * KT * _G, LAM * KT * (_ET / XI - mean)),
        7: (LAM * KB * _CHI, LAM * KB * _TURN / XI),
    }


def _variations() -> tuple[Any, Any, Any]:
    du1, du2, dt, a1, a2, at = sp.symbols("du1 du2 dt a1 a2 at", real=True)
    b1, b2, c0, ud, td = sp.symbols("b1 b2 c0 ud td", real=True)
    kinetic = kinetic_density()
    inertia = [sp.diff(kinetic, ud, 2), sp.diff(kinetic, td, 2)]
    bond = sum(f * d for f, d in zip(balance(), (du1, du2, dt), strict=True))
    return (
        b1 * du1 + b2 * du2 + c0 * dt,
        bond,
        -(inertia[0] * (a1 * du1 + a2 * du2) + inertia[1] * at * dt),
    )


def _newton() -> tuple[Any, Any]:
    b1, c0, a1, at = sp.symbols("b1 c0 a1 at", real=True)
    ud, td = sp.symbols("ud td", real=True)
    kinetic = kinetic_density()
    return (
        balance()[0] + b1 - sp.diff(kinetic, ud, 2) * a1,
        balance()[2] + c0 - sp.diff(kinetic, td, 2) * at,
    )


def _lagrange_names() -> dict[str, Any]:
    u, v, a, k = sp.symbols("u v a k", real=True)
    b = sp.Symbol("b1", real=True)

    def stationary(density: Any) -> Any:
        """Euler and Lagrange's expression for constant coefficients."""
        return sp.diff(density, u) - sp.diff(density, v, 2) * a

    return names(
        "b1 k",
        D=RHO * v**2 / 2,
        V=-b * u,
        W=k * u**2 / 2,
        stationary=stationary,
    )


def _lagrange() -> tuple[Any]:
    u, a, k, b = sp.symbols("u a k b1", real=True)
    return (b - k * u - RHO * a,)


def energy_cloud() -> dict[str, Any]:
    rng = np.random.default_rng(11)
    energies, volumes = rng.uniform(1, 2, (6, 6)), rng.uniform(1, 2, 6)
    energies = energies + energies.T
    np.fill_diagonal(energies, 0.0)
    return {"w": energies, "vol": volumes, "W": _shares(energies, volumes)}


def _shares(energies: np.ndarray, volumes: np.ndarray) -> np.ndarray:
    """Each pair's energy, given in halves to its ends, per volume of the end."""
    share = np.zeros(len(volumes))
    for p in range(len(volumes)):
        for q in range(p):
            energy = energies[p, q] * volumes[p] * volumes[q]
            share[p] += energy / 2 / volumes[p]
            share[q] += energy / 2 / volumes[q]
    return share


def cloud_density() -> tuple[np.ndarray]:
    cloud = energy_cloud()
    return (_shares(cloud["w"], cloud["vol"]),)


def _total() -> tuple[float]:
    cloud = energy_cloud()
    pairs = [(p, q) for p in range(6) for q in range(p)]
    return (sum(cloud["w"][p, q] * cloud["vol"][p] * cloud["vol"][q] for p, q in pairs),)


RHO_READINGS = (
    "rho for the inertia too, as printed: it has the dimension of a density of mass, and natural "
    "frequencies of a polar solid would change with the unit of length",
    "varrho, the density of mass moment of inertia that Sect. 2 defines and uses nowhere else: "
    "right. The letters differ by a stroke, so the text extraction is the likely cause",
)
_BAR_READ = (
    "the w of Eq. 4, as extracted: dw/ds has a length too much",
    "the energy per unit distance that the sentence after Eq. 7 defines with the same letter, so "
    "that an accent is missing: right",
)
_R, _D, _L = Verdict.RIGHT, Verdict.DEFINITION, Verdict.LOST


def _plain(number: str, title: str, form: str, truth: Any, how: str, verdict: Any = _R) -> Entry:
    forms = tuple(Form(text) for text in form.split(" = "))
    return Entry(number, title, verdict, forms, truth, bond_names, how)


ENTRIES = [
    _plain("1", "stretch of a bond", "((u1q - u1)*c + (u2q - u2)*s)/xi = eta_n/xi",
           lambda: (measures()[0],) * 2, "linearised relative elongation of the bond"),
    _plain("2", "shear of a bond",
           "(-(u1q - u1)*s + (u2q - u2)*c)/xi - (tq + t)/2 = eta_t/xi - (t + tq)/2",
           lambda: (measures()[1],) * 2, "linearised turn of the bond less the points' mean one"),
    _plain("3", "curvature of a bond", "(tq - t)/xi", lambda: (measures()[2],),
           "mean gradient of any rotation field along the bond"),
    _plain("4", "pair energy", "ws + wg + wx = xi/2*(kn*st**2 + kt*g**2 + kb*chi**2)*Lam",
           lambda: (pair_energy(),) * 2, "work done by the actions of Eqs. 8-10", _D),
    Entry("5", "normal action as a derivative", _L,
          (Form("diff(w_st, st)", "diff(w_st/xi, st)", ratio="xi"), Form("diff(w_en, en)")),
          lambda: _conjugates()[5], _loose_names, "the action conjugate to the elongation",
          _BAR_READ, "the middle member is |xi| times the action if read with Eq. 4"),
    Entry("6", "tangential action as a derivative", _L,
          (Form("diff(w_g, g)", "diff(w_g/xi, g)", ratio="xi"), Form("diff(w_et, et)")),
          lambda: _conjugates()[6], _loose_names, "the action conjugate to the sliding", _BAR_READ,
          "as for Eq. 5"),
    Entry("7", "couple as a derivative", _L,
          (Form("diff(w_chi, chi)", "diff(w_chi/xi, chi)", ratio="xi"),
           Form("diff(w_t, t)", "diff(w_turn, turn)", off="-Lam*kb*(tq - t + turn)/xi")),
          lambda: _conjugates()[7], _loose_names, "the couple conjugate to the relative rotation",
          (*_BAR_READ, "last member by theta, as extracted: the couple with its sign turned",
           "last member by vartheta, the relative rotation of Eq. 3: right"),
          "as for Eq. 5; the last member has the wrong sign if read by theta"),
    _plain("8", "normal action", "Lam*kn*st", lambda: actions()[:1],
           "minus the gradient of the pair energy by u, along n"),
    _plain("9", "tangential action", "Lam*kt*g", lambda: actions()[1:2],
           "minus the gradient of the pair energy by u, along t"),
    _plain("10", "couple", "Lam*kb*chi", lambda: actions()[2:],
           "minus the gradient of the pair energy by theta, less the couple of the force"),
    Entry("11", "energy density", _D, (Form("1/2*(w @ vol)"),), cloud_density, energy_cloud,
          "a cloud of particles: each pair gives half of its energy to either end", exact=False),
    Entry("12", "energy of the body", _D, (Form("W @ vol"),), _total, energy_cloud,
          "every unordered pair of a cloud once", exact=False),
    Entry("13", "Hamilton's action", _D, (Form("stationary(D - (V + W))"),), _lagrange,
          _lagrange_names, "its Euler-Lagrange expression is Newton's law of a loaded spring"),
    Entry("14", "density of kinetic energy", _L,
          (Form("1/2*rho*ud**2 + 1/2*rho*td**2", "1/2*rho*ud**2 + 1/2*varrho*td**2",
                off="1/2*(rho - varrho)*td**2"),),
          lambda: (kinetic_density(),), bond_names,
          "a square cell that moves and turns, integrated",
          RHO_READINGS, "rotational inertia 6/dx^2 times too large (dx in the unit of length)"),
    _plain("15", "energy of the loads", "-(b1*u1 + b2*u2) - c0*t",
           lambda: (-sum(sp.Symbol(b, real=True) * u for b, u in
                         zip(("b1", "b2", "c0"), MOTIONS[:3], strict=True)),),
           "minus the work of constant loads", _D),
    Entry("16", "stationary action", _L,
          (Form("b1*du1 + b2*du2 + c0*dt"),
           Form("(kn*eta_n/xi*(du1*c + du2*s) + kt*(eta_t/xi - (t + tq)/2)*(-du1*s + du2*c)"
                " + kt/2*(eta_t/xi - (t + tq)/2)*xi*dt + kb*(tq - t)/xi*dt)*Lam"),
           Form("-(rho*(a1*du1 + a2*du2) + rho*at*dt)", "-(rho*(a1*du1 + a2*du2) + varrho*at*dt)",
                off="-(rho - varrho)*at*dt")),
          _variations, bond_names, "gradient of the pair energy; the cell's inertia", RHO_READINGS,
          "as for Eq. 14"),
    _plain("17", "balance of momentum", "f1 + b1 - rho*a1", lambda: _newton()[:1],
           "d'Alembert, from the pair energy and the cell's inertia"),
    Entry("18", "balance of angular momentum", _L,
          (Form("Lam*(kt/2*g*xi + kb*chi) + c0 - rho*at",
                "Lam*(kt/2*g*xi + kb*chi) + c0 - varrho*at", off="(varrho - rho)*at"),),
          lambda: _newton()[1:], bond_names, "d'Alembert, as for Eq. 17",
          RHO_READINGS, "as for Eq. 14"),
    _plain("19", "force density",
           "Lam*(kn*eta_n/xi*c - kt*(eta_t/xi - (tq + t)/2)*s)"
           " = Lam*(kn*eta_n/xi*s + kt*(eta_t/xi - (tq + t)/2)*c)",
           lambda: balance()[:2], "minus the gradient of the pair energy by u"),
    _plain("20", "moment density", "Lam*(kt/2*(eta_t/xi - (tq + t)/2)*xi + kb*(tq - t)/xi)",
           lambda: balance()[2:], "minus the gradient of the pair energy by theta"),
    _plain("21", "force density of a Cauchy solid",
           "Lam*kn*st*c - Lam*kt*g*s = Lam*kn*st*s + Lam*kt*g*c", lambda: balance()[:2],
           "as Eq. 19, through Eqs. 8 and 9"),
    _plain("22", "moment density of a Cauchy solid", "Lam*kt*g*xi/2",
           lambda: (balance()[2].subs(KB, 0),), "as Eq. 20, with k_b = 0"),
]  # fmt: skip
