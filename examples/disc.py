"""Heat in the anisotropic unit disc: error of three calibrations under refinement.

Run with: python examples/disc.py
"""

import numpy as np

from solver import ConductivityTensor, Cosine, Scene, Support, disc


def exact(x, y):
    """exp(x - 2y) cos y solves div(D grad T) = 0 for D = [[5, 2], [2, 1]]."""
    return np.exp(x - 2 * y) * np.cos(y)


for calibration in ("continuum", "lattice", "positive"):
    for n in (25, 50):
        scene = Scene(
            region=disc(1.0),
            spacing=1 / n,
            material=ConductivityTensor([[5, 2], [2, 1]]),
            calibration=calibration,
            law=None if calibration == "lattice" else Cosine(34),
            supports=[Support.layer(cells=5.5, temperature=exact)],
        )
        solution = scene.solve(tolerance=1e-12)
        free = ~solution.prescribed
        truth = exact(*solution.points[free].T)
        error = np.linalg.norm(solution.temperature[free] - truth) / np.linalg.norm(truth)
        print(f"{calibration:<10} a/{n:<4} {error:.1e}")
