"""Bodies that move, for tests of waves and of their steps."""

import numpy as np

from solver import ElasticTensor, Family, Scene, rectangle
from solver.material import calibrated
from solver.material.symbol import condensed_symbol, symbol
from tests.solver.bodies import FIG_7

DENSITY = 2.0
SOLIDS = {
    "anisotropic": FIG_7,
    "central": ElasticTensor.isotropic(1.0, 1 / 3).voigt,
    "negative": ElasticTensor.isotropic(1.0, 0.4).voigt,
}


def square(n, half=1.0, m=3, voigt=FIG_7, **options):
    settings = {
        "region": rectangle(2 * half, 2 * half),
        "spacing": 2 * half / n,
        "m": m,
        "material": ElasticTensor(voigt),
        "density": DENSITY,
    }
    return Scene(**(settings | options))


def whole_frequency(scene, k, step, branch, inertia=False):
    """ω of the lattice and Verlet together: sin²(ω Δt/2) = λ Δt²/4; and the polarisation."""
    family = Family(scene.m, scene.spacing)
    moduli = calibrated(family, scene.material, "lattice", scene.law)
    scaled = np.asarray(k) * scene.spacing
    if inertia:
        root = np.diag([1.0, 1.0, np.sqrt(6.0)])
        # Rows of the rotation are those of θ, the unknown is θ Δx.
        scale = np.diag([1.0, 1.0, 1.0 / scene.spacing])
        matrix = root @ scale @ symbol(family, moduli, scaled) @ scale @ root
    else:
        matrix = condensed_symbol(family, moduli, scaled)
    values, vectors = np.linalg.eigh(matrix)
    frequency = np.sqrt(values[branch] / scene.density)
    return 2.0 / step * np.arcsin(0.5 * frequency * step), vectors[:, branch]
