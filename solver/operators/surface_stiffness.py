"""Stiffness of the bonds that end at the surface, with the surface's nodes condensed out.

What is assembled here, piece by piece: `surface_pieces`.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

from ..arrays import Array, Indices, Mask
from ..bonds import EndedBonds
from ..material import Family, Moduli
from .blocks import entries
from .halves import Halves
from .surface_pieces import (
    BondStrains,
    Layers,
    Membrane,
    chord_strains,
    interface_layers,
    joined,
    membrane,
    mutual,
    of_edges,
)

# Ratio of pivots below which the nodes' stiffness counts as singular.
_SINGULAR = 1e-14


def stiffness_of(ended: EndedBonds, family: Family, moduli: Moduli) -> SurfaceStiffness:
    """Stiffness of some bonds; made once, however many other bonds break."""
    known = ended.__dict__.get("_known")
    if known is None or known[0] is not moduli:
        known = moduli, SurfaceStiffness(ended, family, moduli)
        # The dataclass is frozen for everybody else.
        ended.__dict__["_known"] = known
    stiffness: SurfaceStiffness = known[1]
    return stiffness


class SurfaceStiffness:
    """Stiffness of the ended bonds, the nodes' displacements condensed out.

    Vectors over particles or nodes are component by component, as the operator's.

    Parameters
    ----------
    ended : EndedBonds
    family : Family
    moduli : Moduli

    Attributes
    ----------
    particles : ndarray of int, shape (p,)
        Particles with ended bonds.
    nodes : ndarray of int, shape (s,)
        Nodes of the outline that they end between.
    """

    def __init__(self, ended: EndedBonds, family: Family, moduli: Moduli) -> None:
        self.ended, self.components = ended, moduli.components
        components = self.components
        self._relief: tuple[Array, Mask] | None = None
        self.particles, here = np.unique(ended.particle, return_inverse=True)
        ends = ended.outline.edges[ended.edge]
        self.nodes = np.unique(ends)
        count = len(self.particles), len(self.nodes)
        number = self.number
        length = ended.length
        rule = BondStrains.of(ended, family, moduli)
        whole = family.length[ended.offset]
        particle = rule.rows(-1.0, 0.5 * whole)
        surface = rule.rows(1.0, length - 0.5 * whole)
        self._ends = particle, surface
        #: Diagonal entries of the particles in the operator's order, shape (entries, p).
        self.own: Array = np.array(
            [
                np.bincount(
                    here,
                    (rule.weight * particle[:, a] * particle[:, b]).sum(axis=0),
                    minlength=count[0],
                )
                for a, b in entries(components)
            ]
        )
        #: Values of all nodes for those that are free of each other, shape (components·s, free).
        self._spread = self._sharing(moduli)
        #: K_sp, shape (components·s, components·p).
        self.coupling: sparse.csr_array = joined(
            ended, number[ends], here, mutual(rule.weight, surface, particle), count
        )
        #: K_ps.
        self.transposed: sparse.csr_array = sparse.csr_array(self.coupling.T)
        matrix = of_edges(ended, number[ends], mutual(rule.weight, surface, surface), count[1])
        if (chords := chord_strains(ended, family, moduli, number)) is not None:
            weight, _, strain = chords
            matrix = matrix + sparse.csc_array(strain.T @ sparse.diags_array(weight) @ strain)
        inner = None
        if (found := interface_layers(ended, family, moduli, number)) is not None:
            inner = found[0].bearable(matrix, self._spread, found[1])
            bonds_alone, matrix = matrix, matrix + inner.stiffness
        skin = membrane(ended, family, moduli, number)
        #: K_ss.
        self.matrix: sparse.csc_array = matrix + _stiffness_of_skin(skin, matrix.shape)
        #: Whether the membrane only stiffens.
        self.stiffened = False
        self._hold()
        self._lu = self._factorise(number[ended.outline.edges])
        if moduli.non_negative and self._lu.U.diagonal().min(initial=1.0) < 0.0:
            # Where few bonds hold a node, what is too much of the lattice must not soften it.
            self.stiffened = True
            skin = None if skin is None else skin.stiffening()
            if inner is not None:
                inner = inner.stiffening()
                matrix = bonds_alone + inner.stiffness
            self.matrix = matrix + _stiffness_of_skin(skin, matrix.shape)
            self._hold()
            self._lu = self._factorise(number[ended.outline.edges])

        #: What lattices lack along interfaces, as it is counted.
        self.layers: Layers | None = inner

    @property
    def number(self) -> Indices:
        """Position among `nodes` of every node of the outline, −1 for those without bonds."""
        found = np.full(len(self.ended.outline.nodes), -1)
        found[self.nodes] = np.arange(len(self.nodes))
        return found

    def _sharing(self, moduli: Moduli) -> sparse.csr_array | None:
        """Which components of which nodes are one; None if none are.

        Phases that meet at an interface move together there. Their rotations are their own: the
        displacement has a kink, and half its curl a jump.
        """
        outline, count = self.ended.outline, len(self.nodes)
        if outline.shared is None:
            return None
        _, place = np.unique(outline.shared[self.nodes], return_inverse=True)
        column, first = [], 0
        for turning in moduli.physics.turning[: self.components]:
            column.append(first + (np.arange(count) if turning else place))
            first = int(column[-1].max()) + 1
        where = np.arange(self.components * count), np.concatenate(column)
        return sparse.csr_array((np.ones(len(where[0])), where), shape=(len(where[0]), first))

    def _gathered(self, nodal: Array) -> Array:
        """Forces on what is free of each other, for those of all nodes, flattened."""
        return nodal if self._spread is None else self._spread.T @ nodal

    def _spread_out(self, free: Array) -> Array:
        """Values of all nodes, flattened."""
        return free if self._spread is None else self._spread @ free

    def _hold(self) -> None:
        """Set the nodes' prescribed components apart: identity rows among the others'."""
        ended = self.ended
        matrix, coupling = self.matrix, self.coupling
        if self._spread is not None:
            matrix = sparse.csc_array(self._spread.T @ matrix @ self._spread)
            coupling = sparse.csr_array(self._spread.T @ coupling)
        self._whole = matrix
        #: Prescribed components and their values, of what is free of each other.
        self.held: Mask = np.zeros(matrix.shape[0], dtype=bool)
        self.given: Array = np.zeros(matrix.shape[0])
        if ended.held is not None and ended.given is not None:
            self.held = self._gathered(ended.held[:, self.nodes].ravel().astype(np.float64)) > 0
            self.given = self._prescribed(ended.given)
        self._free_matrix, self._free_coupling = matrix, coupling
        self._back: sparse.csr_array = (
            self.transposed if self._spread is None else sparse.csr_array(coupling.T)
        )
        self._scale = 1.0
        if self.held.any():
            free = sparse.diags_array((~self.held).astype(np.float64))
            self._scale = float(np.abs(matrix.diagonal()).mean())
            identity = sparse.diags_array(self.held * self._scale)
            self._free_matrix = sparse.csc_array(free @ matrix @ free + identity)
            self._free_coupling = sparse.csr_array(free @ coupling)

    def _prescribed(self, given: Array) -> Array:
        """Values of held nodes (components, nodes of the outline) of what is free of each other."""
        held = self.ended.held
        assert held is not None
        times = self._gathered(held[:, self.nodes].ravel().astype(np.float64))
        values = np.where(held, given, 0.0)[:, self.nodes].ravel()
        return np.asarray(self._gathered(values) / np.maximum(times, 1.0))

    def _factorise(self, edges: Indices) -> SuperLU:
        """Factors of K_ss. `edges` joins all nodes of the outline, −1 for those without bonds."""
        options = {
            "permc_spec": "MMD_AT_PLUS_A",
            "diag_pivot_thresh": 0.0,
            "options": {"SymmetricMode": True},
        }
        try:
            factors = splu(self._free_matrix, **options)
            pivots = np.abs(factors.U.diagonal())
            if pivots.min() > _SINGULAR * pivots.max():
                return factors
        except RuntimeError:
            pass
        # Bonds that end at too few points, as on bodies of a few particles, leave nodes undecided:
        # these follow their neighbours along the outline.
        a, b = edges[(edges >= 0).all(axis=1)].T
        size = self.matrix.shape[0] // self.components
        ones = np.ones(len(a))
        adjacency = sparse.coo_array((ones, (a, b)), shape=(size, size))
        links = adjacency + adjacency.T
        laplacian = sparse.diags_array(links.sum(axis=0)) - links
        blocks = sparse.block_diag([laplacian] * self.components)
        scale = _SINGULAR**0.75 * np.abs(self.matrix.diagonal()).mean()
        self.matrix = sparse.csc_array(self.matrix + scale * blocks)
        self._hold()
        try:
            return splu(self._free_matrix, **options)
        except RuntimeError:
            # A scrap of surface that one bond or two end at, alone: it follows them where they do
            # not leave it undecided, so that hardly any stiffness on it makes no difference.
            hardly = _SINGULAR * np.abs(self.matrix.diagonal()).mean()
            size = self.matrix.shape[0]
            self.matrix = sparse.csc_array(self.matrix + hardly * sparse.eye_array(size))
            self._hold()
            return splu(self._free_matrix, **options)

    def energy(self, values: Array, nodal: Array, others: Array, other_nodal: Array) -> float:
        """Half the mutual energy of two fields, per volume of a particle.

        Parameters
        ----------
        values, others : ndarray, shape (components, p)
        nodal, other_nodal : ndarray, shape (components, s)
            With `nodal` of the same field twice: its energy.
        """
        c = self.components
        found = float((others * (self.transposed @ nodal.ravel()).reshape(c, -1)).sum())
        found += float((other_nodal * (self.coupling @ values.ravel()).reshape(c, -1)).sum())
        found += float((other_nodal * (self.matrix @ nodal.ravel()).reshape(c, -1)).sum())
        for entry, (a, b) in zip(self.own, entries(c), strict=True):
            found += float((entry * others[a] * values[b]).sum())
            if a != b:
                found += float((entry * others[b] * values[a]).sum())
        return 0.5 * found

    def nodal(self, values: Array, load: Array | None = None, given: Array | None = None) -> Array:
        """Displacements of the nodes for values of the particles, (components, s).

        Parameters
        ----------
        values : ndarray, shape (components, p)
        load : ndarray, shape (components, nodes of the outline), optional
            Forces on the nodes per volume of a particle.
        given : ndarray, shape (components, nodes of the outline), optional
            Values of held nodes, if others than those of the bonds.
        """
        force = -(self._free_coupling @ values.ravel()) + self._force(load, given)
        return np.asarray(self._spread_out(self._lu.solve(force)).reshape(self.components, -1))

    def _force(self, load: Array | None, given: Array | None = None) -> Array:
        """Right-hand side of the nodes for loads and prescribed values, shape (free,)."""
        if load is None:
            force = np.zeros(len(self.held))
        else:
            force = self._gathered(load[:, self.nodes].ravel())
        if self.held.any():
            values = self.given if given is None else self._prescribed(given)
            force = force - self._whole @ values
            force[self.held] = self._scale * values[self.held]
        return force

    def reaction(self, values: Array) -> Array:
        """−K_ps K_ss⁻¹ K_sp u: what the nodes do to the particles, both (components, p)."""
        nodes = self._lu.solve(-(self._free_coupling @ values.ravel()))
        return np.asarray((self._back @ nodes).reshape(values.shape))

    def condensed_load(self, load: Array, given: Array | None = None) -> Array:
        """−K_ps K_ss⁻¹ f: loads of the particles that replace those of the nodes, on the left.

        `given` are values of held nodes, if others than those of the bonds; see `nodal`.
        """
        nodes = self._lu.solve(self._force(load, given))
        return (self._back @ nodes).reshape(self.components, -1)

    def condensed(self, basis: sparse.csr_array, least: float = 0.0) -> sparse.csr_array:
        """−Bᵀ K_ps K_ss⁻¹ K_sp B for a sparse basis B of the particles' values.

        Entries below `least` of the largest are left out, and the diagonal makes up for them.
        """
        half, signed = self._halves.of(sparse.csc_array(self._free_coupling @ basis))
        form = sparse.csr_array(half.T @ signed)
        return _lumped(-0.5 * sparse.csr_array(form + form.T), least)

    def strains(self, values: Array, nodal: Array) -> tuple[Array, Array]:
        """Strains s and γ (or g) of the bonds, and the differences of the values at their ends.

        Parameters
        ----------
        values, nodal : ndarray, shapes (components, p) and (components, s)
            Of the particles and of the nodes.

        Returns
        -------
        tuple of ndarray, shapes (strains, k) and (components, k)
        """
        here = np.searchsorted(self.particles, self.ended.particle)
        ends = self.number[self.ended.outline.edges[self.ended.edge]]
        position = self.ended.position
        there = (1 - position) * nodal[:, ends[:, 0]] + position * nodal[:, ends[:, 1]]
        at = values[:, here]
        strain = np.einsum("abk,bk->ak", self._ends[0], at)
        strain += np.einsum("abk,bk->ak", self._ends[1], there)
        return strain, there - at

    def energies(
        self, family: Family, moduli: Moduli, values: Array, nodal: Array
    ) -> tuple[Array, list[tuple[Array, Array]]]:
        """Energies of all that ends at the surface, piece by piece, per volume of a particle.

        Parameters
        ----------
        family : Family
        moduli : Moduli
            Those that it was made of.
        values, nodal : ndarray, shapes (components, p) and (components, s)
            Of the particles and of the nodes.

        Returns
        -------
        bonds : ndarray, shape (k,)
            Of the bonds that end at the surface.
        others : list of (places, shape (l, 2), m; energies, shape (l,))
            Of the corners' chords and of the membrane along the edge, where there are any.
        """
        ended, outline, number = self.ended, self.ended.outline, self.number
        rule = BondStrains.of(ended, family, moduli)
        strains, _ = self.strains(values, nodal)
        others = []
        if (chords := ended.chords) is not None:
            known = chord_strains(ended, family, moduli, number)
            if known is not None:
                weight, _, strain = known
                energy = 0.5 * (weight * (strain @ nodal.ravel()) ** 2)
                ends = outline.nodes[outline.edges[chords.edge]].mean(axis=(1, 2))
                others.append((ends, energy.reshape(-1, len(ends)).sum(axis=0)))
        skin = membrane(ended, family, moduli, number)
        if skin is not None:
            skin = skin.stiffening() if self.stiffened else skin
            middle = outline.nodes[outline.edges[skin.edges]].mean(axis=1)
            others.append((middle, 0.5 * skin.weight * (skin.strain @ nodal.ravel()) ** 2))
        return 0.5 * (rule.weight * strains**2).sum(axis=0), others

    def relief(self, which: Indices) -> Array:
        """Diagonal blocks of −K_ps K_ss⁻¹ K_sp of some particles (positions among `particles`).

        Shape (len(which), components, components). What was asked for once is kept: other bonds
        break, these do not.
        """
        if self._relief is None:
            c, count = self.components, len(self.particles)
            self._relief = np.zeros((count, c, c)), np.zeros(count, dtype=bool)
        blocks, known = self._relief
        wanted = which[~known[which]]
        if len(wanted):
            blocks[wanted], known[wanted] = self._relief_of(wanted), True
        return blocks[which]

    def _relief_of(self, which: Indices) -> Array:
        c, count = self.components, len(self.particles)
        columns = (which + count * np.arange(c)[:, None]).ravel()
        found = self._halves.of(sparse.csc_array(self._free_coupling[:, columns]))
        # One particle's columns at a time: only their products among themselves count.
        half, signed = (
            [part[:, a * len(which) : (a + 1) * len(which)] for a in range(c)] for part in found
        )
        blocks = np.zeros((len(which), c, c))
        for a in range(c):
            for b in range(c):
                blocks[:, a, b] = -half[a].multiply(signed[b]).sum(axis=0)
        return 0.5 * (blocks + blocks.transpose(0, 2, 1))

    @cached_property
    def _halves(self) -> Halves:
        return Halves(self._lu)

    @cached_property
    def nbytes(self) -> int:
        """Memory of matrices and factors, bytes."""
        matrices = (self.coupling, self.transposed)
        size = sum(m.data.nbytes + m.indices.nbytes + m.indptr.nbytes for m in matrices)
        return int(size + 12 * self._lu.nnz + self.own.nbytes + self.ended.nbytes)


def _stiffness_of_skin(skin: Membrane | None, shape: tuple[int, int]) -> sparse.csc_array:
    if skin is None:
        return sparse.csc_array(shape)
    return sparse.csc_array(skin.strain.T @ sparse.diags_array(skin.weight) @ skin.strain)


def _lumped(matrix: sparse.csr_array, least: float) -> sparse.csr_array:
    """A symmetric matrix without its small entries, their sizes added to the diagonal.

    What is added is positive semi-definite: it cannot take stiffness away.
    """
    small = np.abs(matrix.data) < least * np.abs(matrix.data).max(initial=0.0)
    gone = matrix.copy()
    gone.data = np.where(small, np.abs(matrix.data), 0.0)
    matrix.data[small] = 0.0
    matrix.eliminate_zeros()
    return sparse.csr_array(matrix + sparse.diags_array(gone.sum(axis=1)))
