"""Eqs. 71-78: isotropy, explicit pair energies, turned materials."""

from __future__ import annotations

import sympy as sp

from references.errata.elasticity import MACRO, MICRO, SCALE, axial_law, micromoduli, shear_law
from references.errata.model import COS, SIN, Entry, differs, require, turned, vanishes

_C11, _C22, _C12, _C66, _C16, _C26 = (
    MACRO[0, 0], MACRO[1, 1], MACRO[0, 1], MACRO[2, 2], MACRO[0, 2], MACRO[1, 2],
)  # fmt: skip
_K11, _K22, _K12, _K66, _K16, _K26 = MICRO
_XI, _STRETCH, _SHEAR = sp.symbols("xi s_ gamma", positive=True)


def _isotropic() -> dict[sp.Symbol, sp.Expr]:
    return {_C22: _C11, _C12: _C11 - 2 * _C66, _C16: sp.Integer(0), _C26: sp.Integer(0)}


def _isotropic_micromoduli() -> None:
    special = {k: sp.expand(v.subs(_isotropic())) for k, v in micromoduli(SCALE).items()}
    kn = sp.expand(axial_law(MICRO).subs(special))
    kt = sp.expand(shear_law(MICRO).subs(special))
    angle = {COS: sp.cos(sp.Symbol("psi")), SIN: sp.sin(sp.Symbol("psi"))}
    vanishes(kn.subs(angle) - 12 * (_C11 - _C66) / SCALE, "Eq. 71")
    vanishes(kt.subs(angle) - 12 * (3 * _C66 - _C11) / SCALE, "Eq. 72")
    vanishes(special[_K66] - (special[_K11] - special[_K12]) / 2, "Eq. 72, middle member")


def _sign_of_the_shear_modulus() -> None:
    kt = 12 * (3 * _C66 - _C11)
    stiff = kt.subs({_C11: 1, _C66: sp.Rational(2, 5)})  # C66 > C11/3
    soft = kt.subs({_C11: 1, _C66: sp.Rational(1, 5)})  # C66 < C11/3
    require(stiff > 0 > soft, "k_t >= 0 needs C66 >= C11/3, the reverse of what is printed")
    nu = sp.symbols("nu")
    stress = sp.Rational(1, 2) / (1 + nu) - 1 / (1 - nu**2) / 3
    strain = sp.Rational(1, 2) / (1 + nu) - (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / 3
    for excess, limit in ((stress, sp.Rational(1, 3)), (strain, sp.Rational(1, 4))):
        vanishes(excess.subs(nu, limit), "limit of Poisson's ratio")
        require(excess.subs(nu, limit - sp.Rational(1, 20)) > 0, "k_t > 0 below the limit")
        require(excess.subs(nu, limit + sp.Rational(1, 20)) < 0, "k_t < 0 above the limit")


def _bond_energies(scale: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Eqs. 73-74 with the brackets over `scale` (pi h delta^3)."""
    c, s = COS, SIN
    axial = 6 * _STRETCH**2 * _XI / scale * (
        (_C11 - _C66) * c**4 + (_C22 - _C66) * s**4
        + (4 * _C12 + 6 * _C66 - _C11 - _C22) * s**2 * c**2
        + 2 * (3 * _C16 - _C26) * c**3 * s + 2 * (3 * _C26 - _C16) * c * s**3
    )  # fmt: skip
    shear = sp.Rational(3, 2) * _SHEAR**2 * _XI / scale * (
        4 * (_C11 + _C22 - 6 * _C12) * s**2 * c**2
        + (8 * _C66 - _C11 - _C22 - 2 * _C12) * (c**2 - s**2) ** 2
        - 16 * (_C16 - _C26) * (c**3 * s - c * s**3)
    )  # fmt: skip
    return axial, shear


def _explicit_pair_energies() -> None:
    micro = micromoduli(SCALE)
    axial, shear = _bond_energies(SCALE)
    vanishes(_XI / 2 * _STRETCH**2 * axial_law(MICRO).subs(micro) - axial, "Eq. 73 over pi h d^3")
    vanishes(_XI / 2 * _SHEAR**2 * shear_law(MICRO).subs(micro) - shear, "Eq. 74 over pi h d^3")
    printed = _bond_energies(1 / SCALE)
    differs(sp.Matrix([axial - printed[0], shear - printed[1]]), "Eqs. 73-74 times pi h delta^3")


def _explicit_isotropic_energies() -> None:
    # |xi|/2 (k_n s^2, k_t gamma^2) with the micromoduli of the isotropic tensor, Eqs. 48-49
    special = {k: v.subs(_isotropic()) for k, v in micromoduli(SCALE).items()}
    angle = {COS: sp.cos(sp.Symbol("psi")), SIN: sp.sin(sp.Symbol("psi"))}
    axial, shear = (
        sp.simplify((_XI / 2 * law(MICRO).subs(special) * strain**2).subs(angle))
        for law, strain in ((axial_law, _STRETCH), (shear_law, _SHEAR))
    )
    printed_axial = 6 * SCALE * _STRETCH**2 * _XI * (_C11 - _C66)
    printed_shear = 6 * SCALE * _SHEAR**2 * _XI * (3 * _C66 - _C11)
    differs(axial - printed_axial, "Eq. 75 as printed")
    differs(shear - printed_shear, "Eq. 76 as printed")
    # and the square of the scale is all that is wrong with them
    vanishes(axial * SCALE**2 - printed_axial, "Eq. 75 over (pi h delta^3)^2")
    vanishes(shear * SCALE**2 - printed_shear, "Eq. 76 over (pi h delta^3)^2")


def _angle_of_the_material() -> None:
    zeta = sp.symbols("zeta", real=True)
    own1, own2 = (
        sp.Matrix([sp.cos(zeta), sp.sin(zeta)]),
        sp.Matrix([-sp.sin(zeta), sp.cos(zeta)]),
    )
    axis1, axis2 = sp.Matrix([1, 0]), sp.Matrix([0, 1])
    for value in (sp.Rational(1, 3), sp.Rational(-6, 5)):
        right = sp.arg((own1.dot(axis1) + sp.I * own1.dot(axis2)).subs(zeta, value))
        printed = sp.arg((own1.dot(axis1) + sp.I * own2.dot(axis2)).subs(zeta, value))
        require(abs(float(right - value)) < 1e-14, "Arg(e1'.e1 + i e1'.e2) is the angle")
        require(abs(float(printed) - float(sp.pi) / 4) < 1e-14, "the printed Arg is pi/4 always")


def _laws_turn_with_the_material() -> None:
    # Micromoduli of the turned tensor at psi equal those of the material's own tensor at
    # psi - zeta: Eqs. 48-49 with Eqs. 65-70 commute with rotations.
    zeta, psi = sp.Rational(3, 7), sp.Rational(5, 4)
    own = {_C11: 7, _C22: 3, _C12: 2, _C66: sp.Rational(3, 2), _C16: 0, _C26: 0}
    # turned() gives components in axes turned by psi, so the material turns by minus that.
    back = turned(MACRO).subs({COS: sp.cos(zeta), SIN: -sp.sin(zeta)}).subs(own)
    here = {
        _C11: back[0, 0], _C22: back[1, 1], _C12: back[0, 1],
        _C66: back[2, 2], _C16: back[0, 2], _C26: back[1, 2],
    }  # fmt: skip
    scale = sp.Integer(1)
    for law in (axial_law, shear_law):
        turned_law = law(MICRO).subs(micromoduli(scale)).subs(here)
        own_law = law(MICRO).subs(micromoduli(scale)).subs(own)
        at_psi = turned_law.subs({COS: sp.cos(psi), SIN: sp.sin(psi)})
        at_difference = own_law.subs({COS: sp.cos(psi - zeta), SIN: sp.sin(psi - zeta)})
        require(abs(sp.N(at_psi - at_difference, 40)) < 1e-30, "Eqs. 77-78")


ENTRIES = [
    Entry(
        "71-72",
        "isotropic micromoduli",
        "k_n = 12 (C1111 - C1212)/(pi h delta^3), k_t = 12 (3 C1212 - C1111)/(pi h delta^3)",
        "as printed",
        "confirmed",
        "Eqs. 48-49 lose their angle",
        _isotropic_micromoduli,
    ),
    Entry(
        "Sect. 2.2.1 (after 72)",
        "condition for a non-negative shear micromodulus",
        "k_t >= 0 for C1212 <= C1111/3",
        "k_t >= 0 for C1212 >= C1111/3",
        "wrong",
        "the printed condition holds for nu > 1/3 (plane stress), where k_t < 0; the limits "
        "nu = 1/3 and 1/4 that follow it are right",
        _sign_of_the_shear_modulus,
    ),
    Entry(
        "73-74",
        "explicit pair energies, anisotropic",
        "w_s = 6 s^2 |xi| pi h delta^3 [...]",
        "w_s = 6 s^2 |xi| / (pi h delta^3) [...], likewise w_gamma",
        "wrong",
        "off by (pi h delta^3)^2; the brackets are right",
        _explicit_pair_energies,
    ),
    Entry(
        "75-76",
        "explicit pair energies, isotropic",
        "w_s = 6 pi h delta^3 s^2 |xi| (C1111 - C1212)",
        "w_s = 6 s^2 |xi| (C1111 - C1212) / (pi h delta^3), likewise w_gamma",
        "wrong",
        "off by (pi h delta^3)^2",
        _explicit_isotropic_energies,
    ),
    Entry(
        "Sect. 2.2.1 (before 77)",
        "angle of the material axes",
        "zeta = Arg(e1'.e1 + i e2'.e2)",
        "zeta = Arg(e1'.e1 + i e1'.e2)",
        "wrong",
        "the printed argument is pi/4 for every rotation below pi/2",
        _angle_of_the_material,
    ),
    Entry(
        "77-78",
        "micromoduli of a turned orthotropic material",
        "k_n(psi - zeta), k_t(psi - zeta) with moduli in the material's axes",
        "as printed",
        "confirmed",
        "the micromoduli of the turned tensor at psi are those of the own tensor at psi - zeta",
        _laws_turn_with_the_material,
    ),
]
