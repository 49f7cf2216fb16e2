"""What the dispersion of the bulk lattice alone does to the frequency of a mode.

For waves that are long against the horizon the lattice's condensed symbol is the solid's acoustic
tensor and a quartic form besides, of the size of (k δ)²:

    S(k) = C(k) + Q(k) + O(k⁶),    Q_ab(k) = Σ_j q_abj k₁^(4−j) k₂^j.

To a smooth mode u of a held body the lattice's operator is therefore L + Q(∂) (i⁴ = 1), and the
first order of perturbation gives its eigenvalue, whatever is done at the edge, so long as that
errs less:

    δ(ω²) = ∫ u_a Q_ab(∂) u_b dA / ∫ ρ u² dA.

Lattices calibrated by uniform strains all have such a Q: another treatment of edges cannot mend it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import legendre

from cmverify.case import Array

# Pairs of components of a symmetric form, and wave numbers (rad a cell) to extrapolate from.
_PAIRS, _LONG = ((0, 0), (0, 1), (1, 1)), (0.1, 0.05)
# Of the polynomials that stand for a shape, and points of Gauss's rule along a side.
_DEGREE, _POINTS = 12, 24


def quartic(voigt: Array, m: float) -> Array:
    """q_abj for ab = 11, 12, 22 and j = 0 … 4, shape (3, 5), over Δx²; in Pa.

    Lattice calibration, constant influence.
    """
    from solver import ElasticTensor, Family
    from solver.material import calibrated
    from solver.material.symbol import acoustic_tensor, condensed_symbol

    family = Family(m, 1.0)
    moduli = calibrated(family, ElasticTensor(voigt), "lattice", None)
    angles = np.linspace(0.0, np.pi, 8, endpoint=False)
    along = np.column_stack([np.cos(angles), np.sin(angles)])
    solid = acoustic_tensor(voigt, along)
    # Errors of the second order in the wave number fall out of two of them.
    coarse, fine = (
        (condensed_symbol(family, moduli, k * along) / k**2 - solid) / k**2 for k in _LONG
    )
    form = (4.0 * fine - coarse) / 3.0
    powers = np.stack([along[:, 0] ** (4 - j) * along[:, 1] ** j for j in range(5)], axis=-1)
    sides = np.column_stack([form[:, a, b] for a, b in _PAIRS])
    return np.asarray(np.linalg.lstsq(powers, sides, rcond=None)[0].T)


def shifts(
    form: Array, shapes: Callable[[Array], Array], side: float, frequencies: Array, density: float
) -> Array:
    """δω/ω of the modes of a square about the origin, over Δx², 1/m².

    Parameters
    ----------
    form : (3, 5) array
        See `quartic`.
    shapes : callable
        (n, 2) points → (count, n, 2) shapes that vanish at the edge.
    side : float, m
    frequencies : (count,) array, rad/s
    density : float
    """
    x, w = legendre.leggauss(_POINTS)
    grid = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    fields = shapes(0.5 * side * grid).reshape(len(frequencies), _POINTS, _POINTS, 2)
    basis = np.eye(_DEGREE + 1)
    root = np.sqrt(w)[:, None]
    fit = np.linalg.pinv(root * legendre.legvander(x, _DEGREE)) * root.T
    slopes = [
        np.stack([legendre.legval(x, legendre.legder(row, k)) for row in basis], axis=-1)
        for k in range(5)
    ]
    weight = np.outer(w, w)
    found = []
    for field, frequency in zip(fields, frequencies, strict=True):
        parts = [field[..., a] for a in (0, 1)]
        known = [fit @ part @ fit.T for part in parts]
        total = 0.0
        for row, (a, b) in zip(form, _PAIRS, strict=True):
            for first, second in {(a, b), (b, a)}:
                for j, coefficient in enumerate(row):
                    curved = slopes[4 - j] @ known[second] @ slopes[j].T
                    total += coefficient * float((weight * parts[first] * curved).sum())
        mass = density * float((weight * (field**2).sum(axis=-1)).sum())
        found.append(total * (2.0 / side) ** 4 / mass / (2.0 * frequency**2))
    return np.array(found)
