"""Pictures of an experiment's stages in a row, beside the curve on which they are marked."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib.figure import Figure

from cmverify.case import Measurement
from cmverify.report import style


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
        figure = Figure(figsize=(3.6 + count * (width + 0.25), height + 0.75), layout="constrained")
        axes = figure.subplots(1, 1 + count, width_ratios=[3.2, *[width] * count])
        curve = line.curves[0]
        axes[0].plot(curve.abscissa, curve.computed, "-", linewidth=1.0, color="0.2")
        axes[0].set(xlabel=line.xlabel, ylabel=line.ylabel, title=line.title)
        axes[0].title.set_fontsize(8)
        columns = np.rint((stages.points - low) / stages.spacing).astype(int)
        shape = columns.max(axis=0) + 1
        half = 0.5 * stages.spacing
        extent = (low[0] - half, high[0] + half, low[1] - half, high[1] + half)
        values = [stage.values for stage in stages.stages]
        finite = np.concatenate([v[np.isfinite(v)] for v in values])
        top = float(finite.max(initial=0.0)) or 1.0
        bottom = min(0.0, float(finite.min(initial=0.0)))
        colours = matplotlib.colormaps["magma_r"].resampled(160)
        for number, (axis, stage) in enumerate(zip(axes[1:], stages.stages, strict=True), 1):
            axes[0].plot(*stage.at, "o", color="C3", markersize=5)
            axes[0].annotate(
                f"S.{number}", stage.at, textcoords="offset points", xytext=(4, 4), fontsize=7
            )
            image = np.full(shape[::-1], np.nan)
            image[columns[:, 1], columns[:, 0]] = stage.values
            axis.imshow(
                image, origin="lower", extent=extent, cmap=colours, vmin=bottom, vmax=top,
                interpolation="nearest",
            )  # fmt: skip
            axis.set_title(f"S.{number}: {stage.label}", fontsize=8)
            axis.set_xticks([])
            axis.set_yticks([])
            axis.grid(False)
        return figure
