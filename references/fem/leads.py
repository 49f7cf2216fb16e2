"""Electrical conduction between leads on a rectangle, by scikit-fem: -div(sigma grad V) = 0.

Leads are rectangles whose edges, like a slit's, run along the lines of a regular mesh, so that
each is a whole number of elements: what it feeds in, or holds, is exact.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import skfem
from numpy.typing import ArrayLike, NDArray
from skfem.helpers import dot, grad

from references.analytic.conduction import checked_conductivity
from references.fem.conduction import ConductionSolution
from references.fem.evaluation import ELEMENTS, check_order, to_skfem
from references.fem.listening import listened
from references.fem.mesh import Mesh
from references.fem.restraint import require_temperature
from references.fem.slit import boundary_edges, split_along
from references.linear import solve_with_prescribed

__all__ = ["Lead", "LeadSolution", "plate_between_leads"]


@dataclass(frozen=True)
class Lead:
    """A rectangle with a current or a potential.

    Attributes
    ----------
    x0, y0, x1, y1 : float
        Corners, m.
    current : float, optional
        A per m of thickness, fed in evenly.
    potential : float, optional
        V.
    """

    x0: float
    y0: float
    x1: float
    y1: float
    current: float | None = None
    potential: float | None = None

    def __post_init__(self) -> None:
        if (self.current is None) == (self.potential is None):
            raise ValueError("a lead has either a current or a potential")

    def holds(self, x: NDArray, y: NDArray, margin: float) -> NDArray[np.bool_]:
        """Points within the rectangle, its edges included."""
        inside = (x > self.x0 - margin) & (x < self.x1 + margin)
        return np.asarray(inside & (y > self.y0 - margin) & (y < self.y1 + margin))


@dataclass
class LeadSolution(ConductionSolution):
    """Potentials, and the heat that the current makes.

    Attributes
    ----------
    heat : float
        W per m of thickness: the current between two leads of given potentials times their
        difference.
    """

    heat: float = 0.0


@listened
def plate_between_leads(
    width: float,
    height: float,
    size: float,
    conductivity: ArrayLike,
    leads: Sequence[Lead],
    slit: tuple[tuple[float, float], tuple[float, float]] | None = None,
    order: int = 2,
) -> LeadSolution:
    """Potential in an insulated rectangle about the origin.

    Parameters
    ----------
    width, height : float
        m, whole numbers of `size`.
    size : float
        Side of the mesh's squares, each cut into two triangles.
    conductivity : (2, 2) array_like
        S/m; symmetric positive definite.
    leads : sequence of Lead
        Without any of given potential the currents must cancel; the potential then vanishes at
        the node nearest to the lower left corner.
    slit : ((x, y), (x, y)), optional
        Along a line of the mesh; an end on the edge of the plate opens there.
    order : {1, 2}

    Raises
    ------
    ValueError
        If an edge of a lead, or the slit, does not run along the mesh, or currents do not cancel.
    """
    check_order(order)
    tensor = checked_conductivity(conductivity)
    mesh = _mesh(width, height, size, slit)
    for lead in leads:
        _require_on_mesh((lead.x0, lead.x1), width, size)
        _require_on_mesh((lead.y0, lead.y1), height, size)
    triangulation, _ = to_skfem(mesh)
    basis = skfem.Basis(triangulation, ELEMENTS[order]())

    @skfem.BilinearForm
    def conduction(u, v, w):  # type: ignore[no-untyped-def]
        return dot(np.einsum("ij,j...->i...", tensor, grad(u)), grad(v))

    @skfem.LinearForm
    def feed(v, w):  # type: ignore[no-untyped-def]
        return 1.0 * v

    load, values = np.zeros(basis.N), np.full(basis.N, np.nan)
    nodes, margin = basis.doflocs.T, 1e-6 * size
    centres = mesh.points[mesh.triangles].mean(axis=1)
    for lead in leads:
        if lead.potential is not None:
            values[lead.holds(nodes[:, 0], nodes[:, 1], margin)] = lead.potential
            continue
        assert lead.current is not None
        inside = np.flatnonzero(lead.holds(centres[:, 0], centres[:, 1], 0.0))
        area = (lead.x1 - lead.x0) * (lead.y1 - lead.y0)
        part = skfem.Basis(triangulation, ELEMENTS[order](), elements=inside)
        load += feed.assemble(part) * (lead.current / area)
    if np.isnan(values).all():
        if abs(load.sum()) > 1e-9 * np.abs(load).sum():
            raise ValueError("no lead has a potential, and the currents do not cancel")
        values[np.argmin(nodes.sum(axis=1))] = 0.0
    require_temperature(nodes, basis.element_dofs, ~np.isnan(values))
    stiffness = conduction.assemble(basis)
    solution, unknowns = solve_with_prescribed(stiffness, load, values)
    return LeadSolution(
        mesh=mesh,
        order=order,
        nodes=nodes,
        values=solution,
        element_dofs=basis.element_dofs,
        triangles=triangulation.t.T,
        conductivity=tensor,
        unknowns=unknowns,
        heat=float(solution @ (stiffness @ solution)),
    )


def _require_on_mesh(values: Sequence[float], side: float, size: float) -> None:
    lines = (np.asarray(values) + side / 2) / size
    if np.abs(lines - np.rint(lines)).max() > 1e-6:
        raise ValueError(f"{values} does not lie on lines of the mesh, {size} apart")


def _mesh(
    width: float,
    height: float,
    size: float,
    slit: tuple[tuple[float, float], tuple[float, float]] | None,
) -> Mesh:
    _require_on_mesh((width / 2,), width, size)
    _require_on_mesh((height / 2,), height, size)
    x, y = (np.linspace(-s / 2, s / 2, round(s / size) + 1) for s in (width, height))
    regular = skfem.MeshTri.init_tensor(x, y)
    points, triangles = regular.p.T.copy(), regular.t.T.astype(np.int64)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    clockwise = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    boundaries: dict[str, NDArray[np.int64]] = {}
    if slit is not None:
        (x0, y0), (x1, y1) = slit
        _require_on_mesh((x0, x1), width, size)
        _require_on_mesh((y0, y1), height, size)
        if (x0 != x1) == (y0 != y1):
            raise ValueError("the slit must run along x or along y")
        box = Lead(min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1), current=0.0)
        on = box.holds(points[:, 0], points[:, 1], 1e-6 * size)
        edges = regular.facets.T.astype(np.int64)
        points, triangles, _ = split_along(points, triangles, edges[on[edges].all(axis=1)])
    boundaries["edge"] = boundary_edges(triangles)
    return Mesh(points, triangles, boundaries, ("edge",), float(size))
