"""Render a run's summary as one HTML page, with the fields beside it as .vtu and .npz."""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cmverify import precision
from cmverify.case import Measurement
from cmverify.results import write_text
from cmverify.summary import CaseResult, Row, RunInfo, all_passed, table
from cmverify.verdict import Verdict

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Picture:
    """A figure, its caption, and a text for those who cannot see it."""

    name: str
    kind: str
    content: bytes
    caption: str
    alt: str
    wide: bool = False

    @property
    def uri(self) -> str:
        """The figure inside the page."""
        media = {"svg": "image/svg+xml", "png": "image/png"}[self.kind]
        return f"data:{media};base64,{base64.b64encode(self.content).decode()}"


def build(summary: Sequence[CaseResult], info: RunInfo, folder: Path) -> Path:
    """Write index.html into a folder, its figures under figures/ and featured fields under fields/.

    Returns
    -------
    Path of index.html
    """
    from jinja2 import Environment, StrictUndefined

    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    environment.filters.update(number=number, seconds=seconds, count=count, mathtext=mathtext)
    resources = files("cmverify.report")
    template = environment.from_string((resources / "template.html").read_text())
    page = template.render(
        css=(resources / "style.css").read_text(),
        info=info,
        passed=all_passed(summary),
        verdicts=[v for result in summary for v in _failures_first(result.verdicts)],
        sections=[_section(result, folder) for result in summary],
    )
    path = folder / "index.html"
    write_text(path, page)
    return path


def _failures_first(verdicts: Sequence[Verdict]) -> list[Verdict]:
    return sorted(verdicts, key=lambda v: v.passed)


def _section(result: CaseResult, folder: Path) -> dict[str, Any]:
    """Everything the template needs to know about one case."""
    case = result.case
    rows = table(result)
    quantities = [q for q in case.quantities if any(q in row.quantities for row in rows)]
    points = precision.points(case, result.outcomes)
    pictures = _pictures(result, points)
    for picture in pictures:  # also as files, for papers and slides
        path = folder / "figures" / f"{case.name}-{picture.name}.{picture.kind}"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(picture.content)
    level_command = f"cmverify run {case.name} --level {{level}} --jobs {{jobs}} --out report"
    return {
        "case": case,
        "result": result,
        "rows": rows,
        "quantities": quantities,
        "pictures": pictures,
        "comparison": _comparison(result, points),
        "downloads": _export(result, folder),
        "command": level_command,
        "solvers": _solvers(rows),
        "timed": any(not math.isnan(row.total) and row.total > 0 for row in rows),
    }


def _solvers(rows: Sequence[Row]) -> str:
    """Which linear solvers each kind of method used, in words."""
    used: dict[str, list[str]] = {}
    for row in rows:
        name = row.statistics.get("method")
        if name and name not in used.setdefault(row.kind, []):
            used[row.kind].append(str(name))
    return "; ".join(f"{' and '.join(names)} ({kind})" for kind, names in used.items())


def _pictures(result: CaseResult, points: list[precision.Point]) -> list[Picture]:
    from cmverify.report import figures

    case, pictures = result.case, list[Picture]()
    curves = [p for p in points if p.error >= 0.0]
    if any(p.seconds > 0 for p in curves):
        quantity = case.quantities[case.primary]
        pictures.append(
            Picture(
                "convergence",
                "svg",
                _render(figures.convergence_plot(case, curves, case.length), "svg"),
                f"{_capital(quantity)} over spacing or element size.",
                _spoken(curves, "error"),
            )
        )
        pictures.append(
            Picture(
                "work-precision",
                "svg",
                _render(figures.work_precision_plot(case, curves, case.length), "svg"),
                "The same error over the wall time of set-up and solve; "
                "meshing and JIT compilation are not counted.",
                _spoken(curves, "seconds"),
            )
        )
    featured = {
        n: m
        for n, m in result.outcomes.get(case.featured, {}).items()
        if isinstance(m, Measurement)
    }
    if not featured:
        return pictures
    finest = max(featured)
    where = f"{case.featured} at Δx = {case.length}/{finest}"
    fields = featured[finest].fields
    for key, item in (fields.items if fields else {}).items():
        assert fields is not None
        caption = f"{mathtext(item.label)}: {where}, particles that are not prescribed."
        alt = f"Maps of {key}: computed, reference and their difference; {where}."
        figure = figures.field_panels(fields, item, case.length)
        content = _render(figure, "png")
        pictures.append(Picture(f"field-{key}", "png", content, caption, alt, wide=True))
    for index, (line, series) in enumerate(figures.lines_of(featured), 1):
        title = mathtext(line.title)
        caption = f"{title}. {_capital(where)}." if not line.over_resolutions else f"{title}."
        alt = f"Line plot: {title}; markers computed, line closed form."
        content = _render(figures.line_plot(line, series, case.length), "svg")
        pictures.append(Picture(f"line-{index}", "svg", content, caption, alt))
    return pictures


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


def _export(result: CaseResult, folder: Path) -> list[str]:
    """Write the featured fields; returns their paths relative to the page."""
    from cmverify.export import write_fields

    found = result.finest(result.case.featured)
    if found is None or found[1].fields is None:
        return []
    resolution, measurement = found
    name = f"{result.case.name}-{result.case.featured.replace('/', '-')}-{resolution}"
    assert measurement.fields is not None
    paths = write_fields(measurement.fields, folder / "fields" / name)
    return [path.relative_to(folder).as_posix() for path in paths]


def _render(figure: Figure, kind: str) -> bytes:
    buffer = io.BytesIO()
    options: dict[str, Any] = {"dpi": 130} if kind == "png" else {"metadata": {"Date": None}}
    figure.savefig(buffer, format=kind, **options)
    return buffer.getvalue()


def _spoken(points: Sequence[precision.Point], what: str) -> str:
    """The plot's data as a sentence for screen readers."""
    parts = []
    for p in points:
        after = f" in {p.seconds:.2g} s" if what == "seconds" else ""
        parts.append(f"{p.method} at 1/{p.resolution}: {p.error:.1e}{after}")
    return "; ".join(parts) + "."


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def number(value: float | None, digits: int = 2) -> str:
    """A figure with few digits: 0.00123 as "1.2e-3", counts as they are."""
    if value is None or math.isnan(value):
        return "n/a"
    if value == int(value) and 1 <= abs(value) < 1e9:
        return f"{int(value):,}".replace(",", "\u202f")
    if 0.1 <= abs(value) < 1000:
        return f"{value:.{digits + 1}g}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def count(value: int | None) -> str:
    """A whole number in groups of three."""
    return "–" if value is None else f"{value:,}".replace(",", "\u202f")


def seconds(value: float | None) -> str:
    """Seconds to a sensible digit."""
    if value is None or math.isnan(value):
        return "–"
    return f"{value:.3f}" if value < 1 else f"{value:.2f}" if value < 100 else f"{value:.0f}"


def mathtext(label: str) -> str:
    """Plain Unicode for the little mathtext that labels use."""
    text = label.replace("$", "").replace("\\sigma", "σ").replace("{", "").replace("}", "")
    for index, sub in (("_11", "₁₁"), ("_22", "₂₂"), ("_12", "₁₂"), ("_1", "₁"), ("_2", "₂")):
        text = text.replace(index, sub)
    return text
