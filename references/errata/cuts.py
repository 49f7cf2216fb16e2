"""Eqs. 92-105: critical energies of bonds, broken bonds, damage."""

from __future__ import annotations

from collections.abc import Callable
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
    half_circle_integral,
    names,
)
from references.errata.model import Entry, Form, Verdict

W1, W2, G0, G1 = sp.symbols("w1 w2 G0 G1", real=True)
#: Eq. 108, GPa.
BONE = np.array([[25.0, 5.89, 0.0], [5.89, 16.25, 0.0], [0.0, 0.0, 6.65]])


def energy(critical: Any) -> Any:
    """Work on the bonds through a cut normal to axis 1, per area: h delta^3/3 int w_c cos psi.

    For a bond (xi, psi) the planes it crosses lie within xi cos(psi), so that the count of Eq. 92
    is h int xi dxi int dpsi w_c xi cos(psi).
    """
    return THICKNESS * HORIZON**3 / 3 * half_circle_integral(critical * COS)


def both(power: int, fourfold: bool = False) -> tuple[Any, Any]:
    """Fracture energies of Eq. 93 (Eq. 101) at its two orientations."""
    waves = (COS**2 - SIN**2, 2 * SIN * COS) if fourfold else (COS, SIN)
    first, second = (energy(W2 + (W1 - W2) * wave**power) for wave in waves)
    return first, second


@cache
def constants(power: int, fourfold: bool = False) -> tuple[Any, Any]:
    """w_c1 and w_c2 for given fracture energies."""
    one, other = both(power, fourfold)
    solution = sp.solve([one - G0, other - G1], [W1, W2], dict=True)[0]
    return solution[W1], solution[W2]


def largest_ratio(power: int, fourfold: bool = False) -> Any:
    """Largest ratio of the two fracture energies with w_c >= 0."""
    first, second = (g.subs({W1: 1, W2: 0}) for g in both(power, fourfold))
    return second / first if fourfold else first / second


def _triple(
    integrand: Callable[..., Any],
    first: Callable[..., Any],
    last: Callable[..., Any],
    nearest: Callable[..., Any],
    farthest: float,
) -> list[float]:
    """int dz int dxi int dpsi by Gauss quadrature, w_c = 1, cos^2 psi, cos(psi - 0.3) + 2."""
    node, weight = np.polynomial.legendre.leggauss(32)
    node, weight = (node + 1) / 2, weight / 2
    # arccos(z/xi) is smooth in these variables, at both ends of z and of xi.
    z, dz = farthest * node**2 * (3 - 2 * node), 6 * farthest * node * (1 - node) * weight
    z, dz = z[:, None, None], dz[:, None, None]
    start = nearest(z)
    grow = np.log(farthest / start)
    xi = start * np.exp(grow * (node**2)[:, None])
    dxi = xi * grow * 2 * (node * weight)[:, None]
    low, high = first(xi, z), last(xi, z)
    psi = low + (high - low) * node
    measure = dz * dxi * (high - low) * weight
    laws = (np.ones_like(psi), np.cos(psi) ** 2, np.cos(psi - 0.3) + 2)
    return [float(np.sum(integrand(law, xi) * measure)) for law in laws]


def _triple_truth() -> tuple[list[float]]:
    psi, h, delta = np.polynomial.legendre.leggauss(60), 1.3, 1.7
    angle, weight = np.pi / 2 * psi[0], np.pi / 2 * psi[1]
    laws = (np.ones_like(angle), np.cos(angle) ** 2, np.cos(angle - 0.3) + 2)
    return ([float(h * delta**3 / 3 * np.sum(law * np.cos(angle) * weight)) for law in laws],)


def _cut_names() -> dict[str, Any]:
    return {"cuts": _triple, "h": 1.3, "acos": np.arccos, "delta": 1.7}


def _law_names() -> dict[str, Any]:
    psi, zeta = sp.symbols("psi zeta", real=True)
    return names("w1 w2 G0 G1 xi n", psi=psi, zeta=zeta, cut=energy)


def _symbols() -> dict[str, Any]:
    return names("w1 w2 G0 G1")


def _turned_law(frequency: int) -> tuple[Any]:
    """Between w_c1 along the turned axis and w_c2 across it, as the n-th power of a cosine."""
    psi, zeta, n = sp.symbols("psi zeta n", real=True)
    share = sp.cos(frequency * psi - frequency * zeta) ** n
    return (W1 * share + W2 * (1 - share),)


def _bracket(sign: int) -> tuple[Any]:
    xi = sp.Symbol("xi", real=True)
    wave = COS if sign == 0 else SIN  # cos(psi -+ pi/2)^2 = sin^2
    return (sp.expand((W2 + (W1 - W2) * wave**2) * THICKNESS * xi),)


# Broken bonds ------------------------------------------------------------------------------------
def _history(rule: Callable[..., int]) -> list[int]:
    """Whether a bond is whole while its energy rises and falls in tension and compression."""
    w = [0.2, 0.9, 1.0, 1.4, 0.6, 0.1, 1.2]
    out = []
    for stretch, limit in ((1.0, 1.0), (-1.0, 1.0), (0.0, 1.0), (1.0, 5.0)):
        before = 1
        for value in w:
            before = int(rule(value, limit, stretch, before))
            out.append(before)
    return out


def _once_broken() -> tuple[list[int]]:
    """Broken for good once the energy reaches its limit in a bond that is not shortened."""
    w, out = [0.2, 0.9, 1.0, 1.4, 0.6, 0.1, 1.2], []
    for stretch, limit in ((1.0, 1.0), (-1.0, 1.0), (0.0, 1.0), (1.0, 5.0)):
        reached = [stretch >= 0 and value >= limit for value in w]
        out += [0 if any(reached[: k + 1]) else 1 for k in range(len(w))]
    return (out,)


def _damage_names() -> dict[str, Any]:
    rng = np.random.default_rng(3)
    mu, area = rng.integers(0, 2, (5, 5)).astype(float), rng.uniform(1, 2, 5)

    def over(variable: str, function: np.ndarray) -> np.ndarray:
        """Integral of a function of (x, x') over one of them; the other is left."""
        return function @ area if variable == "xp" else area @ function

    return {"over": over, "mu": mu, "one": np.ones((5, 5)), "x": "x", "xp": "xp",
            "lost": mu @ area / area.sum() - area @ mu / area.sum()}  # fmt: skip


def _damage() -> tuple[np.ndarray]:
    """Broken share of each particle's family, counted."""
    rng = np.random.default_rng(3)
    mu, area = rng.integers(0, 2, (5, 5)), rng.uniform(1, 2, 5)
    return (np.array([sum(area[q] for q in range(5) if mu[p, q] == 0) for p in range(5)])
            / area.sum(),)  # fmt: skip


# Cosine laws for elasticity ----------------------------------------------------------------------
@cache
def cosine_moduli(power: int) -> tuple[float, ...]:
    """k_n along, across, k_t along, across of bone (times h delta^3, GPa) with Eq. 93 for both."""
    a, b, c, d = sp.symbols("a b c d")
    e1, e2, e12 = sp.symbols("e11 e22 e12")
    stretch = e1 * COS**2 + e2 * SIN**2 + 2 * e12 * COS * SIN
    shear = e12 * (COS**2 - SIN**2) + (e2 - e1) * COS * SIN
    kn, kt = b + (a - b) * COS**power, d + (c - d) * COS**power
    bonds = circle_integral(kn * stretch**2 + kt * shear**2) / 12
    c11, c22, c12, c66 = (sp.Rational(str(v)) for v in (25, 16.25, 5.89, 6.65))
    solid = (c11 * e1**2 + c22 * e2**2 + 2 * c12 * e1 * e2 + 4 * c66 * e12**2) / 2
    found = sp.solve(sp.Poly(bonds - solid, e1, e2, e12).coeffs(), [a, b, c, d], dict=True)[0]
    return tuple(float(found[k]) for k in (a, b, c, d))


def _any_law() -> tuple[Any, Any]:
    """int k_t dpsi for laws with any harmonics, and the names of the macromoduli they give."""
    a, b = sp.symbols("a0:5", real=True), sp.symbols("b0:5", real=True)
    waves = [COS ** (2 * k) for k in range(4)] + [COS**3 * SIN]
    kn = sum(x * wave for x, wave in zip(a, waves, strict=True))
    kt = sum(x * wave for x, wave in zip(b, waves, strict=True))
    e1, e2, e12 = sp.symbols("e11 e22 e12", real=True)
    stretch = e1 * COS**2 + e2 * SIN**2 + 2 * e12 * COS * SIN
    shear = e12 * (COS**2 - SIN**2) + (e2 - e1) * COS * SIN
    stored = THICKNESS * HORIZON**3 / 12 * circle_integral(kn * stretch**2 + kt * shear**2)
    known = names(C66=sp.diff(stored, e12, 2) / 4, C12=sp.diff(stored, e1, e2))
    return circle_integral(kt), known


def _signs() -> list[int]:
    """Sign of the smaller shear modulus of bone, n = 4, 6, 8 and 16."""
    return [int(np.sign(min(cosine_moduli(n)[2:]))) for n in (4, 6, 8, 16)]


def _cosine_effect() -> dict[str, float]:
    return {f"n{n}": min(cosine_moduli(n)[2:]) for n in (4, 6, 8, 16)}


_R, _D = Verdict.RIGHT, Verdict.DEFINITION
#: Printed minus right: bonds that healed (+1), and bonds broken in compression (-1).
_HEALS = [0, 0, 0, 0, 1, 1, 0, 0, 0, -1, -1, 0, 0, -1, 0, 0, 0, 0, 1, 1, 0] + [0] * 7
_SPACED = "psi + pi / 2"
_LIMIT = "the bracket as printed: h |xi| multiplies the second term only, whose dimension differs"


def _critical(number: str, title: str, power: int, one: str, other: str) -> Entry:
    return Entry(number, title, _R, (Form(f"{one}/(h*delta**3)"), Form(f"{other}/(h*delta**3)")),
                 lambda: constants(power), _symbols,
                 "fracture energies at both orientations, solved for w_c1 and w_c2")  # fmt: skip


def _orientation(number: str, sign: int, angle: str) -> Entry:
    printed = f"w2 + (w1 - w2)*cos({angle})**2*h*xi"
    return Entry(number, f"fracture energy at zeta = {'pi/2' if sign else '0'}", Verdict.NOTATION,
                 (Form(f"angle({printed})", f"angle((w2 + (w1 - w2)*cos({angle})**2)*h*xi)",
                       off="w2 - w2*h*xi"),),
                 lambda: _bracket(sign), _angle_names, "Eq. 93 in Eq. 92, n = 2",
                 (_LIMIT, "h |xi| times the whole law, as Eq. 92 has it: right",
                  *(("psi + pi/2 where Eq. 93 has psi - pi/2: the same for even n",) if sign else
                    ())),
                 harmless=tuple(text.replace("+ pi", "- pi") for text in (
                     f"angle(w2 + (w1 - w2) * cos({_SPACED}) ** 2 * h * xi)",
                     f"angle((w2 + (w1 - w2) * cos({_SPACED}) ** 2) * h * xi)")))  # fmt: skip


def _angle_names() -> dict[str, Any]:
    psi = sp.Symbol("psi", real=True)

    def angle(expression: Any) -> Any:
        return sp.expand_trig(expression).subs({sp.cos(psi): COS, sp.sin(psi): SIN})

    return names("w1 w2 xi", psi=psi, angle=angle)


ENTRIES = [
    Entry("92", "fracture energy of broken bonds", _R,
          (Form("cuts(lambda wc, xi: wc*h*xi, lambda xi, z: -acos(z/xi), "
                "lambda xi, z: acos(z/xi), lambda z: z, delta)"),), _triple_truth, _cut_names,
          "planes that a bond crosses, counted in closed form; three laws, printed order",
          exact=False),
    Entry("93", "two-lobe law", _D, (Form("w2 + (w1 - w2)*cos(psi - zeta)**n"),),
          lambda: _turned_law(1), _law_names, "w_c1 along the axis, w_c2 across it"),
    _orientation("94", 0, "psi"),
    _orientation("95", 1, "psi + pi/2"),
    Entry("96", "fracture energies, n = 2", _R,
          (Form("2*h*delta**3*(2*w1 + w2)"), Form("2*h*delta**3*(w1 + 2*w2)")),
          lambda: tuple(9 * g for g in both(2)), _symbols, "Eq. 92 in closed form"),
    _critical("97", "critical energies, n = 2", 2, "3*(2*G0 - G1)/2", "3*(2*G1 - G0)/2"),
    _critical("98", "critical energies, n = 4", 4, "3*(12*G0 - 7*G1)/10", "3*(8*G1 - 3*G0)/10"),
    _critical("99", "critical energies, n = 8", 8, "3*(280*G0 - 187*G1)/186",
              "3*(128*G1 - 35*G0)/186"),
    Entry("100", "critical energy of an isotropic law", _R, (Form("3*G0/(2*h*delta**3)"),),
          lambda: (constants(4)[0].subs(G1, G0),), _symbols, "both fracture energies alike"),
    Entry("101", "fourfold law", _D, (Form("w2 + (w1 - w2)*cos(2*(psi - zeta))**n"),),
          lambda: _turned_law(2), _law_names, "w_c1 along the axes, w_c2 between them"),
    Entry("102", "fracture energies, fourfold law, n = 4", _R,
          (Form("2*h*delta**3*(107*w1 + 208*w2)"), Form("2*h*delta**3*(128*w1 + 187*w2)")),
          lambda: tuple(945 * g for g in both(4, fourfold=True)), _symbols,
          "Eq. 92 in closed form"),
    Entry("103", "critical energies, fourfold law, n = 4", _R,
          (Form("(208*G1 - 187*G0)/(14*h*delta**3)"), Form("(128*G0 - 107*G1)/(14*h*delta**3)")),
          lambda: constants(4, fourfold=True), _symbols, "Eq. 102 solved"),
    Entry("104", "when a bond is broken", Verdict.INCOMPLETE,
          (Form("history(lambda w, wc, s, before: 0 if w >= wc else 1)",
                "history(lambda w, wc, s, before: 0 if before == 0 or w >= wc and s >= 0 else 1)",
                off="heals"),),
          _once_broken, lambda: {"history": _history, "heals": np.array(_HEALS)},
          "a bond loaded, unloaded and loaded again, in tension, compression and at s = 0",
          ("as printed: a bond heals when its energy falls, and breaks in compression",
           "history-dependent, as the sentence before says, and for s >= 0, as Sect. 3.1 adds: "
           "right"),
          "a program that follows the formula alone heals cracks on unloading and breaks bonds "
          "under pressure", exact=False),
    Entry("105", "damage", Verdict.LOST,
          (Form("1 - over(x, mu)/over(x, one)", "1 - over(xp, mu)/over(xp, one)", off="lost"),),
          _damage, _damage_names, "the broken share of each particle's family, counted",
          ("dx, as extracted: nothing of x is left", "dx', with the prime: right"), exact=False,
          harmless=("1 - over(x, mu) / over(xp, one)",)),
    Entry("Sect. 3 (end, mean)", "what every law of k_t must come to", _R,
          (Form("24*(C66 - C12)/(h*delta**3)"),), lambda: _any_law()[:1], lambda: _any_law()[1],
          "energy of a horizon for laws with any harmonics",
          effect="not printed, but it decides the next entry: where C1212 < C1122 no angular law, "
          "of whatever n, keeps k_t positive"),
    Entry("Sect. 3 (end)", "cosine laws are said to keep the micromoduli positive", Verdict.WRONG,
          (Form("[1, 1, 1, 1]", "[-1, 1, -1, -1]", off="[2, 0, 2, 2]"),), lambda: (_signs(),),
          dict, "bone (Eq. 108) with Eq. 93 for both moduli: sign of the smaller k_t for n = 4, 6, "
          "8, 16",
          ("n chosen for the solid: bone has n = 6 and no other of n = 4 ... 64",
           "any n, in a solid with C1212 < C1122: none, since the integral of k_t is negative",
           "n = 2: no such law, k_t cos^2 has no fourth harmonic"),
          "smallest k_t h delta^3 of bone: {n4:.2f}, {n6:.2f}, {n8:.2f}, {n16:.2f} GPa for n = 4, "
          "6, 8, 16", _cosine_effect),
]  # fmt: skip
