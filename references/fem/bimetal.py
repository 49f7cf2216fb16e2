"""A strip of two layers under a temperature, plane stress, by quadratic rectangles.

The layers expand differently and bend the strip (S. Timoshenko 1925). Elements are refined towards
the ends, where the interface meets the free edge and stress is singular.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import skfem
from numpy.typing import ArrayLike, NDArray

from references.fem.elasticity import strain
from references.linear import factorise

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Layers:
    """A strip of length L and thickness H about the origin, in two layers of half of it each.

    Attributes
    ----------
    length, height : float
    lower, upper : (3, 3) arrays
        Stiffness of the layers, Pa.
    lower_strain, upper_strain : (3,) arrays
        What each would be strained by alone: e11, e22, 2 e12.
    """

    length: float
    height: float
    lower: ArrayLike
    upper: ArrayLike
    lower_strain: ArrayLike
    upper_strain: ArrayLike

    def curvature(self) -> float:
        """Of a long strip of isotropic layers, Timoshenko's: 1/radius, positive if u2,11 > 0."""
        young = [
            1 / np.linalg.inv(np.asarray(c, dtype=float))[0, 0] for c in (self.lower, self.upper)
        ]
        n = young[0] / young[1]
        misfit = np.asarray(self.lower_strain)[0] - np.asarray(self.upper_strain)[0]
        return float(24 * misfit / (self.height * (14 + n + 1 / n)))


def displacement(layers: Layers, points: ArrayLike, across: int = 16) -> Floats:
    """u at points, (n, 2): zero and without rotation at the middle.

    Parameters
    ----------
    layers : Layers
    points : (n, 2) array
    across : int
        Elements across the thickness, an even number.
    """
    half, h = layers.length / 2, layers.height / across
    steps = [0.0]
    size = 0.1 * h
    while steps[-1] + size < half:
        steps.append(steps[-1] + size)
        size = min(1.3 * size, 1.5 * h)
    inner = np.array(steps) * (half / (steps[-1] + size))
    x = np.concatenate([inner - half, [0.0], half - inner[::-1]])
    y = np.linspace(-layers.height / 2, layers.height / 2, across + 1)
    mesh = skfem.MeshQuad.init_tensor(x, y)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2()), intorder=4)
    upper = basis.global_coordinates()[1] > 0
    c = np.where(upper, np.asarray(layers.upper)[..., None, None],
                 np.asarray(layers.lower)[..., None, None])  # fmt: skip
    e = np.where(upper, np.asarray(layers.upper_strain)[:, None, None],
                 np.asarray(layers.lower_strain)[:, None, None])  # fmt: skip

    @skfem.BilinearForm
    def elastic(u, v, w):  # type: ignore[no-untyped-def]
        return np.einsum("ij...,j...,i...->...", c, strain(u), strain(v))

    @skfem.LinearForm
    def thermal(v, w):  # type: ignore[no-untyped-def]
        return np.einsum("ij...,j...,i...->...", c, e, strain(v))

    matrix, force = elastic.assemble(basis), thermal.assemble(basis)
    # Three components at two nodes: what they hold bears nothing.
    at = basis.doflocs
    first = np.nonzero(np.hypot(*at) < 1e-12)[0]
    second = np.nonzero((np.abs(at[1]) < 1e-12) & (np.abs(at[0] - half) < 1e-12))[0]
    held = np.concatenate([first, second[1:]])
    free = np.setdiff1d(np.arange(len(force)), held)
    u = np.zeros(len(force))
    u[free] = factorise(matrix[free][:, free]).solve(force[free])
    # Component by component: scikit-fem 10 cannot probe vectors.
    probe = basis.with_element(skfem.ElementQuad2()).probes(np.asarray(points, dtype=float).T)
    return np.stack([probe @ u[basis.split_indices()[k]] for k in (0, 1)], axis=-1)
