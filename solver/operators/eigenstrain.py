"""Strains that cost no energy, such as those of a temperature, and the forces they exert.

A bond whose ends would move apart by themselves stores what it is strained beyond that,

    ½ L Σ_a k_a (ε_a − e_a)² α Λ Δv_p Δv_q,    e_s = n·Ē·n,   e_γ = n·Ē·t,

Ē being the mean of E = A T at the bond's two ends (a particle and the point of the surface where
it ends). Each end then feels the force L k_a e_a ∂ε_a/∂u besides those of the elastic bond.

Why the mean: a temperature linear in x makes E linear, E is the strain of a quadratic displacement
u, and the stretch of a bond in a quadratic field is n·ε·n at its middle, its shear n·ε·t there if
the particles turn by ½ curl u, which is linear. Both are those of Ē: no bond is strained beyond,
whatever the tensor A. (An E that is not linear is the strain of no displacement in general, and
free expansion is then not free of stress.) A bond that ends at the surface takes the displacement
there from a straight line between two nodes, and its point of contact is not its middle: it is
exact for a uniform temperature only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Indices
from ..bonds import Bonds, EndedBonds
from ..bonds.ended import SHORTEST
from ..material import Moduli
from ..material.strains import homogeneous_stretch
from .surface_stiffness import (
    BondStrains,
    SurfaceStiffness,
    between,
    chord_strains,
    membrane,
    place,
)


@dataclass(frozen=True, eq=False)
class Eigenstrain:
    """A strain without stress at every particle, and at the surface's nodes.

    Attributes
    ----------
    bonds : Bonds
    moduli : Moduli
    particles : ndarray, shape (3, N)
        ε11, ε22 and 2 ε12.
    nodes : ndarray, shape (3, nodes of the outline), optional
        Where bonds end at the surface.
    """

    bonds: Bonds
    moduli: Moduli
    particles: Array
    nodes: Array | None = None

    def of_offset(self, o: int) -> Array:
        """e_a of the bonds of one offset, shape (strains, N)."""
        lattice, family = self.bonds.lattice, self.bonds.family
        rows, columns = lattice.rows_columns
        dx, dy = family.offsets[o]
        there = lattice.to_grid(self.particles)[:, rows + dy, columns + dx]
        of = self.moduli.homogeneous(family.normal[o][:, None])[:, :, 0]
        return np.asarray(of @ (0.5 * (self.particles + there)))

    def of_ended(self, ended: EndedBonds) -> Array:
        """e_a of bonds that end at the surface, shape (strains, k)."""
        ends = ended.outline.edges[ended.edge]
        there = self._at(ends, ended.position)
        family = self.bonds.family
        of = self.moduli.homogeneous(family.normal[ended.offset].T)
        found = np.einsum("avk,vk->ak", of, 0.5 * (self.particles[:, ended.particle] + there))
        # The shortest bonds measure their strain over a longer stretch.
        shortest = SHORTEST * family.spacing
        return np.asarray(found * (ended.length / np.maximum(ended.length, shortest)))

    def _at(self, ends: Indices, position: Array) -> Array:
        """At points along the outline's edges, shape (3, k)."""
        assert self.nodes is not None
        return (1 - position) * self.nodes[:, ends[:, 0]] + position * self.nodes[:, ends[:, 1]]

    def load(self) -> Array:
        """What bonds between particles exert, shape (components, N), per volume."""
        family, moduli = self.bonds.family, self.moduli
        scales, arm = moduli.scales(family.spacing), 0.5 * family.length
        rows = moduli.end_rows(scales, family.normal.T, -1.0, arm) / family.length
        weight = family.weight * family.cell_area * moduli.pair_length(family) * moduli.stiffness
        found = np.zeros((moduli.components, self.bonds.lattice.count))
        for o in range(family.size):
            force = (weight[:, o, None] * rows[:, :, o]).T @ self.of_offset(o)
            found += self.bonds.strength(o) * force
        return found

    def surface_load(self, surface: SurfaceStiffness) -> tuple[Array, Array]:
        """What bonds at the surface, its corners and its skin exert.

        Returns
        -------
        tuple of ndarray, shapes (components, N) and (components, nodes of the outline)
            On particles and on nodes, per volume of a particle.
        """
        ended, moduli, family = surface.ended, self.moduli, self.bonds.family
        outline, c = ended.outline, moduli.components
        number = np.full(len(outline.nodes), -1)
        number[surface.nodes] = np.arange(len(surface.nodes))
        rule = BondStrains(family, moduli, ended.offset, ended.length, ended.factor)
        whole = family.length[ended.offset]
        force = rule.weight * self.of_ended(ended)
        on_particles = np.zeros((c, self.bonds.lattice.count))
        rows = np.einsum("ack,ak->ck", rule.rows(-1.0, 0.5 * whole), force)
        for into, what in zip(on_particles, rows, strict=True):
            into += np.bincount(ended.particle, what, minlength=len(into))
        ends = number[outline.edges[ended.edge]]
        at = place(rule.rows(1.0, ended.length - 0.5 * whole), between(ends, ended.position),
                   len(surface.nodes))  # fmt: skip
        total = at.T @ force.ravel()
        chords = chord_strains(ended, family, moduli, number)
        if chords is not None and ended.chords is not None:
            weight, normal, strain = chords
            edge, position = ended.chords.edge, ended.chords.position
            middle = 0.5 * sum(self._at(outline.edges[edge[:, k]], position[:, k]) for k in (0, 1))
            free = np.einsum("avk,vk->ak", moduli.homogeneous(normal), middle)
            total = total + strain.T @ (weight * free.ravel())
        skin = membrane(ended, family, moduli, number)
        if skin is not None:
            skin = skin.stiffening() if surface.stiffened else skin
            middle = self._at(outline.edges[skin.edges], np.full(len(skin.edges), 0.5))
            free = (homogeneous_stretch(skin.along) * middle).sum(axis=0)
            total = total + skin.strain.T @ (skin.weight * free)
        on_nodes = np.zeros((c, len(outline.nodes)))
        on_nodes[:, surface.nodes] = total.reshape(c, -1)
        return on_particles, on_nodes
