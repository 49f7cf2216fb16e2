"""Equilibrium of a body whose bonds break, at unit load, again and again.

Everything that a new break leaves as it was is used again: bond arrays, the operator's parts, the
last solution as a first guess, and the preconditioner, which stays while it serves and is brought
up to date (only what feels the broken bonds) when iterations tell that it does not.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from time import perf_counter, process_time
from typing import Protocol

import numpy as np
from scipy.sparse.linalg import LinearOperator

from .. import threads
from ..arrays import Array, Indices, Mask
from ..blas import one_thread
from ..bonds import Bonds
from ..bonds.parting import Pieces, part
from ..errors import ConvergenceError, MechanismError
from ..linear import Border, Bordered, BorderedInverse, Task, TwoLevel, method, nearby
from ..operators import BondOperator
from ..operators.eigenstrain import Eigenstrain
from ..problem import Discretisation, mechanisms
from ..problem.bordering import border
from ..problem.rigid import unheld
from ..solution import Solution, Statistics
from .broken import BrokenBonds
from .crack_path import initial_tips

# Iterations above those that a fresh preconditioner would have taken after which it is brought up
# to date.
_PATIENCE = 2
# Share of the tolerance that iterations in an avalanche end at; what is left is checked after them.
_AIM = 0.9


@dataclass(frozen=True)
class Step:
    """What one solve took and gave.

    Attributes
    ----------
    iterations : int
    refreshed : bool
        Whether the preconditioner was brought up to date before it.
    released : float
        Potential energy that relaxing to the new equilibrium set free at unit load,
        ½ d·(r₀ + r₁) with the change d of the unknowns and the residuals before and after,
        J per unit thickness.
    """

    iterations: int
    refreshed: bool
    released: float


class Record(Protocol):
    """What an equilibrium follows: the record of broken bonds, and between which particles each is.

    A `Breakable`, or what a sensor makes of one.
    """

    broken: BrokenBonds

    def ends(self, bonds: Indices) -> tuple[Indices, Indices, Indices]:
        """Half offsets, particles of origin and other ends of bonds, each (n,)."""


class Equilibrium:
    """Answer of a body to the unit load of its scene.

    Parameters
    ----------
    discretisation : Discretisation
    breakable : Breakable, or another `Record`
        Its record of broken bonds is what `bonds` and `operator` follow.
    tolerance : float
        Relative residual of every solve.
    max_iterations : int

    Attributes
    ----------
    unknowns : ndarray, shape (components, N)
        u1, u2 and θ Δx at unit load; NaN at particles set aside.
    aside : ndarray of bool, shape (N,)
        Particles that have come loose: no bond of theirs carries anything any more.
    """

    def __init__(
        self,
        discretisation: Discretisation,
        breakable: Record,
        tolerance: float,
        max_iterations: int,
    ) -> None:
        self.sound, self.breakable = discretisation, breakable
        self._bonds: Bonds = discretisation.bonds
        self._operator: BondOperator = discretisation.operator
        # How many of the broken bonds these two know.
        self._followed, self._resuming = 0, False
        # The load with temperatures, and how many broken bonds it knows.
        self._warm: tuple[int, Array] | None = None
        self.tolerance, self.max_iterations = tolerance, max_iterations
        self.kind = discretisation.stability.kind
        self.aside = np.zeros(discretisation.lattice.count, dtype=bool)
        self._tips = initial_tips(discretisation.scene.cracks, discretisation.scene.region)
        #: Loads of the outline's nodes, which are more where a crack has parted edges.
        self.nodal_load: Array | None = discretisation.nodal_load
        #: Potential energy of the surface's bonds that cracks have cut, at unit load; whoever
        #: books it sets it back.
        self.released_by_parting = 0.0
        self.x: Array = np.zeros(self.operator.shape[0])
        # The last answer and the field that it is.
        self._known: tuple[Array, Array] | None = None
        self.preconditioner: LinearOperator | None = None
        #: Right-hand side, and what constraints add to the equations, kept while no bond of a
        #: prescribed particle breaks.
        self.rhs: Array | None = None
        self.border: Border | None = None
        constraints = discretisation.constraints
        #: Free masters of the constraints at unit load, shape (masters,).
        self.masters: Array = np.zeros(0 if constraints is None else constraints.count)
        self._bordered: BorderedInverse | None = None
        self.iterations, self.residual, self.seconds = 0, 0.0, 0.0
        #: CPU time of products and preconditioner alone, of all solves.
        self.solving = 0.0
        # For the preconditioner: iterations a decade of the residual when it was fresh, whether it
        # is due, and how many bonds were gone when it was made.
        self.pace, self.worn, self.built = 0.0, False, 0

    @property
    def bonds(self) -> Bonds:
        """Bonds as the record of broken ones leaves them."""
        self.follow()
        return self._bonds

    @property
    def operator(self) -> BondOperator:
        """Stiffness of these bonds."""
        self.follow()
        return self._operator

    @property
    def prescribed(self) -> Mask:
        """Prescribed unknowns, those of particles set aside included, (components, N)."""
        return self.sound.prescribed | self.aside

    @property
    def unknowns(self) -> Array:
        """Values of all unknowns at unit load, shape (components, N), NaN where set aside.

        The same array until the next solve, and read-only.
        """
        known = self._known
        # Each solve, and whoever sets particles aside, makes a new x.
        if known is None or known[0] is not self.x:
            known = self._known = self.x, self.discretisation().field(self.x)
            known[1].flags.writeable = False
        return known[1]

    def discretisation(self, factor: float = 1.0) -> Discretisation:
        """The body as it is now, under `factor` times its scene's load."""
        return self._before_masters(factor).moved(factor * self.masters)

    def _before_masters(self, factor: float = 1.0) -> Discretisation:
        """The same with the masters at zero."""
        values = self.sound.values * factor
        values[:, self.aside] = np.nan
        return replace(
            self.sound,
            bonds=self.bonds,
            operator=self.operator,
            values=values,
            load=self.load * factor,
            eigenstrain=self._eigenstrain(factor),
            nodal_load=None if self.nodal_load is None else self.nodal_load * factor,
            prescribed=self.prescribed,
        )

    @property
    def load(self) -> Array:
        """Unit load of the particles, with what temperatures exert through the bonds left."""
        if self.sound.acting is None:
            return self.sound.load
        self.follow()
        if self._warm is None or self._warm[0] != self._followed:
            warm = self._eigenstrain(1.0)
            assert warm is not None
            self._warm = self._followed, np.asarray(self.sound.acting + warm.load())
        return self._warm[1]

    def _eigenstrain(self, factor: float) -> Eigenstrain | None:
        """What temperatures strain under `factor` times the load."""
        warm = self.sound.eigenstrain
        if warm is None:
            return None
        change = None if warm.temperature is None else factor * warm.temperature
        particles = factor * warm.particles
        return replace(warm, bonds=self.bonds, particles=particles, temperature=change)

    def solution(self, factor: float) -> Solution:
        """The last equilibrium under `factor` times the load, for recovery."""
        operator, stability = self.operator, self.sound.stability
        now = self.discretisation(factor)
        found = now.field(factor * self.x)
        statistics = Statistics(
            particles=self.sound.lattice.count,
            unknowns=operator.shape[0]
            if operator.identity_rows is None
            else int((~operator.identity_rows).sum()),
            bonds=operator.directed_bonds,
            method=f"fracture, {type(self.preconditioner).__name__}",
            kind=stability.kind,
            margin=stability.margin,
            iterations=self.iterations,
            residual=self.residual,
            setup_seconds=self.sound.seconds,
            solve_seconds=self.seconds,
            peak_memory=0,
            warnings=self.sound.warnings + now.overlaps(found),
        )
        return Solution(now, found, statistics, self.preconditioner)

    def surface_energy(self, others: Array | None = None) -> float:
        """Energy of the bonds that end at the surface at unit load, J per unit thickness.

        With `others`, values of all unknowns and zero at the surface's nodes, half the mutual
        energy of the two fields.
        """
        surface = self.operator.ended_stiffness
        if surface is None:
            return 0.0
        values = np.nan_to_num(self.unknowns[:, surface.particles])
        nodal = surface.nodal(values, self.nodal_load)
        if others is None:
            found = surface.energy(values, nodal, values, nodal)
        else:
            found = surface.energy(values, nodal, others[:, surface.particles], 0.0 * nodal)
        return found * self.sound.family.cell_area

    def surface_load_work(self) -> float:
        """Σ f·u of the loads on the surface's nodes at unit load, J per unit thickness."""
        surface, nodal_load = self.operator.ended_stiffness, self.nodal_load
        if surface is None or nodal_load is None:
            return 0.0
        nodal = surface.nodal(np.nan_to_num(self.unknowns[:, surface.particles]), nodal_load)
        return float((nodal_load[:, surface.nodes] * nodal).sum()) * self.sound.family.cell_area

    def _surface_potential(self) -> float:
        """Energy of what ends at the surface less the work of loads there, J per thickness.

        With the operator as it is, whatever the record of broken bonds says.
        """
        surface = self._operator.ended_stiffness
        if surface is None:
            return 0.0
        given = self.sound.moved(self.masters).values
        fields = given.copy()
        fields[:, self._operator.active] = self.x.reshape(len(fields), -1)
        fields[self.prescribed] = given[self.prescribed]
        values = np.where(self.aside, 0.0, fields)[:, surface.particles]
        nodal = surface.nodal(values, self.nodal_load)
        found = surface.energy(values, nodal, values, nodal)
        if self.nodal_load is not None:
            found -= float((self.nodal_load[:, surface.nodes] * nodal).sum())
        return found * self.sound.family.cell_area

    # ---- changes ------------------------------------------------------------------------

    def warm(self, eigenstrain: Eigenstrain) -> None:
        """Other temperatures strain the body than before."""
        self.sound = replace(self.sound, eigenstrain=eigenstrain)
        self._warm = self.rhs = self.border = None

    def follow(self, last: int | None = None) -> None:
        """Catch up with the record of broken bonds, up to its entry `last` (by default all)."""
        broken = self.breakable.broken
        first, last = self._followed, len(broken) if last is None else last
        if first == last:
            return
        self._followed = last
        bounds = [first, last]
        if self._bonds.ended is not None:
            # Where the crack parts the surface depends on what was broken before: solve by solve,
            # however late the record is followed.
            step, dropped = (
                broken.records["step"][first:last],
                broken.records["dropped"][first:last],
            )
            change = (step[1:] != step[:-1]) | (dropped[1:] != dropped[:-1])
            bounds[1:1] = (first + 1 + np.nonzero(change)[0]).tolist()
        # What prescribed particles exert changes only with bonds of theirs.
        touched: Mask = np.logical_or.reduce(self.sound.prescribed, axis=0)
        for begin, end in pairwise(bounds):
            offsets, origins, ends = self.breakable.ends(broken.between(begin, end))
            self._bonds = self._bonds.breaking(offsets, origins)
            if self._bonds.ended is not None and not broken.records["dropped"][begin]:
                self._part(offsets, origins)
            if touched[origins].any() or touched[ends].any() or self.sound.acting is not None:
                self.rhs = self.border = None
        self._operator = self._made()

    def _made(self) -> BondOperator:
        """The operator of the bonds as they are now."""
        known = self._operator
        return BondOperator(self._bonds, known.moduli, self.prescribed, known)

    def _part(self, offsets: Indices, origins: Indices) -> None:
        """Cut what ends at the surface where the crack runs through it."""
        ended = self._bonds.ended
        assert ended is not None
        pieces = Pieces.of(self.sound.bonds, ended.outline, offsets, origins)
        parted = part(ended, self.sound.lattice, pieces, self._tips)
        if parted is None:
            return
        left, origin = parted
        before = 0.0 if self._resuming else self._surface_potential()
        self._bonds = self._bonds.ending(left)
        if self.nodal_load is not None:
            self.nodal_load = np.where(origin >= 0, self.nodal_load[:, origin], 0.0)
        self.rhs = self.border = None
        if self._resuming:
            return
        self._operator = self._made()
        if self._unloaded():
            raise MechanismError("a crack has run through an edge that carries a load")
        self.released_by_parting += before - self._surface_potential()

    def resume(self, aside: Mask, built: int) -> BondOperator:
        """Take up a run that was saved; returns the operator that its preconditioner was made of.

        Parameters
        ----------
        aside : ndarray of bool, shape (N,)
        built : int
            How many bonds were gone when the preconditioner was made.
        """
        self.aside, self.built = aside, built
        if aside.any():
            self._bonds = self._bonds.without_ends(np.nonzero(aside)[0])
        # What was set free has been booked.
        self._resuming = True
        self.follow(built)
        before = self._operator
        self.follow()
        self._resuming = False
        return before

    def set_aside(self, particles: Indices) -> None:
        """Take particles out of the equations whose bonds have all been broken.

        Raises
        ------
        MechanismError
            If a load acts on one of them, or nothing is left.
        """
        unknowns = self.unknowns
        self.aside[particles] = True
        self._bonds = self.bonds.without_ends(particles)
        # Whole before anything is refused: whoever ends the run looks at what it has come to.
        self._operator = self._made()
        self.rhs = self.border = None
        self.x = unknowns[:, self.operator.active].ravel()
        self.preconditioner = None
        acting = self.sound.load if self.sound.acting is None else self.sound.acting
        if acting[:, self.aside].any() or self._unloaded():
            raise MechanismError("a part on which a load acts has come loose")
        if self.prescribed.all():
            raise MechanismError("all of the body that was free has come loose")

    def _unloaded(self) -> bool:
        """Whether loads act on nodes at which no bond ends any more."""
        if self.nodal_load is None:
            return False
        left = np.zeros(self.nodal_load.shape[1], dtype=bool)
        if self._bonds.ended is not None:
            left[self._bonds.ended.outline.edges[self._bonds.ended.edge]] = True
        return bool(self.nodal_load[:, ~left].any())

    def slack(self) -> Indices:
        """Particles whose own bonds leave them a motion without stiffness."""
        return mechanisms.slack_particles(self.operator)

    def fragments(self) -> Indices:
        """Particles of parts that nothing holds any more."""
        held = self.prescribed
        physics, constraints = self.operator.moduli.physics, self.sound.constraints
        parts = unheld(self.bonds, held, physics, constraints)
        found = [members for members, _ in parts]
        none = np.zeros(len(self.aside), dtype=bool)
        return np.nonzero(np.logical_or.reduce([none, *found]) & ~held.all(axis=0))[0]

    def hinges(self) -> Indices:
        """Particles that can move without straining a bond (slow: only after a failed solve)."""
        return mechanisms.zero_energy_particles(method.positive(self.operator, self.kind))

    # ---- solving ------------------------------------------------------------------------

    def solve(self, tolerance: float | None = None) -> Step:
        """Solve for the present bonds, from the last solution.

        Parameters
        ----------
        tolerance : float, optional
            A coarser one than that of the body.

        Raises
        ------
        NegativeCurvatureError, ConvergenceError
            As `solver.analyses.statics.solve`.
        """
        begun = perf_counter()
        tolerance = self.tolerance if tolerance is None else tolerance
        with one_thread(), threads.suited(self._operator):
            operator = self.operator
            if self.rhs is None:
                unmoved = self._before_masters()
                self.rhs = unmoved.right_hand_side()
                self.border = None if unmoved.constraints is None else border(unmoved)
            rhs, system = self.rhs, operator
            if operator.identity_rows is not None:
                given = self.sound.values[:, operator.active]
                self.x.reshape(given.shape)[operator.identity_rows] = given[operator.identity_rows]
            before = self.x
            if self.border is not None:
                rhs = np.concatenate([rhs, self.border.force])
                before = np.concatenate([before, self.masters])
                system = Bordered(operator, self.border)
            cpu = process_time()
            left = rhs - system.matvec(before)
            refreshed = self._prepare()
            guess, start = self._guess(before, left)
            aim = _AIM if tolerance > self.tolerance else 0.5
            task = Task(rhs, guess, tolerance, self.max_iterations, start, aim)
            inverse = self._inverse()
            found = method.answer(operator, self.kind, inverse, task, self.border)
            after_x, iterations, right = found.x, found.iterations, found.residual
            if right is None:
                right = rhs - system.matvec(after_x)
            self.solving += process_time() - cpu
            size, after = float(np.linalg.norm(rhs)), float(np.linalg.norm(right))
            residual = after / size if size else 0.0
            decades = np.log10(max(float(np.linalg.norm(start)), 1e-300) / max(after, 1e-300))
            if refreshed:
                self.pace = iterations / max(decades, 1.0)
            # It has served; the next solve gets a fresh one.
            self.worn = bool(iterations > self.pace * decades + _PATIENCE)
            self.iterations += iterations
            self.residual, self.seconds = residual, self.seconds + perf_counter() - begun
            if not residual <= max(tolerance, method.attainable(operator, after_x, rhs)):
                raise ConvergenceError(
                    f"equilibrium stopped at a relative residual of {residual:.2e} after "
                    f"{iterations} iterations; {tolerance:.1e} was asked for"
                )
            released = 0.5 * float((after_x - before) @ (left + right))
            self.x, self.masters = np.split(after_x, [operator.shape[0]])
        return Step(iterations, refreshed, released * self.sound.family.cell_area)

    def _guess(self, before: Array, left: Array) -> tuple[Array, Array]:
        """Where to begin and what residual that leaves, from the last answer and its residual.

        Around the bonds that broke last particles have found their balance.
        """
        known, operator = self.preconditioner, self.operator
        records = self.breakable.broken.records
        if self.kind == "indefinite" or not isinstance(known, TwoLevel) or not len(records):
            return before, left
        last = records["bond"][records["step"] == records["step"][-1]]
        near = nearby.around(operator, np.concatenate(self.breakable.ends(last)[1:]))
        if not len(near):
            return before, left
        size = operator.shape[0]
        change, loss = nearby.change(operator, known, near, left[:size])
        guess, start = before.copy(), left.copy()
        guess[:size] += change
        start[:size] -= loss
        if self.border is not None:
            start[size:] -= self.border.coupling.T @ change
        better = np.linalg.norm(start) < np.linalg.norm(left)
        return (guess, start) if better else (before, left)

    def _inverse(self) -> LinearOperator:
        """The preconditioner, with the border if there is one."""
        assert self.preconditioner is not None
        if self.kind == "indefinite":
            return self.preconditioner
        if self.border is None:
            known = self.preconditioner
            return known.following(self.operator) if isinstance(known, TwoLevel) else known
        known = self._bordered
        if (
            known is None
            or known.inverse is not self.preconditioner
            or known.border is not self.border
        ):
            known = self._bordered = BorderedInverse(self.preconditioner, self.border)
        return known

    def _prepare(self) -> bool:
        """Make or bring up to date the preconditioner where it is due; whether it was."""
        known = self.preconditioner
        if isinstance(known, TwoLevel):
            if not self.worn:
                return False
            self.preconditioner = known.updated(method.positive(self.operator, self.kind))
        else:
            self.preconditioner = method.preconditioner(self.operator, self.kind, often=True)
        self.built = self._followed
        return True
