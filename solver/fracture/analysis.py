"""Fracture as scene files ask for it: toughness, programme and options in one flat table."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf, radians

from ..analyses.recording import Progress
from ..analyses.registry import Analysis
from ..geometry import Where
from ..scene import Scene
from .breaking import Criterion
from .growth import Growth
from .programme import Control, Programme
from .quasistatic import grow
from .toughness import Toughness, ToughnessCalibration


def run(
    scene: Scene,
    G1: float,
    G2: float | None = None,
    n: int = 2,
    frequency: int = 1,
    axis_degrees: float = 0.0,
    toughness_calibration: ToughnessCalibration = "lattice",
    start: float = 0.0,
    stop: float = inf,
    increment: float | None = None,
    overload: float | None = None,
    levels: Sequence[float] | None = None,
    control: Control = "fixed",
    least_force: float | None = None,
    no_fail: Where | None = None,
    tension_only: bool = True,
    criterion: Criterion = "total",
    batch: int | None = None,
    advance: float | None = None,
    max_solves: int | None = None,
    tolerance: float = 1e-8,
    checkpoint: str | None = None,
    monitors: Mapping[str, Callable[[Growth], float]] | None = None,
    progress: Progress | None = None,
) -> Growth:
    """Let the scene's cracks grow.

    Parameters
    ----------
    scene : Scene
    G1, G2, n, frequency, axis_degrees, toughness_calibration
        See `Toughness`; G1 and G2 in J/m².
    start, stop, increment, overload, levels, control, least_force
        See `Programme`.
    advance : float, optional
        The run ends when the furthest tip has gone so far, m.
    no_fail, tension_only, criterion, batch, max_solves, tolerance, checkpoint, monitors
        See `grow`.
    progress : callable, optional
        Told the share that is done: how near the run has come to the first of the ends that it is
        given. A body that parts is done earlier.

    Raises
    ------
    SceneError, ToughnessError
        If the numbers make no run.
    """
    toughness = Toughness(
        G1, G2, n, frequency, radians(axis_degrees), calibration=toughness_calibration
    )
    programme = Programme(start, stop, increment, overload, levels, control, least_force)
    return grow(
        scene,
        toughness,
        programme,
        no_fail=() if no_fail is None else (no_fail,),
        tension_only=tension_only,
        criterion=criterion,
        batch=batch,
        tolerance=tolerance,
        max_solves=max_solves,
        until=None if advance is None else lambda run: bool(run.advance >= advance),
        monitors=monitors,
        checkpoint=checkpoint,
        listen=None if progress is None else _telling(progress, programme, advance, max_solves),
    )


def _telling(
    progress: Progress, programme: Programme, advance: float | None, max_solves: int | None
) -> Callable[[Growth], None]:
    """Tells how near a run has come to the nearest of its ends; it never goes back."""
    furthest = 0.0

    def listen(run: Growth) -> None:
        nonlocal furthest
        shares = [furthest]
        if advance:
            shares.append(run.advance / advance)
        if max_solves:
            shares.append(len(run.solves) / max_solves)
        if programme.levels is not None:
            shares.append(run.target / len(programme.levels))
        elif programme.start < programme.stop < inf:
            way = programme.stop - programme.start
            shares.append((run.load_factor - programme.start) / way)
        furthest = min(1.0, max(shares))
        progress(furthest)

    return listen


ANALYSIS = Analysis("fracture", "Quasi-static growth of cracks, bond by bond.", run, stressed=True)
