"""Bodies with two rigid pins in round holes, pulled apart, by superposition.

The rims of the holes move as rigid circles. What a pin may do of itself (turn, move sideways)
follows from the energy: with fields u_i for unit motions of the rims and k_ij = ∫ ε_i C ε_j, the
free motions z make ½ q·k q stationary.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from references.fem.elasticity import (
    ElasticSolution,
    component_dofs,
    elastic_forms,
    solve_elasticity,
)
from references.fem.interaction import stress_intensity
from references.fem.mesh import Mesh


@dataclass(frozen=True)
class Pinned:
    """Answer to a unit displacement of the upper pin along axis 2.

    Attributes
    ----------
    stiffness : float
        Force for a unit displacement, N/m² per unit thickness.
    motions : (4,) array
        Turn of the lower pin (rad), u1, u2 and turn of the upper one.
    fields : list of ElasticSolution
        For a unit of each.
    """

    stiffness: float
    motions: NDArray[np.float64]
    fields: list[ElasticSolution]

    def intensities(self, tip: ArrayLike, angle: float, radius: float) -> tuple[float, float]:
        """K_I and K_II of a crack tip for a unit displacement."""
        found = [stress_intensity(field, tip, angle, radius) for field in self.fields]
        k1, k2 = (np.array([getattr(f, name) for f in found]) for name in ("KI", "KII"))
        return float(k1 @ self.motions), float(k2 @ self.motions)


def pulled_by_pins(
    mesh: Mesh,
    voigt: ArrayLike,
    centres: tuple[tuple[float, float], tuple[float, float]],
    turning: bool = True,
    sliding: bool = True,
    order: int = 2,
) -> Pinned:
    """Lower pin in ``hole0`` (its centre held), upper pin in ``hole1`` moved along axis 2.

    Parameters
    ----------
    mesh : Mesh
    voigt : (3, 3) array_like
    centres : two points
        Of the lower and the upper hole.
    turning : bool
        Whether pins turn freely; else they do not turn.
    sliding : bool
        Whether the upper pin moves freely along axis 1.
    order : {1, 2}
    """
    (x0, y0), (x1, y1) = centres
    still = (0.0, 0.0)

    def about(cx: float, cy: float):  # type: ignore[no-untyped-def]
        return lambda x, y: np.stack([-(y - cy), x - cx], axis=-1)

    motions = [
        {"hole0": about(x0, y0), "hole1": still},
        {"hole0": still, "hole1": (1.0, 0.0)},
        {"hole0": still, "hole1": (0.0, 1.0)},
        {"hole0": still, "hole1": about(x1, y1)},
    ]
    fields = [solve_elasticity(mesh, voigt, motion, order=order) for motion in motions]
    basis, _, stiffness = elastic_forms(mesh, np.asarray(voigt, dtype=float), order)
    dofs = component_dofs(basis)
    columns = np.zeros((basis.N, 4))
    for k, field in enumerate(fields):
        columns[dofs, k] = field.values
    matrix = columns.T @ (stiffness @ columns)
    free = [0, 3] * turning + [1] * sliding
    q = np.array([0.0, 0.0, 1.0, 0.0])
    if free:
        q[free] = -np.linalg.solve(matrix[np.ix_(free, free)], matrix[free, 2])
    return Pinned(float(q @ matrix @ q), q, fields)
