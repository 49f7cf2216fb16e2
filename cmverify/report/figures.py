"""The report's figures, from measurements to matplotlib figures; nothing is computed here."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from textwrap import wrap

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator

from cmverify.case import Case, LinePlot, Measurement
from cmverify.judge.convergence import fitted_order
from cmverify.judge.precision import Point
from cmverify.report import style
from cmverify.report.wording import tidy

ROUNDING = 1e-12
NARROW = (5.4, 3.9)


def line_plot(
    line: LinePlot,
    series: Mapping[int, LinePlot],
    length: str = "a",
    methods: Mapping[str, LinePlot] | None = None,
) -> Figure:
    """Markers for the computed values, a black line for the reference.

    Parameters
    ----------
    line : LinePlot
        The finest.
    series : mapping
        The same plot at every resolution, for those that want them all.
    methods : mapping, optional
        The same plot by every method, for those that want these.
    """
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=NARROW)
        axis = figure.subplots()
        looks = [style.of_index(i) for i in range(max(len(line.curves), len(series)))]
        if line.over_methods and methods:
            curves = [(name, plot.curves[0]) for name, plot in methods.items()]
            drawn = [line.curves[0]]
            looks = [style.marker_of_method(name, i) for i, name in enumerate(methods)]
        elif line.over_resolutions:
            curves = [(f"Δx = {length}/{n}", p.curves[0]) for n, p in sorted(series.items())]
            drawn = [line.curves[0]]
        else:
            curves = [(curve.label, curve) for curve in line.curves]
            drawn = list(line.curves)
        for curve in drawn:
            label = line.reference_label if curve is drawn[0] else None
            x = curve.abscissa if curve.reference_abscissa is None else curve.reference_abscissa
            axis.plot(x, curve.reference, "k-", linewidth=1.1, label=label, zorder=2)
        for index, (label, curve) in enumerate(curves):
            # A joined curve keeps every corner, with few marks to tell it by.
            shown = markers(curve.abscissa, curve.computed, 12 if line.joined else 30)
            look = looks[index]
            axis.plot(
                curve.abscissa, curve.computed, zorder=3, markevery=shown.tolist(),
                linestyle="-" if line.joined else "none", linewidth=0.9,
                label=label, markerfacecolor="none", markeredgewidth=1.2, **look,
            )  # fmt: skip
        axis.set_xlabel(line.xlabel)
        axis.set_ylabel(line.ylabel)
        axis.set_title(line.title)
        if len(curves) > 5 or line.over_methods:
            _legend_below(axis)
        else:
            axis.legend(loc="best")
        return figure


def markers(x: np.ndarray, y: np.ndarray, count: int = 30) -> np.ndarray:
    """Indices of about `count` points at equal distances along a curve as it is drawn."""
    if len(x) <= count:
        return np.arange(len(x))
    steps = np.hypot(np.diff(x) / (np.ptp(x) or 1.0), np.diff(y) / (np.ptp(y) or 1.0))
    length = np.concatenate([[0.0], np.cumsum(steps)])
    return np.unique(np.searchsorted(length, np.linspace(0.0, length[-1], count)))


def convergence_plot(case: Case, points: Iterable[Point], length: str = "a") -> Figure:
    """Error over spacing for every method, with fitted orders and the bounds that are judged."""
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=NARROW)
        axis = figure.subplots()
        for index, (name, series) in enumerate(_by_method(points)):
            h = np.array([1.0 / p.resolution for p in series])
            e = np.array([p.error for p in series])
            look = style.of_method(name, index)
            fit = fitted_order(h, e, ROUNDING) if len(h) > 1 else None
            exact = bool(np.all(e <= ROUNDING * 10))
            note = "rounding" if exact else (f"{fit.order:.2f}" if fit else "")
            label = f"{name} ({note})" if note else name
            axis.loglog(h, np.maximum(e, 1e-17), label=label, **look)
            for check in case.checks:
                if check.method == name and check.quantity == case.primary and check.at_most:
                    _bounds(axis, [p.resolution for p in series], check.bound_at, look["color"])
        _decades(axis.yaxis)
        _shade_rounding(axis)
        axis.set_xlabel(f"spacing or element size, $h/{length}$")
        axis.set_ylabel("\n".join(wrap(case.quantities[case.primary], 44)))
        axis.set_title("Convergence, with fitted order (bars: what must hold)")
        _few_ticks(axis, points)
        _legend_below(axis)
        return figure


def work_precision_plot(case: Case, points: Iterable[Point], length: str = "a") -> Figure:
    """Error over wall seconds for every method: down and to the left is better."""
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=NARROW)
        axis = figure.subplots()
        for index, (name, series) in enumerate(_by_method(points)):
            seconds = [p.seconds for p in series]
            errors = [max(p.error, 1e-17) for p in series]
            axis.loglog(seconds, errors, label=name, **style.of_method(name, index))
        _decades(axis.yaxis)
        _decades(axis.xaxis, "s")
        _shade_rounding(axis)
        axis.set_xlabel("set-up and solve (wall seconds)")
        axis.set_ylabel("\n".join(wrap(case.quantities[case.primary], 44)))
        sizes = sorted({p.resolution for p in points})
        ladder = ", ".join(f"{length}/{n}" for n in sizes)
        axis.set_title(f"Error against time at {ladder} (lower left is better)")
        _legend_below(axis)
        return figure


def _legend_below(axis: Axes) -> None:
    """Outside, where it hides nothing; the figure grows by what it needs."""
    labels = axis.get_legend_handles_labels()[1]
    longest = max(map(len, labels), default=0)
    columns = 3 if longest <= 22 else 2 if longest <= 32 else 1
    rows = -(-len(labels) // columns)
    figure = axis.figure
    below, height = 0.62 + 0.2 * rows, 3.8 + 0.2 * rows
    figure.set_size_inches(NARROW[0], height)  # type: ignore[union-attr]
    figure.subplots_adjust(bottom=below / height, top=1.0 - 0.32 / height)
    if "\n" in axis.get_ylabel():
        figure.subplots_adjust(left=0.165)
    axis.legend(
        loc="upper center",
        bbox_to_anchor=(0.46, -0.5 / (height - below - 0.32)),
        ncols=columns,
        fontsize=8.2,
        columnspacing=1.1,
        handlelength=2.2,
    )


def _decades(axis: Axis, unit: str = "") -> None:
    """Log ticks as plain text: 1e-3 reads like the tables and renders quickly.

    Decades where two or more are in view, else what lies between them too.
    """
    low, high = axis.get_view_interval()
    locators = (LogLocator(subs=subs, numticks=9) for subs in _SUBS)
    for locator in (*locators, MaxNLocator(4, min_n_ticks=2)):
        ticks = np.asarray(locator.tick_values(low, high))
        if np.sum((ticks >= low) & (ticks <= high)) >= (3 if high > 4.0 * low else 2):
            break
    axis.set_major_locator(locator)
    axis.set_major_formatter(FuncFormatter(lambda v, _: _log_label(v, unit)))
    axis.set_minor_formatter(NullFormatter())
    if high > 1e3 * low:  # nobody reads between so many
        axis.set_minor_locator(NullLocator())


#: What is labelled of a decade, in the order in which it is tried.
_SUBS = ((1.0,), (1.0, 3.0), (1.0, 2.0, 5.0), tuple(float(k) for k in range(1, 10)))


def _log_label(value: float, unit: str) -> str:
    if unit and 1e-3 <= value < 1e4:
        return f"{value:g}"
    exact = (d for d in range(3) if abs(float(f"{value:.{d}e}") / value - 1.0) < 1e-3)
    digits = next(exact, 3)
    return tidy(f"{value:.{digits}e}")


def _by_method(points: Iterable[Point]) -> list[tuple[str, list[Point]]]:
    groups: dict[str, list[Point]] = {}
    for point in points:
        groups.setdefault(point.method, []).append(point)
    return list(groups.items())


def _bounds(axis: Axes, resolutions: Sequence[int], bound_at, color: str) -> None:  # type: ignore[no-untyped-def]
    for n in resolutions:
        bound = bound_at(n)
        if bound is not None:
            h = 1.0 / n
            axis.plot([h / 1.13, h * 1.13], [bound, bound], color=color, linewidth=3, alpha=0.45)


def _shade_rounding(axis: Axes) -> None:
    low, high = axis.get_ylim()
    if low < ROUNDING:
        axis.axhspan(low, ROUNDING, color="#eef1f4", zorder=0)
        axis.text(
            0.985, ROUNDING, "rounding", transform=axis.get_yaxis_transform(),
            fontsize=8, color="#667", va="top", ha="right",
        )  # fmt: skip
        axis.set_ylim(low, high)


def _few_ticks(axis: Axes, points: Iterable[Point]) -> None:
    """Ticks at the spacings themselves, as fractions of the length."""
    sizes = sorted({p.resolution for p in points}, reverse=True)
    axis.set_xticks([1.0 / n for n in sizes], [f"1/{n}" for n in sizes])
    axis.minorticks_off()


def lines_of(
    measurements: Mapping[int, Measurement],
) -> list[tuple[LinePlot, dict[int, LinePlot]]]:
    """Each line plot of the finest measurement, with the same plot at every resolution."""
    if not measurements:
        return []
    finest = measurements[max(measurements)]
    return [
        (line, {n: m.lines[i] for n, m in measurements.items() if i < len(m.lines)})
        for i, line in enumerate(finest.lines)
    ]
