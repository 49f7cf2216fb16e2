"""Scenes: what is asked. A scene derives which unknowns and terms exist, and nothing more.

``Scene`` is a description; `Scene.discretise` turns it into arrays and operators (all input is
checked there, before anything long begins), and the analyses work on that `Discretisation`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from numbers import Real
from time import perf_counter
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from .bonds.bonds import Bonds
from .bonds.volume_method import Surface, check_surface
from .errors import MechanismError, SceneError
from .geometry.edge_quadrature import Quadrature
from .geometry.lattice import Lattice
from .geometry.outline import Outline
from .geometry.regions import Crack, Region
from .material.calibration import Calibration, Moduli, calibrate
from .material.family import AreaRule, Family
from .material.influence import CONSTANT, Influence, influence
from .material.laws import AngularLaw
from .material.stability import Stability, require_admissible
from .material.tensors import ElasticTensor, Material
from .operators.bond_operator import BondOperator
from .problem import mechanisms
from .problem.conditions import Load, Support, evaluate

if TYPE_CHECKING:
    from .solution import Solution

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Scene:
    """A body, its material, what holds it and what acts on it.

    Parameters
    ----------
    region : Region
    spacing : float
        Grid spacing Δx, m.
    material : ElasticTensor or ConductivityTensor
        Decides the physics.
    supports : sequence of Support
        Later ones win where they overlap.
    loads : sequence of Load
        They add up.
    m : float
        Horizon in cells.
    calibration : {"continuum", "lattice", "positive"}
    law : angular law, optional
        See `solver.material.calibration.calibrate` for the default.
    influence : str or Influence
    area_rule : {"partial", "full", "exact"}
    surface : {"volume", "none", "extrapolated"}
    cracks : sequence of Crack
        Bonds that cross one are cut, and its faces are surfaces. A part that cracks leave on a
        single bond is not looked for; broken bonds (`broken`) are searched for such hinges.
    broken : callable, optional
        ``broken(lattice, family)`` → booleans of shape (family size / 2, N): bonds, by half
        offset and particle of origin, that carry nothing (damage).
    loose : {"refuse", "drop"}
        What to do with parts and particles that nothing holds: refuse the scene, or set them
        aside (their fields are NaN, the rest is solved). A load on such a part is refused.

    Raises
    ------
    SceneError
        If the description contradicts itself.

    Examples
    --------
    >>> from solver import ConductivityTensor, Scene, Support, disc
    >>> scene = Scene(
    ...     region=disc(1.0), spacing=0.1, material=ConductivityTensor.isotropic(1.0),
    ...     supports=[Support.layer(cells=5.5, temperature=lambda x, y: x)],
    ... )
    >>> bool(abs(scene.solve().temperature - scene.solve().points[:, 0]).max() < 1e-9)
    True
    """

    region: Region
    spacing: float
    material: Material
    supports: Sequence[Support] = ()
    loads: Sequence[Load] = ()
    m: float = 5
    calibration: Calibration = "lattice"
    law: AngularLaw | None = None
    influence: str | Influence = field(default=CONSTANT)
    area_rule: AreaRule = "partial"
    surface: Surface = "volume"
    cracks: Sequence[Crack] = ()
    broken: Callable[[Lattice, Family], Mask] | None = None
    loose: Literal["refuse", "drop"] = "refuse"

    def __post_init__(self) -> None:
        check_surface(self.surface)
        if self.loose not in ("refuse", "drop"):
            raise SceneError(f"loose must be 'refuse' or 'drop', not {self.loose!r}")
        if not isinstance(self.region, Region):
            raise SceneError(f"region must be a Region, not {type(self.region).__name__}")
        if not isinstance(self.material, Material):
            raise SceneError(
                f"material must be an ElasticTensor or a ConductivityTensor, not "
                f"{type(self.material).__name__}"
            )
        listed: dict[str, type] = {"supports": Support, "loads": Load, "cracks": Crack}
        for name, kind in listed.items():
            items = getattr(self, name)
            if not isinstance(items, Sequence) or not all(isinstance(i, kind) for i in items):
                raise SceneError(f"{name} must be a list of {kind.__name__} objects")
        for name in ("spacing", "m"):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, Real):
                raise SceneError(f"{name} must be a number, not {value!r}")
        wanted = {"force", "couple", "traction"} if self.elastic else {"source", "inflow"}
        for load in self.loads:
            if load.kind not in wanted:
                body = "an elastic body" if self.elastic else "a conductive body"
                raise SceneError(f"a {load.kind} does not act on {body}")

    @property
    def elastic(self) -> bool:
        """Whether the physics is elasticity (else conduction)."""
        return isinstance(self.material, ElasticTensor)

    def family(self) -> Family:
        """The family of a bulk particle."""
        return Family(self.m, self.spacing, self.area_rule, influence(self.influence))

    def discretise(self, growing: bool = False) -> Discretisation:
        """Check the scene and turn it into arrays and operators.

        Parameters
        ----------
        growing : bool
            Whether cracks are to grow: then the faces of those that exist share no node at their
            tips (`solver.geometry.outline`).

        Raises
        ------
        SceneError, CalibrationError, InadmissibleMaterialError
        """
        return Discretisation.of(self, growing)

    def solve(self, tolerance: float = 1e-10, **options: Any) -> Solution:
        """Static (or steady) solution; see `solver.analyses.statics.solve`."""
        from .analyses.statics import solve

        return solve(self.discretise(), tolerance=tolerance, **options)


@dataclass(frozen=True, eq=False)
class Discretisation:
    """A scene as arrays: shared by all analyses.

    Attributes
    ----------
    lattice, family, moduli, stability, bonds, operator
        The parts, see their modules.
    prescribed : ndarray of bool, shape (components, N)
        True for parts set aside too.
    values : ndarray, shape (components, N)
        Prescribed values (rotations times the spacing), zero where free, NaN where set aside.
    load : ndarray, shape (components, N)
        Densities of force, couple over spacing, or source.
    pull : ndarray, shape (components, nodes of the outline), optional
        Loads of the surface's nodes, per volume of a particle.
    seconds : float
        Wall time that building all this took.
    """

    scene: Scene
    lattice: Lattice
    family: Family
    moduli: Moduli
    stability: Stability
    bonds: Bonds
    operator: BondOperator
    prescribed: Mask
    values: Array
    load: Array
    pull: Array | None
    seconds: float

    @classmethod
    def of(cls, scene: Scene, growing: bool = False) -> Discretisation:
        """Build it, cheap checks first."""
        begun = perf_counter()
        family = scene.family()
        moduli = calibrate(family, scene.material, scene.calibration, scene.law)
        stability = require_admissible(family, moduli)
        lattice = Lattice(scene.region, scene.spacing, family.reach)
        components = 1
        if scene.elastic:
            components = 2 if stability.sign == "central" else 3
        prescribed, values = _supports(scene, lattice, components)
        load = _loads(scene, lattice, components)
        growing = growing or scene.broken is not None
        pulls = _edge_loads(scene, lattice, growing)
        broken = scene.broken(lattice, family) if scene.broken else None
        held = np.logical_and.reduce(prescribed, axis=0)
        aside = np.zeros(lattice.count, dtype=bool)
        while True:
            bonds = Bonds(lattice, family, scene.cracks, scene.surface, held, broken, growing)
            operator = BondOperator(bonds, moduli, prescribed)
            loose, why = mechanisms.find(
                bonds,
                operator,
                prescribed,
                scene.elastic,
                broken is not None,
                stability.sign != "indefinite",
            )
            if not len(loose):
                break
            if scene.loose == "refuse" or aside.sum() + len(loose) == (~held).sum():
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
        pull = _share_out(pulls, lattice, operator, load)
        if load[:, aside].any():
            raise MechanismError(
                "a load on an edge acts on a part that nothing holds: hold it, or leave it out of "
                "the load (where=...)"
            )
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
            pull,
            seconds,
        )

    @property
    def damaged(self) -> bool:
        """Whether single bonds are broken (cracks that were always there do not count)."""
        return self.scene.broken is not None

    def right_hand_side(self) -> Array:
        """Load of the active unknowns less what the prescribed ones exert, flattened."""
        operator = self.operator
        rhs = self.load[:, operator.active] - operator.coupling(self.values)
        if operator.surface is not None and self.pull is not None:
            operator.add_at_surface(rhs, -operator.surface.pull(self.pull))
        if operator.fixed is not None:
            given = self.values[:, operator.active]
            rhs[operator.fixed] = operator.identity_scale * given[operator.fixed]
        return rhs.ravel()

    def surface_values(self, unknowns: Array) -> Array | None:
        """Values of the surface's nodes for a field of shape (components, N), if it has nodes."""
        surface = self.operator.surface
        if surface is None:
            return None
        return surface.nodal(np.nan_to_num(unknowns[:, surface.particles]), self.pull)

    def field(self, x: Array) -> Array:
        """Values of all unknowns, shape (components, N), from a vector of the active ones."""
        values = self.values.copy()
        values[:, self.operator.active] = x.reshape(self.operator.components, -1)
        values[self.prescribed] = self.values[self.prescribed]
        return values


def _supports(scene: Scene, lattice: Lattice, components: int) -> tuple[Mask, Array]:
    prescribed = np.zeros((components, lattice.count), dtype=bool)
    values = np.zeros((components, lattice.count))
    for support in scene.supports:
        columns = support.columns(scene.elastic)
        selected = support.select(lattice)
        if not selected.any():
            raise SceneError("a support holds no particle: its layer or region is empty")
        evaluated: dict[tuple[int, int], Array] = {}
        for unknown, value, component, width in columns:
            if unknown >= components:
                # Without shear stiffness rotations are no unknowns; prescribing them is moot.
                continue
            key = id(value), width
            if key not in evaluated:
                what = "a prescribed value"
                evaluated[key] = evaluate(value, lattice.points[selected], width, what)
            scale = scene.spacing if unknown == 2 else 1.0
            prescribed[unknown, selected] = True
            values[unknown, selected] = scale * evaluated[key][:, component]
    return prescribed, values


def _loads(scene: Scene, lattice: Lattice, components: int) -> Array:
    load = np.zeros((components, lattice.count))
    for item in scene.loads:
        if item.density is None:
            continue
        mask, density = item.density(lattice)
        if item.kind == "couple":
            if components < 3:
                raise SceneError(
                    "a body couple needs bonds with shear stiffness: this solid has none "
                    "(C66 = C12), its particles do not resist rotation"
                )
            load[2, mask] += density[:, 0] / scene.spacing
        else:
            load[: density.shape[1], mask] += density.T
    return load


def _edge_loads(scene: Scene, lattice: Lattice, growing: bool) -> list[Quadrature]:
    """Loads on the body's edges, evaluated."""
    edges = [item.edge for item in scene.loads if item.edge is not None]
    if not edges:
        return []
    outline = Outline.of(lattice.region, scene.cracks, lattice.spacing, not growing)
    return [edge(outline) for edge in edges]


def _share_out(
    pulls: list[Quadrature], lattice: Lattice, operator: BondOperator, load: Array
) -> Array | None:
    """Give loads on edges to the surface's nodes, or to the nearest particles (into `load`).

    Returns the loads of the outline's nodes, (components, nodes), None if no bond ends at them.
    """
    surface = operator.surface
    nodal = None
    if surface is not None:
        nodal = np.zeros((load.shape[0], len(surface.ended.outline.nodes)))
    for rule in pulls:
        force = rule.force.T / lattice.spacing**2
        ends = rule.outline.edges[rule.edge].T
        share = np.stack([1 - rule.position, rule.position])
        known = np.zeros(len(rule.outline.nodes), dtype=bool)
        if surface is not None:
            known[surface.nodes] = True
        felt = known[ends].all(axis=0)
        if nodal is not None:
            for node, part in zip(ends, share, strict=True):
                for component, values in enumerate(force):
                    np.add.at(nodal[component], node[felt], (part * values)[felt])
        # Edges without nodes: no treatment that has any, or held particles behind them.
        _, nearest = KDTree(lattice.points).query(rule.points[~felt])
        for component, values in enumerate(force):
            np.add.at(load[component], nearest, values[~felt])
    return nodal
