"""Eqs. 86-91: the tetrachiral block lattice and its frequencies."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from references.errata.algebra import names
from references.errata.model import Entry, Form, Verdict

_KN, _KT, _TAN = sp.symbols("Kn Kt tan", positive=True)
_COS2, _SIN2, _SINCOS = 1 / (1 + _TAN**2), _TAN**2 / (1 + _TAN**2), _TAN / (1 + _TAN**2)


@cache
def interface() -> tuple[Any, Any]:
    """K_n and K_t of a thin bed between rigid blocks in plane stress.

    Hooke's law in three dimensions: rigid blocks forbid strain along the bed, the thickness
    direction is free; shear as Young's modulus in tension and compression at 45 degrees gives it.
    """
    e, nu, strain = sp.symbols("E nu strain", positive=True)
    normal, along, length, thick = sp.symbols("sn st b mu", positive=True)
    stress = sp.solve(
        [(normal - nu * along) / e - strain, (along - nu * normal) / e], [normal, along]
    )
    shear = sp.Symbol("shear", positive=True)
    # Pure shear: principal stresses +tau and -tau, whose strain is half of the shear angle.
    tau = sp.solve((normal + nu * normal) / e - shear / 2, normal)[0]
    return (
        sp.simplify(stress[normal] / strain) * length / thick,
        sp.simplify(tau / shear) * length / thick,
    )


@cache
def lattice_stiffness() -> sp.Matrix:
    """Voigt stiffness of one block and its two interfaces over the pitch squared."""
    e11, e22, e12, phi = sp.symbols("e11 e22 e12 phi")
    strain, energy = sp.Matrix([[e11, e12], [e12, e22]]), sp.Integer(0)
    for along in (sp.Matrix([1, 0]), sp.Matrix([0, 1])):
        across = sp.Matrix([-along[1], along[0]])
        # Jump at the midpoint of two centroids one pitch apart, over that pitch; all blocks turn
        # by phi against the macrorotation. The interface's normal is turned by beta.
        jump = strain * along - phi * across
        a, b = jump.dot(along), jump.dot(across)
        normal2 = a**2 * _COS2 + 2 * a * b * _SINCOS + b**2 * _SIN2
        tangent2 = a**2 * _SIN2 - 2 * a * b * _SINCOS + b**2 * _COS2
        energy += (_KN * normal2 + _KT * tangent2) / 2
    relaxed = sp.together(energy.subs(phi, sp.solve(sp.diff(energy, phi), phi)[0]))
    symbols, weight = (e11, e22, e12), (1, 1, sp.Rational(1, 2))
    return sp.Matrix(
        3, 3,
        lambda i, j: sp.factor(sp.diff(relaxed, symbols[i], symbols[j]) * weight[i] * weight[j]),
    )  # fmt: skip


def _names() -> dict[str, Any]:
    cos2b = _COS2 - _SIN2
    return names(
        Kn=_KN, Kt=_KT, cos=sp.sqrt(_COS2), sin=_TAN * sp.sqrt(_COS2), cos2b=cos2b,
        cos4b=2 * cos2b**2 - 1, sin2b=2 * _SINCOS, b=sp.Symbol("b", positive=True),
        mu=sp.Symbol("mu", positive=True), E=sp.Symbol("E", positive=True),
        nu=sp.Symbol("nu", positive=True),
    )  # fmt: skip


@cache
def frequencies(count: int = 6, elements: int = 12) -> dict[str, np.ndarray]:
    """Free circular frequencies, rad/s: the blocks, the homogenised square, and as printed."""
    from references.analytic.tetrachiral import effective_voigt
    from references.fem.modes import in_plane_frequencies
    from references.lattice.blocks import BlockLattice, paper_cell

    cell = paper_cell()
    kn, kt, _ = cell.springs
    right = effective_voigt(kn, kt, cell.angle)
    printed = right.copy()
    printed[0, 0] = printed[1, 1] = printed_modulus(kn, kt, cell.angle)
    side = 25 * cell.pitch

    def solid(voigt: np.ndarray) -> np.ndarray:
        return in_plane_frequencies(
            voigt, side, side, cell.effective_density, count, elements=elements
        )

    return {
        "blocks": BlockLattice(cell, 25, 25).frequencies(count),
        "corrected": solid(right),
        "printed": solid(printed),
    }


def printed_modulus(kn: float, kt: float, beta: float) -> float:
    """C1111 of Eq. 87 as printed."""
    top = (kn - kt) ** 2 * np.cos(4 * beta) - (kn**2 + 14 * kn * kt + kt**2)
    return float(top / (8 * ((kn - kt) * np.cos(4 * beta) - (kn + kt))))


def _too_low() -> dict[str, float]:
    found = frequencies()
    low = 100 * (1 - found["printed"] / found["blocks"])
    exact = 100 * np.abs(found["corrected"] / found["blocks"] - 1)
    return {"least": low.min(), "most": low.max(), "corrected": exact.max()}


def _motion_names() -> dict[str, Any]:
    w, k, m = sp.symbols("w K M", real=True)
    shape = sp.Symbol("shape", real=True)
    return names(K=k, M=m, w=w, shape=shape, eigenvalue=w**2)


def _harmonic() -> tuple[Any, Any]:
    """K v + M d2v/dt2 for v = shape exp(i w t), over that; and what the pencil's roots are."""
    known, time = _motion_names(), sp.Symbol("time", real=True)
    v = known["shape"] * sp.exp(sp.I * known["w"] * time)
    residual = (known["M"] * sp.diff(v, time, 2) + known["K"] * v) / sp.exp(
        sp.I * known["w"] * time
    )
    value = sp.Symbol("value")
    root = sp.solve(known["K"] - value * known["M"], value)[0]
    return sp.simplify(residual), root.subs(known["K"], known["M"] * known["w"] ** 2)


_R, _W = Verdict.RIGHT, Verdict.WRONG
_TOP = "((Kn - Kt)**2*cos4b - (Kn**2 + 14*Kn*Kt + Kt**2))"


def _entry(number: str, title: str, form: str, place: tuple[int, int]) -> Entry:
    return Entry(number, title, _R, (Form(form),), lambda: (lattice_stiffness()[place],), _names,
                 "energy of one block and two interfaces, the block's turn relaxed")  # fmt: skip


ENTRIES = [
    Entry("86", "stiffness of an interface", _R,
          (Form("b/mu*E/(1 - nu**2)"), Form("b/(2*mu)*E/(1 + nu)")), interface, _names,
          "Hooke's law with no strain along the bed; a bed in pure shear"),
    Entry("87", "C1111 of the block lattice", _W,
          (Form(f"{_TOP}/(8*((Kn - Kt)*cos4b - (Kn + Kt)))",
                f"{_TOP}/(8*((Kn - Kt)*cos2b - (Kn + Kt)))",
                ratio="((Kn - Kt)*cos2b - (Kn + Kt))/((Kn - Kt)*cos4b - (Kn + Kt))"),),
          lambda: (lattice_stiffness()[0, 0],), _names,
          "energy of one block and its two interfaces, the block's turn relaxed",
          ("cos 4 beta twice, as printed: not the energy of the cell with the other three moduli, "
           "nor with the block's turn held, nor with beta measured from the other axis",
           "cos 2 beta below: right"),
          "free frequencies {least:.0f} to {most:.0f} % below those of the 25 x 25 blocks; "
          "corrected within {corrected:.1f} %", _too_low),
    _entry("88", "C1212 of the block lattice", "1/2*(Kn*sin**2 + Kt*cos**2)", (2, 2)),
    _entry("89", "C1122 of the block lattice",
           "-(Kn - Kt)**2*cos**2*sin**2/(2*(Kt*cos**2 + Kn*sin**2))", (0, 1)),
    Entry("90", "C1112 and C2212 of the block lattice", _R,
          (Form("1/4*(Kn - Kt)*sin2b"), Form("-(1/4*(Kn - Kt)*sin2b)")),
          lambda: (lattice_stiffness()[0, 2], lattice_stiffness()[1, 2]), _names,
          "energy of one block and its two interfaces, the block's turn relaxed"),
    Entry("91", "eigenvalue problem", Verdict.NOTATION,
          (Form("(K - w**2*M)*shape"), Form("w", "eigenvalue", off="w - w**2")),
          _harmonic, _motion_names, "Eq. 35 with v = shape exp(i w t)",
          ("the equation: right; its eigenvalues are the squares of the circular frequencies",)),
]  # fmt: skip
