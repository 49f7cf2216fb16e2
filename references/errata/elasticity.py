"""Eqs. 43-70: turned tensors and the micro-macro correspondence."""

from __future__ import annotations

import sympy as sp

from references.errata.model import (
    COS,
    HORIZON,
    SIN,
    THICKNESS,
    Entry,
    circle_integral,
    stiffness_symbols,
    turned,
    vanishes,
)

MACRO = stiffness_symbols()
_C11, _C22, _C12, _C66, _C16, _C26 = (
    MACRO[0, 0], MACRO[1, 1], MACRO[0, 1], MACRO[2, 2], MACRO[0, 2], MACRO[1, 2],
)  # fmt: skip
_K11, _K22, _K12, _K66, _K16, _K26 = MICRO = sp.symbols("K11 K22 K12 K66 K16 K26", real=True)
_E11, _E22, _E12 = sp.symbols("e11 e22 e12", real=True)
_XI = sp.symbols("xi", positive=True)


def axial_law(m: tuple[sp.Expr, ...]) -> sp.Expr:
    """Eq. 46, 48 with the six constants 11, 22, 12, 66, 16, 26."""
    c, s = COS, SIN
    return (
        m[0] * c**4 + m[1] * s**4 + (2 * m[2] + 4 * m[3]) * s**2 * c**2
        + 4 * m[4] * c**3 * s + 4 * m[5] * c * s**3
    )  # fmt: skip


def shear_law(m: tuple[sp.Expr, ...]) -> sp.Expr:
    """Eq. 47, 49."""
    c, s = COS, SIN
    return (
        (m[0] + m[1] - 2 * m[2]) * s**2 * c**2
        - 2 * (m[4] - m[5]) * (c**3 * s - c * s**3)
        + m[3] * (c**2 - s**2) ** 2
    )  # fmt: skip


def _strains() -> tuple[sp.Expr, sp.Expr]:
    """Stretch and shear of a bond in a homogeneous strain, from Eqs. 1-2 with no rotation."""
    strain = sp.Matrix([[_E11, _E12], [_E12, _E22]])
    n, t = sp.Matrix([COS, SIN]), sp.Matrix([-SIN, COS])
    eta = strain * n  # relative displacement over the bond's length
    return eta.dot(n), eta.dot(t)


def _energy(influence: sp.Expr | int = 1) -> sp.Expr:
    """W of Eq. 11 for a homogeneous strain: 1/2 h int xi dxi int (xi/2)(kn s^2 + kt g^2) dpsi."""
    stretch, shear = _strains()
    angular = circle_integral(axial_law(MICRO) * stretch**2 + shear_law(MICRO) * shear**2)
    radial = sp.integrate(_XI * _XI / 2 * influence, (_XI, 0, HORIZON))
    return sp.expand(THICKNESS / 2 * radial * angular)


def _printed_energy(factor: sp.Expr) -> sp.Expr:
    """Eq. 55 with h N = factor."""
    a, b, c, d, e, f = MICRO
    return factor * (
        _E11**2 * (19 * a + 3 * b + 12 * d + 2 * c)
        + _E22**2 * (3 * a + 19 * b + 12 * d + 2 * c)
        + 2 * _E11 * _E22 * (a + b + 4 * d + 6 * c)
        + 4 * _E12**2 * (3 * a + 3 * b + 12 * d + 2 * c)
        + 16 * _E11 * _E12 * (3 * e + f)
        + 16 * _E22 * _E12 * (e + 3 * f)
    )


def micromoduli(scale: sp.Expr) -> dict[sp.Symbol, sp.Expr]:
    """Eqs. 65-70."""
    return {
        _K11: 12 * (_C11 - _C66) / scale,
        _K22: 12 * (_C22 - _C66) / scale,
        _K16: 6 * (3 * _C16 - _C26) / scale,
        _K26: 6 * (3 * _C26 - _C16) / scale,
        _K12: 12 * (3 * _C12 - _C66) / scale,
        _K66: 3 * (8 * _C66 - _C11 - _C22 - 2 * _C12) / scale,
    }


SCALE = sp.pi * THICKNESS * HORIZON**3


def _macro_energy() -> sp.Expr:
    strain = sp.Matrix([_E11, _E22, 2 * _E12])
    return sp.expand((strain.T * MACRO * strain)[0] / 2)


def _turning_matrices() -> None:
    c, s = COS, SIN
    q_stress = sp.Matrix(
        [[c**2, s**2, 2 * c * s], [s**2, c**2, -2 * c * s], [-c * s, c * s, c**2 - s**2]]
    )
    q_strain = sp.Matrix(
        [[c**2, s**2, c * s], [s**2, c**2, -c * s], [-2 * c * s, 2 * c * s, c**2 - s**2]]
    )
    frame = sp.Matrix([[c, s], [-s, c]])
    a, b, d = sp.symbols("a b d")
    tensor = frame * sp.Matrix([[a, d], [d, b]]) * frame.T
    pick = sp.Matrix([tensor[0, 0], tensor[1, 1], tensor[0, 1]])
    vanishes(q_stress * sp.Matrix([a, b, d]) - pick, "turned stress")
    double = sp.diag(1, 1, 2)
    vanishes(q_strain * sp.Matrix([a, b, 2 * d]) - double * pick, "turned engineering strain")
    norm = {s: sp.sin(sp.Symbol("psi")), c: sp.cos(sp.Symbol("psi"))}
    product = (q_strain * q_stress.T - sp.eye(3)).subs(norm).applyfunc(sp.simplify)
    vanishes(product, "inverse of Q_strain is the transpose of Q_stress")
    vanishes(q_stress * MACRO * q_stress.T - turned(MACRO), "Eq. 45 against the tensor definition")


def _turned_moduli() -> None:
    here = turned(MACRO)
    constants = (_C11, _C22, _C12, _C66, _C16, _C26)
    vanishes(axial_law(constants) - here[0, 0], "Eq. 46")
    vanishes(shear_law(constants) - here[2, 2], "Eq. 47")


def _bond_strains() -> None:
    stretch, shear = _strains()
    c, s = COS, SIN
    vanishes(stretch - (_E11 * c**2 + _E22 * s**2 + 2 * _E12 * c * s), "Eq. 54, s")
    vanishes(shear - (_E12 * (c**2 - s**2) + (_E22 - _E11) * c * s), "Eq. 54, gamma")


def _energy_densities() -> None:
    c11, c22, c12, c66, c16, c26 = _C11, _C22, _C12, _C66, _C16, _C26
    printed = (
        c11 * _E11**2
        + c22 * _E22**2
        + 2 * c12 * _E11 * _E22
        + 4 * c66 * _E12**2
        + 4 * c16 * _E12 * _E11
        + 4 * c26 * _E12 * _E22
    ) / 2
    vanishes(printed - _macro_energy(), "Eq. 50")
    # Half of a pair's energy |xi| (k_n s^2 + k_t gamma^2)/2 over the area |xi| d|xi| d psi.
    stretch, shear = _strains()
    pair = _XI * (axial_law(MICRO) * stretch**2 + shear_law(MICRO) * shear**2) / 2
    area = sp.integrate(pair / 2 * THICKNESS * _XI, (_XI, 0, HORIZON))
    vanishes(circle_integral(sp.expand(area)) - _energy(), "Eq. 51")


def _energy_of_the_horizon() -> None:
    xi_constant = sp.pi / 384
    vanishes(_energy() - _printed_energy(THICKNESS * HORIZON**3 * xi_constant), "Eqs. 55-57")
    # Another dimensionless influence changes the constant only: 1 - xi/delta makes it a quarter.
    linear = _energy(1 - _XI / HORIZON)
    vanishes(4 * linear - _energy(), "the influence 1 - xi/delta has a quarter of the constant")


def _macro_from_micro() -> None:
    a, b, c, d, e, f = MICRO
    factor = THICKNESS * sp.pi * HORIZON**3 / 192
    printed = {
        _C11: factor * (19 * a + 3 * b + 12 * d + 2 * c),
        _C22: factor * (3 * a + 19 * b + 12 * d + 2 * c),
        _C12: factor * (a + b + 4 * d + 6 * c),
        _C66: factor * (3 * a + 3 * b + 12 * d + 2 * c),
        _C16: factor * 4 * (3 * e + f),
        _C26: factor * 4 * (e + 3 * f),
    }
    vanishes(_macro_energy().subs(printed, simultaneous=True) - _energy(), "Eqs. 58-64")


def _micro_from_macro() -> None:
    vanishes(_energy().subs(micromoduli(SCALE)) - _macro_energy(), "Eqs. 65-70 in the energy")


ENTRIES = [
    Entry(
        "43-45",
        "stress and strain in turned axes",
        "Q_sigma, Q_epsilon; C' = Q_sigma C Q_sigma^T; Q_epsilon^-1 = Q_sigma^T",
        "as printed",
        "confirmed",
        "against C_ijkl turned with four direction cosines",
        _turning_matrices,
    ),
    Entry(
        "46-49",
        "off-axis moduli, and the micromoduli shaped after them",
        "C'1111(psi), C'1212(psi)",
        "as printed",
        "confirmed",
        "against C_ijkl turned with four direction cosines",
        _turned_moduli,
    ),
    Entry(
        "50-51",
        "strain energy density, of the continuum and of the bonds",
        "phi = (C1111 e11^2 + ... + 4 C2212 e12 e22)/2; W = h/4 int |xi|^2 int [...] d|xi|",
        "as printed, with the d psi that Eq. 51 leaves out",
        "confirmed",
        "against eps C eps / 2 and the integral of the pair energies over the horizon",
        _energy_densities,
    ),
    Entry(
        "52-54",
        "bond strains in a homogeneous strain",
        "s = eps_nn, gamma = eps_nt",
        "as printed: gamma is the tensor shear, half of what Q_epsilon (Eq. 44) gives",
        "confirmed",
        "read with the engineering shear of Eq. 44, k_t would come out four times too small",
        _bond_strains,
    ),
    Entry(
        "55-57",
        "energy of the full horizon",
        "W = h delta^3 Xi [...], Xi = pi/384",
        "as printed for Lambda = 1; Xi = pi/1536 for Lambda = 1 - xi/delta",
        "confirmed",
        "integrated over the horizon term by term",
        _energy_of_the_horizon,
    ),
    Entry(
        "58-64",
        "macromoduli from micromoduli",
        "C1111 = h pi delta^3/192 (19 K1111 + 3 K2222 + 12 K1212 + 2 K1122), ...",
        "as printed",
        "confirmed",
        "strain energies agree for every strain",
        _macro_from_micro,
    ),
    Entry(
        "65-70",
        "micromoduli from macromoduli",
        "K1111 = 12 (C1111 - C1212)/(pi h delta^3), ...",
        "as printed (for the integral over a full disc; the lattice sum differs)",
        "confirmed",
        "put into the energy of the horizon they return the six macromoduli",
        _micro_from_macro,
    ),
]
