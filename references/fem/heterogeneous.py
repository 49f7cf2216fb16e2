"""The tetrachiral lattice as the paper's finite elements see it: rigid squares, meshed interfaces.

All interfaces are alike, so one of them is meshed with eight-node quadratic elements, condensed
onto the motions of its two blocks (6×6) and assembled for all. :func:`full_frequencies` meshes
every interface instead; on a small lattice it verifies the condensation.

The interfaces take their room from the blocks, which are squares of side a − t between centroids
of pitch ℓ; blocks and interfaces have the same density.
"""

from dataclasses import dataclass

import numpy as np
import skfem
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csr_matrix, hstack

from references.eigen import RIGID_MOTIONS, elastic_frequencies
from references.fem.elasticity import component_dofs, strain
from references.fem.mesh_record import MeshRecord
from references.lattice.blocks import BlockLattice, TetrachiralCell
from references.linear import factorise


@dataclass(frozen=True)
class CondensedInterface:
    """Stiffness and mass (6, 6) of an interface between blocks at (−ℓ/2, 0) and (ℓ/2, 0).

    Attributes
    ----------
    stiffness, mass : (6, 6) float arrays
    nodes, elements : int
        Of its mesh.
    """

    stiffness: NDArray[np.float64]
    mass: NDArray[np.float64]
    nodes: int
    elements: int


def interface_grid(cell: TetrachiralCell, across: int) -> skfem.MeshQuad:
    """Rectangles on t × b about the origin, normal along axis 1, refined towards all edges.

    ``across`` elements span the thickness, ever thinner towards the faces; along the length they
    grow by a factor two at most from the corners, where the stress is singular, up to 4 t.
    """
    if across < 2 or across % 2:
        raise ValueError("an even number of elements across the thickness, two at least")
    half = across // 2
    # geometric: each layer twice as thick as its outer neighbour
    layers = 2.0 ** np.arange(half)
    layers *= cell.thickness / 2 / layers.sum()
    outer = np.concatenate([[0], np.cumsum(layers)]) - cell.thickness / 2
    x = np.concatenate([outer, -outer[-2::-1]])
    steps, here = [0.0], layers[0]
    while steps[-1] + here < cell.contact / 2:
        steps.append(steps[-1] + here)
        here = min(2 * here, 4 * cell.thickness)
    ends = np.array(steps) * (cell.contact / 2) / (steps[-1] + here)
    y = np.concatenate([ends - cell.contact / 2, [0.0], cell.contact / 2 - ends[::-1]])
    return skfem.MeshQuad.init_tensor(x, y)


def interface_record(cell: TetrachiralCell, across: int) -> MeshRecord:
    """Provenance of the mesh of one interface (see :func:`interface_grid`)."""
    grid = interface_grid(cell, across)
    corners = grid.p[:, grid.t]
    return MeshRecord.of_grid(grid.p.T, grid.t.T, float(np.ptp(corners, axis=1).max()))


def _assemble(
    mesh: skfem.MeshQuad, cell: TetrachiralCell
) -> tuple[csr_matrix, csr_matrix, NDArray[np.float64], NDArray[np.int64]]:
    """Stiffness, mass, nodes (n, 2) and unknowns (n, 2) of isotropic plane-stress elements."""
    e, nu = cell.young, cell.poisson
    voigt = e / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuadS2()), intorder=4)

    @skfem.BilinearForm
    def elastic(u, v, w):  # type: ignore[no-untyped-def]
        return np.einsum("ij,j...,i...->...", voigt, strain(u), strain(v))

    @skfem.BilinearForm
    def inertia(u, v, w):  # type: ignore[no-untyped-def]
        return cell.density * (u[0] * v[0] + u[1] * v[1])

    dofs = component_dofs(basis)
    nodes = basis.doflocs[:, dofs[:, 0]].T
    return elastic.assemble(basis), inertia.assemble(basis), nodes, dofs


def _rigid(
    nodes: NDArray[np.float64],
    dofs: NDArray[np.int64],
    centre: NDArray[np.float64],
    column: int,
    shape: tuple[int, int],
) -> csr_matrix:
    """Unknowns of nodes that move with a block: u + θ × (x − centre), columns column…column + 2."""
    arm = nodes - centre
    one = np.ones(len(nodes))
    rows = np.concatenate([dofs[:, 0], dofs[:, 0], dofs[:, 1], dofs[:, 1]])
    columns = np.repeat([column, column + 2, column + 1, column + 2], len(nodes))
    values = np.concatenate([one, -arm[:, 1], one, arm[:, 0]])
    return coo_matrix((values, (rows, columns)), shape=shape).tocsr()


def condensed_interface(cell: TetrachiralCell, across: int = 8) -> CondensedInterface:
    """Mesh one interface and condense it onto the motions of its two blocks.

    The stiffness is exact for the mesh; the mass follows the static deformation (Guyan): an
    interface's own resonances lie thousands of times above the lattice's.

    Parameters
    ----------
    cell : TetrachiralCell
    across : int
        Elements across the thickness (even).
    """
    mesh = interface_grid(cell, across)
    stiffness, mass, nodes, dofs = _assemble(mesh, cell)
    c, s = np.cos(cell.angle), np.sin(cell.angle)
    centre = cell.pitch / 2 * np.array([c, -s])  # of the second block, in the interface's axes
    face = cell.thickness / 2 * (1 - 1e-9)
    size = stiffness.shape[0]
    link = csr_matrix((size, 6))
    held = np.zeros(size, dtype=bool)
    for side, column in ((-1, 0), (1, 3)):
        on_face = side * nodes[:, 0] > face
        link = link + _rigid(nodes[on_face], dofs[on_face], side * centre, column, (size, 6))
        held[dofs[on_face]] = True
    motion = link.toarray()
    free = ~held
    inner = stiffness[free][:, free]
    motion[free] = -factorise(inner).solve(stiffness[free][:, held] @ motion[held])
    turn = np.kron(np.eye(2), np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]))
    return CondensedInterface(
        stiffness=turn @ (motion.T @ (stiffness @ motion)) @ turn.T,
        mass=turn @ (motion.T @ (mass @ motion)) @ turn.T,
        nodes=len(nodes),
        elements=mesh.nelements,
    )


def heterogeneous_frequencies(
    lattice: BlockLattice,
    count: int,
    held: NDArray[np.bool_] | None = None,
    across: int = 8,
) -> NDArray[np.float64]:
    """Lowest elastic circular frequencies, rad/s, with FE interfaces condensed and assembled.

    Parameters
    ----------
    lattice : BlockLattice
    count : int
    held : (blocks,) bool array, optional
    across : int
        Elements across each interface's thickness (even).
    """
    cell = lattice.cell
    interface = condensed_interface(cell, across)
    mass = lattice.mass(cell.side - cell.thickness) + lattice.assemble(interface.mass)
    return lattice.frequencies(count, held, interface.stiffness, mass)


def full_frequencies(lattice: BlockLattice, count: int, across: int = 4) -> NDArray[np.float64]:
    """The free lattice with every interface meshed: nothing condensed. For small lattices.

    Parameters
    ----------
    lattice : BlockLattice
    count : int
    across : int
    """
    cell = lattice.cell
    grid = interface_grid(cell, across)
    centroids = lattice.centroids
    points: list[NDArray[np.float64]] = []
    quads, owners = [], []
    for pairs in lattice.pairs:
        for p, q in pairs.tolist():
            line = centroids[q] - centroids[p]
            angle = np.arctan2(line[1], line[0]) + cell.angle
            turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            quads.append(grid.t + sum(x.shape[1] for x in points))
            points.append(turn @ grid.p + ((centroids[p] + centroids[q]) / 2)[:, None])
            owners.append((p, q, turn[:, 0]))
    mesh = skfem.MeshQuad(np.hstack(points), np.hstack(quads))
    stiffness, mass, nodes, dofs = _assemble(mesh, cell)
    size, blocks = stiffness.shape[0], 3 * len(centroids)
    link = csr_matrix((size, blocks))
    held = np.zeros(size, dtype=bool)
    # every interface keeps its vertices and mid-sides together: find them by position
    for p, q, normal in owners:
        middle = (centroids[p] + centroids[q]) / 2
        near = np.hypot(*(nodes - middle).T) < cell.contact / 2 + cell.thickness
        distance = (nodes - middle) @ normal
        for block, side in ((p, -1), (q, 1)):
            on_face = near & (np.abs(distance - side * cell.thickness / 2) < 1e-6 * cell.thickness)
            link = link + _rigid(
                nodes[on_face], dofs[on_face], centroids[block], 3 * block, (size, blocks)
            )
            held[dofs[on_face]] = True
    identity = csr_matrix(
        (np.ones((~held).sum()), (np.flatnonzero(~held), np.arange((~held).sum()))),
        shape=(size, int((~held).sum())),
    )
    transform = hstack([link, identity]).tocsr()
    block_mass = lattice.mass(cell.side - cell.thickness)
    block_mass.resize(transform.shape[1], transform.shape[1])
    return elastic_frequencies(
        (transform.T @ stiffness @ transform).tocsr(),
        (transform.T @ mass @ transform + block_mass).tocsr(),
        count,
        RIGID_MOTIONS,
    )
