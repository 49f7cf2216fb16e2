"""Tetrachiral lattice of rigid square blocks (Bacigalupo and Gambarotta; Sect. 2.4, Eq. 86).

Squares of side a, turned by β, sit on a grid of pitch ℓ = a / cos β. Neighbours touch along
b = (1 − tan β) a, where an elastic layer of thickness t joins them. Each block has three unknowns
(u₁, u₂, θ); each layer is a bed of springs that acts at the midpoint of the two centroids. Nothing
else is approximated.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_matrix, csr_matrix, diags

from references.analytic.tetrachiral import cell_geometry, interface_stiffness
from references.eigen import RIGID_MOTIONS, elastic_frequencies, elastic_pairs


@dataclass(frozen=True)
class TetrachiralCell:
    """Block and interface.

    Attributes
    ----------
    side : float
        a of the squares, m.
    angle : float
        β, rad, 0 ≤ β < π/4.
    thickness : float
        t of the interfaces, m.
    young, poisson : float
        Of the interfaces (plane stress), Pa and 1.
    density : float
        ρ of the blocks, kg/m³.
    """

    side: float
    angle: float
    thickness: float
    young: float
    poisson: float
    density: float

    def __post_init__(self) -> None:
        if min(self.side, self.thickness, self.young, self.density) <= 0:
            raise ValueError("side, thickness, Young's modulus and density must be positive")
        if not 0 <= self.angle < np.pi / 4:
            raise ValueError(
                f"the chirality angle must lie in [0, π/4), not {self.angle}: beyond it the"
                " squares no longer touch"
            )
        if not -1 < self.poisson <= 0.5:
            raise ValueError(f"Poisson's ratio must lie in (−1, 1/2], not {self.poisson}")

    @property
    def pitch(self) -> float:
        """ℓ = a / cos β, distance of neighbouring centroids."""
        return cell_geometry(self.side, self.angle)[0]

    @property
    def contact(self) -> float:
        """b = (1 − tan β) a, length of an interface."""
        return cell_geometry(self.side, self.angle)[1]

    @property
    def springs(self) -> tuple[float, float, float]:
        """K_n, K_t (N/m per unit depth, Eq. 86) and rotational K_n b²/12 (N m per unit depth)."""
        normal, shear = interface_stiffness(self.young, self.poisson, self.contact, self.thickness)
        return float(normal), float(shear), float(normal * self.contact**2 / 12)

    @property
    def effective_density(self) -> float:
        """ρ cos²β: the cell has pores."""
        return self.density * cell_geometry(self.side, self.angle)[2]


def paper_cell() -> TetrachiralCell:
    """The cell of Sect. 2.4: a = 20 mm, β = atan(1/2), t = a/500, E = 10 MPa, ν = 1/2."""
    side = 0.02
    return TetrachiralCell(side, float(np.arctan(0.5)), side / 500, 10e6, 0.5, 1000.0)


def relative_motion(start: ArrayLike, end: ArrayLike, angle: float) -> NDArray[np.float64]:
    """B (3, 6): block motions -> opening, sliding and relative rotation of the interface.

    Parameters
    ----------
    start, end : pairs of float
        The two centroids; the interface acts at their midpoint.
    angle : float
        By which its normal is turned from the line of centroids.
    """
    between = np.subtract(end, start).astype(float)
    direction = np.arctan2(between[1], between[0]) + angle
    normal = np.array([np.cos(direction), np.sin(direction)])
    tangent = np.array([-normal[1], normal[0]])
    lever = between / 2
    turned = np.array([-lever[1], lever[0]])  # velocity of the midpoint when the first block turns
    b = np.zeros((3, 6))
    for row, axis in enumerate((normal, tangent)):
        b[row, 0:2], b[row, 2] = -axis, -axis @ turned
        b[row, 3:5], b[row, 5] = axis, -axis @ turned
    b[2, 2], b[2, 5] = -1, 1
    return b


def spring_interface(cell: TetrachiralCell) -> NDArray[np.float64]:
    """6×6 stiffness of an interface between blocks at (−ℓ/2, 0) and (ℓ/2, 0)."""
    b = relative_motion((-cell.pitch / 2, 0), (cell.pitch / 2, 0), cell.angle)
    stiffness: NDArray[np.float64] = b.T @ np.diag(cell.springs) @ b
    return stiffness


def cell_voigt(cell: TetrachiralCell) -> NDArray[np.float64]:
    """Effective 3×3 stiffness by the energy of one cell, the blocks' rotation condensed.

    Under a uniform strain every block moves with it and turns alike; the rotation takes the value
    that makes the energy least. Independent of the printed closed forms (Eqs. 87–90).
    """
    springs = np.diag(cell.springs)
    energy = np.zeros((4, 4))
    # columns: ε11, ε22, 2ε12, block rotation against the macroscopic one
    for step in (np.array([cell.pitch, 0.0]), np.array([0.0, cell.pitch])):
        b = relative_motion((0, 0), step, cell.angle)
        motion = np.zeros((6, 4))
        motion[3, 0], motion[4, 1] = step
        motion[3, 2], motion[4, 2] = step[1] / 2, step[0] / 2
        motion[2, 3] = motion[5, 3] = 1
        energy += motion.T @ b.T @ springs @ b @ motion
    energy /= cell.pitch**2
    condensed: NDArray[np.float64] = (
        energy[:3, :3] - np.outer(energy[:3, 3], energy[3, :3]) / energy[3, 3]
    )
    return condensed


@dataclass(frozen=True)
class BlockLattice:
    """columns × rows blocks, numbered row by row.

    Attributes
    ----------
    cell : TetrachiralCell
    columns, rows : int
    """

    cell: TetrachiralCell
    columns: int
    rows: int

    def __post_init__(self) -> None:
        if self.columns < 1 or self.rows < 1 or self.columns * self.rows < 2:
            raise ValueError("a lattice needs at least two blocks")

    @property
    def centroids(self) -> NDArray[np.float64]:
        """(columns · rows, 2), about the origin."""
        x = (np.arange(self.columns) - (self.columns - 1) / 2) * self.cell.pitch
        y = (np.arange(self.rows) - (self.rows - 1) / 2) * self.cell.pitch
        return np.column_stack([np.tile(x, self.rows), np.repeat(y, self.columns)])

    @property
    def pairs(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Neighbours (k, 2) along axis 1 and (l, 2) along axis 2."""
        number = np.arange(self.columns * self.rows).reshape(self.rows, self.columns)
        across = np.column_stack([number[:, :-1].ravel(), number[:, 1:].ravel()])
        along = np.column_stack([number[:-1].ravel(), number[1:].ravel()])
        return across, along

    @property
    def ring(self) -> NDArray[np.bool_]:
        """The outer ring of blocks."""
        inside = np.zeros((self.rows, self.columns), dtype=bool)
        inside[1:-1, 1:-1] = True
        return ~inside.ravel()

    def assemble(self, interface: NDArray[np.float64]) -> csr_matrix:
        """Sum of a 6×6 interface matrix, given for a pair along axis 1, over all interfaces."""
        quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
        turn = np.kron(np.eye(2), quarter)
        rows, columns, values = [], [], []
        for pairs, matrix in zip(self.pairs, (interface, turn @ interface @ turn.T), strict=True):
            dofs = (3 * pairs[:, :, None] + np.arange(3)).reshape(-1, 6)
            rows.append(np.repeat(dofs, 6, axis=1).ravel())
            columns.append(np.tile(dofs, (1, 6)).ravel())
            values.append(np.tile(matrix.ravel(), len(dofs)))
        size = 3 * self.columns * self.rows
        index = (np.concatenate(rows), np.concatenate(columns))
        return coo_matrix((np.concatenate(values), index), shape=(size, size)).tocsr()

    def mass(self, side: float | None = None) -> csr_matrix:
        """Rigid squares of the given side (that of the cell unless told)."""
        a = self.cell.side if side is None else side
        m = self.cell.density * a**2
        return diags(np.tile([m, m, m * a**2 / 6], self.columns * self.rows)).tocsr()

    def frequencies(
        self,
        count: int,
        held: NDArray[np.bool_] | None = None,
        interface: NDArray[np.float64] | None = None,
        mass: csr_matrix | None = None,
        **solver: float,
    ) -> NDArray[np.float64]:
        """Lowest elastic circular frequencies, rad/s.

        Parameters
        ----------
        count : int
        held : (blocks,) bool array, optional
            Blocks that do not move (``lattice.ring`` clamps the outer ring). None: free.
        interface : (6, 6) array, optional
            The spring bed unless given.
        mass : sparse matrix, optional
            Rigid squares unless given.
        **solver
            ``shift`` and ``dense`` of :func:`references.eigen.elastic_frequencies`.

        Raises
        ------
        ValueError
            If more modes are asked for than there are.
        """
        matrix = spring_interface(self.cell) if interface is None else interface
        stiffness, inertia = self.assemble(matrix), self.mass() if mass is None else mass
        rigid = RIGID_MOTIONS
        if held is not None and np.any(held):
            free = np.repeat(~np.asarray(held, dtype=bool), 3)
            stiffness, inertia = stiffness[free][:, free], inertia[free][:, free]
            rigid = 0
        return elastic_frequencies(stiffness, inertia, count, rigid, **solver)  # type: ignore[arg-type]

    def modes(
        self, count: int, held: NDArray[np.bool_] | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lowest elastic frequencies (count,), rad/s, and displacements of the centroids.

        Parameters
        ----------
        count : int
        held : (blocks,) bool array, optional

        Returns
        -------
        frequencies : (count,) float array
        shapes : (count, blocks, 2) float array
            Mass-normalised with the blocks' turning; zero where held.
        """
        free = np.ones(3 * self.columns * self.rows, dtype=bool)
        if held is not None:
            free = np.repeat(~np.asarray(held, dtype=bool), 3)
        stiffness, inertia = self.assemble(spring_interface(self.cell)), self.mass()
        rigid = RIGID_MOTIONS if free.all() else 0
        frequencies, vectors = elastic_pairs(
            stiffness[free][:, free], inertia[free][:, free], count, rigid
        )
        full = np.zeros((len(free), count))
        full[free] = vectors
        return frequencies, np.moveaxis(full.reshape(-1, 3, count)[:, :2], -1, 0)
