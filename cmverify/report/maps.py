"""Maps of a field: computed, reference and difference in one row.

A report has dozens of them and they differ in little but their pixels, so that the axes are made
once a process and filled anew for each: making and measuring them is most of what a map costs.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Colormap
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from cmverify.case import Field, FieldSet
from cmverify.report import style

_TITLES = ("computed", "reference", "computed − reference")
# Steps of a hundredth of the scale, which no eye sees and which leave a palette of 256 colours
# room for letters; an odd number where the middle is a colour of its own.
_CMAPS = tuple(
    matplotlib.colormaps[name].resampled(levels)
    for name, levels in (("viridis", 96), ("viridis", 96), ("RdBu_r", 97))
)
#: Height of the arrows of a colour bar, as a share of the bar's.
_ARROW = 0.045


class _Panel(NamedTuple):
    """A map's axes and its colour bar's, with the bar's two arrows (below, above)."""

    axis: Axes
    bar: Axes
    arrows: tuple[Polygon, Polygon]


def field_panels(fields: FieldSet, item: Field, length: str = "a") -> Figure:
    """Computed and reference on one colour scale, their difference on its own.

    A singular field is cut at its 0.5 and 99.5 percentiles; the colour bars' arrows say so.

    Returns
    -------
    Figure
        The same object in each call: write it before the next field is drawn.
    """
    with matplotlib.rc_context(style.RC):
        figure, panels = _frame()
        low, high = np.nanpercentile(item.reference, [0.5, 99.5])
        reach = np.nanpercentile(np.abs(item.difference), 99.5) or np.finfo(float).tiny
        scales = ((low, high), (low, high), (-reach, reach))
        low_corner, high_corner = fields.points.min(axis=0), fields.points.max(axis=0)
        middle = 0.5 * (low_corner + high_corner)
        # Panels are square: the longer side of the body fills them.
        edge = 0.52 * float((high_corner - low_corner).max())
        values = (item.computed, item.reference, item.difference)
        for index, panel in enumerate(panels):
            bottom, top = scales[index]
            for old in (*panel.axis.images, *panel.axis.collections):
                old.remove()
            _draw(panel.axis, fields, values[index], _CMAPS[index], bottom, top)
            for side, centre in zip((panel.axis.xaxis, panel.axis.yaxis), middle, strict=True):
                side.set_view_interval(centre - edge, centre + edge, ignore=True)
            panel.axis.set_aspect("equal")
            panel.axis.set_xlabel(f"$x_1/{length}$", labelpad=1)
            name = ("Δ " if index == 2 else "") + item.label
            _scale(panel, values[index], bottom, top, name, item.unit)
        panels[0].axis.set_ylabel(f"$x_2/{length}$", labelpad=0)
        return figure


@cache
def _frame() -> tuple[Figure, tuple[_Panel, ...]]:
    """Three empty panels, laid out by hand: the panels of all fields align."""
    figure = Figure(figsize=(10.4, 2.95))
    panels = []
    for index, (title, cmap) in enumerate(zip(_TITLES, _CMAPS, strict=True)):
        left = 0.052 + index * 0.318
        axis = figure.add_axes((left, 0.155, 0.225, 0.745))
        axis.set_title(title)
        axis.grid(False)
        axis.tick_params(labelleft=index == 0)
        for side in (axis.xaxis, axis.yaxis):
            side.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
        panels.append(_Panel(axis, *_bar(figure, left + 0.233, cmap)))
    return figure, tuple(panels)


def _bar(figure: Figure, left: float, cmap: Colormap) -> tuple[Axes, tuple[Polygon, Polygon]]:
    """A colour bar from 0 to 1; its ticks come with a field."""
    bar = figure.add_axes((left, 0.155, 0.011, 0.745))
    colours = np.linspace(0.0, 1.0, cmap.N)[:, None]
    box = (0.0, 1.0, 0.0, 1.0)
    bar.imshow(
        colours, origin="lower", extent=box, cmap=cmap, aspect="auto", interpolation="nearest"
    )
    bar.set(xticks=[], xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    bar.grid(False)
    bar.spines[:].set_visible(False)
    bar.yaxis.tick_right()
    bar.yaxis.set_label_position("right")
    below, above = (
        Polygon([(0.0, y), (1.0, y), (0.5, tip)], color=cmap(y), clip_on=False, linewidth=0)
        for y, tip in ((0.0, -_ARROW), (1.0, 1.0 + _ARROW))
    )
    bar.add_patch(below)
    bar.add_patch(above)
    return bar, (below, above)


def _scale(
    panel: _Panel, values: np.ndarray, low: float, high: float, label: str, unit: str
) -> None:
    """Ticks, arrows and label of a colour bar that goes from `low` to `high`."""
    span = (high - low) or 1.0
    power = _power(max(abs(low), abs(high)))
    ticks = np.asarray(MaxNLocator(5).tick_values(low, high))
    ticks = ticks[(ticks >= low - 1e-9 * span) & (ticks <= high + 1e-9 * span)]
    panel.bar.set_yticks((ticks - low) / span, [f"{tick / 10.0**power:.3g}" for tick in ticks])
    for arrow, shown in zip(panel.arrows, _beyond(values, low, high), strict=True):
        arrow.set_visible(shown)
    notes = ([f"1e{power}"] if power else []) + ([unit] if unit != "1" else [])
    panel.bar.set_ylabel(f"{label} ({' '.join(notes)})" if notes else label, labelpad=2)


def _power(size: float) -> int:
    """Power of ten to take out of a colour bar's numbers; 0 for everyday sizes."""
    if size == 0.0 or 0.05 <= size < 1000.0:
        return 0
    return int(np.floor(np.log10(size)))


def _draw(
    axis: Axes, fields: FieldSet, values: np.ndarray, cmap: Colormap, low: float, high: float
) -> Any:
    if fields.triangles is not None:
        mesh = Triangulation(fields.points[:, 0], fields.points[:, 1], fields.triangles)
        return axis.tripcolor(
            mesh, values, cmap=cmap, vmin=low, vmax=high, shading="gouraud", rasterized=True
        )
    image, extent = as_image(fields.points, values, fields.spacing or 1.0)
    return axis.imshow(
        image, origin="lower", extent=extent, cmap=cmap, vmin=low, vmax=high,
        interpolation="nearest",
    )  # fmt: skip


def as_image(
    points: np.ndarray, values: np.ndarray, spacing: float
) -> tuple[np.ndarray, tuple[float, float, float, float]]:
    """Lattice values as an image (rows along x2, NaN where there is no particle) and its extent."""
    origin = points.min(axis=0)
    column, line = np.rint((points - origin) / spacing).astype(int).T
    image = np.full((line.max() + 1, column.max() + 1), np.nan)
    image[line, column] = values
    left, bottom = origin - 0.5 * spacing
    extent = (left, left + spacing * image.shape[1], bottom, bottom + spacing * image.shape[0])
    return image, tuple(float(edge) for edge in extent)  # type: ignore[return-value]


def _beyond(values: np.ndarray, low: float, high: float) -> tuple[bool, bool]:
    """Whether a part of the values lies visibly below and above a scale."""
    slack = 0.02 * (high - low)
    return bool(np.nanmin(values) < low - slack), bool(np.nanmax(values) > high + slack)
