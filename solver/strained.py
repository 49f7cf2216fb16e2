"""A conductor under strain: the bonds' moduli follow their stretch (`Piezoresistance`).

Mechanics and conduction share the lattice, not the family: the stretch of every bond of the
conductor is that of the displacements at its two ends, s = n·(u' − u)/|ξ|, less what a temperature
strains without stress. What ends at the surface (bonds, corners' chords, the membrane) takes the
strain tensor at its particle, or at the nearest one: exact in a homogeneous strain, and within a
horizon of an edge first order in a part of the body that vanishes with it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from . import recovery
from .arrays import Array, Indices
from .bonds import Bonds, Factors
from .errors import SceneError
from .material import AngularLaw, ConductiveModuli, ConductivityTensor, Moduli, Piezoresistance
from .material.physics import ELASTICITY
from .material.strains import homogeneous_stretch
from .problem import Description
from .state import State

D = TypeVar("D", bound=Description)


def strained(conductor: D, state: State, piezoresistance: Piezoresistance) -> D:
    """The scene of a conductor as a state of the same body has strained it.

    Parameters
    ----------
    conductor : Scene
        Of heat or electrical conduction, without strain.
    state : State
        Of an elastic body on the same lattice, a `Solution` or `Growth.solution`.
    piezoresistance : Piezoresistance

    Raises
    ------
    SceneError
        If the scene does not conduct or the state is no elastic one; when it is discretised, if the
        lattices differ, bonds conduct across what has parted in the state, or a bond is stretched
        so far that its conductivity would be negative.

    Examples
    --------
    >>> from solver import ElasticTensor, ElectricConductivityTensor, Scene, Support, rectangle
    >>> def stretched(x, y):
    ...     return np.stack([1e-3 * x, 0 * y], axis=-1)
    >>> square, held = rectangle(1, 1), Support.layer(2.5, displacement=stretched, rotation=0.0)
    >>> pulled = Scene(square, 0.1, ElasticTensor.isotropic(1.0, 0.2), [held], m=2).solve()
    >>> live = Support.layer(2.5, potential=lambda x, y: x)
    >>> bar = Scene(square, 0.1, ElectricConductivityTensor.isotropic(1.0), [live], m=2)
    >>> now = strained(bar, pulled, Piezoresistance(4.0)).solve()
    >>> f"{recovery.current_density(now)[44, 0]:.4f}"
    '-1.0030'
    """
    if len(conductor.physics.unknowns) != 1:
        raise SceneError(
            f"only conductors change their conductivity, not {conductor.physics.adjective} body"
        )
    if state.physics is not ELASTICITY:
        raise SceneError(f"a state of {state.physics.name} strains nothing: it must be elastic")
    if conductor.factors is not None:
        raise SceneError("the conductor is strained already: strain it from its unstrained scene")
    assert isinstance(conductor.material, ConductivityTensor)
    found = Stretched(state, piezoresistance, conductor.material, conductor.law)
    return replace(conductor, factors=found)


@dataclass(frozen=True, eq=False)
class Stretched:
    """Factors of a conductor's bonds in a state, as `Description.factors` calls them."""

    state: State
    piezoresistance: Piezoresistance
    material: ConductivityTensor
    angular: AngularLaw | None

    def __call__(self, bonds: Bonds, moduli: Moduli) -> Factors:
        """The factor of every bond.

        Raises
        ------
        SceneError
            See `strained`.
        """
        self._require_same_body(bonds)
        assert isinstance(moduli, ConductiveModuli)
        family, law = bonds.family, self.piezoresistance
        gauges = law.gauges(family, moduli, self.material, self.angular)
        whole = np.ones((family.size, bonds.lattice.count))
        for o in range(family.size // 2):
            exists = bonds.strength(o) != 0
            elastic, total = (np.where(exists, s, 0.0) for s in self.of_offset(bonds, o))
            gone = law.wrong(gauges[o], elastic, total)
            if gone.any():
                k = int(np.argmax(gone))
                raise self._error(bonds, k, float(elastic[k]), float(gauges[o]))
            whole[o] = law.factor(gauges[o], elastic, total)
        self._opposite(bonds, whole)
        if bonds.ended is None:
            return Factors(whole)
        return Factors(whole, *self._of_surface(bonds, gauges))

    def of_offset(self, bonds: Bonds, o: int) -> tuple[Array, Array]:
        """Elastic and total stretch of the bonds of one offset, each (N,); 0 where unknown."""
        lattice, family = bonds.lattice, bonds.family
        rows, columns = lattice.rows_columns
        dx, dy = family.offsets[o]
        u = np.nan_to_num(self.state.unknowns[:2])
        there = lattice.to_grid(u)[:, rows + dy, columns + dx]
        aside = np.isnan(self.state.unknowns[0]).astype(np.float64)
        unknown = (aside > 0) | (lattice.to_grid(aside)[rows + dy, columns + dx] > 0)
        total = np.einsum("i,in->n", family.normal[o], there - u) / family.length[o]
        total[unknown] = 0.0
        free = self.state.discretisation.eigenstrain
        if free is None:
            return total, total
        mean = 0.5 * (free.particles + lattice.to_grid(free.particles)[:, rows + dy, columns + dx])
        return total - homogeneous_stretch(family.normal[o][:, None])[:, 0] @ mean, total

    def _opposite(self, bonds: Bonds, whole: Array) -> None:
        """Fill in the factors of the other direction of every bond."""
        lattice, family = bonds.lattice, bonds.family
        rows, columns = lattice.rows_columns
        half = family.size // 2
        for o, (dx, dy) in enumerate(family.offsets[:half]):
            whole[o + half] = lattice.to_grid(whole[o])[rows - dy, columns - dx]

    def _of_surface(self, bonds: Bonds, gauges: Array) -> tuple[Array, Array | None, Array]:
        """Factors of ended bonds, chords and edges, from the strain at the nearest particles."""
        ended, family, law = bonds.ended, bonds.family, self.piezoresistance
        assert ended is not None
        slope = np.nan_to_num(recovery.displacement_gradient(self.state))
        strain = np.stack([slope[:, 0, 0], slope[:, 1, 1], slope[:, 0, 1] + slope[:, 1, 0]])
        free = self.state.discretisation.eigenstrain
        parts = strain if free is None else strain - free.particles, strain
        along = homogeneous_stretch(family.normal.T)

        def factor(offset: Indices, particle: Indices) -> Array:
            n, gauge = along[:, offset], gauges[offset]
            elastic, total = (np.einsum("vk,vk->k", n, part[:, particle]) for part in parts)
            gone = law.wrong(gauge, elastic, total)
            if gone.any():
                k = int(np.argmax(gone))
                raise self._error(bonds, int(particle[k]), float(elastic[k]), float(gauge[k]))
            return law.factor(gauge, elastic, total)

        outline, tree = ended.outline, bonds.lattice.tree
        chords = None
        if ended.chords is not None and len(ended.chords.offset):
            first, last = (
                outline.nodes[outline.edges[ended.chords.edge[:, k]]].mean(axis=1) for k in (0, 1)
            )
            chords = factor(ended.chords.offset, tree.query(0.5 * (first + last))[1])
        half = family.size // 2
        middle = outline.nodes[outline.edges].mean(axis=1)
        nearest = np.repeat(tree.query(middle)[1], half)
        edges = factor(np.tile(np.arange(half), len(middle)), nearest).reshape(-1, half)
        return factor(ended.offset, ended.particle), chords, edges

    def _require_same_body(self, bonds: Bonds) -> None:
        known = self.state.discretisation
        here, there = bonds.lattice, known.bonds.lattice
        same = here.spacing == there.spacing and here.shift == there.shift
        if not (same and np.array_equal(here.points, there.points)):
            raise SceneError("mechanics and conduction share one lattice: their particles differ")
        mechanical = known.bonds
        if mechanical.phases is not None or bonds.phases is not None:
            raise SceneError("a strained conductor knows one solid: the scene has inclusions")
        offsets = {tuple(o): k for k, o in enumerate(mechanical.family.offsets.tolist())}
        for o, offset in enumerate(bonds.family.offsets[: bonds.family.size // 2].tolist()):
            other = offsets.get(tuple(offset))
            if other is None:
                continue
            parted = (mechanical.strength(other) == 0) & (bonds.strength(o) != 0)
            # What came loose is not strained, whatever became of its own bonds.
            parted &= ~np.isnan(self.state.unknowns[0])
            if parted.any():
                x, y = here.points[np.argmax(parted)] + np.array(here.shift)
                raise SceneError(
                    f"a bond at ({x:.4g}, {y:.4g}) conducts across what has parted in the strained "
                    f"body: give the conductor the same cracks and broken bonds"
                )

    def _error(self, bonds: Bonds, particle: int, stretch: float, gauge: float) -> SceneError:
        x, y = bonds.lattice.points[particle] + np.array(bonds.lattice.shift)
        what = self.piezoresistance.law
        return SceneError(
            f"a bond at ({x:.4g}, {y:.4g}) is stretched by {stretch:.3g}, where its {what} "
            f"1 + a s (a = {gauge:.4g}) is negative or its length vanishes: the linear law ends "
            f"before that. Strain the body less, or take the other law"
        )
