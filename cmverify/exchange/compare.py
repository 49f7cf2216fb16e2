"""`cmverify compare`: answers of other programs, judged as ours are and shown beside them.

An answer becomes a method of the case, with the case's own norms and the bounds of one of our
methods: verdicts, figures and page are those of any run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cmverify.case import (
    Case,
    Check,
    Curve,
    Failed,
    Field,
    FieldSet,
    Level,
    LinePlot,
    Measurement,
    Method,
)
from cmverify.exchange.answers import Answer, AnswerError
from cmverify.exchange.carry import carry
from cmverify.exchange.case_export import bounds_of
from cmverify.exchange.statement import Array, Pose, Statement, Target
from cmverify.run import results


@dataclass(frozen=True)
class Comparison:
    """A case in which answers stand beside our method, and what is known of all of them.

    Attributes
    ----------
    case : Case
        Our method and one for each answer, with the checks of these alone.
    records : tuple of results.Record
        Ours first; its outcome may be a failure.
    resolution : int
    absent : mapping from an answer's name to the quantities that it says nothing about
    """

    case: Case
    records: tuple[results.Record, ...]
    resolution: int
    absent: dict[str, tuple[str, ...]]


def compare(
    case: Case,
    pose: Pose,
    n: int,
    answers: Sequence[Answer],
    ours: results.Record,
    held_to: str | None = None,
) -> Comparison:
    """Judge answers to a problem.

    Parameters
    ----------
    case, pose, n
        The problem, and the resolution at which it was stated.
    answers : sequence of Answer
    ours : results.Record
        Of `pose.method` at n.
    held_to : str, optional
        Our method whose bounds apply, `pose.method` by default.

    Raises
    ------
    AnswerError
        If an answer says nothing near a point that is judged, or two have one name.
    ValueError
        If `held_to` is no method of the case, or has no bound on anything that is judged.
    """
    name = held_to or pose.method
    if name not in {method.name for method in case.methods}:
        known = ", ".join(method.name for method in case.methods)
        raise ValueError(f"{case.name} has no method {name!r}; it has {known}")
    if len({answer.name for answer in answers} | {ours.method}) != len(answers) + 1:
        raise AnswerError("two answers have the same name: name them, NAME=FILE")
    statement = pose.state(n)
    bounds = bounds_of(case, name, n)
    judged = {target.quantity for target in statement.targets}
    if not judged & set(bounds):
        what = ", ".join(sorted(judged))
        raise ValueError(f"{case.name}: no bound of {name} at {case.length}/{n} judges {what}")
    records, checks, absent = [ours], [], {}
    own = bounds_of(case, pose.method, n)
    checks += [replace(check, order=None, exact=True) for check in own.values()]
    for answer in answers:
        measured = score(statement, answer)
        record = replace(ours, method=answer.name, outcome=measured, wall_seconds=0.0)
        records.append(record)
        told = set(measured.quantities)
        absent[answer.name] = tuple(sorted(judged - told))
        checks += [_same_bound(bounds[q], answer.name, n, name) for q in sorted(told & set(bounds))]
    methods = [_method(pose.method, case.method(pose.method).kind, n)]
    methods += [_method(answer.name, "other", n) for answer in answers]
    derived = replace(
        case,
        name=case.name,
        methods=tuple(methods),
        checks=tuple(checks),
        featured=answers[0].name,
        primary=statement.targets[0].quantity,
        poses=(),
        # One resolution: errors over seconds mean something if the answers say theirs.
        timed=case.timed and any(answer.seconds is not None for answer in answers),
    )
    return Comparison(derived, tuple(records), n, absent)


def _method(name: str, kind: str, n: int) -> Method:
    return Method(name, kind, _is_not_run, dict.fromkeys(Level, (n,)))  # type: ignore[arg-type]


def _is_not_run(resolution: int) -> Measurement:
    raise RuntimeError("an answer is read, not measured")


def _same_bound(check: Check, method: str, n: int, ours: str) -> Check:
    """The bound that holds of ours at n, of an answer; how exact another method may be, it says."""
    bound = check.bound_at(n)
    assert bound is not None
    source = f"the bound of {ours}: {check.source}"
    return Check(method, check.quantity, {n: bound}, source=source, exact=True)


def score(statement: Statement, answer: Answer) -> Measurement:
    """Errors of an answer in the case's norms, with its fields at the judged points."""
    scene = statement.scene
    segments = tuple(segment for crack in scene.cracks for segment in crack.segments)
    found: dict[str, float] = {}
    items: dict[str, Field] = {}
    lines: list[LinePlot] = []
    shown: Array | None = None
    for target in statement.targets:
        if target.key not in answer.values:
            continue
        computed = carry(answer, target, scene.spacing, segments)
        if not np.isfinite(computed).all():
            raise AnswerError(
                f"{answer.name}: {target.key} is not a finite number at "
                f"{int((~np.isfinite(computed)).sum())} of the judged values"
            )
        found[target.quantity] = target.error(computed)
        if target.line:
            x, y = target.reference.T
            curve = Curve(answer.name, computed[:, 0], computed[:, 1], y, x)
            unit = f" ({target.unit})" if target.unit else ""
            lines.append(
                LinePlot(
                    f"The crack's {target.key}",
                    f"$x_1${unit}",
                    f"$x_2${unit}",
                    (curve,),
                    over_methods=True,
                    joined=True,
                    reference_label="reference",
                )
            )
        if target.points is not None and target.times is None:
            shown = target.points if shown is None else shown
            if np.array_equal(shown, target.points):
                items |= _fields(target, computed)
    fields = None if shown is None else FieldSet(shown, items, spacing=scene.spacing)
    return Measurement(
        unknowns=answer.unknowns or 0,
        quantities=found,
        seconds={} if answer.seconds is None else {"solve": answer.seconds},
        statistics={"read from": answer.name},
        fields=fields,
        lines=tuple(lines),
    )


def _fields(target: Target, computed: Array) -> dict[str, Field]:
    if computed.ndim == 1:
        return {target.names[0]: Field(target.names[0], target.unit, computed, target.reference)}
    return {
        name: Field(name, target.unit, computed[:, k], target.reference[:, k])
        for k, name in enumerate(target.names)
    }


def our_record(case: Case, pose: Pose, n: int, folder: Path | None) -> results.Record:
    """Our own result: of a run in `folder` if the same code made it, else measured now.

    Raises
    ------
    ValueError
        If our method fails at that resolution.
    """
    from cmverify.run import worker
    from cmverify.run.threads import available_cores

    current = results.source_fingerprint()
    if folder is not None:
        path = results.stem(folder, case.name, pose.method, n).with_suffix(".json")
        if path.is_file():
            record = results.load(path)
            if record.fingerprint == current and not record.failed:
                return record
    record = worker.record(case, case.method(pose.method), n, available_cores(), current)
    if isinstance(record.outcome, Failed):
        raise ValueError(f"{pose.method} at {case.length}/{n}: {record.outcome.message}")
    return record


def resolution_of(case: Case, pose: Pose, level: Level, n: int | None) -> int:
    """The resolution that is meant: as given, or the finest of our method at a level.

    Raises
    ------
    ValueError
        If the level runs nothing of that method, or n is not positive.
    """
    if n is not None:
        if n < 1:
            raise ValueError(f"--resolution {n}: spacing = {case.length}/n needs a positive n")
        return n
    ladders = case.method(pose.method).resolutions
    for chosen in (level, *Level):
        if ladders.get(chosen):
            return max(ladders[chosen])
    raise ValueError(f"{case.name}: {pose.method} runs at no level; give --resolution")
