"""A scene as arrays and operators: shared by all analyses."""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from functools import cached_property
from time import perf_counter

import numpy as np

from ..arrays import Array, Mask
from ..blas import one_thread
from ..bonds import Bonds
from ..errors import MechanismError, SceneError
from ..geometry import Lattice
from ..material import Family, Moduli, Stability
from ..operators import BondOperator
from ..operators.eigenstrain import Eigenstrain
from . import cautions, inclusions, leads, loading, mechanisms, thickness, tips
from . import constraints as constraints_of
from .constraints import Constraints
from .description import Description
from .loads import particle_volumes

#: Told of every scene that is discretised, at level DEBUG: who judges asks what was solved.
_SCENES = logging.getLogger("solver.scenes")


@dataclass(frozen=True, eq=False)
class Discretisation:
    """A scene as arrays: shared by all analyses.

    Attributes
    ----------
    lattice, family, moduli, stability, bonds, operator
        The parts, see their modules. The bonds' lattice is `lattice.centred`.
    prescribed : ndarray of bool, shape (components, N)
        True for parts set aside too.
    values : ndarray, shape (components, N)
        Prescribed values (rotations times the spacing), zero where free, NaN where set aside.
    load : ndarray, shape (components, N)
        Densities of force, couple over spacing, or source, of a whole cell: what acts on the area
        that a particle stands for, over Δx².
    nodal_load : ndarray, shape (components, nodes of the outline), optional
        Loads of the surface's nodes, per volume of a particle.
    seconds : float
        Wall time that building all this took.
    constraints : Constraints, optional
        Of rigid pins and tied unknowns; slaves are among the prescribed.
    eigenstrain : Eigenstrain, optional
        Of temperatures; the loads hold what it exerts.
    acting : ndarray, shape (components, N), optional
        `load` without what temperatures exert, where there are any.
    edge_values : ndarray, shape (components, nodes of the outline), optional
        Values at which nodes are held, if others than those of the bonds: at another time.
    tips_left : tuple of str
        Why some tips of cracks are not calibrated, and which are loaded, one sentence each.
    """

    scene: Description
    lattice: Lattice
    family: Family
    moduli: Moduli
    stability: Stability
    bonds: Bonds
    operator: BondOperator
    prescribed: Mask
    values: Array
    load: Array
    nodal_load: Array | None
    seconds: float
    constraints: Constraints | None = None
    eigenstrain: Eigenstrain | None = None
    acting: Array | None = None
    edge_values: Array | None = None
    tips_left: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        scene: Description,
        sharp_tips: bool = True,
        constrained: bool = False,
        free: bool = False,
    ) -> Discretisation:
        """Build it, cheap checks first.

        Parameters
        ----------
        scene : Description
        sharp_tips : bool
        constrained : bool
            Whether the caller knows rigid pins and tied unknowns. Slaves are among the
            `prescribed`: who does not ask for `constraints` would take them for clamped. Nor
            do others know that temperatures strain bonds.
        free : bool
            Whether parts that no support holds are no fault: bodies may move in time.

        Raises
        ------
        SceneError
            If the scene has constraints and the caller does not know them.
        """
        with one_thread():
            # Factors, products and least squares are the same whatever threads BLAS has.
            return cls._of(scene, sharp_tips, constrained, free)

    @classmethod
    def _of(
        cls, scene: Description, sharp_tips: bool, constrained: bool, free: bool
    ) -> Discretisation:
        begun = perf_counter()
        _tell(scene)
        family = scene.family()
        each, stability = inclusions.solids(scene, family)
        if not constrained and any(support.constrains for support in scene.supports):
            raise SceneError(
                "rigid pins and equal unknowns (Support.pin, Support.equal) are known to statics "
                "and fracture only: prescribe displacements instead"
            )
        if not constrained and any(load.strain is not None for load in scene.loads):
            raise SceneError(
                "temperatures that strain a body (Load.temperature) are known to statics and "
                "quasi-static fracture only"
            )
        tips.require_static(scene, sharp_tips, constrained, stability)
        lattice = Lattice(scene.region, scene.spacing, family.reach, scene.phase)
        cracks = loading.centred_cracks(scene.cracks, lattice)
        phases = inclusions.phases_of(scene, lattice)
        moduli = inclusions.mixed(each, phases)
        prescribed, values = loading.prescribed_values(scene, lattice, moduli)
        leads.check(scene, lattice, prescribed)
        relating = [support for support in scene.supports if support.constrains]
        constraints = constraints_of.build(relating, lattice, moduli, prescribed, values)
        load = loading.body_loads(scene, lattice, moduli, phases)
        sharp_tips = sharp_tips and scene.broken is None
        on_edges = loading.edge_loads(scene, lattice, sharp_tips, phases)
        # Loads act on the nodes at which bonds end: one outline serves both.
        outline = on_edges[0].outline if on_edges else None
        broken = scene.broken(lattice, family) if scene.broken else None
        held = loading.held_particles(scene, prescribed)
        aside = np.zeros(lattice.count, dtype=bool)
        while True:
            bonds = Bonds(
                lattice.centred,
                family,
                cracks,
                scene.surface,
                held,
                broken,
                sharp_tips,
                outline,
                phases,
            )
            if bonds.ended is not None:
                outline = bonds.ended.outline
            bonds = leads.rimmed(scene, bonds, moduli)
            if scene.factors is not None:
                bonds = bonds.scaled(scene.factors(bonds, moduli))
            if (thick := thickness.factors(scene, lattice, bonds)) is not None:
                bonds = bonds.scaled(thick)
            loading.hold_edges(scene, bonds, moduli)
            operator = BondOperator(bonds, moduli, prescribed)
            loose, why = mechanisms.find(
                bonds,
                operator,
                prescribed,
                broken is not None,
                stability.kind != "indefinite",
                constraints,
                free,
            )
            if not len(loose):
                break
            if (
                scene.loose == "refuse"
                or prescribed.all(axis=0).sum() + len(loose) == lattice.count
            ):
                raise mechanisms.refuse(why)
            if load[:, loose].any():
                raise MechanismError(
                    f"a load acts on a part that nothing holds: {why}. Hold it, or leave it out "
                    f"of the load (where=...)"
                )
            aside[loose] = True
            prescribed[:, loose] = True
            values[:, loose] = np.nan
            broken = mechanisms.without(bonds, broken, loose)
        left = tips.calibrate(scene, operator, prescribed)
        nodal_load = loading.share_out(on_edges, lattice, operator, load)
        loading.concentrate(scene, lattice, cracks, operator, load, nodal_load)
        if load[:, aside].any():
            raise MechanismError(
                "a load on an edge acts on a part that nothing holds: hold it, or leave it out of "
                "the load (where=...)"
            )
        left += tips.loaded(operator, load)
        acting = load.copy() if any(item.strain is not None for item in scene.loads) else None
        eigenstrain = loading.eigenstrain(scene, lattice, operator, load, nodal_load)
        loading.require_range(operator, values, load, nodal_load)
        seconds = perf_counter() - begun
        return cls(
            scene,
            lattice,
            family,
            moduli,
            stability,
            bonds,
            operator,
            prescribed,
            values,
            load,
            nodal_load,
            seconds,
            constraints,
            eigenstrain,
            acting,
            tips_left=left,
        )

    @property
    def held(self) -> Mask:
        """Particles whose place (or temperature) is prescribed, or which were set aside, (N,)."""
        return loading.held_particles(self.scene, self.prescribed)

    @cached_property
    def volumes(self) -> Array:
        """Area of the body that each particle stands for, shape (N,), cells (Δx²).

        Loads in the body, and its mass, act on it. With ``extrapolated`` surfaces the sum is the
        area of the body (`solver.geometry.strips`); the other treatments let the body end at its
        outermost cells, and every particle is a whole one, unless an interface cuts its cell.
        """
        true_edges = self.scene.surface == "extrapolated"
        return particle_volumes(self.lattice, true_edges, self.bonds.phases)

    def storage(self, name: str) -> Array:
        """`volumes` times thickness and density (or heat capacity) over the scene's own, (N,).

        Parameters
        ----------
        name : {"density", "heat_capacity"}
        """
        found = self.volumes if self.thickness is None else self.volumes * self.thickness
        if self.bonds.phases is None:
            return found
        shares = inclusions.shares(self.scene, name)
        return np.asarray(found * shares[self.bonds.phases.of])

    @property
    def thickness(self) -> Array | None:
        """Thickness of every particle, shape (N,), m; None where all is per unit thickness."""
        if not thickness.varies(self.scene):
            return None
        return thickness.of_particles(self.scene, self.lattice)

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What the answer leaves out or settles by a rule, one sentence each."""
        scene, lattice = self.scene, self.lattice
        translations = ~np.array(scene.physics.turning[: len(self.prescribed)])
        given = (self.prescribed & ~np.isnan(self.values))[translations].any(axis=0)
        return cautions.told(
            (
                *self.bonds.warnings,
                *cautions.left_over(lattice, scene.surface),
                *cautions.on_edges(self.bonds),
                *cautions.missing_bonds(self.bonds, self.held, self.damaged),
                *cautions.chiral_edges(self.bonds, self.moduli, self.held),
                *cautions.thin_layers(lattice, given, scene.m),
                *cautions.thin_members(lattice, scene.m, scene.surface),
                *leads.cautions(scene, lattice),
                *self.tips_left,
            )
        )

    def overlaps(self, unknowns: Array) -> tuple[str, ...]:
        """Cracks whose faces a field of shape (components, N) moves into each other."""
        if not (self.scene.physics.breakable and self.scene.cracks):
            return ()
        cracks = loading.centred_cracks(self.scene.cracks, self.lattice)
        return cautions.told(cautions.overlaps(self.bonds, cracks, unknowns[:2]))

    @property
    def damaged(self) -> bool:
        """Whether single bonds are broken (cracks that were always there do not count)."""
        return self.scene.broken is not None

    def right_hand_side(self, coupling: Array | None = None) -> Array:
        """Load of the active unknowns less what the prescribed ones exert, flattened.

        `coupling` is what those exert, shape (components, active), where it is known.
        """
        operator = self.operator
        exerted = operator.coupling(self.values) if coupling is None else coupling
        rhs = self.load[:, operator.active] - exerted
        if operator.ended_stiffness is not None and self.nodal_load is not None:
            condensed = operator.ended_stiffness.condensed_load(self.nodal_load, self.edge_values)
            operator.add_at_surface(rhs, -condensed)
        if operator.identity_rows is not None:
            given = self.values[:, operator.active]
            rhs[operator.identity_rows] = operator.identity_scale * given[operator.identity_rows]
        return rhs.ravel()

    def moved(self, masters: Array) -> Discretisation:
        """The same with the free masters of its constraints known: values like any others."""
        if self.constraints is None:
            return self
        return replace(self, values=self.values + self.constraints.field(masters))

    def surface_values(self, unknowns: Array) -> Array | None:
        """Values of the surface's nodes for a field of shape (components, N), if it has nodes."""
        surface = self.operator.ended_stiffness
        if surface is None:
            return None
        near = np.nan_to_num(unknowns[:, surface.particles])
        return surface.nodal(near, self.nodal_load, self.edge_values)

    def field(self, x: Array) -> Array:
        """Values of all unknowns, shape (components, N), from a vector of the active ones."""
        values = self.values.copy()
        values[:, self.operator.active] = x.reshape(self.operator.components, -1)
        values[self.prescribed] = self.values[self.prescribed]
        return values


def _tell(scene: Description) -> None:
    """Say with what a scene is solved: physics, calibration, surface, m, influence."""
    if _SCENES.isEnabledFor(logging.DEBUG):
        influence = scene.influence if isinstance(scene.influence, str) else scene.influence.name
        _SCENES.debug(
            "%s, %s, %s, m = %g, %s",
            scene.material.physics.name, scene.calibration, scene.surface, scene.m, influence,
        )  # fmt: skip
