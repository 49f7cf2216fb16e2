"""Eqs. 176-181: thermal expansion and bending micromoduli."""

from __future__ import annotations

import sympy as sp

from references.errata.model import (
    COS,
    HORIZON,
    SIN,
    THICKNESS,
    Entry,
    circle_integral,
    differs,
    vanishes,
)


def _free_expansion() -> None:
    a11, a22, a12, rise, kn, kt = sp.symbols("A11 A22 A12 T k_n k_t", positive=True)
    expansion = sp.Matrix([[a11, a12], [a12, a22]])
    n, t = sp.Matrix([COS, SIN]), sp.Matrix([-SIN, COS])
    eta = expansion * n * rise  # free expansion, per length of the bond, without rotation
    along, across = (n.T * expansion * n)[0], (t.T * expansion * n)[0]
    vanishes(kn * (eta.dot(n) - along * rise), "f_n of Eq. 176 in free expansion")
    differs(kt * eta.dot(t), "f_t of Eq. 9 in free expansion")
    vanishes(kt * (eta.dot(t) - across * rise), "f_t with gamma - n.A.t T")
    isotropic = {a22: a11, a12: 0}
    vanishes(across.subs(isotropic), "isotropic expansion needs no correction of gamma")


def _bending_moduli() -> None:
    k1, k2, e1, e2, c1, c2, xi = sp.symbols("k31 k32 E31 E32 chi1 chi2 xi", positive=True)
    law = k2 + (k1 - k2) * COS**2
    curvature = c1 * COS + c2 * SIN  # (theta' - theta)/|xi| in a homogeneous gradient
    # For cos^2 the law is k1 cos^2 + k2 sin^2; written so that the integral is homogeneous.
    angular = circle_integral((k1 * COS**2 + k2 * SIN**2) * curvature**2)
    vanishes((law - k1 * COS**2 - k2 * SIN**2).subs(SIN**2, 1 - COS**2), "n = 2 law")
    energy = THICKNESS / 2 * sp.integrate(xi * xi / 2, (xi, 0, HORIZON)) * angular
    scale = sp.pi * THICKNESS * HORIZON**3
    micro = {k1: 3 * (3 * e1 - e2) / scale, k2: 3 * (3 * e2 - e1) / scale}
    vanishes(energy.subs(micro, simultaneous=True) - (e1 * c1**2 + e2 * c2**2) / 2, "Eqs. 180-181")


ENTRIES = [
    Entry(
        "176",
        "thermal expansion of a bond",
        "f_n = k_n (s - alpha_T T), f_t unchanged",
        "f_n = k_n (s - n.A.n T) and f_t = k_t (gamma - n.A.t T)",
        "wrong",
        "with anisotropic expansion a freely expanding body is not stress-free as printed",
        _free_expansion,
    ),
    Entry(
        "179-181",
        "bending micromoduli, n = 2",
        "k3131 = 3 (3 E3131 - E3232)/(pi h delta^3)",
        "as printed",
        "confirmed",
        "put into the curvature energy of the horizon they return E",
        _bending_moduli,
    ),
]
