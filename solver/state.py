"""The state of a body: values of its unknowns, and their names and units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arrays import Array, Mask
from .material.physics import Physics
from .problem import Description, Discretisation


@dataclass(frozen=True, eq=False)
class State:
    """Values of all unknowns of a body, whatever analysis found them.

    Attributes
    ----------
    discretisation : Discretisation
    unknowns : ndarray, shape (components, N)
        u1, u2 and θ Δx, or T, or φ; NaN at parts that were set aside.
    """

    discretisation: Discretisation
    unknowns: Array

    @property
    def scene(self) -> Description:
        """The scene that was solved."""
        return self.discretisation.scene

    @property
    def points(self) -> Array:
        """Particle centres, shape (N, 2), m."""
        return self.discretisation.lattice.points

    @property
    def spacing(self) -> float:
        """Δx, m."""
        return self.scene.spacing

    @property
    def prescribed(self) -> Mask:
        """Particles of which everything is prescribed, or which were set aside, shape (N,)."""
        return np.logical_and.reduce(self.discretisation.prescribed, axis=0)

    @property
    def physics(self) -> Physics:
        """What was solved: it knows the names of the fields."""
        return self.discretisation.moduli.physics

    @property
    def values(self) -> Array:
        """Values of all unknowns in their own units, shape (components, N): u1, u2, θ, or T."""
        return self._unscaled(self.unknowns)

    def solved(self) -> dict[str, Array]:
        """The fields that the equations hold, by name: (N,) or (N, 2) arrays in SI units.

        Without those that the solid lacks, such as rotations where no bond resists shear.
        """
        names = self.physics.fields.items()
        held = [name for name, unknowns in names if max(unknowns) < len(self.unknowns)]
        return {name: self._field(name) for name in held}

    def _unscaled(self, unknowns: Array) -> Array:
        return unknowns / self.physics.scales(self.spacing, len(unknowns))[:, None]

    def _field(self, name: str, unknowns: Array | None = None) -> Array:
        """A field at the particles, or at the surface's nodes from their unknowns."""
        known = self.physics.fields
        if name not in known:
            raise AttributeError(
                f"a solution of {self.physics.name} holds {', '.join(known)}, not {name}"
            )
        values = self.values if unknowns is None else self._unscaled(unknowns)
        which = [k for k in known[name] if k < len(values)]
        if not which:  # the solid has no such unknown
            return np.full(values.shape[1], np.nan)
        return values[which[0]] if len(which) == 1 else values[which].T

    @property
    def displacement(self) -> Array:
        """u, shape (N, 2), m."""
        return self._field("displacement")

    @property
    def rotation(self) -> Array:
        """θ, shape (N,), rad; NaN where the solid has no rotations (no shear stiffness)."""
        return self._field("rotation")

    @property
    def temperature(self) -> Array:
        """T, shape (N,), K."""
        return self._field("temperature")

    @property
    def potential(self) -> Array:
        """φ, shape (N,), V."""
        return self._field("potential")

    @property
    def surface_points(self) -> Array:
        """Nodes of the surface at which bonds end, shape (s, 2), m; none where no bond does."""
        surface = self.discretisation.operator.ended_stiffness
        if surface is None:
            return np.zeros((0, 2))
        shift = self.discretisation.bonds.lattice.shift
        return surface.ended.outline.nodes[surface.nodes] + shift

    def _at_surface(self, name: str) -> Array:
        nodal = self.discretisation.surface_values(self.unknowns)
        return self._field(name, np.zeros((len(self.unknowns), 0)) if nodal is None else nodal)

    @property
    def surface_displacement(self) -> Array:
        """u at the surface's nodes, shape (s, 2), m."""
        return self._at_surface("displacement")

    @property
    def surface_temperature(self) -> Array:
        """T at the surface's nodes, shape (s,), K."""
        return self._at_surface("temperature")

    @property
    def surface_potential(self) -> Array:
        """φ at the surface's nodes, shape (s,), V."""
        return self._at_surface("potential")
