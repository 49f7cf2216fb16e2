"""Eqs. 168-172: the heated disc, its temperature, gradient and flux."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from references.errata.algebra import family, names
from references.errata.model import Entry, Form, Verdict

_X, _Y = sp.symbols("x1 x2", real=True)
_D = np.array([[5.0, 2.0], [2.0, 1.0]])


def field(last: Any) -> Any:
    """Eq. 169 with its last coefficient left open."""
    return _X**3 / 5 - _X**2 * _Y + _X * _Y**2 + last * _Y**3


def balance(temperature: Any, tensor: Any = ((5, 2), (2, 1))) -> Any:
    """div(D grad T)."""
    (a, b), (_, d) = tensor
    return sp.expand(
        a * sp.diff(temperature, _X, 2)
        + 2 * b * sp.diff(temperature, _X, _Y)
        + d * sp.diff(temperature, _Y, 2)
    )


@cache
def last_coefficient() -> Any:
    """The one coefficient of x2^3 for which Eq. 169 conducts without sources."""
    last = sp.Symbol("last")
    return sp.solve(sp.Poly(balance(field(last)), _X, _Y).coeffs(), last)[last]


def tensor_of(last: Any) -> sp.Matrix:
    """The conductivity, up to a factor (K22 = 1), of which the field is a solution."""
    a, b = sp.symbols("a b")
    found = sp.solve(sp.Poly(balance(field(last), ((a, b), (b, 1))), _X, _Y).coeffs(), [a, b])
    return sp.Matrix([[found[a], found[b]], [found[b], 1]])


@cache
def solution_as_printed() -> Any:
    """What the boundary values of Eq. 169 as printed lead to in the disc: the exact solution.

    The printed field leaves div(D grad T) = -4 x2/5; (1 - r^2)(A x1 + B x2) takes it away and
    leaves the boundary values alone.
    """
    a, b = sp.symbols("A B")
    printed = field(sp.Rational(1, 5))
    found = printed + (1 - _X**2 - _Y**2) * (a * _X + b * _Y)
    values = sp.solve(sp.Poly(balance(found), _X, _Y).coeffs(), [a, b])
    return sp.expand(found.subs(values))


def particles(cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Particle centres of the unit disc at spacing 1/cells."""
    centres = (np.arange(-cells, cells) + 0.5) / cells
    x, y = np.meshgrid(centres, centres)
    inside = np.hypot(x, y) < 1
    return x[inside], y[inside]


def largest(temperature: Any, second: Any = None, cells: int | None = 100) -> tuple[float, float]:
    """Largest temperature and flux on the particles, or on the circle if `cells` is None."""
    if cells is None:
        angle = np.linspace(0, 2 * np.pi, 7201)
        x, y = np.cos(angle), np.sin(angle)
    else:
        x, y = particles(cells)
    first = sp.diff(temperature, _X)
    slope = sp.diff(temperature, _Y) if second is None else second
    t, d1, d2 = (sp.lambdify((_X, _Y), f)(x, y) for f in (temperature, first, slope))
    size = np.hypot(_D[0, 0] * d1 + _D[0, 1] * d2, _D[1, 0] * d1 + _D[1, 1] * d2)
    return float(t.max()), float(size.max())


def _maxima() -> tuple[float, float]:
    return largest(field(sp.Rational(1, 5)))


@cache
def _disc_effect() -> dict[str, float]:
    solved, printed = largest(field(last_coefficient())), field(sp.Rational(1, 5))
    x, y = particles(100)
    away = sp.lambdify((_X, _Y), solution_as_printed() - printed)(x, y)
    return {
        "t": solved[0],
        "q": solved[1],
        "away": 100 * float(np.max(np.abs(away))) / _maxima()[0],
    }


_SECOND = -(_Y**2) + 2 * _X * _Y + 3 * _Y**2 / 5


def _flux_effect() -> dict[str, float]:
    printed = field(sp.Rational(1, 5))
    return {
        "particles": largest(printed, _SECOND)[1],
        "circle": largest(printed, _SECOND, cells=None)[1],
    }


# The flux from the hotter bonds ------------------------------------------------------------------
def _hotter(m: int) -> dict[str, np.ndarray]:
    """Bonds of a lattice of unit cells to hotter neighbours in a gradient along (0.8, 0.6).

    Isotropic, conductivity 1 on this lattice with its area fractions.  The rise is T_q - T_p.
    """
    xi, alpha = family(m)
    length = np.hypot(*xi.T)
    n = xi / length[:, None]
    k = 4 / np.sum(alpha)
    rise = xi @ np.array([0.8, 0.6])
    hot = rise > 1e-12
    return {"k": k, "rise": rise[hot], "xi": length[hot], "n": n[hot], "alpha": alpha[hot]}


def _hot_names() -> dict[str, Any]:
    bonds = _hotter(5)
    return {**bonds, "over_hotter": lambda f: f @ bonds["n"], "excess": 1 + _excess(5)}


def _excess(m: int) -> float:
    """Sum over all bonds of a family without area fractions over that with them, less one."""
    xi, alpha = family(m)
    return float(len(xi) / alpha.sum() - 1)


def _excesses() -> dict[str, float]:
    return {"coarse": 100 * _excess(3), "fine": 100 * _excess(5)}


@cache
def truncated(layer: float) -> int:
    """Particles of the disc at a/100 behind a layer of some cells whose family the edge cuts."""
    centres = np.arange(-100, 100) + 0.5
    x, y = np.meshgrid(centres, centres)
    free = np.hypot(x, y) < 100 - layer
    outside = np.zeros(np.count_nonzero(free), dtype=bool)
    for i, j in family(5)[0]:
        outside |= np.hypot(x[free] + i, y[free] + j) >= 100
    return int(np.count_nonzero(outside))


def _layer_effect() -> dict[str, float]:
    return {"five": truncated(5.0), "more": truncated(5.5)}


def _principal() -> tuple[Any, Any]:
    values, vectors = np.linalg.eigh(_D)
    return values[1] / values[0], float(np.arctan(vectors[1, 1] / vectors[0, 1]) / np.pi)


def _rounded_ratio() -> float:
    """Quotient of the two eigenvalues at four digits."""
    small, large = np.linalg.eigvalsh(_D)
    return float(f"{large:.4g}") / float(f"{small:.4g}")


def _gradient() -> tuple[Any, Any]:
    printed = field(sp.Rational(1, 5))
    return sp.diff(printed, _X), sp.diff(printed, _Y)


def _symbols() -> dict[str, Any]:
    return names("x1 x2 z1 z2")


_R, _W = Verdict.RIGHT, Verdict.WRONG

ENTRIES = [
    Entry("168", "conductivity of the disc", Verdict.DEFINITION,
          (Form("Matrix([[5, 2], [2, 1]])"),), lambda: (tensor_of(sp.Rational(1, 3)),), _symbols,
          "the only tensor (K22 = 1) for which Eq. 169, corrected, conducts without sources"),
    Entry("Sect. 4.3.1 (ratio)", "anisotropy ratio of the disc", Verdict.UNSAID,
          (Form("33.96", digits=True),), lambda: (_rounded_ratio(),),
          how="quotient of the eigenvalues, each rounded to four digits",
          readings=("17 + 12 sqrt(2): 33.97", "5.828/0.1716, rounded first: 33.96"),
          effect="none: n = 34 allows ratios to 35"),
    Entry("Sect. 4.3.1 (angle)", "angle of the disc's principal axes over pi", _R,
          (Form("0.125", digits=True),), lambda: _principal()[1:], how="eigenvector"),
    Entry("169", "temperature of the disc", _W,
          (Form("x1**3/5 - x1**2*x2 + x1*x2**2 + x2**3/5",
                "x1**3/5 - x1**2*x2 + x1*x2**2 + x2**3/3", off="-2*x2**3/15"),),
          lambda: (field(last_coefficient()),), _symbols,
          "the last coefficient from div(D grad T) = 0",
          ("as printed, D of Eq. 168: div(D grad T) = -4 x2/5",
           "as printed, other principal axes: it solves for D = [[4, 1.7], [1.7, 1]] only",
           "as printed, with a source 4 x2/5: none is mentioned, and Fig. 37 compares with Eq. 136",
           "x2^3/3: right"),
          "boundary values as printed lead to a field up to {away:.1f} % of the largest value "
          "away from the printed one, however fine the grid; the plotted maxima 0.73 and 8.11 are "
          "the printed field's, those of the corrected one {t:.2f} and {q:.2f}", _disc_effect),
    Entry("Sect. 4.3.1 (maxima)", "largest temperature and flux, Figs. 34 and 36",
          Verdict.UNSAID, (Form("0.73", digits=True), Form("8.11", digits=True, truncated=True)),
          _maxima, how="on the 31428 particles, Eq. 169 as printed and its own gradient; 8.1156 "
          "cut off, or the model's own value",
          readings=("of the field of Eq. 169 as printed: right",
                    "with the gradient of Eq. 172 as printed, or of the solution: not")),
    Entry("Sect. 4.3.1 (layer)", "layer with prescribed temperature, cells", _R,
          (Form("a/20"),), lambda: (5 * sp.Symbol("a", real=True) / 100,), lambda: names("a"),
          how="m dx with m = 5, dx = a/100: delta",
          effect="a remark on method: families of partial areas reach m + 1/2 cells (Sect. 2.1), "
          "so {five:.0f} free particles miss neighbours; behind m + 1/2 cells {more:.0f}",
          measure=_layer_effect),
    Entry("170", "heat flux from the hotter bonds", _W,
          (Form("over_hotter(k*rise/xi)", "-over_hotter(alpha*k*rise/xi)",
                ratio="-excess"),),
          lambda: (-np.array([0.8, 0.6]),), _hot_names,
          "Fourier's law on a lattice whose conductivity with area fractions is one",
          ("xi_pq from p to q, as Sect. 2 has it: heat flows uphill",
           "xi_pq from q to p: the sign is right, against the definition of a bond",
           "the magnitude only, which is what Figs. 36 and 37 show: the sign does not matter",
           "dv_q without its area fraction, unlike Eq. 128: too large"),
          "without area fractions the flux is {coarse:.0f} % (m = 3) or {fine:.0f} % (m = 5) too "
          "large in an isotropic body", _excesses,
          exact=False),
    Entry("171", "flux of the disc", _R, (Form("-(5*z1 + 2*z2)"), Form("-(2*z1 + z2)")),
          lambda: tuple(-sp.Matrix([[5, 2], [2, 1]]) * sp.Matrix(sp.symbols("z1 z2", real=True))),
          _symbols, "Eq. 136 with Eq. 168"),
    Entry("172", "temperature gradient of the disc", _W,
          (Form("3*x1**2/5 - 2*x1*x2 + x2**2"),
           Form("-x2**2 + 2*x1*x2 + 3*x2**2/5", "-x1**2 + 2*x1*x2 + 3*x2**2/5",
                off="x1**2 - x2**2")),
          _gradient, _symbols, "derivatives of Eq. 169 as printed",
          ("x2^2 twice, as printed: no term of Eq. 169 gives it", "x1^2 first: right for Eq. 169 "
           "as printed", "x1^2 first and x2^2 without 3/5: right for Eq. 169 corrected"),
          "largest flux {particles:.2f} on the particles and {circle:.2f} on the circle; Fig. 36 "
          "shows 8.11, so it was drawn with the right gradient", _flux_effect),
]  # fmt: skip
