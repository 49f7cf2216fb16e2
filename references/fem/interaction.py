"""Stress intensity factors of finite-element solutions, for any plane anisotropic tensor.

The interaction integral of `references.analytic.interaction` over the elements of a ring about
the tip.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from skfem.quadrature import get_quadrature_tri

from references.analytic.interaction import intensities
from references.analytic.lekhnitskii import energy_release_rate
from references.fem.elasticity import ElasticSolution
from references.fem.evaluation import ELEMENTS
from references.fem.mesh import Mesh
from references.fem.slit import boundary_edges


@dataclass(frozen=True)
class StressIntensity:
    """K_I, K_II (Pa √m) in the crack's own axes, G (J/m²), and the mesh they were found on."""

    KI: float
    KII: float
    G: float
    mesh: Mesh = field(repr=False, compare=False)


def stress_intensity(
    solution: ElasticSolution, tip: ArrayLike, angle: float, radius: float, inner: float = 0.3
) -> StressIntensity:
    """Stress intensity factors at a crack tip.

    Parameters
    ----------
    solution : ElasticSolution
    tip : pair of float
    angle : float
        Direction in which the crack would advance along itself, rad from axis 1.
    radius : float
        Outer radius of the integration ring; the crack must be straight inside it and no other
        boundary may enter it.
    inner : float
        Inner radius over the outer one.

    Returns
    -------
    StressIntensity

    Raises
    ------
    ValueError
        If the ring is coarser than the mesh, there is no crack tip of the mesh at ``tip``, the
        crack does not arrive there straight and along ``angle`` within ``radius``, or an edge of
        the body or another tip lies within it.
    """
    at = np.asarray(tip, dtype=float)
    if at.shape != (2,) or not np.isfinite(at).all() or not np.isfinite(angle):
        raise ValueError("the tip is a pair of finite coordinates and the angle a finite number")
    distance = np.hypot(*(solution.mesh.tips - at).T)
    if not len(distance) or distance.min() > 1e-6 * radius:
        raise ValueError(f"the mesh has no crack tip at ({at[0]:g}, {at[1]:g})")
    if not 0 < inner < 1:
        raise ValueError("the ring's inner radius must be a fraction of the outer one")
    _require_straight_crack(solution.mesh, at, float(angle), radius)
    ring = _ring_elements(solution, at, inner * radius, radius)
    x, gradient, weight = _quadrature(solution, ring)
    k1, k2 = intensities(solution.voigt, x - at, gradient, weight, angle, inner * radius, radius)
    rate = energy_release_rate(solution.voigt, k1, k2, angle)
    return StressIntensity(k1, k2, rate, solution.mesh)


def _require_straight_crack(
    mesh: Mesh, tip: NDArray[np.float64], angle: float, radius: float
) -> None:
    """Raise ValueError unless the ring holds the body and one straight crack along the angle."""
    others = np.hypot(*(mesh.tips - tip).T)
    if np.any((others > 1e-6 * radius) & (others < radius)):
        raise ValueError("another crack tip lies within the integration ring: use a smaller radius")
    edges = np.sort(boundary_edges(mesh.triangles), axis=1)
    key = np.array([len(mesh.points), 1])
    face = np.isin(edges @ key, np.sort(mesh.boundaries["crack"], axis=1) @ key)
    start, end = (mesh.points[edges[:, i]] - tip for i in range(2))
    along = end - start
    nearest = np.clip(-np.sum(start * along, axis=1) / np.sum(along**2, axis=1), 0, 1)
    near = np.hypot(*(start + nearest[:, None] * along).T) < radius * (1 - 1e-9)
    if np.any(near & ~face):
        raise ValueError(
            "the integration ring leaves the body: an edge that is no crack face lies within its"
            " radius"
        )
    behind = -np.array([np.cos(angle), np.sin(angle)])
    for ends in (start[near], end[near]):
        across = behind[0] * ends[:, 1] - behind[1] * ends[:, 0]
        if np.any(np.abs(across) > 1e-6 * radius) or np.any(ends @ behind < -1e-6 * radius):
            raise ValueError(
                "within the integration ring the crack is not a straight line that arrives at the"
                f" tip along the angle {angle:g}: wrong angle, or a kink or another crack"
            )


def _ring_elements(
    solution: ElasticSolution, tip: NDArray[np.float64], inner: float, outer: float
) -> NDArray[np.int64]:
    corners = solution.mesh.points[solution.triangles]
    r = np.hypot(corners[..., 0] - tip[0], corners[..., 1] - tip[1])
    size = np.ptp(corners, axis=1).max(axis=1)
    chosen = np.flatnonzero((r.max(axis=1) > inner - size) & (r.min(axis=1) < outer + size))
    touched = (r[chosen].min(axis=1) < outer) & (r[chosen].max(axis=1) > inner)
    if not touched.any() or size[chosen][touched].max() > outer - inner:
        raise ValueError(
            "the elements are too large for the integration ring: refine the mesh at the tip or"
            " widen the ring"
        )
    return chosen


def _quadrature(
    solution: ElasticSolution, cells: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Points (k, q, 2), displacement gradients (k, q, 2, 2) and weights (k, q) of elements."""
    reference, weight = get_quadrature_tri(8)
    a, b, c = (solution.mesh.points[solution.triangles[cells, i]] for i in range(3))
    jacobian = np.stack([b - a, c - a], axis=-1)
    inverse = np.linalg.inv(jacobian)
    x = a[:, None] + np.einsum("kij,jq->kqi", jacobian, reference)
    element = ELEMENTS[solution.order]()
    gradient = np.zeros((len(cells), reference.shape[1], 2, 2))
    for i, dofs in enumerate(solution.element_dofs):
        slope = np.broadcast_to(
            np.asarray(element.lbasis(reference, i)[1], float).reshape(2, -1), reference.shape
        )
        in_space = np.einsum("kij,iq->kqj", inverse, slope)
        gradient += solution.values[dofs[cells]][:, None, :, None] * in_space[:, :, None, :]
    return x, gradient, np.abs(np.linalg.det(jacobian))[:, None] * weight
