"""Eqs. 111-135: pair potential and balance of heat, the assembled conductance."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from references.errata import discrete, heat_cloud, pairs
from references.errata.algebra import COS, HORIZON, SIN, THICKNESS, circle_integral, names
from references.errata.expression import evaluate
from references.errata.model import Entry, Form, Verdict

_T, _TQ, _XI, _K, _LAM = sp.symbols("T Tq xi k Lam", real=True)
_Z1, _Z2 = sp.symbols("z1 z2", real=True)


@cache
def gradient() -> Any:
    """Mean gradient along a bond of any temperature between its ends."""
    a, bubble = sp.symbols("a bubble", real=True)
    field = _T * (1 - a) + _TQ * a + bubble * a * (1 - a)
    return sp.expand(sp.integrate(sp.diff(field, a), (a, 0, 1)) / _XI)


def action() -> Any:
    """Heat that enters the first point: conductance k/xi^2 of a bond times the difference."""
    return _LAM * _K / _XI * gradient()


def pair_potential() -> Any:
    """Work of the action while the difference grows from nothing."""
    difference = sp.Symbol("difference", real=True)
    work = sp.integrate(_LAM * _K * difference / _XI**2, difference)
    return sp.expand(work.subs(difference, _TQ - _T))


def _names() -> dict[str, Any]:
    z = sp.Matrix([_T, _TQ])
    return names(
        "T Tq xi k Lam om rho cT Tdot Idot phi phiq",
        g=gradient(),
        e=-gradient(),
        z=z,
        l=sp.Matrix([[gradient()]]).jacobian(z),
        f=action(),
        entropy_free=sp.Integer(0),
    )


def _flux_names() -> dict[str, Any]:
    conductivity = sp.Symbol("K", real=True)

    def half_family(integrand: Any) -> Any:
        """Over the hotter half of a family, by symmetry half of the whole."""
        return THICKNESS * HORIZON**2 / 2 * circle_integral(integrand) / 2

    return names(
        "z1 z2",
        k=4 * conductivity / (sp.pi * THICKNESS * HORIZON**2),
        g=_Z1 * COS + _Z2 * SIN,
        half_family=half_family,
        Lam=sp.Integer(1),
    )


def _conjugates() -> sp.Matrix:
    """Derivative of T om + Tq omq by the sources of p and q."""
    own, other = sp.symbols("om omq", real=True)
    supplied = _T * own + _TQ * other
    return sp.Matrix([sp.diff(supplied, own), sp.diff(supplied, other)])


def _stationary_names() -> dict[str, Any]:
    t, k = sp.symbols("T k", real=True)
    return names(
        "T om rho cT Tdot k",
        W=k * t**2 / 2,
        stationary=lambda density: sp.diff(density, t),
    )


def _heat_balance() -> tuple[Any]:
    """Stored less supplied, where the bonds bring -dW/dT."""
    t, k, om, rho, c, rate = sp.symbols("T k om rho cT Tdot", real=True)
    return (rho * c * rate - (om - k * t),)


def _half() -> dict[str, float]:
    printed = evaluate(_CONDUCTANCE, heat_cloud.cloud_names(), exact=False)
    return {"ratio": float(np.linalg.norm(printed) / np.linalg.norm(heat_cloud.conductance()))}


_CONDUCTANCE = "over_pairs(lambda l, D, L, alpha, dvp, dvq: 1/2*(l.T @ l*D*alpha*dvq*dvp) @ L)"
_NO_L = _CONDUCTANCE.replace(" @ L)", ")")
_HALF = "the assembled matrix is {ratio:.3f} of the Hessian: a body conducts half of what it should"
_R, _D, _N = Verdict.RIGHT, Verdict.DEFINITION, Verdict.NOTATION
_LOST, _W = Verdict.LOST, Verdict.WRONG


def _entry(number: str, title: str, form: str, truth: Any, how: str, verdict: Any = _R) -> Entry:
    forms = tuple(Form(text) for text in form.split(" = "))
    return Entry(number, title, verdict, forms, lambda: (truth(),) * len(forms), _names, how)


def _sum(number: str, title: str, form: Form, truth: Any, how: str, verdict: Any = _R,
         **more: Any) -> Entry:  # fmt: skip
    return Entry(
        number, title, verdict, (form,), truth, heat_cloud.cloud_names, how, exact=False, **more
    )


def _per_particle(number: str, title: str, body: tuple[str, str, str], truth: Any) -> Entry:
    pair, printed, right = body
    form = Form(f"over_pairs(lambda L, {pair}: {printed})",
                f"over_particles(lambda {pair}: {right})", ratio="neighbours")  # fmt: skip
    return _sum(number, title, form, truth, "particle by particle", _N,
                readings=discrete.LITERALLY, measure=discrete.family_size,
                effect="read literally a full family at m = 5 counts a particle {full:.0f} times",
                )  # fmt: skip


ENTRIES = [
    _entry("111", "temperature difference of a bond over its length", "(Tq - T)/xi", gradient,
           "mean gradient along the bond", _D),
    _entry("112", "thermal pair potential", "Lam*k*g**2/2 = Lam*k*(Tq - T)**2/(2*xi**2)",
           pair_potential, "work of the action of Eq. 113", _D),
    _entry("113", "thermal pair action", "Lam*k*g/xi = Lam*k*(Tq - T)/xi**2",
           lambda: -sp.diff(pair_potential(), _T), "minus the derivative of the potential by T"),
    Entry("114", "heat flux of a bond", _D,
          (Form("half_family(-Lam*k*g*c)"), Form("half_family(-Lam*k*g*s)")),
          lambda: (-sp.Symbol("K", real=True) * _Z1, -sp.Symbol("K", real=True) * _Z2),
          _flux_names, "over the hotter half of a family it is Fourier's law (k of Eq. 156)"),
    Entry("115", "thermal potential of a point", _D, (Form("1/2*(w @ vol)"),), pairs.cloud_density,
          pairs.energy_cloud, "each pair of a cloud gives half to either end", exact=False),
    Entry("116", "functional of heat conduction", _D,
          (Form("stationary(W - (T*om - T*rho*cT*Tdot))"),), _heat_balance, _stationary_names,
          "stationary in T with its rate kept, it is the balance of heat"),
    Entry("117", "balance of heat", _LOST,
          (Form("f + om - rho*cT*Idot", "f + om - rho*cT*Tdot", off="rho*cT*(Tdot - Idot)"),),
          lambda: (-sp.diff(pair_potential(), _T) + sp.Symbol("om", real=True)
                   - sp.Symbol("rho", real=True) * sp.Symbol("cT", real=True)
                   * sp.Symbol("Tdot", real=True),), _names,
          "stationary point of Eq. 116",
          ("the rate of I, the functional, as extracted: it is no field",
           "the rate of T, a similar letter, as in Eq. 116: right")),
    _entry("118", "electric field of a bond", "-(Tq - T)/xi", lambda: -gradient(),
           "minus the mean gradient", _D),
    _entry("119", "electric pair potential", "Lam*k*e**2/2 = Lam*k*(Tq - T)**2/(2*xi**2)",
           pair_potential, "work of the action of Eq. 120, last member", _D),
    Entry("120", "electric pair action", _W,
          (Form("Lam*k*e/xi", "-Lam*k*e/xi", ratio="-1"), Form("Lam*k*(Tq - T)/xi**2")),
          lambda: (-sp.diff(pair_potential(), _T),) * 2, _names,
          "minus the derivative of the potential by phi, as Eq. 121 needs it",
          ("the last member: right", "the middle one with e of Eq. 118: its sign is turned",
           "the middle one, and omega_e as what is taken out: then the last member is wrong; the "
           "two never agree"),
          "with the middle member sources drain current: the potential's sign is turned"),
    Entry("121", "balance of current", _R, (Form("f + om"),),
          lambda: (-sp.diff(pair_potential() - sp.Symbol("om", real=True) * _T, _T),), _names,
          "stationary point of the electric functional, f the last member of Eq. 120"),
    Entry("122", "temperatures of a pair", _D, (Form("Matrix([T, Tq])"),),
          lambda: (_conjugates(),), _names,
          "conjugate to the sources of p and q in that order"),
    _entry("123", "gradient of a pair", "(l*z)[0]", gradient, "mean gradient along the bond"),
    Entry("124", "compatibility row", _R, (Form("1/xi*Matrix([[-1, 1]])"),),
          lambda: (sp.Matrix([[gradient()]]).jacobian([_T, _TQ]),), _names,
          "derivative of the gradient by both temperatures"),
    _entry("125", "constitutive equation of a pair", "Lam*k/xi*(l*z)[0]", action,
           "conductance of a bond times the difference"),
    _sum("126", "variation of the storage term", Form("sum(dT*rho*cT*rate*vol)"),
         lambda: heat_cloud.changed("capacity"), "T changed, its rate kept"),
    _sum("127", "variation of the sources", Form("-sum(dT*om*vol)"),
         lambda: heat_cloud.changed("source"), "T changed, sources kept"),
    _sum("128", "potential of the discrete body",
         Form("pair_sums_over_2(lambda l, D, alpha, dvp, dvq, z: "
              "1/2*(z @ (l.T @ l*D) @ z)*alpha*dvq*dvp)"),
         lambda: (heat_cloud.potential(heat_cloud.fields()["T"]),),
         "every unordered pair of a cloud once"),
    Entry("129", "balance of heat, pair by pair", _W,
          (Form("over_pairs(lambda L, rho, cT, dvp: L*rho*cT*dvp)",
                "over_particles(lambda rho, cT, dvp: rho*cT*dvp)", ratio="neighbours"),
           Form("-over_pairs(lambda L, om, dvp: L[:, 0]*om*dvp)",
                "-over_particles(lambda om, dvp: om*dvp)", ratio="neighbours"),
           Form(_CONDUCTANCE, _NO_L, ratio="0.5")),
          lambda: (heat_cloud.capacity(), -heat_cloud.sources(), heat_cloud.conductance()),
          heat_cloud.cloud_names, "second derivatives of a random cloud's potential",
          (*discrete.LITERALLY, *discrete.COLUMNS), _HALF, _half, exact=False),
    _sum("130", "balance of heat, assembled", Form("M @ rate + K @ z - p"), heat_cloud.balance,
         "gradient of the cloud's functional"),
    _per_particle("131", "assembled capacity", ("rho, cT, dvp", "L*rho*cT*dvp", "rho*cT*dvp"),
                  lambda: (heat_cloud.capacity(),)),
    _sum("132", "assembled conductance", Form(_CONDUCTANCE, _NO_L, ratio="0.5"),
         lambda: (heat_cloud.conductance(),), "second derivative of a random cloud's potential", _W,
         readings=discrete.COLUMNS, effect=_HALF, measure=_half),
    _per_particle("133", "assembled sources", ("om, dvp", "L[:, 0]*om*dvp", "om*dvp"),
                  lambda: (heat_cloud.sources(),)),
    _per_particle("134", "assembled temperatures", ("T", "L[:, 0]*T", "T"),
                  lambda: (heat_cloud.fields()["T"],)),
    Entry("135", "potentials of a pair", _D, (Form("Matrix([T, Tq])"),),
          lambda: (_conjugates(),), _names,
          "as Eq. 122"),
    Entry("Sect. 4.1 (after 135)", "minus Eq. 124 for conduction of current", Verdict.INCOMPLETE,
          (Form("(-l*z)[0]"), Form("((-l).T*(-l))[0, 1]"),
           Form("Lam*k/xi*(-l*z)[0]", "-Lam*k/xi*(-l*z)[0]", ratio="-1")),
          lambda: (-gradient(), -1 / _XI**2, action()), _names,
          "Eq. 118; the matrix; the action that Eq. 121 balances",
          ("for the field and for K, in which l stands twice: right",
           "for Eq. 125 too: the action's sign is turned, as in the middle member of Eq. 120"),
          harmless=("(l.T * -l)[0, 1]", "((-l).T * l)[0, 1]")),
]  # fmt: skip
