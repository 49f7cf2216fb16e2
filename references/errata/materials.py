"""Eqs. 106-110: silicon, the anisotropic solid, bone, energy release rate and peak load."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp
from scipy.optimize import brentq

from references.errata import cuts
from references.errata.algebra import names
from references.errata.model import Entry, Form, Verdict

_K_CL, _K_CR = 6.5e6, 4.0e6


def _silicon() -> tuple[Any, ...]:
    """C1111, C1122, C1212 in plane stress from the cubic constants 165.7, 63.9, 79.6 GPa.

    M. A. Hopcroft, W. D. Nix, T. W. Kenny, J. Microelectromech. Syst. 19 (2010) 229-238.
    """
    c11, c12, c44 = 165.7, 63.9, 79.6
    return c11 - c12**2 / c11, c12 - c12**2 / c11, c44


# The table of Van Buskirk et al. (1981) as it is usually reproduced, GPa: 1 radial,
# 2 circumferential, 3 longitudinal.
_ULTRASOUND = {"11": 14.1, "22": 18.4, "33": 25.0, "44": 7.00, "55": 6.30, "13": 4.84, "23": 6.94}


def _bone() -> tuple[float, ...]:
    """C1111, C2222, C1122, C1212: the means over the two directions across the long axis."""
    c = _ULTRASOUND
    return (
        c["33"],
        (c["11"] + c["22"]) / 2,
        (c["13"] + c["23"]) / 2,
        (c["44"] + c["55"]) / 2,
    )


@cache
def _kink() -> dict[str, float]:
    """Largest move of a kink angle of modes 0 to 90 degrees for C1212 = 33.4 GPa, degrees."""
    from references.analytic.kinking import hoop_kink_angle

    def angles(shear: float) -> np.ndarray:
        tensor = np.array([[100, 20, 10], [20, 80, 100 / 6], [10, 100 / 6, shear]])
        modes = np.radians(np.arange(0, 91, 5))
        return np.array([hoop_kink_angle(tensor, np.cos(m), np.sin(m)) for m in modes])

    printed = np.degrees(angles(33.4))
    return {
        "exact": float(np.max(np.abs(printed - np.degrees(angles(100 / 3))))),
        "rounded": float(np.max(np.abs(printed - np.degrees(angles(33.3))))),
    }


# Energy release rate -----------------------------------------------------------------------------
def _bone_compliance(across: bool) -> np.ndarray:
    """In the axes of a crack along the fibres, or across them (axes exchanged), 1/Pa."""
    order = [1, 0, 2] if across else [0, 1, 2]
    compliance: np.ndarray = np.linalg.inv(cuts.BONE[np.ix_(order, order)] * 1e9)
    return compliance


def _roots(s: np.ndarray) -> np.ndarray:
    squares = np.roots([s[0, 0], 2 * s[0, 1] + s[2, 2], s[1, 1]]).astype(complex)
    return 1j * np.sqrt(-squares)


def closure(k: float, s: np.ndarray) -> float:
    """Energy release rate in mode I by Irwin's crack closure, displacements from Stroh's form."""
    from references.errata.crack_tip import tip_displacement

    node, weight = np.polynomial.legendre.leggauss(40)
    node, weight = (node + 1) / 2, weight / 2
    tensor, a = np.linalg.inv(s), 1.0
    # int over 0..a of K/sqrt(2 pi x) times the opening at a - x, with x = a sin^2
    x = a * np.sin(np.pi / 2 * node) ** 2
    dx = a * np.pi / 2 * np.sin(np.pi * node) * weight
    total = 0.0
    for place, length in zip(x, dx, strict=True):
        faces = [tip_displacement(tensor, a - place, w, np.array([k, 0.0]))[1]
                 for w in (np.pi, -np.pi)]  # fmt: skip
        total += length * k / np.sqrt(2 * np.pi * place) * (faces[0] - faces[1])
    return float(total / (2 * a))


def _release_rates() -> tuple[float, float]:
    return closure(_K_CL, _bone_compliance(True)), closure(_K_CR, _bone_compliance(False))


def _release_names() -> dict[str, Any]:
    """S2222, S1111 in the material's axes; roots in those of the crack."""
    s, across = _bone_compliance(False), _roots(_bone_compliance(True))
    along = _roots(s)
    return {
        "S11": s[0, 0], "S22": s[1, 1], "K_cl": _K_CL, "K_cr": _K_CR, "Im": np.imag,
        "conj": np.conj, "mu1c": across[0], "mu2c": across[1], "mu1": along[0], "mu2": along[1],
    }  # fmt: skip


@cache
def _frames() -> dict[str, float]:
    n = _release_names()

    def line(compliance: float, k: float, mu: tuple[complex, complex]) -> float:
        product = (mu[0] + mu[1]) * np.conj(mu[0]) * np.conj(mu[1])
        return float(0.5 * compliance * (-(k**2) * product).imag)

    crack, own = (n["mu1c"], n["mu2c"]), (n["mu1"], n["mu2"])
    across, along = line(n["S22"], _K_CL, crack), line(n["S11"], _K_CR, own)
    return {
        "across": across,
        "along": along,
        "ratio": across / along,
        "one_set": line(n["S22"], _K_CL, own) / along,
        "all_crack": line(n["S11"], _K_CL, crack),
        "limit": float(cuts.largest_ratio(8)),
    }


# Peak load ---------------------------------------------------------------------------------------
def _width() -> float:
    """Length under the root that the printed load, toughness and Y belong to, m."""
    return (98.0 * 6.554 / (4.0e6 * 1e-3)) ** 2


def _crack_ratio() -> dict[str, float]:
    from references.analytic.compact_tension import shape_factor

    ratio = brentq(lambda r: float(shape_factor(r)) - 6.554, 0.3, 0.5)
    return {"width": 1e3 * _width(), "ratio": float(ratio)}


def _load() -> tuple[Any]:
    """P from K = P Y/(h sqrt(W)), the definition of Y in ASTM E399."""
    p, k, y, h, width = sp.symbols("P K Y h W", positive=True)
    return (sp.solve(p * y / (h * sp.sqrt(width)) - k, p)[0],)


_R, _W = Verdict.RIGHT, Verdict.WRONG

ENTRIES = [
    Entry("106", "silicon in plane stress, GPa", _R,
          (Form("141.1", digits=True), Form("39.3", digits=True), Form("79.6", digits=True)),
          _silicon, how="the cubic constants, 33 stress set to zero"),
    Entry("107", "fully anisotropic solid, GPa", _W,
          (Form("100.0", digits=True), Form("80.0", digits=True), Form("20.0", digits=True),
           Form("10.0", digits=True), Form("16.7", digits=True),
           Form("33.4", "33.3", off="0.1", digits=True)),
          lambda: (100.0, 80.0, 20.0, 10.0, 100 / 6, 100 / 3),
          how="the ratios of Sect. 2.3.1 with C = 100 GPa",
          readings=("C/3 to the digits printed: 33.3",
                    "twice the rounded C/6 = 16.7: 33.4, which may be how it arose"),
          effect="kink angles move by {rounded:.4f} degrees at most against 33.3, by {exact:.4f} "
          "against C/3", measure=_kink),
    Entry("108", "cortical bone, GPa", Verdict.UNSAID,
          (Form("25.00", digits=True), Form("16.25", digits=True), Form("5.89", digits=True),
           Form("6.65", digits=True)), _bone,
          how="means over the radial and circumferential directions of the stiffnesses usually "
          "quoted from Van Buskirk et al. (all four come out); the source itself was not at hand",
          readings=("radial direction alone: C2222 would be 14.1",
                    "the mean of both, not reduced for a free third direction: as printed"),
          effect="the tensor is one of plane strain, averaged across the long axis; where plane "
          "stress is meant it is too stiff"),
    Entry("109", "energy release rates of bone", Verdict.UNSAID,
          (Form("1/2*S22*Im(-K_cl**2*(mu1c + mu2c)*conj(mu1c)*conj(mu2c))"),
           Form("1/2*S11*Im(-K_cr**2*(mu1 + mu2)*conj(mu1)*conj(mu2))")),
          _release_rates, _release_names, "Irwin's crack closure with Stroh's displacements",
          ("line 2 as printed, crack along the fibres, roots in the material's axes: right",
           "line 1, crack across the fibres, with S2222 in the material's axes (S1111 in the "
           "crack's) and the roots in the crack's axes: right",
           "line 1 with the roots of line 2: the ratio of the two energies is that of K^2 S",
           "line 1 with roots and S2222 both in the crack's axes: too low (last number)"),
          "{across:.1f} and {along:.2f} J/m^2, ratio {ratio:.2f}; one set of roots in both lines "
          "gives the ratio {one_set:.2f}, above the {limit:.2f} that n = 8 allows (w_c2 < 0); "
          "all in the crack's axes line 1 gives {all_crack:.1f} J/m^2",
          _frames, exact=False),
    Entry("110", "theoretical peak load", Verdict.UNSAID, (Form("K*h*sqrt(W)/Y"),), _load,
          lambda: names(K=sp.Symbol("K", positive=True), h=sp.Symbol("h", positive=True),
                        W=sp.Symbol("W", positive=True), Y=sp.Symbol("Y", positive=True)),
          "K = P Y/(h sqrt(W)) of ASTM E399",
          ("the length under the root is W of Fig. 28, a figure: which the text does not give",
           "K_cr at zeta = 0: in the specimen zeta = 0 turns the fibres along the crack, in Sect. "
           "3 across it; each is right in its own frame"),
          "W = {width:.1f} mm and a/W = {ratio:.3f} belong to the printed Y, P, K", _crack_ratio),
]  # fmt: skip
