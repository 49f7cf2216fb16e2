"""The least change of a stiffness that makes given states answer as they should.

Let B be the stiffness that the bonds within a patch have among the particles at the tip, K the
whole one, and C = K⁻¹ at those particles. Forces y that a change ΔB exerts in the state of a mode
move that state to u = u⁰ − C y, whatever ΔB is. So which forces are best is a linear question:

    minimise |u⁰ + … − u_exact|² + μ² yᵀ B⁺ y over y_I, y_II

with what any symmetric ΔB fulfils that leaves alone rigid motions and the stress t along the
crack, which no tip disturbs: y·t = 0, and u_Iᵀ y_II = u_IIᵀ y_I (in which the quadratic terms
cancel, as C is symmetric). The penalty keeps forces small in the energy norm of the bonds that
bear them.

Of all symmetric B' with B' S = G, for the states S = [u_I, u_II, t] and the forces
G = B S + [y_I, y_II, 0], the update of quasi-Newton methods (Broyden, Fletcher, Goldfarb,
Shanno; in block form R. B. Schnabel 1983) is next to B,

    B' = B − B S (SᵀB S)⁻¹ SᵀB + G (SᵀG)⁻¹ Gᵀ.

It is positive semi-definite if SᵀG is positive, that is if the states themselves store energy;
rigid motions strain neither; a stress along the crack exerts the forces that it did.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array

# Share of the largest below which an energy is none.
_NOTHING = 1e-9


def best_forces(
    moved: Array, error: Array, plain: Array, bonds: Array, still: Array, mu: float
) -> Array | None:
    """y_I and y_II, shape (d, 2); None if the bonds bear no force.

    Parameters
    ----------
    moved : ndarray, shape (n, d)
        Displacements of all particles for unit forces at the tip's unknowns.
    error : ndarray, shape (n, 2)
        u⁰ − u_exact of all of them, in units of the exact field's norm.
    plain : ndarray, shape (d, 2)
        u⁰ at the tip's unknowns, in the same units.
    bonds : ndarray, shape (d, d)
        B.
    still : ndarray, shape (d, s)
        States that the change must leave alone.
    mu : float
        Weight of forces, over that of the field's own.
    """
    values, vectors = np.linalg.eigh(bonds)
    kept = values > _NOTHING * values[-1]
    if values[0] < -_NOTHING * values[-1]:
        return None
    # y = L z: forces that the bonds can bear, rigid motions without work; |z|² = yᵀ B⁺ y.
    bear = vectors[:, kept] * np.sqrt(values[kept])
    half = moved @ bear
    energy = np.einsum("im,ij,jm->m", plain, bonds, plain)
    size = bear.shape[1]
    normal = np.zeros((2 * size, 2 * size))
    square = half.T @ half
    for k in range(2):
        part = slice(k * size, (k + 1) * size)
        normal[part, part] = square + mu**2 / energy[k] * np.eye(size)
    right = (half.T @ error).T.ravel()
    alone = (bear.T @ still).T
    none = np.zeros_like(alone)
    mutual = np.concatenate([-bear.T @ plain[:, 1], bear.T @ plain[:, 0]])
    bound = np.vstack([np.hstack([alone, none]), np.hstack([none, alone]), mutual])
    bound /= np.linalg.norm(bound, axis=1, keepdims=True)
    found = np.linalg.solve(normal, np.column_stack([right, bound.T]))
    multiplier = np.linalg.solve(bound @ found[:, 1:], bound @ found[:, 0])
    z = found[:, 0] - found[:, 1:] @ multiplier
    return np.asarray(bear @ z.reshape(2, size).T)


def changed(bonds: Array, states: Array, forces: Array) -> Array | None:
    """B' − B, shape (d, d), for forces that are to be added; None if B' were not positive.

    Parameters
    ----------
    bonds : ndarray, shape (d, d)
    states, forces : ndarray, shape (d, k)
    """
    states, forces = states / (size := np.linalg.norm(states, axis=0)), forces / size
    before = bonds @ states
    after = before + forces
    had, has = states.T @ before, states.T @ after
    has = 0.5 * (has + has.T)
    least = min(np.linalg.eigvalsh(had)[0], np.linalg.eigvalsh(has)[0])
    if least < _NOTHING * np.trace(had):
        return None
    found = after @ np.linalg.solve(has, after.T) - before @ np.linalg.solve(had, before.T)
    return np.asarray(0.5 * (found + found.T))


def stretch(bonds: Array, change: Array) -> tuple[float, float]:
    """Least and greatest of uᵀB'u / uᵀBu."""
    values, vectors = np.linalg.eigh(bonds)
    kept = values > _NOTHING * values[-1]
    scaled = vectors[:, kept] / np.sqrt(values[kept])
    found = 1.0 + np.linalg.eigvalsh(scaled.T @ change @ scaled)
    return float(found[0]), float(found[-1])
