"""Quasi-static fracture: bonds break, the body finds a new equilibrium, cracks grow.

`grow` raises the load factor of a scene from event to event. A bond breaks when its energy
reaches its critical value (`breaking`); at an event the most loaded bonds break in small
batches, each followed by a new equilibrium, until no bond is overloaded. All loads and prescribed
values scale with the factor, so that one solve at unit load per broken state says everything.

Energies are booked as they occur, per unit thickness: *work* of supports and loads along the
straight pieces of the load path; *stored* energy of all bonds, summed anew; *dissipated* energy,
w_c of every broken bond; and *excess*, what breaking sets free beyond that: what a bond held more
than its w_c when its batch broke, and the potential energy that the body lost in finding its new
equilibrium (kinetic energy, in a real body). Their balance is a check, not a definition.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..errors import MechanismError, SceneError
from ..geometry import Where
from ..scene import Scene
from . import checkpoint as state_file
from .breaking import Criterion, Critical
from .growth import Growth
from .programme import Programme
from .temperatures import Temperatures, Tempered

__all__ = ["Growth", "Temperatures", "grow"]


def grow(
    scene: Scene,
    toughness: Critical | ArrayLike,
    programme: Programme | None = None,
    *,
    no_fail: Sequence[Where] = (),
    tension_only: bool = True,
    criterion: Criterion = "total",
    batch: int | None = None,
    tolerance: float = 1e-8,
    max_iterations: int = 2_000,
    max_solves: int | None = None,
    until: Callable[[Growth], bool] | None = None,
    monitors: Mapping[str, Callable[[Growth], float]] | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    every: int = 50,
    listen: Callable[[Growth], None] | None = None,
    temperatures: Temperatures | None = None,
) -> Growth:
    """Let cracks grow in an elastic scene.

    Parameters
    ----------
    scene : Scene
        Elastic. What it prescribes and applies is the load at factor 1; all of it scales.
    toughness : object with ``energies(family)``, or array
        Critical bond energy densities w_c of the family's offsets, J/m⁶ (`solver.Toughness`).
    programme : Programme, optional
        By default the load rises from event to event until `until` says stop.
    no_fail : sequence of Region or callable
        Where bonds never break: those with an end in a region or where ``f(x, y)`` is true.
        Bonds between two prescribed particles never do.
    tension_only : bool
        Only bonds with s ≥ 0 break.
    criterion : {"total", "axial"}
        Energy that is compared with w_c; see `breaking.Breakable` for materials with
        negative bond stiffness.
    batch : int, optional
        Most bonds to break between two equilibria (ties are broken together). By default a fifth
        of what a straight cut breaks per cell of its length: 22 at m = 5. Where a crack grows from
        a tip and the load holds still, a few more or fewer make no difference to loads and paths.
        Where it nucleates or runs brutally the batch is part of the model: small ones follow a row
        of the lattice, at G a length; breaking all that is overloaded at once (a batch larger than
        the body has bonds, the paper's way) takes in a wider band and bends sooner. Say which one
        a result was found with. A load that follows the crack must overload all of a batch and is
        the higher for larger ones.
    tolerance : float
        Relative residual of every equilibrium at rest and of the last one; 1e-6 serves within an
        avalanche, where all that is asked is which bonds are overloaded.
    max_iterations : int
        Of one solve.
    max_solves : int, optional
        The run ends there.
    until : callable, optional
        Called with the `Growth` before every batch, also within an avalanche; the run ends when
        it returns true.
    monitors : mapping from name to callable, optional
        Further columns of the history.
    checkpoint : path, optional
        The run is saved there every `every` solves and at its end, and goes on from there if the
        file exists: results are the same to the last bit as without interruption.
    every : int
        Solves between two checkpoints.
    listen : callable, optional
        Called with the `Growth` before every batch; it decides nothing.
    temperatures : Temperatures, optional
        Fields that the body goes through instead of a programme; the scene's supports and loads
        act in full. The run ends with the last one.

    Returns
    -------
    Growth

    Raises
    ------
    SceneError
        If scene, toughness and criterion do not fit, or the checkpoint is another run's.
    NegativeCurvatureError, ConvergenceError
        If the damaged body has no stable equilibrium that could be found.

    Notes
    -----
    A part that comes loose is set aside (`Growth.loose`); if a load acts on it, the run ends and
    says so in `Growth.reason`. A run also ends when the unit load strains the body no more (it has
    parted), or when the force falls below `Programme.least_force` of its peak.

    A scene that is its own mirror image breaks mirror-symmetrically, whatever the batch: bonds are
    parted into batches only where there is a gap wider than the solver's noise.

    Examples
    --------
    >>> from solver import Crack, ElasticTensor, Scene, Support, rectangle
    >>> held = Support.where(lambda x, y: abs(y) > 6, displacement=lambda x, y: 1e-3 * y[:, None]
    ...     * [0, 1])
    >>> scene = Scene(rectangle(24, 16), 1.0, ElasticTensor.isotropic(1.0, 0.2), m=3,
    ...     supports=[held], cracks=[Crack((-13, 0), (0, 0))])
    >>> run = grow(scene, 1e-6, until=lambda run: run.advance > 3)
    >>> bool(abs(run.tip[1]) < 1e-9), bool(abs(run.history.imbalance).max() < 1e-8)
    (True, True)
    """
    if temperatures is not None and programme is not None:
        raise SceneError("cracks follow a programme of the load or temperatures, not both")
    programme = Programme() if programme is None else programme
    if (
        temperatures is None
        and until is None
        and max_solves is None
        and programme.targets[-1] == np.inf
    ):
        raise SceneError("the run has no end: give programme.stop, until or max_solves")
    rest = tuple(no_fail), tension_only, criterion, batch, tolerance, max_iterations, monitors or {}
    run = (
        Growth(scene, toughness, programme, *rest)
        if temperatures is None
        else Tempered(scene, toughness, temperatures, *rest)
    )
    mark = state_file.fingerprint(run)
    if checkpoint is None or not state_file.load(run, checkpoint, mark):
        run.begin()
    saved = len(run.solves)
    while not run.reason:
        if listen is not None:
            listen(run)
        # What was asked from outside may be asked otherwise when the run goes on.
        if until is not None and until(run):
            asked = "as asked (until)"
        elif max_solves is not None and len(run.solves) >= max_solves:
            asked = f"{max_solves} solves are done"
        else:
            asked = ""
        if checkpoint is not None and (asked or len(run.solves) >= saved + every):
            saved = len(run.solves)
            state_file.save(run, checkpoint, mark)
        try:
            if asked:
                # After the checkpoint: a run that goes on does not know that it was interrupted.
                run.finish()
            else:
                run.proceed()
        except MechanismError as error:
            run.reason = str(error)
        if asked:
            run.reason = run.reason or asked
            if not run.resting:
                run.record()
            return run
    if checkpoint is not None:
        state_file.save(run, checkpoint, mark)
    return run
