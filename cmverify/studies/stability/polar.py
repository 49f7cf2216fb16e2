"""Macro- and micromoduli over the direction, like the paper's Figs. 2 and 3."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cmverify.case import Array
from cmverify.cases.common import materials


@dataclass(frozen=True)
class Polar:
    """Off-axis moduli of a solid over ψ, and the bond moduli that stand for them.

    Attributes
    ----------
    solid : str
    psi : (n,) ndarray, rad
    axial, shear : (n,) ndarrays
        Ĉ1111(ψ) and Ĉ1212(ψ) over the largest Ĉ1111.
    kn, kt : (n,) ndarrays
        Eqs. 48–49 with Eqs. 65–70, over the largest k_n.
    bonds : mapping of a calibration to (angle, k_n, k_t) of its bonds, normalised alike
    """

    solid: str
    psi: Array
    axial: Array
    shear: Array
    kn: Array
    kt: Array
    bonds: Mapping[str, tuple[Array, Array, Array]]


def micromoduli(voigt: Array, horizon: float = 1.0) -> dict[str, float]:
    """The six micromoduli of Eqs. 65–70 for unit thickness, N/m⁵."""
    c11, c22, c12, c66, c16, c26 = voigt[[0, 1, 0, 2, 0, 1], [0, 1, 1, 2, 2, 2]]
    unit = 3.0 / (np.pi * horizon**3)
    return {
        "1111": 4 * unit * (c11 - c66),
        "2222": 4 * unit * (c22 - c66),
        "1112": 2 * unit * (3 * c16 - c26),
        "2212": 2 * unit * (3 * c26 - c16),
        "1122": 4 * unit * (3 * c12 - c66),
        "1212": unit * (8 * c66 - c11 - c22 - 2 * c12),
    }


def functions(voigt: Array, psi: Array, horizon: float = 1.0) -> tuple[Array, Array]:
    """k_n(ψ) and k_t(ψ) of Eqs. 48–49."""
    k = micromoduli(voigt, horizon)
    c, s = np.cos(psi), np.sin(psi)
    kn = (
        k["1111"] * c**4
        + k["2222"] * s**4
        + (2 * k["1122"] + 4 * k["1212"]) * (c * s) ** 2
        + 4 * (k["1112"] * c**2 + k["2212"] * s**2) * c * s
    )
    kt = (
        (k["1111"] + k["2222"] - 2 * k["1122"]) * (c * s) ** 2
        + k["1212"] * (c * c - s * s) ** 2
        + 2 * (k["2212"] - k["1112"]) * c * s * (c * c - s * s)
    )
    return kn, kt


def off_axis(voigt: Array, psi: Array) -> tuple[Array, Array]:
    """Ĉ1111(ψ) and Ĉ1212(ψ): stiffness to a stretch along ψ and a shear of it."""
    c, s = np.cos(psi), np.sin(psi)
    stretch = np.array([c * c, s * s, 2 * c * s])
    shear = np.array([-c * s, c * s, c * c - s * s])
    axial = np.einsum("an,ab,bn->n", stretch, voigt, stretch)
    return axial, np.einsum("an,ab,bn->n", shear, voigt, shear)


def polar(solid: str, voigt: Array, m: float = 5, count: int = 361) -> Polar:
    """Curves of the closed forms and the bonds of every calibration that has any."""
    from cmverify.cases.common.materials import CALIBRATIONS
    from solver import CalibrationError, ElasticTensor, Family
    from solver.material import ElasticModuli, calibrate

    psi = np.linspace(0.0, 2 * np.pi, count)
    axial, shear = off_axis(voigt, psi)
    family = Family(m)
    kn, kt = functions(voigt, psi, family.horizon)
    scale = np.abs(kn).max()
    bonds: dict[str, tuple[Array, Array, Array]] = {}
    for calibration in CALIBRATIONS:
        try:
            moduli = calibrate(family, ElasticTensor(voigt), calibration)
        except CalibrationError:
            continue
        assert isinstance(moduli, ElasticModuli)
        bonds[calibration] = (family.angle, moduli.normal / scale, moduli.shear / scale)
    top = axial.max()
    return Polar(solid, psi, axial / top, shear / top, kn / scale, kt / scale, bonds)


def over_poisson(count: int = 141) -> dict[str, tuple[Array, Array]]:
    """Fig. 3: C1111, C1212 over E and 𝒦1111, 𝒦1212 over 12 E/(π h δ³), plane stress, over ν."""
    nu = np.linspace(-0.9, 0.49, count)
    tensors = np.array([materials.isotropic(v) for v in nu])
    unit = 12.0 / np.pi
    k = [micromoduli(voigt) for voigt in tensors]
    return {
        "$C_{1111}/E$": (nu, tensors[:, 0, 0]),
        "$C_{1212}/E$": (nu, tensors[:, 2, 2]),
        "$\\mathcal{K}_{1111}\\pi h\\delta^3/12E$": (nu, np.array([v["1111"] for v in k]) / unit),
        "$\\mathcal{K}_{1212}\\pi h\\delta^3/12E$": (nu, np.array([v["1212"] for v in k]) / unit),
    }
