"""Strains that cost no energy, such as those of a temperature, and the forces they exert.

A bond whose ends would move apart by themselves stores what it is strained beyond that,

    ½ L Σ_a k_a (ε_a − e_a)² α Λ Δv_p Δv_q,    e_s = n·Ē·n,   e_γ = n·Ē·t,

Ē being the mean of E = A T at the bond's two ends (a particle and the point of the surface where
it ends). Each end then feels the force L k_a e_a ∂ε_a/∂u besides those of the elastic bond.

Why the mean: a temperature linear in x makes E linear, E is the strain of a quadratic displacement
u, and the stretch of a bond in a quadratic field is n·ε·n at its middle, its shear n·ε·t there if
the particles turn by ½ curl u, which is linear. Both are those of Ē: no bond is strained beyond,
whatever the tensor A. (An E that is not linear is the strain of no displacement in general, and
free expansion is then not free of stress.)

A bond that ends at the surface takes the displacement there from a straight line between two nodes,
and its point of contact is not its middle, so that free expansion strains it by more than Ē. From
the gradient of E follow, as of any displacement, ω,k = E2k,1 − E1k,2 and u_i,jk = E_ij,k + E_ik,j −
E_jk,i; with the edge's direction τ and length L, the end at the share p of it, and the arm a of the
rotation there,

    ℓ e = ℓ n·Ē·n + n·c   and   ℓ n·Ē·t + t·c + ℓ (½ ℓ − a) ω,n,      c = ½ p (1 − p) L² u,ττ.

In a polar solid free expansion under a linear temperature bends bonds, too, which no temperature
does by itself: χ is mechanical, and such a body bears couple stress.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from ..arrays import Array, Indices
from ..bonds import Bonds, EndedBonds
from ..bonds.ended import SHORTEST
from ..material import Moduli
from ..material.strains import elongations, homogeneous_stretch
from .surface_pieces import BondStrains, between, chord_strains, membrane, place
from .surface_stiffness import SurfaceStiffness


@dataclass(frozen=True, eq=False)
class Eigenstrain:
    """A strain without stress at every particle, and at the surface's nodes.

    Attributes
    ----------
    bonds : Bonds
    moduli : Moduli
    particles : ndarray, shape (3, N)
        ε11, ε22 and 2 ε12.
    nodes : ndarray, shape (phases, 3, nodes of the outline), optional
        Where bonds end at the surface: that of each of the body's solids.
    temperature : ndarray, shape (N,), optional
        The change of temperature behind it, K, for results.
    """

    bonds: Bonds
    moduli: Moduli
    particles: Array
    nodes: Array | None = None
    temperature: Array | None = None

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
        there = self._at(ends, ended.position, ended.phase)
        family = self.bonds.family
        normal, length = family.normal[ended.offset].T, ended.length
        of = self.moduli.homogeneous(normal)
        mean = np.einsum("avk,vk->ak", of, 0.5 * (self.particles[:, ended.particle] + there))
        slope = self.gradient(ended)[..., ended.particle]
        sag = _sag(slope, ended.outline.nodes[ends], ended.position)
        arm = length - 0.5 * family.length[ended.offset]
        found = length * mean + self._beyond(normal, slope, sag, length * (0.5 * length - arm))
        # The shortest bonds measure their strain over a longer stretch.
        return np.asarray(found / np.maximum(length, SHORTEST * family.spacing))

    def _beyond(self, normal: Array, slope: Array, sag: Array, lever: Array) -> Array:
        """What ℓ e has beyond the mean of both ends, shape (strains, k).

        `sag` (2, k) is how much farther apart the ends are than the displacement at their places,
        `lever` (k,) is ℓ (½ ℓ − a).
        """
        n1, n2 = normal
        turn = n1 * (slope[0, 1, 0] - slope[0, 0, 1]) + n2 * (slope[1, 1, 0] - slope[1, 0, 1])
        # A bond that turns like its ends is not sheared: the lever counts against the turn.
        difference = np.concatenate([sag, np.zeros((1, sag.shape[1]))])
        return elongations(self.moduli.strains, normal, difference, -lever * turn)

    def gradient(self, ended: EndedBonds) -> Array:
        """∂E_ij/∂x_k at the particles as [i, j, k, particle], by least squares over the bonds.

        Exact where E is linear; across cracks nothing counts.
        """
        bonds, family = self.bonds, self.bonds.family
        lattice, count = bonds.lattice, bonds.lattice.count
        rows, columns = lattice.rows_columns
        grid = lattice.to_grid(self.particles)
        moment, slope = np.zeros((2, 2, count)), np.zeros((3, 2, count))
        for o, (dx, dy) in enumerate(family.offsets):
            weight = family.weight[o] * (bonds.strength(o) > 0)
            difference = grid[:, rows + dy, columns + dx] - self.particles
            moment += weight * np.multiply.outer(family.normal[o], family.normal[o])[..., None]
            slope += (weight / family.length[o]) * (
                difference[:, None] * family.normal[o][None, :, None]
            )
        there = self._at(ended.outline.edges[ended.edge], ended.position, ended.phase)
        difference = there - self.particles[:, ended.particle]
        normal, weight = family.normal[ended.offset].T, family.weight[ended.offset]
        # As whole bonds of the same slope, weighted by the square of what there is of them.
        whole = family.length[ended.offset]
        more = weight * (ended.length / whole) ** 2 * normal[:, None] * normal[None]
        rise = weight * ended.length / whole**2
        for i in range(2):
            for j in range(2):
                moment[i, j] += np.bincount(ended.particle, more[i, j], minlength=count)
            for v in range(3):
                part = rise * difference[v] * normal[i]
                slope[v, i] += np.bincount(ended.particle, part, minlength=count)
        inverse = np.linalg.pinv(np.moveaxis(moment, 2, 0), hermitian=True)
        found = np.einsum("vkp,pkl->vlp", slope, inverse)
        e11, e22, e12 = found[0], found[1], 0.5 * found[2]
        return np.stack([np.stack([e11, e12]), np.stack([e12, e22])])

    def _at(self, ends: Indices, position: Array, phase: Indices | None) -> Array:
        """At points along the outline's edges, as their phases have it, shape (3, k)."""
        assert self.nodes is not None
        own = np.zeros(len(ends), dtype=np.int64) if phase is None else phase
        first, last = (self.nodes[own, :, ends[:, k]].T for k in (0, 1))
        return np.asarray((1 - position) * first + position * last)

    def _nearest(self, places: Array, phase: Indices | None) -> Indices:
        """The particles nearest to some places, of their phases."""
        lattice, phases = self.bonds.lattice, self.bonds.phases
        if phase is None or phases is None:
            return np.asarray(lattice.tree.query(places)[1])
        found = np.zeros(len(places), dtype=np.int64)
        for k in np.unique(phase):
            mine = np.nonzero(phases.of == k)[0]
            here = phase == k
            found[here] = mine[KDTree(lattice.points[mine]).query(places[here])[1]]
        return found

    def load(self) -> Array:
        """What bonds between particles exert, shape (components, N), per volume."""
        family, moduli = self.bonds.family, self.moduli
        scales, arm = moduli.scales(family.spacing), 0.5 * family.length
        rows = moduli.end_rows(scales, family.normal.T, -1.0, arm) / family.length
        weight = family.weight * family.cell_area * moduli.pair_length(family)
        found = np.zeros((moduli.components, self.bonds.lattice.count))
        for o in range(family.size):
            force = rows[:, :, o].T @ (moduli.of_offset(o) * self.of_offset(o))
            found += self.bonds.strength(o) * weight[o] * force
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
        number = surface.number
        rule = BondStrains.of(ended, family, moduli)
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
            phase = None if outline.phase is None else outline.phase[edge[:, 0]]
            middle = 0.5 * sum(
                self._at(outline.edges[edge[:, k]], position[:, k], phase) for k in (0, 1)
            )
            free = np.einsum("avk,vk->ak", moduli.homogeneous(normal), middle)
            length = ended.chords.length
            corners = outline.nodes[outline.edges[edge]]
            nearest = self._nearest(corners.mean(axis=(1, 2)), phase)
            slope = self.gradient(ended)[..., nearest]
            first, last = (_sag(slope, corners[:, k], position[:, k]) for k in (0, 1))
            lever = length * (0.5 * length - ended.chords.arm[:, 1])
            free += self._beyond(normal, slope, last - first, lever) / length
            total = total + strain.T @ (weight * free.ravel())
        skin = membrane(ended, family, moduli, number)
        if skin is not None:
            skin = skin.stiffening() if surface.stiffened else skin
            phase = None if outline.phase is None else outline.phase[skin.edges]
            middle = self._at(outline.edges[skin.edges], np.full(len(skin.edges), 0.5), phase)
            free = (homogeneous_stretch(skin.along) * middle).sum(axis=0)
            total = total + skin.strain.T @ (skin.weight * free)
        if (inner := surface.layers) is not None:
            # Bonds from node to node along interfaces.
            phase = None if outline.phase is None else outline.phase[inner.edges]
            middle = self._at(outline.edges[inner.edges], np.full(len(inner.edges), 0.5), phase)
            free = np.einsum("avk,vk->ak", moduli.homogeneous(inner.along), middle)
            total = total + inner.strain.T @ (inner.weight.ravel() * free.ravel())
        on_nodes = np.zeros((c, len(outline.nodes)))
        on_nodes[:, surface.nodes] = total.reshape(c, -1)
        return on_particles, on_nodes


def _sag(slope: Array, ends: Array, position: Array) -> Array:
    """How far a straight line between nodes runs from a displacement of strain E, shape (2, k).

    Parameters
    ----------
    slope : ndarray, shape (2, 2, 2, k)
        ∂E_ij/∂x_k.
    ends : ndarray, shape (k, 2, 2)
        Places of the two nodes.
    position : ndarray, shape (k,)
        Between them, 0 to 1.
    """
    along = (ends[:, 1] - ends[:, 0]).T
    bend = 2 * np.einsum("ijkb,jb,kb->ib", slope, along, along)
    bend -= np.einsum("jkib,jb,kb->ib", slope, along, along)
    return np.asarray(0.5 * position * (1 - position) * bend)
