"""In-plane natural frequencies of a homogeneous rectangle by quadratic finite elements."""

from dataclasses import dataclass, field

import numpy as np
import skfem
from numpy.typing import ArrayLike, NDArray

from references.analytic.voigt import checked_voigt
from references.eigen import elastic_part, smallest_eigenpairs
from references.fem.elasticity import component_dofs, elastic_forms
from references.fem.evaluation import Field, check_order
from references.fem.listening import listened
from references.fem.mesh import Mesh, rectangle
from references.fem.restraint import rigid_motions


@dataclass(frozen=True)
class Modes:
    """Frequencies with their shapes.

    Attributes
    ----------
    frequencies : (count,) float array
        Circular, rad/s, ascending; rigid motions left out.
    nodes : (n, 2) float array
    shapes : (count, n, 2) float array
        Mass-normalised.
    unknowns : int
    """

    frequencies: NDArray[np.float64]
    nodes: NDArray[np.float64]
    shapes: NDArray[np.float64]
    unknowns: int
    _field: Field | None = field(default=None, repr=False)

    def at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Shapes (count, n, 2) at points (n, 2)."""
        if self._field is None:
            raise ValueError("these modes know no mesh")
        return np.moveaxis(self._field.at(points).reshape(-1, len(self.shapes), 2), 0, 1)


@listened
def in_plane_modes(
    mesh: Mesh,
    voigt: ArrayLike,
    density: float,
    count: int,
    clamped: tuple[str, ...] = (),
    order: int = 2,
) -> Modes:
    """Lowest elastic modes of a plane body.

    Parameters
    ----------
    mesh : Mesh
    voigt : (3, 3) array_like
        Pa; order 11, 22, 12.
    density : float
        kg/m³ (per unit depth).
    count : int
        Number of elastic modes; the three rigid motions of a free body do not count.
    clamped : tuple of str
        Boundaries that do not move; none: free-free.
    order : {1, 2}

    Returns
    -------
    Modes

    Raises
    ------
    ValueError
        For bad material data, more modes than unknowns, or a body part of which can move without
        strain though it is clamped, or beside the rest.
    """
    check_order(order)
    tensor = checked_voigt(voigt)
    if not np.isfinite(density) or density <= 0:
        raise ValueError(f"the density must be positive, not {density}")
    if count < 1:
        raise ValueError("at least one mode must be asked for")
    for name in clamped:
        mesh.nodes(name)
    basis, facets, stiffness = elastic_forms(mesh, tensor, order)

    @skfem.BilinearForm
    def inertia(u, v, w):  # type: ignore[no-untyped-def]
        return density * (u[0] * v[0] + u[1] * v[1])

    mass = inertia.assemble(basis)
    free = np.ones(basis.N, dtype=bool)
    for name in clamped:
        free[basis.get_dofs(facets[name]).flatten()] = False
    dofs = component_dofs(basis)
    nodes = basis.doflocs[:, dofs[:, 0]].T
    owner = np.empty(basis.N, dtype=np.int64)
    owner[dofs] = np.arange(len(dofs))[:, None]
    rigid = rigid_motions(nodes, owner[basis.element_dofs[::2]], ~free[dofs])
    if count + rigid >= free.sum() - 1:
        raise ValueError(f"{count} modes are too many for {free.sum()} unknowns: use a finer mesh")
    k, m = stiffness[free][:, free], mass[free][:, free]
    # a shift of the size of the first eigenvalue: rigid motions stay well separated from it
    extent = np.ptp(mesh.points, axis=0).max()
    shift = -float(np.linalg.eigvalsh(tensor)[0] / (density * extent**2))
    values, vectors = smallest_eigenpairs(k, m, count + rigid, shift)
    frequencies = elastic_part(values, rigid)
    full = np.zeros((basis.N, count))
    full[free] = vectors[:, rigid:]
    shapes = np.moveaxis(full[dofs], -1, 0)
    values = np.moveaxis(shapes, 0, 1).reshape(len(nodes), -1)
    elements = owner[basis.element_dofs[::2]]
    return Modes(
        frequencies=frequencies,
        nodes=nodes,
        shapes=shapes,
        unknowns=int(free.sum()),
        _field=Field(mesh, order, nodes, values, elements, basis.mesh.t.T),
    )


def in_plane_frequencies(
    voigt: ArrayLike,
    width: float,
    height: float,
    density: float,
    count: int,
    free: bool = True,
    elements: int = 24,
    order: int = 2,
) -> NDArray[np.float64]:
    """Circular natural frequencies of a rectangle, rad/s.

    Parameters
    ----------
    voigt : (3, 3) array_like
        Pa; order 11, 22, 12 with engineering shear.
    width, height : float
        m.
    density : float
        kg/m³.
    count : int
        Elastic modes wanted (rigid motions of a free body are left out).
    free : bool
        All edges free, or all edges clamped.
    elements : int
        Elements along the longer side.
    order : {1, 2}

    Returns
    -------
    (count,) float array, ascending

    Examples
    --------
    A square with C11 − C12 = 1, ρ = 1 has Lamé's mode at ω = π/L exactly:

    >>> voigt = [[1.5, 0.5, 0.0], [0.5, 1.5, 0.0], [0.0, 0.0, 1.0]]
    >>> w = in_plane_frequencies(voigt, 1.0, 1.0, 1.0, 8, elements=8)
    >>> bool(abs(w - np.pi).min() < 1e-3)
    True
    """
    if elements < 1:
        raise ValueError("at least one element along the longer side")
    mesh = rectangle(width, height, max(width, height) / elements)
    clamped = () if free else mesh.outer
    return in_plane_modes(mesh, voigt, density, count, clamped, order).frequencies
