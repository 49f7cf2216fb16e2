"""Eqs. 79-85: the tip of a crack in an anisotropic body, stress and rotation of a section."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from references.errata import tensors
from references.errata.algebra import COS, SIN, circle_integral, family, names, particles_in_disc
from references.errata.model import Entry, Form, Verdict

_MU = sp.Symbol("mu", real=True)
_COMPLIANCE = sp.Matrix(3, 3, sp.symbols("S11 S12 S16 S12 S22 S26 S16 S26 S66", real=True))
#: Sect. 2.3.1 with C = 1.
TENSOR = np.array([[1, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])


def _wave_strain() -> sp.Matrix:
    """Strain of the stress function F(x + mu y) over F'': stress is mu^2, 1, -mu."""
    return _COMPLIANCE * sp.Matrix([_MU**2, 1, -_MU])


def _compatibility() -> tuple[Any]:
    e11, e22, shear = _wave_strain()
    return (sp.expand(_MU**2 * e11 + e22 - _MU * shear),)


def _potentials() -> tuple[Any, Any]:
    """u1 = p F', u2 = q F': the strains u1,1 = p F'' and u2,2 = mu q F''."""
    e11, e22, _ = _wave_strain()
    return e11, sp.expand(e22 / _MU)


def roots(coefficients: list[float]) -> np.ndarray:
    """The two roots of a real quartic with the larger imaginary parts."""
    found = np.roots(coefficients)
    return found[np.argsort(found.imag)][2:]


def _stroh(tensor: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Eigenvalues, A and B of Stroh's six-(here four-)dimensional problem, from the stiffness."""
    place = {(0, 0): 0, (1, 1): 1, (0, 1): 2, (1, 0): 2}
    c = np.array([[[[tensor[place[i, j], place[k, m]] for m in range(2)] for k in range(2)]
                   for j in range(2)] for i in range(2)])  # fmt: skip
    q, r, t = c[:, 0, :, 0], c[:, 0, :, 1], c[:, 1, :, 1]
    inverse = np.linalg.inv(t)
    n = np.block([[-inverse @ r.T, inverse], [r @ inverse @ r.T - q, -r @ inverse]])
    values, vectors = np.linalg.eig(n)
    upper = np.argsort(values.imag)[2:]
    return values[upper], vectors[:2, upper], vectors[2:, upper]


def tip_displacement(tensor: np.ndarray, r: float, omega: float, k: np.ndarray) -> np.ndarray:
    """Displacement at a crack tip with sigma_22 = K_I, sigma_12 = K_II over sqrt(2 pi r) ahead.

    Stroh's form u = sqrt(2 r/pi) Re[A <sqrt(cos + mu sin)> B^-1 (K_II, K_I)]; nothing of
    Lekhnitskii's compliances, roots or p, q enters.
    """
    mu, a, b = _stroh(tensor)
    function = np.diag(np.sqrt(np.cos(omega) + mu * np.sin(omega)))
    field = a @ function @ np.linalg.inv(b) @ np.array([k[1], k[0]])
    return np.sqrt(2 * r / np.pi) * np.real(field)


_POINTS = ((0.3, 0.4), (1.2, -2.0), (0.7, 3.0))
_LOADS = np.array([0.7, -1.3])


def _tip_names() -> dict[str, Any]:
    s = np.linalg.inv(TENSOR)
    mu = roots([s[0, 0], -2 * s[0, 2], 2 * s[0, 1] + s[2, 2], -2 * s[1, 2], s[1, 1]])
    p = s[0, 0] * mu**2 + s[0, 1] - s[0, 2] * mu
    q = s[0, 1] * mu + s[1, 1] / mu - s[1, 2]
    radius, omega = np.array(_POINTS).T
    return {
        "KI": _LOADS[0], "KII": _LOADS[1], "r": radius, "pi": np.pi, "sqrt": np.sqrt,
        "Re": np.real, "cos": np.cos(omega), "sin": np.sin(omega), "mu1": mu[0], "mu2": mu[1],
        "p1": p[0], "p2": p[1], "q1": q[0], "q2": q[1],
    }  # fmt: skip


def _tip(component: int) -> tuple[np.ndarray]:
    return (np.array([tip_displacement(TENSOR, r, w, _LOADS)[component] for r, w in _POINTS]),)


def _tip_form(letter: str) -> str:
    root = "sqrt(cos + mu{0}*sin)"
    one, two = root.format(1), root.format(2)
    return (
        f"KI*sqrt(2*r/pi)*Re(1/(mu1 - mu2)*(mu1*{letter}2*{two} - mu2*{letter}1*{one}))"
        f" + KII*sqrt(2*r/pi)*Re(1/(mu1 - mu2)*({letter}2*{two} - {letter}1*{one}))"
    )


@cache
def printed_roots() -> dict[str, float]:
    """Displacement at r = a, over the circle, with the roots of Eq. 79 as printed."""
    s = np.linalg.inv(TENSOR)
    constant = s[1, 1] - 2 * s[1, 2]
    mu = roots([s[0, 0] - 2 * s[0, 2], 0.0, 2 * s[0, 1] + s[2, 2], 0.0, constant])
    p = s[0, 0] * mu**2 + s[0, 1] - s[0, 2] * mu
    q = s[0, 1] * mu + s[1, 1] / mu - s[1, 2]
    worst = {}
    for name, load in (("opening", (1.0, 0.0)), ("sliding", (0.0, 1.0))):
        omega = np.linspace(-np.pi, np.pi, 73)
        right = np.array([tip_displacement(TENSOR, 1.0, w, np.array(load)) for w in omega])
        root = np.sqrt(np.cos(omega)[:, None] + mu * np.sin(omega)[:, None])
        parts = []
        for f in (p, q):
            one, two = f[0] * root[:, 0], f[1] * root[:, 1]
            combined = load[0] * (mu[0] * two - mu[1] * one) + load[1] * (two - one)
            parts.append(np.sqrt(2 / np.pi) * np.real(combined / (mu[0] - mu[1])))
        error = np.linalg.norm(np.array(parts).T - right, axis=1).max()
        worst[name] = float(100 * error / np.linalg.norm(right, axis=1).max())
    return worst


# The stress of a section -----------------------------------------------------------------------
_STRAIN = np.array([[0.9, 0.35], [0.35, -0.4]])


def section_sums(m: int, strain: np.ndarray) -> dict[str, np.ndarray]:
    """Traction on a section normal to axis 1 of a homogeneously strained lattice of unit cells.

    k_n = 1 and k_t = 1/3 in every bond.  The work-conjugate stress dW/d eps, the bonds that cross
    the section of one cell with their area fractions, and the same without.
    """
    xi, alpha = family(m)
    stress = {name: np.zeros(2) for name in ("conjugate", "crossing", "bare")}
    for (i, j), part in zip(xi.astype(int), alpha, strict=True):
        bond = np.array([i, j]) / np.hypot(i, j)
        across = np.array([-bond[1], bond[0]])
        force = (bond @ strain @ bond) * bond + (across @ strain @ bond) / 3 * across
        stress["conjugate"] += 0.5 * part * force * i
        for a in range(-i + 1, 1):
            for b in range(-2 * m - 4, 2 * m + 5):
                if -i < 2 * (b * i - a * j) <= i:  # crosses within half a cell of the particle
                    stress["crossing"] += part * force
                    stress["bare"] += force
    return stress


def _section_names() -> dict[str, Any]:
    sums = section_sums(3, _STRAIN)
    return {"A": 0.25, "f_dv_dv": 0.25 * sums["bare"], "alpha_f_dv_dv": 0.25 * sums["crossing"],
            "missing": sums["bare"] - sums["crossing"]}  # fmt: skip


@cache
def without_fractions() -> dict[str, float]:
    """By how much the section's traction is too large without area fractions, per cent."""
    errors: dict[int, list[float]] = {3: [], 5: []}
    for m, found in errors.items():
        for strain in ([[1, 0], [0, 0]], [[0, 0], [0, 1]], [[0, 1], [1, 0]], [[1, 0], [0, 1]],
                       _STRAIN):  # fmt: skip
            sums = section_sums(m, np.array(strain, dtype=float))
            size = np.linalg.norm(sums["conjugate"])
            excess = np.linalg.norm(sums["bare"] - sums["conjugate"])
            found.append(float(100 * excess / size))
    return {"low": min(errors[3]), "high": max(errors[3]), "fine": max(errors[5])}


def _rotation() -> tuple[Any, Any]:
    """The rotation that balances the couples of a homogeneous gradient, and Sect. 2's sign."""
    turn, theta = sp.symbols("turn theta", real=True)
    strain_t = tensors.bond_strains()[1]
    couple = circle_integral(tensors.shear_law(tensors.MICRO) * (strain_t + turn - theta))
    balanced = sp.solve(couple, theta)[0]
    return (sp.simplify(balanced),) * 2


def _rotation_names() -> dict[str, Any]:
    x, y, turn = sp.symbols("x y turn", real=True)
    u1 = tensors.E11 * x + (tensors.E12 - turn) * y
    u2 = (tensors.E12 + turn) * x + tensors.E22 * y
    return names("x y turn", u1=u1, u2=u2, x=x, y=y)


def _largest_count(cells: int) -> dict[str, int]:
    shifts = np.linspace(0.0, 0.5, 26)
    counts = [particles_in_disc(cells, (a, b)) for a in shifts for b in shifts]
    return {"least": min(counts), "most": max(counts)}


_R, _W = Verdict.RIGHT, Verdict.WRONG
_QUARTIC = "S11*mu**4 - 2*S16*mu**{0} + (2*S12 + S66)*mu**2 - 2*S26{1} + S22"


def _compliance_names() -> dict[str, Any]:
    return names("S11 S22 S12 S66 S16 S26 mu")


ENTRIES = [
    Entry("79", "Lekhnitskii's characteristic equation", _W,
          (Form(_QUARTIC.format(4, ""), _QUARTIC.format(3, "*mu"),
                off="2*S16*mu**3 - 2*S16*mu**4 + 2*S26*mu - 2*S26"),),
          _compatibility, _compliance_names,
          "compatibility of the strains of a stress function F(x + mu y)",
          ("exponent and factor as extracted: the roots are not those of Eqs. 80-82",
           "S1112 mu^4 and a bare S2212 in other axes: no turn of the axes removes an odd power",
           "mu^3 and S2212 mu, as in Lekhnitskii's book: right"),
          "no effect for orthotropic axes; in the paper's material displacements at the tip err by "
          "{opening:.0f} % (mode I) and {sliding:.0f} % (mode II)", printed_roots),
    Entry("80", "displacement u1 at a crack tip", _R, (Form(_tip_form("p")),), lambda: _tip(0),
          _tip_names, "Stroh's formalism, from stiffnesses; K_I and K_II stand ahead of the tip",
          exact=False),
    Entry("81", "displacement u2 at a crack tip", _R, (Form(_tip_form("q")),), lambda: _tip(1),
          _tip_names, "Stroh's formalism, from stiffnesses; K_I and K_II stand ahead of the tip",
          exact=False),
    Entry("82", "p and q", _R, (Form("S11*mu**2 + S12 - S16*mu"), Form("S12*mu + S22/mu - S26")),
          _potentials, _compliance_names, "strains of a stress function F(x + mu y)"),
    Entry("83", "force through a section", Verdict.INCOMPLETE,
          (Form("1/A*f_dv_dv", "1/A*alpha_f_dv_dv", off="missing"),),
          lambda: (section_sums(3, _STRAIN)["conjugate"],), _section_names,
          "dW/d eps of a homogeneously strained lattice",
          ("f_pq dv_p dv_q with p the particle of the section: the double sum runs over q- and q+, "
           "so the indices are meant to be theirs",
           "all bonds through (or ending at) the section, each with its area fraction as in "
           "Eq. 33: exactly the work-conjugate stress"),
          "without area fractions the stress of a homogeneous strain is {low:.0f} to {high:.0f} % "
          "too large at m = 3 (up to {fine:.0f} % at m = 5)", without_fractions, exact=False),
    Entry("84", "normal and shear stress", Verdict.DEFINITION,
          (Form("(n.T*(S*n))[0]"), Form("(t.T*(S*n))[0]")),
          lambda: ((tensors.FRAME * _stress_symbols() * tensors.FRAME.T)[0, 0],
                   (tensors.FRAME * _stress_symbols() * tensors.FRAME.T)[1, 0]),
          lambda: names(S=_stress_symbols(), n=sp.Matrix([COS, SIN]), t=sp.Matrix([-SIN, COS])),
          "components of the stress in axes n*, t*"),
    Entry("85", "rotation in the local limit", _R,
          (Form("1/2*(diff(u2, x) - diff(u1, y))"), Form("-1/2*(diff(u1, y) - diff(u2, x))")),
          _rotation, _rotation_names,
          "the rotation at which the couples of a homogeneous gradient vanish, law of Eq. 49"),
]  # fmt: skip


def _stress_symbols() -> sp.Matrix:
    a, b, d = sp.symbols("t11 t22 t12", real=True)
    return sp.Matrix([[a, d], [d, b]])
