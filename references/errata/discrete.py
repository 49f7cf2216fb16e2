"""Eqs. 23-39: vectors and matrices of a pair, the assembled system."""

from __future__ import annotations

from typing import Any

import numpy as np
import sympy as sp

from references.errata import cloud, pairs
from references.errata.algebra import COS, SIN, family
from references.errata.expression import evaluate
from references.errata.model import Entry, Form, Verdict

_V1, _V2, _TD = sp.symbols("v1 v2 td", real=True)
_U, _HAT = pairs.MOTIONS, sp.symbols("h1 h2 ht h1q h2q htq", real=True)


def _rotation() -> sp.Matrix:
    """Local components of both points' motions: along n, along t, rotation."""
    block = sp.Matrix([[COS, SIN, 0], [-SIN, COS, 0], [0, 0, 1]])
    return sp.diag(block, block)


def _local_measures() -> list[Any]:
    """Eqs. 1-3 of a bond along axis 1, whose global components are the local ones."""
    own = {COS: 1, SIN: 0, **dict(zip(_U, _HAT, strict=True))}
    return [measure.subs(own, simultaneous=True) for measure in pairs.measures()]


def _local_motions() -> list[Any]:
    """Components along n and t, and the rotation, of both points."""
    found = []
    for u1, u2, turn in (_U[:3], _U[3:]):
        found += [u1 * COS + u2 * SIN, -u1 * SIN + u2 * COS, turn]
    return found


def _names() -> dict[str, Any]:
    known = pairs.bond_names()
    hats = sp.Matrix(_HAT)
    known.update(
        R=_rotation(),
        B=sp.Matrix(_local_measures()).jacobian(hats),
        vhat=sp.Matrix(_local_motions()),
        v=sp.Matrix(_U),
        D=pairs.LAM * sp.diag(pairs.KN, pairs.KT, pairs.KB),
        hpq=sp.Matrix(pairs.measures()),
    )
    known.update({str(name): name for name in _HAT})
    return known


def _load_conjugates() -> tuple[sp.Matrix]:
    """Motions in the order of the loads b1, b2, c (Sect. 2.1): minus the loads' energy by them."""
    loads = sp.symbols("b1 b2 c0", real=True)
    energy = -sum(b * u for b, u in zip(loads, _U[:3], strict=True))
    return (sp.Matrix([-sp.diff(energy, b) for b in loads]),)


def _constitutive() -> tuple[sp.Matrix]:
    s, g, x = sp.symbols("s_ g_ x_", real=True)
    half = pairs.LAM / 2
    energy = half * (pairs.KN * s**2 + pairs.KT * g**2 + pairs.KB * x**2)
    return (sp.hessian(energy, [s, g, x]),)


def half_a_hessian() -> dict[str, float]:
    """What the trailing L does to stiffness and frequencies of the cloud."""
    printed = evaluate(STIFFNESS, cloud.cloud_names(), exact=False)
    exact = cloud.energy_hessian()
    ratio = float(np.linalg.norm(printed) / np.linalg.norm(exact))
    return {"ratio": ratio, "frequency": float(np.sqrt(ratio))}


def family_size() -> dict[str, float]:
    return {"full": float(len(family(5)[0]))}


STIFFNESS = (
    "over_pairs(lambda R, B, D, L, xi, alpha, dvp, dvq: "
    "xi/2*(R.T @ B.T @ D @ B @ R*alpha*dvq*dvp) @ L)"
)
_NO_L = STIFFNESS.replace(" @ L)", ")")
_R, _D, _N, _W = Verdict.RIGHT, Verdict.DEFINITION, Verdict.NOTATION, Verdict.WRONG
LITERALLY = (
    "the assembly operator as Sect. 2.1 defines it, a double sum whose terms are added: every "
    "particle counts once for each neighbour",
    "a sum over particles, as Eqs. 30 and 32 have it, or terms put and not added: right",
)
COLUMNS = (
    "L = [I 0]^T as printed: a 6x3 block, the columns of p only; the pairs (p, q) and (q, p) then "
    "give one Hessian of a pair between them, each with |xi|/2",
    "L^T from the left instead: the rows of p only, the same half by symmetry",
    "no L, as Eq. 175 prints the same matrix: right",
)
_HALF = (
    "the assembled matrix is {ratio:.3f} of the Hessian: frequencies x {frequency:.3f}, "
    "displacements under dead loads twice too large"
)


def _symbolic(number: str, title: str, form: str, truth: Any, how: str, verdict: Any = _R) -> Entry:
    return Entry(number, title, verdict, (Form(form),), truth, _names, how)


def _numeric(
    number: str,
    title: str,
    form: Form,
    truth: Any,
    how: str,
    verdict: Any = _R,
    readings: tuple[str, ...] = (),
    effect: str = "",
    measure: Any = None,
) -> Entry:
    return Entry(number, title, verdict, (form,), truth, cloud.cloud_names, how, readings, effect,
                 measure, exact=False)  # fmt: skip


def _per_particle(number: str, title: str, body: tuple[str, ...], truth: Any, how: str) -> Entry:
    printed = f"over_pairs({body[0]}: {body[1]})"
    right = f"over_particles({body[2]}: {body[3]})"
    return _numeric(number, title, Form(printed, right, ratio="neighbours"), truth, how, _N,
                    LITERALLY, "read literally a full family at m = 5 counts a particle "
                    "{full:.0f} times", family_size)  # fmt: skip


ENTRIES = [
    _symbolic("23", "motions of a particle", "Matrix([u1, u2, t])", _load_conjugates,
              "conjugate to the loads b1, b2, c in that order", _D),
    _symbolic("24", "motions of a pair", "R.T*vhat", lambda: (sp.Matrix(_U),),
              "R turns into the local basis n, t; its transpose turns back", _D),
    _symbolic("25", "local motions of a particle", "(R*v)[0:3]",
              lambda: (_local_motions()[:3],),
              "components along n and t", _D),
    _symbolic("26", "measures of a pair", "B*R*v", lambda: (sp.Matrix(pairs.measures()),),
              "Eqs. 1-3 for any direction of the bond"),
    _symbolic("27", "compatibility matrix",
              "1/(2*xi)*Matrix([[-2, 0, 0, 2, 0, 0], [0, -2, -xi, 0, 2, -xi], "
              "[0, 0, -2, 0, 0, 2]])", lambda: (sp.Matrix(_local_measures()).jacobian(_HAT),),
              "derivative of Eqs. 1-3 by the local motions"),
    _symbolic("28", "actions of a pair", "D*hpq", lambda: (sp.Matrix(pairs.actions()),),
              "the actions that the pair energy gives"),
    _symbolic("29", "elasticity of a pair", "Lam*Matrix([[kn, 0, 0], [0, kt, 0], [0, 0, kb]])",
              _constitutive, "second derivative of the energy per unit distance"),
    _numeric("30", "variation of the kinetic energy",
             Form("-over_time(lambda dv, P, a, b, vol: dv @ P @ a*vol)"), cloud.kinetic_variation,
             "integrated by parts in time over motions of constant acceleration"),
    Entry("31", "inertia of a particle", Verdict.LOST,
          (Form("diag(rho, rho, rho)", "diag(rho, rho, varrho)", off="diag(0, 0, rho - varrho)"),),
          lambda: (sp.hessian(pairs.kinetic_density().subs(sp.Symbol("ud", real=True), 0)
                              + pairs.RHO * (_V1**2 + _V2**2) / 2, [_V1, _V2, _TD]),),
          _names, "kinetic energy of a square cell; varrho = rho dx^2/6", pairs.RHO_READINGS,
          "rotational inertia 6/dx^2 times too large, a number that depends on the unit of length; "
          "where rotations are condensed nothing happens"),
    _numeric("32", "variation of the loads' energy",
             Form("-over_time(lambda dv, P, a, b, vol: dv @ b*vol)"), cloud.load_variation,
             "minus the virtual work of constant loads"),
    _numeric("33", "energy of the discrete body",
             Form("pair_sums_over_2(lambda R, B, D, xi, alpha, dvp, dvq, v: "
                  "xi/2*alpha*dvq*dvp*(v @ (R.T @ B.T @ D @ B @ R) @ v))"),
             lambda: (cloud.cloud_energy(cloud.cloud().motion),),
             "every unordered pair of a random cloud once, by Eqs. 1-4"),
    Entry("34", "equation of motion, pair by pair", _W,
          (Form("over_pairs(lambda L, P, dvp: L @ P*dvp)",
                "over_particles(lambda P, dvp: P*dvp)", ratio="neighbours"),
           Form("-over_pairs(lambda L, b, dvp: L @ b*dvp)",
                "-over_particles(lambda b, dvp: b*dvp)", ratio="neighbours"),
           Form(STIFFNESS, _NO_L, ratio="0.5")),
          lambda: (cloud.mass(), -cloud.loads(), cloud.energy_hessian()), cloud.cloud_names,
          "second derivatives of a random cloud's energies", (*LITERALLY, *COLUMNS), _HALF,
          half_a_hessian, exact=False),
    _numeric("35", "equation of motion", Form("M @ a + K @ v - p"), cloud.equation_of_motion,
             "gradient of kinetic, stored and load energy"),
    _per_particle("36", "assembled mass", ("lambda L, P, dvp", "L @ P*dvp", "lambda P, dvp",
                  "P*dvp"), lambda: (cloud.mass(),), "kinetic energy, particle by particle"),
    _numeric("37", "assembled stiffness", Form(STIFFNESS, _NO_L, ratio="0.5"),
             lambda: (cloud.energy_hessian(),), "second derivative of a random cloud's energy", _W,
             COLUMNS, _HALF, half_a_hessian),
    _per_particle("38", "assembled loads", ("lambda L, b, dvp", "L @ b*dvp", "lambda b, dvp",
                  "b*dvp"), lambda: (cloud.loads(),), "work of the loads, particle by particle"),
    _per_particle("39", "assembled motions", ("lambda L, vp", "L @ vp", "lambda vp", "vp"),
                  lambda: (cloud.cloud().motion.ravel(),), "the particles' motions, one by one"),
]  # fmt: skip
