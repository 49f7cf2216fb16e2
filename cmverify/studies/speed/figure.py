"""The speed study as a figure: products, whole solves, growth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cmverify.report import style


def draw(tables: dict[str, list[dict[str, Any]]], path: Path) -> None:
    """Three panels: what slows by how much, and what a particle costs as the lattice grows."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.ticker import NullFormatter, ScalarFormatter

    with plt.rc_context(style.RC):
        figure, axes = plt.subplots(1, 3, figsize=(13.5, 4.4), layout="constrained")
        products = [r for r in tables["Product with the stiffness"] if "threads" not in r["name"]]
        _bars(axes[0], products, "time of one product ÷ matrix-free, one thread each")
        _bars(axes[1], tables["Whole solve"], "CPU seconds of a solve ÷ two-level CG")
        growth = tables["Growth"]
        particles = [r["values"]["particles"] for r in growth]
        cost = [r["values"]["us_per_particle"] for r in growth]
        axes[2].loglog(particles, cost, "o-", color=style.BLUE)
        for place, (x, y, row) in enumerate(zip(particles, cost, growth, strict=True)):
            note = f"{row['name']}\n{row['values']['iterations']} it."
            axes[2].annotate(
                note,
                (x, y),
                (0, 9 if place % 2 == 0 else -28),
                textcoords="offset points",
                ha="center",
                fontsize=8,
            )
        axes[2].set(
            xlabel="particles",
            ylabel="time per particle / µs",
            title="set-up and solve of the crack tip to 1e-8",
            ylim=(0.5 * min(cost), 2.5 * max(cost)),
        )
        axes[2].xaxis.set_minor_formatter(NullFormatter())
        axes[2].yaxis.set_major_formatter(ScalarFormatter())
        axes[2].yaxis.set_minor_formatter(ScalarFormatter())
        figure.savefig(path, dpi=130)
        plt.close(figure)


def _bars(axis: Any, rows: list[dict[str, Any]], title: str) -> None:
    names = [row["name"].replace(": ", "\n") for row in rows]
    values = [row["values"]["slower"] for row in rows]
    colours = [style.BLUE if v == 1.0 else style.GREY for v in values]
    axis.barh(range(len(rows)), values, color=colours)
    axis.set_yticks(range(len(rows)), names, fontsize=7.5)
    axis.invert_yaxis()
    axis.set_xscale("log")
    axis.set_xlim(0.8, 2.2 * max(values))
    axis.set_title(title)
    for place, value in enumerate(values):
        axis.text(value * 1.05, place, f"{value:.3g}", va="center", fontsize=8)
