"""Statics and steady conduction of a body of several solids, with everything that may act on it.

One assembly for both (`references.fem.body`): the unknown has one component or two, the tensor
relates what the body's gradient makes of it (ε11, ε22, 2 ε12 or ∇T) to the stress or the
(negative) flux.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from references.fem.body import Acting, Array, Body, Held, InSolid, of_solids
from references.fem.evaluation import Field
from references.fem.listening import listened
from references.fem.mesh import Mesh
from references.fem.restraint import require_held, require_temperature
from references.linear import solve_with_prescribed

__all__ = ["Acting", "GeneralSolution", "solve", "solved"]


@dataclass
class GeneralSolution(Field):
    """A field; ``at(points)``, and ``flux_at(points)`` is the stress or the flux.

    Attributes
    ----------
    moduli : callable
        (x, y, solid) → (k, k, *x.shape).
    solid : (M,) int array
        Of each triangle.
    strain : callable, optional
        As in `Acting`.
    work : float
        u·K u: twice the energy, J per unit thickness, or what a current dissipates.
    """

    moduli: InSolid = field(default_factory=lambda: of_solids(np.eye(3)[None]))
    solid: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    strain: InSolid | None = None
    work: float = 0.0

    def gradient_in(self, points: ArrayLike) -> tuple[Array, Array]:
        """∇T (n, 2), or the strain (ε11, ε22, 2 ε12) less that without stress, (n, 3); moduli."""
        where = np.asarray(points, dtype=float)
        gradient = self.gradient_at(where)
        assert self._locator is not None
        which = self.solid[self._locator(where)[0]]
        x, y = where.T
        tensors = np.moveaxis(np.asarray(self.moduli(x, y, which)), -1, 0)
        if self.values.ndim == 1:
            return gradient, tensors
        strain = np.stack(
            [gradient[:, 0, 0], gradient[:, 1, 1], gradient[:, 0, 1] + gradient[:, 1, 0]], axis=1
        )
        if self.strain is not None:
            strain -= np.moveaxis(np.asarray(self.strain(x, y, which)), 0, -1)
        return strain, tensors

    def flux_at(self, points: ArrayLike) -> Array:
        """Stress (n, 3) as 11, 22, 12, or flux −D ∇T (n, 2), element by element."""
        gradient, tensors = self.gradient_in(points)
        found = np.einsum("nij,nj->ni", tensors, gradient)
        return np.asarray(-found if self.values.ndim == 1 else found)

    def heat_at(self, points: ArrayLike) -> Array:
        """∇φ·D ∇φ (n,), what a current dissipates, W/m³."""
        gradient, tensors = self.gradient_in(points)
        return np.asarray(np.einsum("ni,nij,nj->n", gradient, tensors, gradient))


@listened
def solve(
    mesh: Mesh,
    tensors: ArrayLike,
    solid: NDArray[np.int64],
    held: Held,
    acting: Acting,
    thickness: InSolid | None = None,
    order: int = 2,
) -> GeneralSolution:
    """Solve div(C ε(u)) + f = 0, or div(D ∇T) + s = 0.

    Parameters
    ----------
    mesh : Mesh
        Its outer boundary is called ``edge``.
    tensors : (solids, 3, 3) or (solids, 2, 2) array_like
        Stiffness in Pa, or conductivity in W/(m K), of each solid.
    solid : (M,) int array
        Of each triangle.
    held : callable
        Nodes (n, 2), which of them are on the edge (n,) → values (n, components), NaN where they
        are free.
    acting : Acting
    thickness : callable, optional
        (x, y, solid) → m.
    order : {1, 2}

    Raises
    ------
    ValueError, FloatingPointError
        As `solved`.
    """
    components = 2 if np.shape(tensors)[-1] == 3 else 1
    body = Body(mesh, components, solid, thickness, order)
    return solved(body, of_solids(tensors), held, acting)


def solved(body: Body, moduli: InSolid, held: Held, acting: Acting) -> GeneralSolution:
    """As `solve`, of a body that has its elements, and moduli that may depend on the place.

    Raises
    ------
    ValueError
        If supports leave a part of the body a rigid motion, or a temperature that nothing sets, or
        the mesh has no point where something is spread.
    FloatingPointError
        If the equations cannot be solved to nine digits.
    """
    values = body.held(held)
    prescribed = ~np.isnan(values[body.dofs])
    if body.components == 2:
        require_held(body.nodes, body.element_nodes, prescribed)
    else:
        require_temperature(body.nodes, body.element_nodes, prescribed[:, 0])
    stiffness = body.stiffness(moduli)
    unknowns, _ = solve_with_prescribed(stiffness, body.load(acting, moduli), values)
    return GeneralSolution(
        **vars(body.field(unknowns)),
        moduli=moduli,
        solid=body.solid,
        strain=acting.strain,
        work=float(unknowns @ (stiffness @ unknowns)),
    )
