"""Kinematic constraints: particles that move as one rigid body, components with one common value.

Constrained unknowns (slaves) follow from a few masters, u_s = û_s + T z: û holds what is prescribed
(a pin that is moved, say), z the masters that are free, such as a pin's turn. Work is done on the
masters by Tᵀ: with x the other unknowns, energy and loads give

    [ K_xx      K_xs T    ] [x]   [ f_x − K_xs û_s         ]
    [ Tᵀ K_sx   Tᵀ K_ss T ] [z] = [ Tᵀ (f_s − K_ss û_s)    ],

symmetric, and positive wherever K is. Slaves are no unknowns of the operator: it has them among its
prescribed ones, and everything that serves it (products, preconditioner, cracks that grow) serves
the bordered system (`solver.linear.bordered`) as it is. Once z is known, û + T z are values like
any other prescribed ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ..arrays import Array, Indices, Mask
from ..errors import SceneError
from ..geometry import Lattice
from ..material import Moduli
from .supports import Support
from .values import evaluate


@dataclass(frozen=True, eq=False)
class Constraints:
    """Which unknowns follow from which masters.

    Attributes
    ----------
    slaves : ndarray of bool, shape (components, N)
    basis : csc_array, shape (components·N, masters)
        T, its rows in the order of the slaves' flattened array.
    names : tuple of str
        What each master is.
    """

    slaves: Mask
    basis: sparse.csc_array
    names: tuple[str, ...]

    @property
    def count(self) -> int:
        """Number of free masters."""
        return int(self.basis.shape[1])

    def field(self, masters: Array) -> Array:
        """T z, shape (components, N)."""
        return np.asarray((self.basis @ masters).reshape(self.slaves.shape))

    def project(self, field: Array) -> Array:
        """Tᵀ f for a field of shape (components, N), shape (masters,)."""
        return np.asarray(self.basis.T @ field.ravel())

    def held(self, motions: Array) -> Array:
        """What remains of some motions at the slaves when masters follow as they can.

        Parameters
        ----------
        motions : ndarray, shape (motions, components, N)

        Returns
        -------
        ndarray, as `motions`: zero where the constraints allow the motion, and off the slaves.
        """
        flat = np.where(self.slaves, motions, 0.0).reshape(len(motions), -1)
        if self.count:
            rows = np.unique(self.basis.nonzero()[0])
            dense = self.basis[rows].toarray()
            flat[:, rows] -= (dense @ np.linalg.lstsq(dense, flat[:, rows].T, rcond=None)[0]).T
        return flat.reshape(motions.shape)

    def joined(self, labels: NDArray[np.int32]) -> NDArray[np.int32]:
        """Part numbers, those of parts made one that a master moves."""
        labels = labels.copy()
        for column in range(self.count):
            rows = self.basis[:, [column]].nonzero()[0]
            mine = np.unique(labels[rows % len(labels)])
            labels[np.isin(labels, mine)] = mine[0]
        return labels


def build(
    supports: list[Support],
    lattice: Lattice,
    moduli: Moduli,
    prescribed: Mask,
    values: Array,
) -> Constraints | None:
    """Constraints of rigid and tied supports, None without any.

    `prescribed` and `values`, of the other supports, are added to: slaves count as prescribed.

    Raises
    ------
    SceneError
        If two supports want the same unknown, or a pin holds a single particle.
    """
    slaves = np.zeros_like(prescribed)
    columns: list[tuple[Indices, Array]] = []
    names: list[str] = []
    scales = moduli.scales(lattice.spacing)
    physics = moduli.physics
    for number, support in enumerate(supports, 1):
        selected = support.select(lattice)
        if not selected.any():
            raise SceneError("a support holds no particle: its layer or region is empty")
        if support.tied is not None:
            for name in support.tied:
                for unknown in physics.supports.get(name, ()):
                    if unknown >= moduli.components:
                        continue
                    _claim(slaves, prescribed, np.arange(len(slaves)) == unknown, selected)
                    flat = unknown * lattice.count + np.nonzero(selected)[0]
                    columns.append((flat, np.ones(len(flat))))
                    names.append(f"tied {physics.unknowns[unknown]} of support {number}")
            if support.tied and not set(support.tied) <= set(physics.supports):
                wrong = sorted(set(support.tied) - set(physics.supports))
                raise SceneError(f"{physics.adjective} scene has no {', '.join(wrong)} to tie")
            continue
        if len(physics.motion_names) != 3:
            raise SceneError(f"{physics.adjective} scene has no rigid pins")
        _claim(slaves, prescribed, np.ones(len(slaves), dtype=bool), selected)
        if selected.sum() < 2:
            raise SceneError("a rigid pin needs two particles at least: prescribe a single one")
        points = lattice.points[selected]
        centre = points.mean(axis=0) if support.centre is None else np.array(support.centre)
        motions = physics.motions(points - centre)[:, : moduli.components]
        motions = motions * scales[:, None]
        # As the rotations among the unknowns, a pin's turn is scaled by the spacing.
        motions[2] /= lattice.spacing
        flat = (
            np.arange(moduli.components)[:, None] * lattice.count + np.nonzero(selected)[0]
        ).ravel()
        given = support.columns(physics)
        fixed: dict[int, float] = {}
        for unknown, value, component, width in given:
            where = evaluate(value, centre[None], width, "the motion of a rigid pin")
            fixed[unknown] = float(where[0, component])
        for unknown, name in enumerate(physics.motion_names):
            if unknown in fixed:
                scale = lattice.spacing if unknown == 2 else 1.0
                values.ravel()[flat] += scale * fixed[unknown] * motions[unknown].ravel()
            else:
                columns.append((flat, motions[unknown].ravel()))
                names.append(f"{name} of pin {number}")
    if not slaves.any():
        return None
    prescribed |= slaves
    rows = np.concatenate([c[0] for c in columns]) if columns else np.zeros(0, dtype=np.int64)
    data = np.concatenate([c[1] for c in columns]) if columns else np.zeros(0)
    index = np.repeat(np.arange(len(columns)), [len(c[0]) for c in columns])
    shape = (slaves.size, len(columns))
    return Constraints(slaves, sparse.csc_array((data, (rows, index)), shape=shape), tuple(names))


def _claim(slaves: Mask, prescribed: Mask, unknowns: Mask, selected: Mask) -> None:
    mine = unknowns[:, None] & selected
    if (mine & (slaves | prescribed)).any():
        raise SceneError(
            "a rigid pin or a tie holds unknowns that another support prescribes too: let them "
            "not overlap"
        )
    slaves |= mine
