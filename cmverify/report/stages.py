"""Pictures of an experiment's stages in a row, beside the curve on which they are marked."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from cmverify.case import Measurement
from cmverify.report import style

#: A body is grey where it is whole, and told from what is not body (white).
_MAP = LinearSegmentedColormap.from_list(
    "damage", ["#e3e6ea", "#f3b562", "#d6402b", "#5a0f2e", "#14040f"], N=160
)


def stages_figure(measurement: Measurement) -> Figure:
    """The first line plot with numbered marks, and one map for each of them.

    Parameters
    ----------
    measurement : Measurement
        With stages, and at least one line plot.
    """
    stages, line = measurement.stages, measurement.lines[0]
    assert stages is not None
    count = len(stages.stages)
    low, high = stages.points.min(axis=0), stages.points.max(axis=0)
    size = high - low
    # Maps are as high as the curve; their width follows the body.
    height = 2.6
    width = min(max(height * float(size[0] / size[1]), 1.2), 3.2)
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=(4.4 + count * (width + 0.25), height + 0.75), layout="constrained")
        axes = figure.subplots(1, 1 + count, width_ratios=[3.2, *[width] * count])
        curve = line.curves[0]
        axes[0].plot(curve.abscissa, curve.computed, "-", linewidth=1.0, color="0.2")
        if len(curve.reference):
            x = curve.abscissa if curve.reference_abscissa is None else curve.reference_abscissa
            axes[0].plot(
                x, curve.reference, "--", color=style.BLUE, linewidth=0.9, zorder=1,
                label=line.reference_label,
            )  # fmt: skip
            axes[0].legend(loc="best", fontsize=7)
        axes[0].set(xlabel=line.xlabel, ylabel=line.ylabel, title=line.title)
        axes[0].title.set_fontsize(8)
        axes[0].margins(x=0.08, y=0.1)
        columns = np.rint((stages.points - low) / stages.spacing).astype(int)
        shape = columns.max(axis=0) + 1
        half = 0.5 * stages.spacing
        extent = (low[0] - half, high[0] + half, low[1] - half, high[1] + half)
        values = [stage.values for stage in stages.stages]
        finite = np.concatenate([v[np.isfinite(v)] for v in values])
        top = float(finite.max(initial=0.0)) or 1.0
        bottom = min(0.0, float(finite.min(initial=0.0)))
        body = np.zeros(shape[::-1])
        body[columns[:, 1], columns[:, 0]] = 1.0
        drawn = None
        previous: np.ndarray | None = None
        for number, (axis, stage) in enumerate(zip(axes[1:], stages.stages, strict=True), 1):
            axes[0].plot(*stage.at, "o", color="C3", markersize=5, zorder=4)
            # Marks at nearly the same place have their names one beside the other.
            near = previous is not None and _near(axes[0], previous, stage.at)
            previous = stage.at
            axes[0].annotate(
                f"S.{number}", stage.at, textcoords="offset points",
                xytext=(-20, -3) if near and number % 2 == 0 else (6, 3), fontsize=7, zorder=5,
                bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none",
                      "alpha": 0.8},
            )  # fmt: skip
            image = np.full(shape[::-1], np.nan)
            image[columns[:, 1], columns[:, 0]] = stage.values
            drawn = axis.imshow(
                image, origin="lower", extent=extent, cmap=_MAP, vmin=bottom, vmax=top,
                interpolation="nearest",
            )  # fmt: skip
            if not body.all():
                axis.contour(
                    np.linspace(extent[0] + half, extent[1] - half, shape[0]),
                    np.linspace(extent[2] + half, extent[3] - half, shape[1]),
                    body, levels=[0.5], colors="0.35", linewidths=0.6,
                )  # fmt: skip
            for outline in stages.outlines:
                axis.plot(*outline.T, "-", color="0.35", linewidth=0.8)
            axis.set(xlim=extent[:2], ylim=extent[2:])
            axis.set_title(f"S.{number}: {stage.label}", fontsize=8)
            axis.set_xticks([])
            axis.set_yticks([])
            axis.grid(False)
            for spine in axis.spines.values():
                spine.set(visible=True, color="0.35", linewidth=0.6)
        if drawn is not None:
            bar = figure.colorbar(drawn, ax=axes[-1], shrink=0.8, pad=0.03, aspect=18)
            bar.set_label(stages.quantity, fontsize=8)
            bar.ax.tick_params(labelsize=7)
        return figure


def _near(axis: matplotlib.axes.Axes, one: np.ndarray, other: np.ndarray) -> bool:
    """Whether two points of a curve lie within a label's size of each other."""
    (x0, x1), (y0, y1) = axis.get_xlim(), axis.get_ylim()
    apart = (np.asarray(one) - other) / [x1 - x0, y1 - y0]
    return bool(abs(apart[0]) < 0.08 and abs(apart[1]) < 0.08)
