"""The strains of a bond (Eqs. 1–3), written once: what it feels of the values at its ends.

A bond from p to q has the normal n, the tangent t (n turned by +90°) and the length ℓ:

    s = n·(u_q − u_p)/ℓ                            stretch (Eq. 1)
    γ = t·(u_q − u_p)/ℓ − (a_p θ_p + a_q θ_q)/ℓ    shear (Eq. 2)
    χ = (θ_q − θ_p)/ℓ                              bending (Eq. 3), of polar solids only
    g = (T_q − T_p)/ℓ                              gradient of a temperature or potential

The sum s + γ is a strain, too: as k (s + γ)² = k s² + 2 k s γ + k γ² it couples both, which chiral
solids need, and no kernel learns of it.

The arms a_p, a_q say how far each rotation carries the bond's point of contact, its middle: half
the length each for a whole bond. A bond that ends at the surface keeps that point
(`solver.bonds.ended`).

Everything here is ℓ times a strain, so that a bond without length has finite rows. The scalar
functions serve kernels and arrays alike.
"""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np

from ..arrays import Array

# Inlined where they are used, so that nothing of them is kept on disk.
_INLINE: Any = {"inline": "always"}


@nb.njit(**_INLINE)
def stretched(n1: Any, n2: Any, d1: Any, d2: Any) -> Any:
    """ℓ s of a difference d = u_q − u_p."""
    return n1 * d1 + n2 * d2


@nb.njit(**_INLINE)
def sheared(n1: Any, n2: Any, d1: Any, d2: Any, turn: Any) -> Any:
    """ℓ γ of a difference d = u_q − u_p and a turn a_p θ_p + a_q θ_q."""
    return n1 * d2 - n2 * d1 - turn


@nb.njit(**_INLINE)
def bent(d3: Any) -> Any:
    """ℓ χ of a difference θ_q − θ_p of rotations."""
    return d3


def elongations(strains: tuple[str, ...], normal: Array, difference: Array, turn: Array) -> Array:
    """ℓ times each strain of some bonds, shape (strains, ...).

    Parameters
    ----------
    strains : tuple of {"s", "γ", "s+γ", "χ", "g"}
    normal : ndarray, shape (2, ...)
    difference : ndarray, shape (components, ...)
        Values at q less those at p.
    turn : ndarray, shape (...)
        a_p θ_p + a_q θ_q, m.
    """
    (n1, n2), d = normal, difference
    found = []
    for strain in strains:
        if strain == "s":
            found.append(stretched.py_func(n1, n2, d[0], d[1]))
        elif strain == "γ":
            found.append(sheared.py_func(n1, n2, d[0], d[1], turn))
        elif strain == "s+γ":
            both = stretched.py_func(n1, n2, d[0], d[1])
            found.append(both + sheared.py_func(n1, n2, d[0], d[1], turn))
        elif strain == "χ":
            found.append(bent.py_func(d[2]) + 0.0 * n1)
        elif strain == "g":
            found.append(d[0] + 0.0 * n1)
        else:
            raise ValueError(f"unknown strain {strain!r} of a bond; known: s, γ, s+γ, χ, g")
    return np.stack(np.broadcast_arrays(*found))


def directions(strains: tuple[str, ...], normal: Array) -> Array:
    """Vectors along which the force of each strain acts, or its flow runs.

    n for s and g, t for γ, n + t for s + γ, none for χ, which exerts a couple alone; `normal` has
    shape (2, ...),
    the result (strains, 2, ...).
    """
    n1, n2 = normal
    tangent = np.stack([-n2, n1])
    along = {"γ": tangent, "s+γ": normal + tangent, "χ": np.zeros_like(normal)}
    return np.stack([along.get(strain, np.asarray(normal)) for strain in strains])


def end_rows(
    strains: tuple[str, ...], scales: Array, normal: Array, end: float, arm: Array
) -> Array:
    """The share of one end in ℓ times each strain, shape (strains, components, k).

    Parameters
    ----------
    strains : tuple of str
    scales : ndarray, shape (components,)
        Of the unknowns, see `solver.material.physics.Physics.scales`.
    normal : ndarray, shape (2, k)
    end : float
        −1 where the bond starts, 1 where it ends.
    arm : ndarray, shape (k,), m
    """
    rows = np.empty((len(strains), len(scales), normal.shape[1]))
    for c, scale in enumerate(scales):
        value = np.zeros((len(scales), normal.shape[1]))
        value[c] = 1.0 / scale
        turn = arm * value[2] if len(scales) > 2 else np.zeros_like(arm)
        rows[:, c] = elongations(strains, normal, end * value, turn)
    return rows


def homogeneous_stretch(normal: Array) -> Array:
    """v_s: s = v_s·(ε11, ε22, 2ε12) in a homogeneous strain (Eqs. 52–54), shape (3, n)."""
    return _homogeneous("s", normal)


def homogeneous_shear(normal: Array) -> Array:
    """v_γ: γ = v_γ·(ε11, ε22, 2ε12) in a homogeneous strain without rotation, shape (3, n)."""
    return _homogeneous("γ", normal)


def _homogeneous(strain: str, normal: Array) -> Array:
    n1, n2 = normal
    zero = np.zeros_like(n1)
    # ε·n for the three unit strains: differences of the displacements over the length.
    units = (np.array([n1, zero]), np.array([zero, n2]), 0.5 * np.array([n2, n1]))
    return np.concatenate([elongations((strain,), normal, unit, zero) for unit in units])
