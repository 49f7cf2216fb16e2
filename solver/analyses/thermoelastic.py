"""Motion and heat together: deformational heating and cooling (Sect. 5, after Eq. 176).

    M ü + K u = f + G ϑ,        C ϑ̇ + K_T ϑ = q − T₀ Gᵀ u̇,

ϑ the change of temperature, G the thermal forces and Gᵀ their adjoint
(`solver.operators.thermal_force`), C the heat capacity at constant strain. The midpoint rule keeps
what the equations keep: with the energy

    E = ½ v·M v + ½ u·K u + ½ ϑ·C ϑ/T₀ − f·u

every step loses the heat conduction's Δt ϑ̄·(K_T ϑ̄ − q)/T₀, to rounding. Rotations carry no inertia
and are in equilibrium. One factorisation serves all steps: bodies of some ten thousand particles.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from numbers import Integral
from typing import Annotated, Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from .. import recovery, threads
from ..arrays import Array, Indices
from ..blas import one_thread
from ..bonds import Cells
from ..errors import SceneError
from ..geometry import Where
from ..material import ExpansionTensor
from ..material.physics import ELASTICITY
from ..operators.assembled import to_csr
from ..operators.eigenstrain import Eigenstrain
from ..operators.mass import inertia
from ..operators.thermal_force import thermal_force
from ..problem import Description, Discretisation, Support
from ..problem.values import Value, evaluate
from ..result import Result, Table
from ..state import State
from . import solids
from .registry import Analysis


@dataclass(frozen=True, eq=False)
class Thermoelastic(Result):
    """A coupled motion at every step.

    Attributes
    ----------
    body, heat : Discretisation
    expansion : ExpansionTensor
    times : ndarray, shape (k,), s
    unknowns : ndarray, shape (k, components, N)
        u1, u2 and θ Δx.
    temperature : ndarray, shape (k, N), K
        Change from T₀.
    kinetic, elastic, thermal, dissipated : ndarray, shape (k,), J/m (J with a thickness)
        ½ v·M v, ½ u·K u − f·u, ½ ϑ·C ϑ/T₀, and what heat conduction has lost since the start.
    """

    body: Discretisation
    heat: Discretisation
    expansion: ExpansionTensor
    times: Array
    unknowns: Array
    temperature: Array
    kinetic: Array
    elastic: Array
    thermal: Array
    dissipated: Array

    @property
    def points(self) -> Array:
        """Particle centres, shape (N, 2), m."""
        return self.body.lattice.points

    @property
    def cells(self) -> Cells:
        """The particles' cells, parted where bonds carry nothing."""
        return Cells.of(self.body.bonds)

    @property
    def displacement(self) -> Array:
        """u, shape (k, 2, N), m."""
        return self.unknowns[:, :2]

    @property
    def imbalance(self) -> Array:
        """Energy and what was lost less the energy at the start, shape (k,), as these."""
        total = self.kinetic + self.elastic + self.thermal + self.dissipated
        return np.asarray(total - total[0])

    @property
    def stressed(self) -> State:
        """The body at the end; its stress is that of the mechanical strain, as everywhere."""
        free = self.expansion.voigt[:, None] * self.temperature[-1]
        warm = Eigenstrain(self.body.bonds, self.body.moduli, free)
        return State(replace(self.body, eigenstrain=warm), self.unknowns[-1])

    def fields(self) -> dict[str, Array]:
        """Displacement, rotation, temperature and stress at the end."""
        state = self.stressed
        return {**state.solved(), "temperature": self.temperature[-1], **recovery.fields(state)}

    def tables(self) -> dict[str, Table]:
        """The energies."""
        names = "time", "kinetic", "elastic", "thermal", "dissipated", "imbalance"
        columns = self.times, self.kinetic, self.elastic, self.thermal, self.dissipated
        return {"energy": Table(names, np.column_stack([*columns, self.imbalance]))}

    def summary(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        scale = float(np.abs(self.kinetic + self.elastic + self.thermal).max())
        return {
            "physics": "thermo-elasticity",
            "particles": self.body.lattice.count,
            "steps": len(self.times) - 1,
            "end": float(self.times[-1]),
            "dissipated": float(self.dissipated[-1]),
            "imbalance": float(np.abs(self.imbalance).max()) / (scale or 1.0),
            "warnings": self.warnings,
        }

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the answer leaves out or settles by a rule, of the motion and of the heat."""
        motion = self.body.warnings + self.body.overlaps(self.unknowns[-1])
        return tuple(dict.fromkeys(motion + self.heat.warnings))


def run(
    scene: Description,
    heat: Description,
    expansion: ExpansionTensor,
    reference: float,
    *,
    step: float,
    steps: int,
    displacement: Value = 0.0,
    velocity: Value = 0.0,
    temperature: Value = 0.0,
) -> Thermoelastic:
    """March an elastic body and its temperature through time.

    Parameters
    ----------
    scene, heat : Scene
        The same body and lattice: an elastic one with a density, a conductive one with a
        heat_capacity (at constant strain). Supports and loads do not depend on time; temperatures
        are changes from `reference`. A body that nothing holds floats, or is insulated.
    expansion : ExpansionTensor
        In plane strain the plane's effective one.
    reference : float
        T₀, K.
    step : float, s
    steps : int
    displacement, velocity, temperature : values
        At the start, of the free particles.

    Raises
    ------
    SceneError
        If the two scenes are not one body, bonds end at the surface (``extrapolated``) or at
        inclusions, something depends on time, or a number makes no sense.
    InadmissibleMaterialError, MechanismError
        As for statics.
    """
    if not (np.isfinite(reference) and reference > 0):
        raise SceneError(f"the reference temperature is absolute and positive (K), not {reference}")
    if not (np.isfinite(step) and step > 0):
        raise SceneError(f"the step must be a positive time, not {step}")
    if isinstance(steps, bool) or not isinstance(steps, Integral) or steps < 1:
        raise SceneError(f"the number of steps must be a positive integer, not {steps!r}")
    if scene.physics.storage != "density" or heat.physics.storage != "heat_capacity":
        raise SceneError("deformational heating needs an elastic scene and one of heat conduction")
    if heat.heat_capacity is None:
        raise SceneError("deformational heating needs the heat_capacity of the body, J/(m³ K)")
    if scene.timed or heat.timed:
        raise SceneError("supports and loads of a coupled motion do not depend on time yet")
    if "extrapolated" in (scene.surface, heat.surface):
        raise SceneError(
            "deformational heating is known to whole bonds only: use surface='volume' or 'none'"
        )
    if scene.inclusions or heat.inclusions:
        raise SceneError("deformational heating knows one solid: the body has inclusions")
    density = scene.density_for("coupled motions")
    body, warm = (Discretisation.of(described, free=True) for described in (scene, heat))
    if not np.array_equal(body.lattice.places, warm.lattice.places):
        raise SceneError("the elastic scene and the conductive one are not the same body")
    given = [
        evaluate(displacement, body.lattice.places, 2, "the initial displacement"),
        evaluate(velocity, body.lattice.places, 2, "the initial velocity"),
        evaluate(temperature, body.lattice.places, 1, "the initial temperature"),
    ]
    with one_thread(), threads.suited(body.operator):
        march = _March(body, warm, expansion, reference, step, density)
        return march.go(steps, *given)


class _March:
    """The equations of a coupled body, free unknowns only, per volume of a particle."""

    def __init__(
        self,
        body: Discretisation,
        heat: Discretisation,
        expansion: ExpansionTensor,
        reference: float,
        step: float,
        density: float,
    ) -> None:
        self.body, self.heat, self.step, self.reference = body, heat, step, reference
        self.expansion = expansion
        first = body.operator
        capacity = heat.scene.heat_capacity
        assert capacity is not None
        count, c = body.lattice.count, first.components
        #: Free unknowns among all, (components·N,) and (N,).
        self.moving: Indices = np.nonzero(~body.prescribed.ravel())[0]
        self.warming: Indices = np.nonzero(~heat.prescribed[0])[0]
        self.stiffness, self.load = self._free(body, self.moving)
        self.conduction, self.source = self._free(heat, self.warming)
        whole = np.zeros((c, count))
        physics = body.scene.physics
        whole[:, first.active] = density * inertia(
            body.storage("density"), first.active, physics, c
        )
        self.mass = whole.ravel()[self.moving]
        self.capacity = capacity * heat.storage("heat_capacity")[self.warming]
        force = thermal_force(body.bonds, body.moduli, expansion)[self.moving]
        self.force = sparse.csr_array(force[:, self.warming])
        # What prescribed temperatures exert, all the time.
        held = np.nan_to_num(heat.values[0])
        self.load = self.load + force @ np.where(heat.prescribed[0], held, 0.0)
        inert = sparse.diags_array(4.0 * self.mass / step**2)
        stored = sparse.diags_array(self.capacity) + 0.5 * step * self.conduction
        matrix = sparse.block_array(
            [
                [self.stiffness + inert, -self.force],
                [-self.force.T, -stored / reference],
            ],
            format="csc",
        )
        self.factors = splu(matrix)

    def _free(self, body: Discretisation, free: Indices) -> tuple[sparse.csr_array, Array]:
        """Stiffness and right-hand side of the free unknowns."""
        operator, count = body.operator, body.lattice.count
        place = np.full(operator.components * count, -1)
        active = (np.arange(operator.components)[:, None] * count + operator.active).ravel()
        place[active] = np.arange(len(active))
        kept = place[free]
        return sparse.csr_array(to_csr(operator)[kept][:, kept]), body.right_hand_side()[kept]

    def go(self, steps: int, shift: Array, speed: Array, warmth: Array) -> Thermoelastic:
        """All steps from the values at the start, (N, 2), (N, 2) and (N, 1)."""
        count, c = self.body.lattice.count, self.body.operator.components
        x = self._unknowns(shift, c)
        x[self.mass == 0.0] = 0.0
        v = self._unknowns(speed, c) * (self.mass > 0)
        t = warmth[self.warming, 0]
        x = self._turned(x, t)
        states, energies, lost = [(x, t)], [self._energies(x, v, t)], [0.0]
        for _ in range(steps):
            right = self.load + self.mass * (4.0 * x / self.step**2 + 2.0 * v / self.step)
            flow = self.capacity * t + 0.5 * self.step * self.source
            flow = -flow / self.reference - self.force.T @ x
            middle, mean = np.split(self.factors.solve(np.concatenate([right, flow])), [len(x)])
            v = np.where(self.mass > 0, 4.0 * (middle - x) / self.step - v, 0.0)
            x, t = 2.0 * middle - x, 2.0 * mean - t
            heat = mean @ (self.conduction @ mean - self.source)
            lost.append(lost[-1] + self.step * float(heat) / self.reference)
            states.append((x, t))
            energies.append(self._energies(x, v, t))
        moved = np.tile(self.body.values.reshape(1, -1), (steps + 1, 1))
        warm = np.tile(self.heat.values[:1], (steps + 1, 1))
        moved[:, self.moving] = [state[0] for state in states]
        warm[:, self.warming] = [state[1] for state in states]
        area = self.body.family.cell_area
        kinetic, elastic, thermal = area * np.array(energies).T
        return Thermoelastic(
            self.body,
            self.heat,
            self.expansion,
            np.asarray(np.arange(steps + 1) * self.step, dtype=np.float64),
            moved.reshape(steps + 1, c, count),
            warm,
            kinetic,
            elastic,
            thermal,
            area * np.array(lost),
        )

    def _unknowns(self, values: Array, components: int) -> Array:
        """Free unknowns of a field of displacements or velocities, rotations zero."""
        found = np.zeros((components, len(values)))
        found[:2] = values.T
        return found.ravel()[self.moving]

    def _turned(self, x: Array, t: Array) -> Array:
        """The same displacement with rotations in equilibrium."""
        inert = self.mass > 0
        if inert.all():
            return x
        left = (self.load + self.force @ t - self.stiffness @ x)[~inert]
        block = sparse.csc_array(self.stiffness[~inert][:, ~inert])
        x = x.copy()
        x[~inert] += splu(block).solve(left)
        return x

    def _energies(self, x: Array, v: Array, t: Array) -> tuple[float, float, float]:
        """Kinetic, elastic and thermal energy per volume of a particle."""
        return (
            0.5 * float(v @ (self.mass * v)),
            float(x @ (0.5 * (self.stiffness @ x) - self.load)),
            0.5 * float(t @ (self.capacity * t)) / self.reference,
        )


def motion(
    scene: Description,
    conductivities: tuple[float, float],
    expansions: tuple[float, float],
    heat_capacity: float,
    reference: float,
    step: float,
    steps: int,
    angle_degrees: float = 0.0,
    sink: Where | None = None,
    displacement: Annotated[Value, 2] = 0.0,
    velocity: Annotated[Value, 2] = 0.0,
    temperature: Value = 0.0,
) -> Thermoelastic:
    """March an elastic body that conducts heat through time; see `run`.

    Parameters
    ----------
    scene : Scene
        Elastic, with a density.
    conductivities, expansions : pair of float
        Principal ones along common axes: W/(m K), 1/K (in plane strain the effective ones).
    heat_capacity : float
        At constant strain, J/(m³ K).
    reference : float
        T₀, K.
    step : float, s
    steps : int
    angle_degrees : float
        Turn of the axes, anticlockwise.
    sink : Region or callable, optional
        Particles whose temperature stays at T₀; without one the body is insulated.
    displacement, velocity, temperature : values
        At the start, of the free particles.

    Raises
    ------
    SceneError
        If the scene is not elastic, a conductivity is not positive, and as `run`.
    """
    if scene.physics is not ELASTICITY:
        raise SceneError(f"heat strains an elastic body, and this is {scene.physics.adjective} one")
    if scene.tip == "calibrated":
        raise SceneError(
            "tips of cracks are calibrated (tip='calibrated') in bodies that no temperature strains"
        )
    conductor, expansion = solids.heated(conductivities, expansions, angle_degrees)
    heat = replace(
        scene,
        material=conductor,
        supports=[] if sink is None else [Support.where(sink, temperature=0.0)],
        loads=(),
        law=None,
        density=None,
        heat_capacity=heat_capacity,
    )
    return run(
        scene,
        heat,
        expansion,
        reference,
        step=step,
        steps=steps,
        displacement=displacement,
        velocity=velocity,
        temperature=temperature,
    )


ANALYSIS = Analysis(
    "thermoelastic",
    "Motion and heat together: deformational heating and cooling.",
    motion,
    stressed=True,
)


def adiabatic_temperature(
    state: Any, expansion: ExpansionTensor, reference: float, heat_capacity: float
) -> Array:
    """Change of temperature of a body that is strained faster than heat flows, shape (N,), K.

    −T₀ Gᵀ u/C: what its bonds give off, particle by particle; −T₀ β:ε/C in a homogeneous strain.

    Parameters
    ----------
    state : Solution, or the State of any analysis
        Of an elastic scene with whole bonds.
    expansion : ExpansionTensor
    reference : float
        T₀, K.
    heat_capacity : float
        At constant strain, J/(m³ K).

    Raises
    ------
    SceneError
        If bonds end at the surface or at inclusions, or a number is not positive.
    """
    if not (reference > 0 and heat_capacity > 0):
        raise SceneError("T₀ and the heat capacity must be positive")
    body = state.discretisation
    force = thermal_force(body.bonds, body.moduli, expansion)
    drawn = force.T @ np.nan_to_num(state.unknowns).ravel()
    thick = 1.0 if body.thickness is None else body.thickness
    return np.asarray(-reference * drawn / (heat_capacity * thick * body.volumes))
