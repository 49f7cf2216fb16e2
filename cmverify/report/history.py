"""The page of the history: what asv has measured, drawn from its result files over the commits.

asv's own dashboard takes its scripts from the web; this page takes nothing from anywhere. It knows
asv's files of version 2: results/MACHINE/COMMIT-ENVIRONMENT.json, and benchmarks.json beside the
machines.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cmverify.report import pages
from cmverify.report.picture import Picture
from cmverify.run.results import write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAME, VERSION = "history.html", 2
#: Series that one figure can tell apart; the table has all of them.
SHOWN = 8


@dataclass(frozen=True)
class Series:
    """One benchmark with one set of parameters on one machine.

    Attributes
    ----------
    machine, benchmark, parameters, unit : str
    commits : tuple of str
        Short hashes, by the dates of their commits.
    values : tuple of float
        NaN where the benchmark failed.
    once : bool
        Whether no figure was repeated, as with `asv run --quick`: asv knows no interval of them.
    """

    machine: str
    benchmark: str
    parameters: str
    unit: str
    commits: tuple[str, ...]
    values: tuple[float, ...]
    once: bool = False

    @property
    def known(self) -> list[tuple[str, float]]:
        """Commits where it was measured, with the figure."""
        pairs = zip(self.commits, self.values, strict=True)
        return [(commit, value) for commit, value in pairs if math.isfinite(value)]

    @property
    def ratio(self) -> float:
        """The last figure over the first."""
        known = self.known
        return known[-1][1] / known[0][1] if known and known[0][1] else math.nan


def read(folder: Path) -> list[Series]:
    """Every series below a folder of asv's results.

    Raises
    ------
    ValueError
        If it holds no results, or not of the version known here.
    """
    units = {}
    if (folder / "benchmarks.json").is_file():
        about = _load(folder / "benchmarks.json")
        units = {n: b.get("unit", "") for n, b in about.items() if isinstance(b, dict)}
    found: dict[tuple[str, str, str], dict[tuple[float, str], float]] = {}
    repeated: set[tuple[str, str]] = set()
    for path in sorted(folder.glob("*/*.json")):
        if path.name == "machine.json":
            continue
        data = _load(path)
        if data.get("version") != VERSION:
            raise ValueError(f"{path} is not of asv's version {VERSION}")
        when = (float(data["date"]), str(data["commit_hash"])[:8])
        # Environments are series of their own: another Python is no other commit.
        where = " · ".join(filter(None, (path.parent.name, str(data.get("env_name", "")))))
        for name, entry in data["results"].items():
            row = dict(zip(data["result_columns"], entry, strict=False))
            if units.get(name) != "seconds" or any(
                n and n > 1 for n in row.get("stats_repeat") or ()
            ):
                repeated.add((where, name))
            for parameters, value in _values(row):
                found.setdefault((where, name, parameters), {})[when] = value
    if not found:
        raise ValueError(f"{folder} holds no results of asv: asv run HEAD^!")
    return [
        Series(
            machine, name, parameters, units.get(name, ""),
            tuple(commit for _, commit in sorted(at)), tuple(at[when] for when in sorted(at)),
            (machine, name) not in repeated,
        )
        for (machine, name, parameters), at in sorted(found.items())
    ]  # fmt: skip


def _load(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ValueError(f"{path} cannot be read: {error}") from error
    if not isinstance(data, dict):
        raise ValueError(f"{path} is no file of asv's")
    return data


def _values(row: dict[str, Any]) -> Iterator[tuple[str, float]]:
    """Parameters and figure of each entry of a benchmark's result."""
    values = row.get("result")
    if values is None:  # it failed as a whole
        return
    sets = itertools.product(*row.get("params", []))
    for given, value in zip(sets, values, strict=False):
        yield ", ".join(str(p).strip("'") for p in given), math.nan if value is None else value


def write(series: Sequence[Series], command: str, folder: Path) -> Path:
    """Write history.html into a folder; returns its path."""
    sections = []
    for machine, name in dict.fromkeys((s.machine, s.benchmark) for s in series):
        own = [s for s in series if (s.machine, s.benchmark) == (machine, name)]
        moved = sorted(own, key=lambda s: -abs(math.log(s.ratio)) if s.ratio > 0 else 0.0)
        drawn = [s for s in moved if len(s.known) > 1][:SHOWN]
        sections.append({"machine": machine, "name": name, "series": own,
                         "unit": own[0].unit if own[0].unit not in ("", "unit", "1") else "figure",
                         "picture": _picture(name, drawn) if drawn else None})  # fmt: skip
    commits = {commit for s in series for commit in s.commits}
    text = (
        pages.environment()
        .get_template("history.html")
        .render(
            css=pages.css(),
            name="history",
            contents=[(f"b{k}", s["name"]) for k, s in enumerate(sections, 1)],
            sections=sections,
            commits=len(commits),
            machines=len({s.machine.split(" · ")[0] for s in series}),
            command=command,
        )
    )
    path = folder / NAME
    write_text(path, text)
    return path


def _picture(name: str, drawn: Sequence[Series]) -> Picture:
    caption = "Those that moved most, each over its first figure."
    alt = "; ".join(f"{s.parameters or name}: last over first {s.ratio:.3g}" for s in drawn)
    return Picture.drawn(f"history-{name}", "svg", _figure(name, drawn), caption, alt)


def _figure(name: str, drawn: Sequence[Series]) -> Figure:
    import matplotlib
    from matplotlib.figure import Figure

    from cmverify.report import figures, style

    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=figures.NARROW)
        axis = figure.subplots()
        order = list(dict.fromkeys(commit for s in drawn for commit in s.commits))
        for index, s in enumerate(drawn):
            first = s.known[0][1]
            axis.plot(
                [order.index(commit) for commit, _ in s.known],
                [value / first if first else math.nan for _, value in s.known],
                label=s.parameters or name, color=style.CYCLE[index % len(style.CYCLE)],
                marker=style.MARKERS[index % len(style.MARKERS)],
                linestyle="-" if index < len(style.CYCLE) else "--",
            )  # fmt: skip
        step = max(1, -(-len(order) // 6))
        axis.set_xticks(range(0, len(order), step), order[::step], fontsize=8)
        axis.axhline(1.0, color=style.GREY, linewidth=0.8)
        ratios = [v / s.known[0][1] for s in drawn for _, v in s.known if s.known[0][1]]
        if min(ratios, default=0.0) > 0.0 and max(ratios) > 4.0 * min(ratios):
            axis.set_yscale("log")
            figures._decades(axis.yaxis)
        axis.set(title=name, xlabel="commit", ylabel="over the first")
        figures._legend_below(axis)
        return figure
