"""Eqs. 1-37: pair energies, actions, momentum balance and the assembled stiffness."""

from __future__ import annotations

import sympy as sp

from references.errata.model import COS, SIN, Entry, differs, require, vanishes

_U, _UP = sp.Matrix(sp.symbols("u1 u2 theta")), sp.Matrix(sp.symbols("u1' u2' theta'"))
_LENGTH = sp.symbols("xi", positive=True)
_KN, _KT, _KB, _ATTENUATION = sp.symbols("k_n k_t k_b Lambda", positive=True)
_NORMAL, _TANGENT = sp.Matrix([COS, SIN]), sp.Matrix([-SIN, COS])


def _measures() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Stretch, shear and curvature of a bond, Eqs. 1-3."""
    eta = (_UP - _U)[:2, :]
    stretch = eta.dot(_NORMAL) / _LENGTH
    shear = eta.dot(_TANGENT) / _LENGTH - (_U[2] + _UP[2]) / 2
    return stretch, shear, (_UP[2] - _U[2]) / _LENGTH


def _pair_energy() -> sp.Expr:
    """Eq. 4."""
    s, g, x = _measures()
    return _LENGTH / 2 * (_KN * s**2 + _KT * g**2 + _KB * x**2) * _ATTENUATION


def _measures_are_objective() -> None:
    stretch, shear, curvature = _measures()
    turn, d1, d2 = sp.symbols("omega d1 d2")
    rigid = {
        _U[0]: d1,
        _U[1]: d2,
        _U[2]: turn,
        _UP[0]: d1 - turn * _LENGTH * SIN,
        _UP[1]: d2 + turn * _LENGTH * COS,
        _UP[2]: turn,
    }
    for measure in (stretch, shear, curvature):
        vanishes(sp.expand(measure.subs(rigid)).subs(SIN**2, 1 - COS**2), "rigid motion of a bond")


def _actions_follow_from_the_energy() -> None:
    eta_n, eta_t, turn = sp.symbols("eta_n eta_t vartheta")
    mean = sp.symbols("theta_mean")
    s, g, x = eta_n / _LENGTH, eta_t / _LENGTH - mean, turn / _LENGTH
    for k, measure, variable in ((_KN, s, eta_n), (_KT, g, eta_t), (_KB, x, turn)):
        part = _LENGTH / 2 * k * measure**2 * _ATTENUATION
        action = _ATTENUATION * k * measure
        vanishes(sp.diff(part, variable) - action, "derivative by the relative displacement")
        strain = sp.symbols("e")
        per_length = k * strain**2 * _ATTENUATION / 2
        vanishes(
            sp.diff(per_length, strain).subs(strain, measure) - action,
            "derivative of the energy per unit distance",
        )


def _balance_follows_from_the_energy() -> None:
    # In 1/2 of the double integral every pair stands twice, so the variation at x is the
    # derivative of the whole pair energy.
    energy = _pair_energy()
    s, g, x = _measures()
    force = _ATTENUATION * (_KN * s * _NORMAL + _KT * g * _TANGENT)
    moment = _ATTENUATION * (_KT / 2 * g * _LENGTH + _KB * x)
    for k in range(2):
        vanishes(-sp.diff(energy, _U[k]) - force[k], "force density, Eq. 19")
    vanishes(-sp.diff(energy, _U[2]) - moment, "moment density, Eq. 20")


def _operator() -> tuple[sp.Matrix, sp.Matrix, sp.Matrix]:
    """R, B (Eq. 27) and D (Eq. 29) of the pair (p, q)."""
    xi = _LENGTH
    block = sp.Matrix([[COS, SIN, 0], [-SIN, COS, 0], [0, 0, 1]])
    rotation = sp.diag(block, block)
    compatibility = sp.Matrix(
        [[-2, 0, 0, 2, 0, 0], [0, -2, -xi, 0, 2, -xi], [0, 0, -2, 0, 0, 2]]
    ) / (2 * xi)
    return rotation, compatibility, _ATTENUATION * sp.diag(_KN, _KT, _KB)


def _compatibility_matrix() -> None:
    rotation, compatibility, _ = _operator()
    got = compatibility * rotation * sp.Matrix([*_U, *_UP])
    vanishes(got - sp.Matrix(_measures()), "B R v against Eqs. 1-3")


def _assembled_stiffness() -> None:
    rotation, b, d = _operator()
    half = _LENGTH / 2 * rotation.T * b.T * d * b * rotation
    # The pair (q, p): its bond points backwards, its first particle is q.
    turn = {COS: -COS, SIN: -SIN}
    swapped = half.xreplace(turn)
    order = [3, 4, 5, 0, 1, 2]
    assembled = half + swapped.extract(order, order)
    unordered = sp.hessian(_pair_energy(), [*_U, *_UP])
    vanishes((assembled - unordered).applyfunc(sp.expand), "K of Eq. 37 against the pair energy")
    differs(half - unordered, "one ordered pair alone carries half the stiffness")


def _mass_of_a_particle() -> None:
    # A square of 12x12 unit cells of unit density: twice its kinetic energy at unit speed is its
    # area.  m = 5, offsets within m + 1/2 cells (Sect. 2.1).
    side = range(12)
    cells = {(i, j) for i in side for j in side}
    offsets = [
        (i, j)
        for i in range(-5, 6)
        for j in range(-5, 6)
        if (i, j) != (0, 0) and i * i + j * j < 5.5**2
    ]
    families = {p: sum((p[0] + i, p[1] + j) in cells for i, j in offsets) for p in cells}
    by_particle, by_pair = len(families), sum(families.values())
    require(by_particle == len(side) ** 2, "summed over particles, Eq. 30, the mass is the body's")
    require(by_pair > 50 * by_particle, "summed over pairs, Eq. 36, it is not")
    require(max(families.values()) == 96, "a full family at m = 5")


def _rotational_inertia() -> None:
    dx, rho, rate, x, y = sp.symbols("dx rho Omega x y", positive=True)
    cell = (x, -dx / 2, dx / 2), (y, -dx / 2, dx / 2)
    kinetic = sp.integrate(rho * rate**2 * (x**2 + y**2) / 2, *cell) / dx**2
    vanishes(kinetic - rho * dx**2 / 6 * rate**2 / 2, "kinetic energy density of a turning cell")
    differs(kinetic - rho * rate**2 / 2, "the density in the place of the moment of inertia")
    # The printed ratio changes with the unit of length, so no unit can make it right.
    ratio = sp.simplify(rho * rate**2 / 2 / kinetic)
    require(ratio.has(dx), "the printed inertia is not a density of moment of inertia")


ENTRIES = [
    Entry(
        "1-3",
        "bond stretch, shear and curvature",
        "s = eta.n/|xi|, gamma = eta.t/|xi| - (theta + theta')/2, chi = (theta' - theta)/|xi|",
        "as printed, with t = n turned by +90 degrees",
        "confirmed",
        "all three vanish in any rigid motion",
        _measures_are_objective,
    ),
    Entry(
        "4-10",
        "pair energy and pair actions",
        "w = |xi|/2 (kn s^2 + kt gamma^2 + kb chi^2) Lambda; f = Lambda k (measure)",
        "as printed, where the middle members differentiate the energy per unit distance w/|xi| "
        "and Eq. 7 differentiates by the relative rotation theta' - theta",
        "confirmed",
        "both derivatives of each part give Eqs. 8-10",
        _actions_follow_from_the_energy,
    ),
    Entry(
        "11-22",
        "energy density and balance of momentum",
        "W = 1/2 int w dx', force and moment densities of Eqs. 19 and 20",
        "as printed; an unordered pair carries the whole w, that is |xi|/2 (kn s^2 + kt gamma^2)",
        "confirmed",
        "minus the derivative of the pair energy by u, theta is Eq. 19, Eq. 20",
        _balance_follows_from_the_energy,
    ),
    Entry(
        "27",
        "compatibility matrix of a pair",
        "B = 1/(2|xi|) [[-2,0,0,2,0,0],[0,-2,-|xi|,0,2,-|xi|],[0,0,-2,0,0,2]]",
        "as printed",
        "confirmed",
        "B R v gives Eqs. 1-3 for any bond direction",
        _compatibility_matrix,
    ),
    Entry(
        "31",
        "rotational inertia of a particle",
        "P = diag(rho, rho, rho)",
        "P = diag(rho, rho, rho dx^2/6) for a square cell (or no inertia where rotations are "
        "condensed)",
        "wrong",
        "natural frequencies depend on the unit of length as printed; Eq. 14 has the same term",
        _rotational_inertia,
    ),
    Entry(
        "36",
        "assembled mass and load (also Eqs. 38, 131, 133)",
        "M = assembly over all pairs (p, q) of P_p dv_p",
        "M = assembly over particles p of P_p dv_p, as Eqs. 30 and 32 sum",
        "wrong",
        "read literally a particle's mass counts once for each neighbour: 96 times at m = 5",
        _mass_of_a_particle,
    ),
    Entry(
        "37",
        "assembled stiffness (also Eqs. 33, 34, 175)",
        "K = sum over ordered pairs of |xi|/2 [R^T B^T D B R alpha dv dv]",
        "as printed: both orders of a pair together carry |xi|",
        "confirmed",
        "half of it (each unordered pair once) gives frequencies 29 % low",
        _assembled_stiffness,
    ),
]
