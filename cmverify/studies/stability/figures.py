"""The figures of the stability studies; nothing is computed here."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from cmverify.case import Array
from cmverify.report import style
from cmverify.studies.stability.polar import Polar
from cmverify.studies.stability.studies import Map, Representability

# Margins in steps: an eye tells seven shades apart, and zero is an edge.
_EDGES = (0.0, 0.01, 0.1, 0.25, 0.5, 0.75, 0.9, 1.001)
_SHADES = ("#fde8c9", "#d7eec4", "#a8dcc0", "#6fc3be", "#3f9fbf", "#2a78b0", "#1d4f91")
_UNSTABLE, _NO_ROTATION, _NO_MODULI = "#d1495b", "#8d1f3a", "#c9ccd1"


def _edges(centres: Array, log: bool) -> Array:
    values = np.log(centres) if log else centres
    middle = 0.5 * (values[1:] + values[:-1])
    ends = 2 * values[0] - middle[0], 2 * values[-1] - middle[-1]
    edges = np.concatenate([ends[:1], middle, ends[1:]])
    return np.exp(edges) if log else edges


def _draw(axis: Axes, found: Map, log: tuple[bool, bool]) -> None:
    x, y = _edges(found.x, log[0]), _edges(found.y, log[1])
    colours = ListedColormap(_SHADES)
    norm = BoundaryNorm(_EDGES, len(_SHADES))
    value = np.ma.masked_where(~(found.margin > 0), np.minimum(found.margin, 1.0))
    axis.pcolormesh(x, y, value, cmap=colours, norm=norm)
    classes = (
        (np.isnan(found.margin), _NO_MODULI),
        (np.isneginf(found.margin), _NO_ROTATION),
        (np.isfinite(found.margin) & ~(found.margin > 0), _UNSTABLE),
    )
    for chosen, colour in classes:
        mask = np.ma.masked_where(~chosen, np.ones_like(found.margin))
        axis.pcolormesh(x, y, mask, cmap=ListedColormap([colour]))
    axis.grid(False)
    axis.set_title(found.title)
    axis.set_xlabel(found.xlabel)
    if log[0]:
        _log_axis(axis, "x", found.x)
    if log[1]:
        _log_axis(axis, "y", found.y)


def _log_axis(axis: Axes, which: str, values: Array) -> None:
    scale = axis.xaxis if which == "x" else axis.yaxis
    (axis.set_xscale if which == "x" else axis.set_yscale)("log")
    ticks = [t for t in (0.2, 0.5, 1, 2, 5, 10, 20, 40, 100, 1000) if values[0] <= t <= values[-1]]
    if values[-1] > 100:
        ticks = [1, 10, 100, 1000]
    scale.set_major_locator(FixedLocator(ticks))
    scale.set_minor_locator(NullLocator())
    scale.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))


def _legend(figure: Figure, maps: Sequence[Map], bottom: float = 0.0) -> None:
    names = [f"{a:g} – {b:g}" for a, b in zip(_EDGES[:-1], (*_EDGES[1:-1], 1.0), strict=True)]
    handles = [Patch(color=c, label=n) for c, n in zip(_SHADES, names, strict=True)]
    margins = np.concatenate([m.margin.ravel() for m in maps])
    if np.any(np.isfinite(margins) & (margins <= 0)):
        handles.append(Patch(color=_UNSTABLE, label="unstable"))
    if np.any(np.isneginf(margins)):
        handles.append(Patch(color=_NO_ROTATION, label="unstable: no rotation stiffness"))
    if np.any(np.isnan(margins)):
        handles.append(Patch(color=_NO_MODULI, label="no such moduli"))
    figure.legend(
        handles=handles, loc="lower center", ncol=5, title="stability margin",
        bbox_to_anchor=(0.5, bottom), fontsize=8.4, title_fontsize=9,
    )  # fmt: skip


def maps(found: Sequence[Map], log: tuple[bool, bool] = (False, False)) -> Figure:
    """Maps side by side on one scale."""
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=(3.45 * len(found) + 0.6, 4.2))
        axes = figure.subplots(1, len(found), sharey=True, squeeze=False)[0]
        for axis, one in zip(axes, found, strict=True):
            _draw(axis, one, log)
        axes[0].set_ylabel(found[0].ylabel)
        figure.subplots_adjust(left=0.09, right=0.985, top=0.93, bottom=0.29, wspace=0.08)
        _legend(figure, found)
        return figure


def poisson(found: Sequence[Map], limit: float) -> Figure:
    """Maps over (ν, m) with the change of sign and the limit of plane strain."""
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=(9.2, 4.2))
        axes = figure.subplots(1, 2, sharey=True)
        for axis, one, change in zip(axes, found, (1 / 3, 1 / 4), strict=True):
            rows = Map(
                one.title, one.xlabel, one.ylabel, one.x,
                np.arange(len(one.y), dtype=float), one.margin,
            )  # fmt: skip
            _draw(axis, rows, (False, False))
            axis.set_yticks(rows.y, [f"{m:g}" for m in one.y])
            axis.axvline(change, color="white", linestyle="--", linewidth=1.1)
            axis.text(
                change - 0.006, 0.97, "$k_t$ < 0 beyond", rotation=90, ha="right", va="top",
                fontsize=8.5, color="white", transform=axis.get_xaxis_transform(),
            )  # fmt: skip
        axes[0].set_ylabel(found[0].ylabel)
        axes[1].axvline(limit, color="k", linewidth=1.1)
        axes[1].text(
            limit + 0.006, 0.97, f"limit {limit:.4f} (m = 5)", rotation=90, ha="left", va="top",
            fontsize=8.5, color="white", transform=axes[1].get_xaxis_transform(),
        )  # fmt: skip
        figure.subplots_adjust(left=0.07, right=0.985, top=0.93, bottom=0.29, wspace=0.08)
        _legend(figure, found)
        return figure


def representability(found: Representability) -> Figure:
    """Smallest m over orthotropy, and shares of random tensors by m."""
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=(9.2, 3.9))
        left, right = figure.subplots(1, 2)
        grid = found.orthotropic
        x, y = _edges(grid.x, True), _edges(grid.y, True)
        finite = grid.margin[np.isfinite(grid.margin)]
        levels = np.arange(1, int(finite.max(initial=2)) + 2) - 0.5
        palette = ListedColormap(
            ["#1d4f91", "#2a78b0", "#3f9fbf", "#6fc3be", "#a8dcc0", "#d7eec4", "#fde8c9",
             "#f5cf94", "#eeb35f", "#e59a3a"][: len(levels) - 1]
        )  # fmt: skip
        value = np.ma.masked_where(~np.isfinite(grid.margin), grid.margin)
        image = left.pcolormesh(x, y, value, cmap=palette, norm=BoundaryNorm(levels, palette.N))
        for chosen, colour in ((np.isinf(grid.margin), _UNSTABLE), (np.isnan(grid.margin), "w")):
            mask = np.ma.masked_where(~chosen, np.ones_like(grid.margin))
            left.pcolormesh(x, y, mask, cmap=ListedColormap([colour]))
        bar = figure.colorbar(image, ax=left, ticks=levels[:-1] + 0.5)
        bar.set_label("smallest m")
        bar.ax.minorticks_off()
        left.grid(False)
        _log_axis(left, "x", grid.x)
        _log_axis(left, "y", grid.y)
        left.set(xlabel=grid.xlabel, ylabel=grid.ylabel, title=grid.title)
        left.legend(
            handles=[Patch(color=_UNSTABLE, label="at no m")], loc="lower left",
            frameon=True, framealpha=0.9,
        )  # fmt: skip
        right.bar(found.horizons, 100 * np.array(found.shares), color=style.BLUE, width=0.7)
        right.axhline(100 * (1 - found.never), color="k", linestyle="--", linewidth=1.1)
        right.text(
            found.horizons[-1] + 0.4, 100 * (1 - found.never) + 1.5,
            f"the other {100 * found.never:.0f} % at no m\n"
            f"({100 * found.below:.0f} % because C66 < C12)", ha="right", va="bottom", fontsize=9,
        )  # fmt: skip
        right.set(
            xlabel="horizon m", ylabel="share with non-negative bonds (%)",
            title=f"{found.count} random tensors", xticks=found.horizons, ylim=(0, 100),
        )  # fmt: skip
        right.grid(axis="x", visible=False)
        figure.subplots_adjust(left=0.08, right=0.985, top=0.91, bottom=0.14, wspace=0.24)
        return figure


def polar(found: Polar) -> Figure:
    """Macromoduli and micromoduli over the direction (Fig. 2), negative values dashed."""
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=(9.2, 4.9))
        left: Any = figure.add_subplot(1, 2, 1, projection="polar")
        right: Any = figure.add_subplot(1, 2, 2, projection="polar")
        left.plot(found.psi, found.axial, color=style.BLUE, label="$\\hat{C}_{1111}$")
        left.plot(found.psi, found.shear, color=style.ORANGE, label="$\\hat{C}_{1212}$")
        left.set_title(f"macromoduli of {found.solid}", y=1.08)
        for values, colour, label in (
            (found.kn, style.BLUE, "$k_n$, Eq. 48"),
            (found.kt, style.ORANGE, "$k_t$, Eq. 49"),
        ):
            right.plot(found.psi, np.where(values >= 0, values, np.nan), color=colour, label=label)
            if values.min() < 0:
                right.plot(
                    found.psi, np.where(values < 0, -values, np.nan), color=colour,
                    linestyle="--", label="negative",
                )  # fmt: skip
        for (name, (angle, kn, kt)), marker in zip(found.bonds.items(), "osx", strict=False):
            look: dict[str, Any] = {"linestyle": "none", "marker": marker, "markersize": 3.2}
            if marker != "x":
                look["markerfacecolor"] = "none"
            right.plot(angle, np.abs(kn), color=style.BLUE, label=f"{name} bonds", **look)
            right.plot(angle, np.abs(kt), color=style.ORANGE, **look)
        right.set_title("micromoduli", y=1.08)
        for axis in (left, right):
            axis.set_rlabel_position(112)
            axis.tick_params(labelsize=8)
            axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.07), ncol=3)
        figure.subplots_adjust(left=0.03, right=0.97, top=0.86, bottom=0.2, wspace=0.12)
        return figure


def over_poisson(curves: dict[str, tuple[Array, Array]]) -> Figure:
    """Macro- and micromoduli over Poisson's ratio (Fig. 3)."""
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=(5.4, 3.9))
        axis = figure.subplots()
        for index, (label, (nu, value)) in enumerate(curves.items()):
            axis.plot(
                nu, value, label=label, color=style.CYCLE[index],
                linestyle="-" if index < 2 else "--",
            )  # fmt: skip
        axis.axhline(0, color="k", linewidth=0.8)
        axis.axvline(1 / 3, color="k", linewidth=0.8, linestyle=":")
        axis.set(xlabel="Poisson's ratio ν (plane stress)", ylabel="modulus", ylim=(-1.0, 3.0))
        axis.set_title("Isotropic solids: the shear bonds vanish at ν = 1/3")
        axis.legend(loc="upper center")
        return figure
