"""The chapter on work and precision: what `cmverify precision --measure` has left in a folder."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cmverify.report import study_file
from cmverify.report.picture import Picture
from cmverify.run.results import write_text
from cmverify.studies.precision import Point, as_csv, seconds_to

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAME, TABLE, FORMAT = "precision.json", "precision.csv", 1


@dataclass(frozen=True)
class Study:
    """Points with what one must know to trust or repeat them.

    `load` is the machine's load average (processes that want to run) before the timing pass.
    """

    points: list[Point]
    refused: list[str]
    level: str
    threads: int
    cores: int
    load: float
    started: str
    environment: dict[str, Any] = field(default_factory=dict)

    @property
    def busy(self) -> bool:
        """Whether others were at work while times were taken: then they say little."""
        return self.load > 0.5 * self.cores


def write(study: Study, folder: Path) -> None:
    """Write precision.json and precision.csv."""
    study_file.write(folder / NAME, FORMAT, asdict(study))
    write_text(folder / TABLE, as_csv(study.points))


def read(folder: Path) -> Study | None:
    """The study of a folder; None if there is none.

    Raises
    ------
    ValueError
        If it cannot be read.
    """
    return study_file.read(
        folder / NAME,
        FORMAT,
        "study of precision",
        lambda data: Study(**{**data, "points": [Point(**one) for one in data["points"]]}),
    )


def sections(study: Study, titles: dict[str, str], quantities: dict[str, str]) -> list[Any]:
    """What the template shows of each problem: picture, points, and the time to some errors."""
    found = []
    problems = dict.fromkeys((p.case, p.problem) for p in study.points)
    for number, (name, problem) in enumerate(problems):
        points = [p for p in study.points if (p.case, p.problem) == (name, problem)]
        caption = "Bars are quartiles of repeated times; points that nothing beats are filled."
        alt = "; ".join(f"{p.method}: {p.error:.1e} in {p.seconds:.2g} s" for p in points)
        picture = Picture.drawn(
            f"precision-{number}-{name}", "svg", _figure(points, quantities[name]), caption, alt
        )
        targets = _targets(points)
        found.append(
            {
                "name": name,
                "id": f"precision-{number}-{name}",
                "title": f"{titles[name]}: {problem}" if problem else titles[name],
                "quantity": quantities[name],
                "picture": picture,
                "points": points,
                "reached": [(error, seconds_to(points, error)) for error in targets],
            }
        )
    return found


def _targets(points: list[Point]) -> list[float]:
    """The coarsest and the finest error of scikit-fem, and the power of ten that both can reach."""
    fem = sorted({p.error for p in points if p.method.startswith("fem")})
    if not fem:
        return [min(p.error for p in points)]
    power = 10.0 ** math.ceil(math.log10(fem[0])) if fem[0] > 0 else fem[0]
    return sorted({fem[-1], min(power, fem[-1]), fem[0]}, reverse=True)


def _figure(points: list[Point], quantity: str) -> Figure:
    import matplotlib
    from matplotlib.figure import Figure

    from cmverify.report import figures, style

    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=figures.NARROW)
        axis = figure.subplots()
        for index, name in enumerate(dict.fromkeys(p.method for p in points)):
            series = sorted((p for p in points if p.method == name), key=lambda p: p.resolution)
            look = style.of_method(name, index)
            errors = [max(p.error, 1e-17) for p in series]
            spread = [
                [p.seconds - p.fast for p in series],
                [p.slow - p.seconds for p in series],
            ]
            axis.errorbar(
                [p.seconds for p in series], errors, xerr=spread, label=name, elinewidth=1.0,
                **{**look, "markerfacecolor": "white"},
            )  # fmt: skip
            front = [p for p in series if p.standing == "front"]
            axis.plot(
                [p.seconds for p in front], [max(p.error, 1e-17) for p in front],
                linestyle="none", zorder=4,
                **{key: look[key] for key in ("color", "marker", "markersize")},
            )  # fmt: skip
        axis.set(xscale="log", yscale="log", title="Error against time (lower left is better)")
        axis.set_xlabel("set-up and solve (s, median)")
        axis.set_ylabel(quantity.split(",")[0])
        figures._decades(axis.xaxis, "s")
        figures._decades(axis.yaxis)
        figures._legend_below(axis)
        return figure
