"""Natural modes of a body of several solids."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from references.eigen import elastic_pairs
from references.fem.body import Array, Body, Held, InSolid
from references.fem.evaluation import Field
from references.fem.restraint import free_motions


@dataclass(frozen=True)
class Vibrations:
    """Elastic modes, rigid motions left out.

    Attributes
    ----------
    frequencies : (count,) float array
        Circular, rad/s, ascending.
    rigid : int
        Motions that strain nothing.
    shapes : Field
        Of all modes; see `at`.
    """

    frequencies: Array
    rigid: int
    shapes: Field

    def at(self, points: ArrayLike) -> Array:
        """Shapes (count, n, 2) at points (n, 2), mass-normalised."""
        found = self.shapes.at(points)
        return np.moveaxis(found.reshape(len(found), -1, 2), 1, 0)


def vibrations(
    body: Body, moduli: InSolid, densities: ArrayLike, held: Held, count: int
) -> Vibrations:
    """The lowest elastic modes of a body, of which parts may be free.

    Parameters
    ----------
    body : Body
        Of two components.
    moduli : callable
        Stiffness, Pa.
    densities : (solids,) array_like
        kg/m³.
    held : callable
        Its values play no part.
    count : int

    Raises
    ------
    ValueError
        For more modes than a mesh has.
    FloatingPointError
        If a rigid motion is lost, or one too many is found.
    """
    values = body.held(held)
    rigid = free_motions(body.nodes, body.element_nodes, ~np.isnan(values[body.dofs])).number
    free = np.isnan(values)
    if count + rigid >= free.sum() - 1:
        raise ValueError(f"{count} modes are too many for {free.sum()} unknowns")
    stiffness = body.stiffness(moduli).tocsr()[free][:, free]
    mass = body.mass(densities).tocsr()[free][:, free]
    frequencies, vectors = elastic_pairs(stiffness, mass, count, rigid)
    unknowns = np.zeros((body.basis.N, count))
    unknowns[free] = vectors
    return Vibrations(frequencies, rigid, body.field(unknowns))
