"""Work against precision: what an error costs, in time, memory and unknowns.

Two passes that do not disturb each other. The error pass measures each point once, and the memory
it takes. The timing pass then repeats set-up and solve alone, one point after the other in this
process, with compiled code warm; times are medians, with the quartiles as their spread. A
bond method is varied one choice at a time (calibration, m, area rule, tolerance) on the problem
that its case poses to other programs, and solved as an assembled matrix too; the case's rivals
stand beside, and finite elements by a second code (`cmverify.studies.by_fenicsx`).
"""

from __future__ import annotations

import csv
import gc
import io
import math
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from cmverify.case import Case, Level, Measurement, Method
from cmverify.studies import assembled, by_fenicsx

if TYPE_CHECKING:
    from cmverify.exchange.statement import Pose

#: Cases that carry it are measured if none is named.
TAG = "work-precision"
#: What is changed, one at a time, on the bond method of a posed problem. No larger m than its own:
#: layers that are prescribed hold whole families up to that.
VARIANTS: tuple[tuple[str, dict[str, Any], float], ...] = (
    ("m = 3", {"m": 3}, 1e-10),
    ("m = 4", {"m": 4}, 1e-10),
    ("continuum", {"calibration": "continuum"}, 1e-10),
    ("full areas", {"area_rule": "full"}, 1e-10),
    ("tolerance 1e-4", {}, 1e-4),
    ("tolerance 1e-6", {}, 1e-6),
)
#: Seconds after which a point is repeated no more, and the fewest repetitions.
ENOUGH, FEWEST = 2.0, 3
#: Errors that differ by less, relatively, are alike: two codes on one mesh differ by rounding.
ALIKE = 1e-3
#: Seconds between looks at the memory.
_LOOK = 2e-3

Standing = Literal["front", "perhaps", "beaten"]


@dataclass(frozen=True)
class Point:
    """One method at one resolution.

    Attributes
    ----------
    error : of the case's main figure
    seconds : median of set-up and solve, s
    fast, slow : its quartiles, s
    repeats : times it was measured
    compiling : seconds that the warm-up took, compilation or loading of compiled code included
    memory : bytes by which the process grew at most meanwhile
    problem : of the case's, where it has several; points of different ones are not compared
    standing : "front" if nothing as accurate is quicker, "beaten" if something is, beyond the
        spread of both; "perhaps" if the spreads do not tell
    command : measures it again
    """

    case: str
    method: str
    kind: str
    resolution: int
    unknowns: int
    error: float
    seconds: float
    fast: float
    slow: float
    repeats: int
    compiling: float
    memory: int
    command: str
    standing: Standing = "perhaps"
    problem: str = ""


def methods_of(case: Case) -> tuple[Method, ...]:
    """The case's own, its rivals, and its bond method varied and on the assembled matrix.

    Scenes are changed where the case poses a static problem. FEniCSx is beside scikit-fem. A
    problem that one method alone solves is left out: nothing stands beside it.
    """
    every = _ways(case)
    common = Counter(method.problem for method in every)
    return tuple(method for method in every if common[method.problem] > 1 or not method.problem)


def _ways(case: Case) -> tuple[Method, ...]:
    """All of `methods_of`, and what stands alone."""
    known = (*case.methods, *case.rivals)
    known = (*known, *by_fenicsx.beside(known))
    if not case.poses:
        return known
    pose = case.poses[0]
    own = case.method(pose.method)
    usual = assembled.method(case, pose)
    if usual is None:
        return known
    statement = pose.state(own.coarsest)
    static = statement.targets[0].key in assembled.FIELDS
    varied = tuple(
        Method(
            f"{own.name}, {name}", "bond", partial(vary, case, pose, changes, tolerance),
            own.resolutions, own.warm_up, own.problem,
        )
        for name, changes, tolerance in VARIANTS
        if static and not any(method.name.endswith(name) for method in known)
        if changes.get("m", 0) < statement.scene.m
    )  # fmt: skip
    return (*known, *varied, usual)


def vary(case: Case, pose: Pose, changes: dict[str, Any], tolerance: float, n: int) -> Measurement:
    """Solve the problem that a case poses with some of the scene changed.

    Raises
    ------
    ValueError
        If the changed scene has no particle where an error is asked.
    """
    from cmverify.cases.common import adapters

    statement = pose.state(n)
    target = statement.targets[0]
    solution = replace(statement.scene, **changes).solve(tolerance=tolerance)
    values = np.asarray(getattr(solution, target.key))
    values = assembled.at(solution.points, target.points, statement.scene.spacing, values)
    return Measurement(
        unknowns=solution.statistics.unknowns,
        quantities={case.primary: target.error(values)},
        seconds=adapters.solver_seconds(solution.statistics),
    )


def measure(
    cases: Sequence[Case],
    level: Level,
    repeats: int = 5,
    only: Sequence[str] = (),
    resolution: int | None = None,
    listen: Callable[[str], None] = lambda text: None,
) -> tuple[list[Point], list[str]]:
    """Both passes for every method of these cases at a level.

    Parameters
    ----------
    repeats : int
        Most repetitions of a time; slow points are repeated `FEWEST` times.
    only : sequence of str
        Names of methods; all of them for none.
    resolution : int, optional
        One, instead of those of the level.

    Returns
    -------
    points : list of Point
    refused : list of str
        Methods that raised, with what they said; FEniCSx where there is none.

    Raises
    ------
    FenicsxError
        If another FEniCSx is asked for than there is.
    """
    from cmverify.run import worker

    plan = [
        (case, method, n)
        for case in cases
        for method in methods_of(case)
        if not only or method.name in only
        for n in ((resolution,) if resolution else method.resolutions.get(level, ()))
    ]
    found: list[tuple[Case, Method, int, Measurement, float, int]] = []
    plan, refused = _possible(plan)
    for said in refused:
        listen(said)
    listen(f"{len(plan)} points: errors and memory")
    for case, method, n in plan:
        begun = time.perf_counter()
        worker.warm_up(method)
        compiling = time.perf_counter() - begun
        try:
            with growth() as grown:
                outcome = worker.measure(method, n)
        except Exception as error:
            refused.append(f"{case.name} {method.name} {case.length}/{n}: {error}")
            continue
        if outcome.total_seconds > 0 and case.primary in outcome.quantities:
            memory = int(outcome.statistics.get("memory", grown[0]))
            compiling = float(outcome.statistics.get("compiling", compiling))
            found.append((case, method, n, outcome, compiling, memory))
    listen("times, alone on this process")
    points = []
    for case, method, n, outcome, compiling, memory in found:
        times = _times(method, n, repeats, outcome.total_seconds)
        fast, middle, slow = np.percentile(times, (25, 50, 75))
        points.append(
            Point(
                case.name, method.name, method.kind, n, outcome.unknowns,
                float(outcome.quantities[case.primary]), float(middle), float(fast), float(slow),
                len(times), compiling, memory,
                f'cmverify precision {case.name} --measure --method "{method.name}" '
                f"--resolution {n}",
                problem=method.problem,
            )
        )  # fmt: skip
    return judged(points), refused


def _possible(
    plan: list[tuple[Case, Method, int]],
) -> tuple[list[tuple[Case, Method, int]], list[str]]:
    """Without what needs a code that is not installed, and what is to be said of it."""
    from references.fenicsx import bridge

    ours = [item for item in plan if not isinstance(item[1].run, by_fenicsx.ByFenicsx)]
    left = len(plan) - len(ours)
    if not left or bridge.find() is not None:
        return plan, []
    return ours, [f"Left out: {left} by FEniCSx. {bridge.INSTALL}"]


def _times(method: Method, n: int, repeats: int, known: float) -> list[float]:
    """Repeated seconds of a method that takes about the `known` ones."""
    if isinstance(method.run, by_fenicsx.ByFenicsx):
        enough = int(min(repeats, ENOUGH / known + 1.0))
        return method.run.times(n, max(FEWEST, enough))
    times: list[float] = []
    gc.collect()
    while len(times) < FEWEST or (len(times) < repeats and sum(times) < ENOUGH):
        times.append(method.run(n).total_seconds)
    return times


@contextmanager
def growth() -> Iterator[list[int]]:
    """By how many bytes the process grows at most within the block, looked at every 2 ms."""
    import psutil

    process = psutil.Process()
    gc.collect()
    before, most, done = process.memory_info().rss, [0], threading.Event()

    def watch() -> None:
        while not done.wait(_LOOK):
            most[0] = max(most[0], process.memory_info().rss - before)

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield most
    finally:
        done.set()
        watcher.join()


def judged(points: Iterable[Point]) -> list[Point]:
    """The same points with their standing among those of their case and problem."""
    known = list(points)
    found = []
    for p in known:
        rivals = [
            q
            for q in known
            if (q.case, q.problem) == (p.case, p.problem) and q is not p
            if q.error <= p.error * (1.0 + ALIKE)
        ]
        standing: Standing = "front"
        if any(q.slow < p.fast for q in rivals):
            standing = "beaten"
        elif any(q.fast < p.slow for q in rivals):
            standing = "perhaps"
        found.append(replace(p, standing=standing))
    return found


def seconds_to(points: Iterable[Point], error: float) -> dict[str, tuple[float, float]]:
    """Least median seconds of each method to an error alike or a better one, with that error."""
    best: dict[str, tuple[float, float]] = {}
    for p in points:
        if p.error <= error * (1.0 + ALIKE) and p.seconds < best.get(p.method, (math.inf, 0.0))[0]:
            best[p.method] = (p.seconds, p.error)
    return best


def as_csv(points: Iterable[Point]) -> str:
    """One line a point, with a header; SI units."""
    stream = io.StringIO()
    names = list(Point.__dataclass_fields__)
    writer = csv.DictWriter(stream, names, lineterminator="\n")
    writer.writeheader()
    writer.writerows(asdict(p) for p in points)
    return stream.getvalue()
