"""What holds the nodes of a surface: bonds that end there, corners' chords, membranes and layers.

Each piece has an energy ½ Σ w ε² of strains ε that are linear in the values of its ends; here are
the weights and the rows. Why the energies are what they are: `solver.bonds.ended`; the membrane
along the edge and layers along interfaces: `skin`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse

from ..arrays import Array, Indices
from ..bonds import EndedBonds
from ..bonds.ended import SHORTEST
from ..geometry.outline import INNER
from ..material import Family, Moduli, PolarModuli
from .skin import layers, skinned, thickness

# Share of a node's stiffness that a layer along an interface may take, for each of its edges.
_BORNE = 1.0 / 16.0


class Membrane(NamedTuple):
    """The membrane that makes up for strips of the lattice along the edge (`skin`).

    Attributes
    ----------
    edges : ndarray of int, shape (e,)
        Of the outline.
    along : ndarray, shape (2 or 1, e)
        Their directions; zero where the strain is the curvature of a polar solid along an edge.
    weight : ndarray, shape (e,)
        Twice the energy for a strain of one along each edge.
    strain : sparse, shape (e, components·s)
        That strain of the nodes' values.
    """

    edges: Indices
    along: Array
    weight: Array
    strain: sparse.csr_array

    def stiffening(self) -> Membrane:
        """Only what stiffens of it."""
        return self._replace(weight=np.maximum(self.weight, 0.0))


def membrane(ended: EndedBonds, family: Family, moduli: Moduli, number: Indices) -> Membrane | None:
    """The membrane of a body, None without edges that have one.

    Parameters
    ----------
    number : ndarray of int, shape (nodes of the outline,)
        Of each node among those at which bonds end, −1 for others.
    """
    outline, c = ended.outline, moduli.components
    ends = number[outline.edges]
    bearing = skinned(outline, family) & (outline.face != INNER)
    edges = np.nonzero(bearing & ended.surface & (ends >= 0).all(axis=1))[0]
    if not len(edges):
        return None
    stiffness = thickness(outline, family, moduli, edges, ended.edge_factor) / family.cell_area
    length = outline.length[edges]
    along = (outline.nodes[outline.edges[edges, 1]] - outline.nodes[outline.edges[edges, 0]]).T
    along = along / length if c > 1 else np.ones((1, len(edges)))
    rows = np.zeros((1, c, len(edges)))
    rows[0, : len(along)] = along / length
    one = np.ones(len(edges))
    count = int(number.max(initial=-1)) + 1
    across = [(ends[edges, 1], one), (ends[edges, 0], -one)]
    found = Membrane(edges, along, stiffness * length, place(rows, across, count))
    if not isinstance(moduli, PolarModuli):
        return found
    # What curvature along the edge meets, in the same strip.
    bending = thickness(outline, family, moduli.curvature, edges) / family.cell_area
    turned = np.zeros((1, c, len(edges)))
    turned[0, 2] = 1.0 / (moduli.scales(family.spacing)[2] * length)
    return Membrane(
        np.concatenate([edges, edges]),
        np.concatenate([along, np.zeros_like(along)], axis=1),
        np.concatenate([found.weight, bending * length]),
        sparse.csr_array(sparse.vstack([found.strain, place(turned, across, count)])),
    )


class Layers(NamedTuple):
    """What lattices lack along interfaces (`skin.layers`).

    Attributes
    ----------
    weight : ndarray, shape (strains, e)
        Twice the energy for a strain of one along each edge.
    strain : sparse, shape (strains·e, components·s)
        These strains of the nodes' values.
    edges : ndarray of int, shape (e,)
        Of the outline.
    along : ndarray, shape (2, e)
        Their directions.
    """

    weight: Array
    strain: sparse.csr_array
    edges: Indices
    along: Array

    @property
    def stiffness(self) -> sparse.csc_array:
        """Of the nodes."""
        scaled = sparse.diags_array(self.weight.ravel()) @ self.strain
        return sparse.csc_array(self.strain.T @ scaled)

    def bearable(
        self, matrix: sparse.csc_array, spread: sparse.csr_array | None, twin: Indices
    ) -> Layers:
        """The same without more softening than the nodes bear.

        Values that alternate from node to node have half the stiffness of the diagonal (as a mass
        matrix has a third of its row sums), and twice what the layers of both their edges add
        to it: where each takes no more than a sixteenth half of that is left for one strain. It is
        a measure, no proof, as strains and rotations act together: nodes that are not held all the
        same keep what stiffens only (`SurfaceStiffness`). What both sides of an interface add
        counts together, as the stretch along it is common to both.

        Parameters
        ----------
        matrix : sparse, shape (components·s, components·s)
            The nodes' stiffness without the layers.
        spread : sparse, optional
            See `SurfaceStiffness`.
        twin : ndarray of int, shape (e,)
            The same edge seen from the other side.
        """
        whole = matrix if spread is None else spread.T @ matrix @ spread
        diagonal = np.abs(whole.diagonal() if spread is None else spread @ whole.diagonal())
        rows = sparse.csr_array(self.strain)
        square = sparse.csr_array((rows.data**2, rows.indices, rows.indptr), shape=rows.shape)
        # What a weight of one adds to its nodes, over what they have.
        each = square @ sparse.diags_array(1.0 / np.maximum(diagonal, np.finfo(float).tiny))
        share = np.asarray(each.max(axis=1).todense()).reshape(self.weight.shape)
        most = _BORNE / share
        both = self.weight + np.where(self.weight[:, twin] > 0, self.weight[:, twin], 0.0)
        weight = np.where(both < -most, self.weight - (both + most), self.weight)
        return self._replace(weight=np.minimum(weight, np.maximum(self.weight, 0.0)))

    def stiffening(self) -> Layers:
        """Only what stiffens of them."""
        return self._replace(weight=np.maximum(self.weight, 0.0))


def interface_layers(
    ended: EndedBonds, family: Family, moduli: Moduli, number: Indices
) -> tuple[Layers, Indices] | None:
    """Layers along interfaces and the twin of each of their edges, None without interfaces."""
    outline = ended.outline
    ends = number[outline.edges]
    edges = np.nonzero((outline.face == INNER) & (ends >= 0).all(axis=1))[0]
    if not len(edges):
        return None
    length = outline.length[edges]
    along = (outline.nodes[outline.edges[edges, 1]] - outline.nodes[outline.edges[edges, 0]]).T
    weight = layers(outline, family, moduli, edges) * length / family.cell_area
    scales, one = moduli.scales(family.spacing), np.ones(len(edges))
    count = int(number.max(initial=-1)) + 1
    strain = sparse.csr_array((weight.size, moduli.components * count))
    for end, sign in enumerate((-1.0, 1.0)):
        rows = moduli.end_rows(scales, along / length, sign, 0.5 * length) / length
        strain = strain + place(rows, [(ends[edges, end], one)], count)
    places = outline.standing_for(outline.edges[edges])
    key, back = (places @ np.array(by) for by in ((len(outline.nodes), 1), (1, len(outline.nodes))))
    order = np.argsort(key)
    found = order[np.minimum(np.searchsorted(key[order], back), len(order) - 1)]
    twin = np.where(key[found] == back, found, np.arange(len(edges)))
    return Layers(weight, strain, edges, along / length), twin


def chord_strains(
    ended: EndedBonds, family: Family, moduli: Moduli, number: Indices
) -> tuple[Array, Array, sparse.csr_array] | None:
    """Strains of the chords that corners cut out of bonds, None if there are no chords.

    Returns
    -------
    tuple of ndarray, shapes (strains·k,) and (2, k), and sparse, shape (strains·k, components·s)
        Twice the energy for a strain of one, normals, and the strains of the nodes' values.
    """
    chords = ended.chords
    if chords is None or not len(chords.offset):
        return None
    phase = None if ended.outline.phase is None else ended.outline.phase[chords.edge[:, 0]]
    rule = BondStrains(family, moduli, chords.offset, chords.length, chords.factor, phase)
    count = int(number.max(initial=-1)) + 1
    strain = sparse.csr_array((rule.weight.size, moduli.components * count))
    for end, sign in enumerate((-1.0, 1.0)):
        ends = number[ended.outline.edges[chords.edge[:, end]]]
        rows = rule.rows(sign, chords.arm[:, end])
        strain = strain + place(rows, between(ends, chords.position[:, end]), count)
    return rule.weight.ravel(), rule.normal, strain


class BondStrains:
    """The strains of bonds of given offsets and lengths, as rows of values at their ends."""

    @classmethod
    def of(cls, ended: EndedBonds, family: Family, moduli: Moduli) -> BondStrains:
        """Of the bonds that end at a surface or an interface."""
        return cls(family, moduli, ended.offset, ended.length, ended.factor, ended.phase)

    def __init__(
        self,
        family: Family,
        moduli: Moduli,
        offset: Indices,
        length: Array,
        factor: Array | None = None,
        phase: Indices | None = None,
    ) -> None:
        self.moduli, self.normal = moduli, family.normal[offset].T
        self.scales = moduli.scales(family.spacing)
        # A bond without length would be a rigid link. Below a share of the spacing its stiffness
        # grows no more; its geometry stays, so that rigid motions still strain nothing.
        self.length = np.maximum(length, SHORTEST * family.spacing)
        # The energy is that of the bond's part within the body.
        share = self.length / family.length[offset]
        weight = family.weight[offset] * family.cell_area * share
        #: Twice the energy for a strain of one, shape (strains, k).
        self.weight: Array = (
            weight * moduli.pair_length(family)[offset] * moduli.of_bonds(offset, phase)
        )
        if factor is not None:
            self.weight *= factor

    def rows(self, end: float, arm: Array) -> Array:
        """The share of one end, shape (strains, components, k).

        Parameters
        ----------
        end : float
            −1 where the bond starts, 1 where it ends.
        arm : ndarray, shape (k,), m
            What the rotation there contributes to −ℓ γ.
        """
        return self.moduli.end_rows(self.scales, self.normal, end, arm) / self.length


def between(nodes: Indices, position: Array) -> list[tuple[Indices, Array]]:
    """Nodes (k, 2) and weights of points along edges."""
    return [(nodes[:, 0], 1 - position), (nodes[:, 1], position)]


def place(rows: Array, ends: list[tuple[Indices, Array]], count: int) -> sparse.csr_array:
    """Rows (strains, components, k) of values that are weighted means over `ends`."""
    strains, components, size = rows.shape
    row = np.arange(strains * size).reshape(strains, size)
    values, i, j = [], [], []
    for a in range(strains):
        for b in range(components):
            for place, weight in ends:
                values.append(rows[a, b] * weight)
                i.append(row[a])
                j.append(b * count + place)
    entries = np.concatenate(values), (np.concatenate(i), np.concatenate(j))
    return sparse.csr_array(entries, shape=(strains * size, components * count))


def mutual(weight: Array, one: Array, other: Array) -> Array:
    """Σ_a w_a r_a sᵀ_a of bonds, shape (c, c, k), for rows r and s of shape (strains, c, k)."""
    return np.asarray(np.einsum("abk,ack->bck", weight[:, None] * one, other))


def of_edges(ended: EndedBonds, nodes: Indices, blocks: Array, count: int) -> sparse.csc_array:
    """K_ss of bonds that end between `nodes` (k, 2): all that end at one edge as one.

    Parameters
    ----------
    blocks : ndarray, shape (c, c, k)
        `mutual` stiffness of the bonds' surface ends.
    count : int
        Of all nodes.
    """
    c, edges = len(blocks), len(ended.outline.edges)
    at = np.zeros((edges, 2), dtype=np.int64)
    at[ended.edge] = nodes
    some = np.nonzero(np.bincount(ended.edge, minlength=edges))[0]
    ends = at[some].T
    share = 1.0 - ended.position, ended.position
    data = np.empty((2, 2, c, c, len(some)))
    for i, j, a, b in np.ndindex(2, 2, c, c):
        weights = share[i] * share[j] * blocks[a, b]
        data[i, j, a, b] = np.bincount(ended.edge, weights, minlength=edges)[some]
    component = count * np.arange(c)[:, None]
    rows = np.broadcast_to((ends[:, None] + component)[:, None, :, None], data.shape)
    columns = np.broadcast_to((ends[:, None] + component)[None, :, None], data.shape)
    entries = data.ravel(), (rows.ravel(), columns.ravel())
    return sparse.coo_array(entries, shape=(c * count,) * 2).tocsc()


def joined(
    ended: EndedBonds, nodes: Indices, here: Indices, blocks: Array, count: tuple[int, int]
) -> sparse.csr_array:
    """K_sp of bonds between particles `here` (k,) and edges: all between the same two as one.

    Parameters
    ----------
    nodes, blocks
        See `of_edges`; the blocks are those of surface and particle.
    count : pair of int
        Of all particles and of all nodes.
    """
    c, (particles, every) = len(blocks), count
    pair, first, of = np.unique(
        ended.edge * particles + here, return_index=True, return_inverse=True
    )
    share = 1.0 - ended.position, ended.position
    data = np.empty((2, c, c, len(pair)))
    for i, a, b in np.ndindex(2, c, c):
        data[i, a, b] = np.bincount(of, share[i] * blocks[a, b], minlength=len(pair))
    component = np.arange(c)[:, None]
    rows = np.broadcast_to((nodes[first].T[:, None] + every * component)[:, :, None], data.shape)
    columns = np.broadcast_to((here[first] + particles * component)[None, None], data.shape)
    entries = data.ravel(), (rows.ravel(), columns.ravel())
    return sparse.coo_array(entries, shape=(c * every, c * particles)).tocsr()
