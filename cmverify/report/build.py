"""Render a run's summary as one HTML page, with the fields beside it as .vtu and .npz."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from cmverify.case import Case, LinePlot, Measurement, nothing_to_compile
from cmverify.judge import precision
from cmverify.judge.verdict import Verdict
from cmverify.report import (
    crosscheck_chapter,
    opening,
    pages,
    precision_chapter,
    previous,
    validity,
)
from cmverify.report.numbers import Results
from cmverify.report.picture import Picture
from cmverify.report.summary import CaseResult, Row, RunInfo, as_json, table, tally
from cmverify.report.tables import blocks
from cmverify.report.topics import by_topic
from cmverify.report.wording import heading, mathtext
from cmverify.run.lifeline import workers
from cmverify.run.results import write_text
from cmverify.run.threads import child_environment

#: Pages that other commands write beside this one, and what they hold.
BESIDE = (
    ("stability.html", "Stability of bond models: verdicts, maps, polar plots"),
    (
        "materials.html",
        "Solids of the cases: their bonds, stability, waves, kinks, and what to use",
    ),
    ("speed.html", "Speed beside what one would otherwise use"),
    ("history.html", "The history of times and errors over the commits"),
    ("faults.html", "Faults put in on purpose: which case catches which"),
    ("errata.html", "The paper, audited: every equation and number"),
)


def build(summary: Sequence[CaseResult], info: RunInfo, folder: Path) -> Path:
    """Write index.html into a folder, its figures under figures/ and featured fields under fields/.

    Returns
    -------
    Path of index.html
    """
    drawn = _drawn(summary, folder, info.jobs)
    pictures = {r.case.name: parts[0] for r, parts in zip(summary, drawn, strict=True)}
    sections = {
        result.case.name: _section(result, info, *parts)
        for result, parts in zip(summary, drawn, strict=True)
    }
    page = (
        pages.environment()
        .get_template("template.html")
        .render(
            css=pages.css(),
            info=info,
            counts=tally(summary),
            missing=[task for result in summary for task in result.missing],
            failed=_failed(summary),
            topics=[
                (topic, [sections[result.case.name] for result in own])
                for topic, own in by_topic(summary)
            ],
            lines=opening.lines(summary),
            pictures=opening.pictures(summary, pictures),
            methods=sorted({name for r in summary for name in r.outcomes}),
            before=_before(summary, info, folder),
            **_precision(folder),
            **_crosscheck(folder),
            cases={result.case.name for result in summary},
            validity=covered if (covered := validity.matrix(summary)).covered else None,
            beside=[(name, text) for name, text in BESIDE if (folder / name).is_file()],
        )
    )
    path = folder / "index.html"
    write_text(path, page)
    return path


def _failed(summary: Sequence[CaseResult]) -> list[Verdict]:
    """What fails, but for checks of what nobody measured: those are told of as missing."""
    found = []
    for result in summary:
        missing = set(result.missing)
        for v in result.verdicts:
            at = {f"{v.case} {v.method} {part}" for part in re.split(", | → ", v.where)}
            # A method that raised at one resolution may have been measured nowhere else.
            enough = v.value if v.kind == "ran" else 1
            if not v.passed and len(missing & at) < enough:
                found.append(v)
    return found


def _precision(folder: Path) -> dict[str, Any]:
    """The study of precision in a folder and its sections; why there is none, or None."""
    from cmverify.cases import registry

    try:
        study = precision_chapter.read(folder)
    except ValueError as error:
        return {"precision": str(error), "precise": []}
    cases = {case.name: case for case in registry.all_cases()}
    if study is None or not all(p.case in cases for p in study.points):
        return {"precision": None, "precise": []}
    titles = {name: case.title for name, case in cases.items()}
    errors = {name: case.quantities[case.primary] for name, case in cases.items()}
    return {"precision": study, "precise": precision_chapter.sections(study, titles, errors)}


def _crosscheck(folder: Path) -> dict[str, Any]:
    """The cross-check in a folder (or why it cannot be read, or None), and its column."""
    try:
        found = crosscheck_chapter.read(folder)
    except ValueError as error:
        return {"crosscheck": str(error), "fenicsx": {}}
    return {"crosscheck": found, "fenicsx": crosscheck_chapter.column(found) if found else {}}


def _before(summary: Sequence[CaseResult], info: RunInfo, folder: Path) -> Any:
    """The run before beside this one: a comparison, why there is none, or None."""
    try:
        return previous.compare(folder, Results.model_validate_json(as_json(summary, info)))
    except ValueError as error:
        return str(error)


def _drawn(
    summary: Sequence[CaseResult], folder: Path, jobs: int
) -> list[tuple[list[Picture], list[str]]]:
    """Figures and exported fields of each case, in `jobs` processes if that pays."""
    if min(jobs, len(summary)) < 2:
        return [(_draw(result, folder), _export(result, folder)) for result in summary]
    return _draw_in_processes(summary, folder, min(jobs, len(summary)))


def _draw_in_processes(
    summary: Sequence[CaseResult], folder: Path, jobs: int
) -> list[tuple[list[Picture], list[str]]]:
    # Functions of a case stay here: they cannot be sent.
    bare = [replace(result, case=_without_functions(result.case)) for result in summary]
    with child_environment(), workers(jobs) as pool:
        # By one of them: to write fields is quick, to load the solver that knows how is not.
        writing = pool.submit(_export_all, bare, folder)
        drawn = list(pool.map(_draw, bare, [folder] * len(bare)))
        written = writing.result()
    return list(zip(drawn, written, strict=True))


def _without_functions(case: Case) -> Case:
    methods = tuple(replace(m, run=_not_here, warm_up=nothing_to_compile) for m in case.methods)
    return replace(case, methods=methods, elements={}, rivals=())


def _not_here(resolution: int) -> Measurement:
    raise RuntimeError("a process that draws figures does not measure")


def _draw(result: CaseResult, folder: Path) -> list[Picture]:
    """Figures of a case, written as files too."""
    pictures = _pictures(result, precision.points(result.case, result.outcomes))
    for picture in pictures:  # for papers and slides
        picture.save(folder / "figures" / f"{result.case.name}-{picture.name}")
    return pictures


def _section(
    result: CaseResult, info: RunInfo, pictures: list[Picture], downloads: list[str]
) -> dict[str, Any]:
    """Everything the template needs to know about one case."""
    case = result.case
    rows = table(result)
    quantities = [q for q in case.quantities if any(q in row.quantities for row in rows)]
    points = precision.points(case, result.outcomes)
    run = result.run or info
    return {
        "case": case,
        "result": result,
        "rows": rows,
        "blocks": blocks(rows, quantities),
        "quantities": quantities,
        "pictures": pictures,
        "comparison": _comparison(result, points),
        "downloads": downloads,
        "verdicts": sorted(result.verdicts, key=lambda v: v.passed),
        "tightest": result.tightest,
        "command": f"cmverify run {case.name} --level {run.level} --jobs {run.jobs} --out report",
        "earlier": run if run.started != info.started else None,
        "solvers": _solvers(rows),
        "warnings": _warnings(rows, case.length),
        "ordered": any(row.orders for row in rows),
    }


def _warnings(rows: Sequence[Row], length: str) -> list[tuple[str, list[str]]]:
    """What the solver said, each sentence once, and of which measurements."""
    said: dict[str, list[str]] = {}
    for row in rows:
        for sentence in row.warnings:
            said.setdefault(sentence, []).append(f"{row.method}, {length}/{row.resolution}")
    return list(said.items())


def _solvers(rows: Sequence[Row]) -> str:
    """Which linear solvers each kind of method used, in words."""
    used: dict[str, list[str]] = {}
    for row in rows:
        name = row.statistics.get("method")
        if name and name not in used.setdefault(row.kind, []):
            used[row.kind].append(str(name))
    return "; ".join(f"{' and '.join(names)} ({kind})" for kind, names in used.items())


def _pictures(result: CaseResult, points: list[precision.Point]) -> list[Picture]:
    from cmverify.report import figures, maps
    from cmverify.report.stages import stages_figure

    case, pictures = result.case, list[Picture]()
    curves = [p for p in points if p.error >= 0.0]
    ladder = len({p.resolution for p in curves}) > 1  # a single spacing makes no curve
    if ladder and any(not c.equals for c in case.checks if c.quantity == case.primary):
        quantity = case.quantities[case.primary]
        pictures.append(
            Picture.drawn(
                "convergence",
                "svg",
                figures.convergence_plot(case, curves, case.length),
                f"{heading(quantity)} over spacing or element size.",
                _spoken(curves, "error"),
            )
        )
    if ladder and case.timed:
        pictures.append(
            Picture.drawn(
                "work-precision",
                "svg",
                figures.work_precision_plot(case, curves, case.length),
                "The same error over the wall time of set-up and solve; "
                "meshing and JIT compilation are not counted.",
                _spoken(curves, "seconds"),
            )
        )
    featured = {
        n: m
        for n, m in result.outcomes.get(result.featured, {}).items()
        if isinstance(m, Measurement)
    }
    if not featured:
        return pictures
    finest = max(featured)
    where = f"{result.featured} at Δx = {case.length}/{finest}"
    fields = featured[finest].fields
    for key, item in (fields.items if fields else {}).items():
        assert fields is not None
        caption = f"{mathtext(item.label)}: {where}, particles that are not prescribed."
        alt = f"Maps of {key}: computed, reference and their difference; {where}."
        figure = maps.field_panels(fields, item, case.length)
        pictures.append(Picture.drawn(f"field-{key}", "png", figure, caption, alt, wide=True))
    for name, number, shown in _staged(result):
        stages = shown.stages
        assert stages is not None
        at = f"{name} at Δx = {case.length}/{number}"
        caption = f"The crack's stages beside the curve: {at}."
        alt = f"Maps of {stages.quantity} at marked points of the curve; {at}."
        key = "stages" if name == result.featured else f"stages-{len(pictures)}"
        figure = stages_figure(shown)
        pictures.append(Picture.drawn(key, "png", figure, caption, alt, wide=True))
    for index, (line, series) in enumerate(figures.lines_of(featured), 1):
        title = mathtext(line.title)
        caption = f"{title}. {heading(where)}."
        if line.over_methods:
            caption = f"{title}. Every method at its finest spacing."
        elif line.over_resolutions:
            caption = f"{title}."
        alt = f"Line plot: {title}; markers computed, line {line.reference_label}."
        beside = _by_methods(result, index - 1) if line.over_methods else None
        figure = figures.line_plot(line, series, case.length, beside)
        pictures.append(Picture.drawn(f"line-{index}", "svg", figure, caption, alt))
    return pictures


def _staged(result: CaseResult) -> list[tuple[str, int, Measurement]]:
    """Methods with stages, each at its finest resolution, the featured one first."""
    found = []
    for method in sorted(result.outcomes, key=lambda name: name != result.featured):
        finest = result.finest(method)
        if finest is not None and finest[1].stages is not None:
            found.append((method, *finest))
    return found


def _by_methods(result: CaseResult, index: int) -> dict[str, LinePlot]:
    """One line plot of every method that draws it, at its finest resolution."""
    found = {}
    for method in result.outcomes:
        finest = result.finest(method)
        if finest and index < len(finest[1].lines):
            found[method] = finest[1].lines[index]
    return found


def _comparison(result: CaseResult, points: list[precision.Point]) -> list[dict[str, Any]]:
    """Seconds in which each method reaches the same errors, those of the plainest FEM."""
    fem = [p for p in points if p.kind == "fem" and p.seconds > 0]
    if not fem:
        return []
    first = fem[0].method
    targets = [p.error for p in fem if p.method == first]
    names = list(dict.fromkeys(p.method for p in points))
    return [
        {
            "method": name,
            "seconds": [
                precision.seconds_for([p for p in points if p.method == name], target)
                for target in targets
            ],
            "targets": targets,
        }
        for name in names
    ]


def _export_all(summary: Sequence[CaseResult], folder: Path) -> list[list[str]]:
    return [_export(result, folder) for result in summary]


def _export(result: CaseResult, folder: Path) -> list[str]:
    """Write the featured fields; returns their paths relative to the page."""
    from cmverify.exchange.export import write_fields

    found = result.finest(result.featured)
    if found is None or found[1].fields is None:
        return []
    resolution, measurement = found
    name = f"{result.case.name}-{result.featured.replace('/', '-')}-{resolution}"
    assert measurement.fields is not None
    paths = write_fields(measurement.fields, folder / "fields" / name)
    return [path.relative_to(folder).as_posix() for path in paths]


def _spoken(points: Sequence[precision.Point], what: str) -> str:
    """The plot's data as a sentence for screen readers."""
    parts = []
    for p in points:
        after = f" in {p.seconds:.2g} s" if what == "seconds" else ""
        parts.append(f"{p.method} at 1/{p.resolution}: {p.error:.1e}{after}")
    return "; ".join(parts) + "."
