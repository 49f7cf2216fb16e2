"""One figure of a solid: bonds, stability, energy, kinks, waves, hole and crack."""

from __future__ import annotations

from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from cmverify.report import style
from cmverify.studies.anisotropy.profile import (
    DIRECTIONS,
    HORIZONS,
    MIXITIES,
    Profile,
    named,
    ripple,
)

_COLOURS = {"lattice": style.BLUE, "positive": style.GREEN, "continuum": style.ORANGE}
_STRAINS = ("extension", "shear")


def draw(found: Profile) -> Figure:
    """Six panels."""
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=(12.6, 8.2))
        bonds: Any = figure.add_subplot(2, 3, 1, projection="polar")
        margins, energy = (figure.add_subplot(2, 3, k) for k in (2, 3))
        waves: Any = figure.add_subplot(2, 3, 4, projection="polar")
        kinks, factors = (figure.add_subplot(2, 3, k) for k in (5, 6))
        _bonds(bonds, found)
        _margins(margins, found)
        _energy(energy, found)
        _waves(waves, found)
        _kinks(kinks, found)
        kinks.set(
            xlabel=r"mixity atan($K_\mathrm{II}/K_\mathrm{I}$), degrees", ylabel="kink, degrees",
            title="kink of a crack along axis 1, hoop criterion", xticks=[0, 30, 60, 90],
        )  # fmt: skip
        _factors(factors, found)
        figure.suptitle(f"{found.solid}, m = {found.m:g}", x=0.01, ha="left", weight="bold")
        figure.subplots_adjust(0.05, 0.1, 0.94, 0.89, wspace=0.34, hspace=0.52)
        return figure


def _bonds(axis: Any, found: Profile) -> None:
    p = found.polar
    for values, colour, label in ((p.kn, style.BLUE, "$k_n$"), (p.kt, style.ORANGE, "$k_t$")):
        positive = np.where(values >= 0, values, np.nan)
        axis.plot(p.psi, positive, color=colour, label=label)
        if values.min() < 0:
            negative = np.where(values < 0, -values, np.nan)
            axis.plot(p.psi, negative, color=colour, linestyle="--", label=f"−{label}")
    for (name, (angle, kn, kt)), marker in zip(p.bonds.items(), "osx", strict=False):
        look = {"linestyle": "none", "marker": marker, "markersize": 3, "markerfacecolor": "none"}
        axis.plot(angle, np.abs(kn), color=style.BLUE, label=f"{name} bonds", **look)
        axis.plot(angle, np.abs(kt), color=style.ORANGE, **look)
    axis.set_title("bond moduli over their largest", pad=24)
    axis.set_rlabel_position(112)
    _few_rings(axis)
    axis.tick_params(labelsize=8)
    axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncol=3, fontsize=8)


def _few_rings(axis: Any) -> None:
    ticks = axis.get_yticks()
    axis.set_rticks(ticks[1:-1][::2] if len(ticks) > 5 else ticks)


def _margins(axis: Any, found: Profile) -> None:
    lowest = 0.0
    for (calibration, law), values in found.margins.items():
        if not np.isfinite(values).any():
            continue
        shown = np.where(np.isneginf(values), np.nan, values)
        lowest = min(lowest, float(np.nanmin(shown, initial=0.0)))
        line = "--" if law == "UniformShear" else "-"
        axis.plot(
            HORIZONS, shown, line, marker="o", markersize=3, color=_COLOURS[calibration],
            label=named(calibration, law),
        )  # fmt: skip
    axis.axhline(0.0, color="0.4", linewidth=0.8)
    axis.set(
        xlabel="horizon m", ylabel="margin", title="stability in bulk: stable above 0",
        xticks=HORIZONS, ylim=(max(lowest, -1.0) - 0.05, 1.05),
    )  # fmt: skip
    axis.legend(fontsize=8, loc="best")


def _energy(axis: Any, found: Profile) -> None:
    for calibration, (degrees, ratio) in found.energies.items():
        for k, line in enumerate(("-", "--")):
            axis.plot(
                degrees, ratio[:, k], line, color=_COLOURS[calibration],
                label=f"{calibration}, {_STRAINS[k]}",
            )  # fmt: skip
    most = max([ripple(ratio) for _, ratio in found.energies.values()], default=0.0)
    axis.set(
        xlabel="turn of the material, degrees", ylabel=r"$W/W_\mathrm{exact}$",
        title="energy as it turns",
        xticks=[0, 45, 90, 135, 180], ylim=(1 - 1.3 * max(most, 1e-3), 1 + 2.6 * max(most, 1e-3)),
    )  # fmt: skip
    axis.legend(fontsize=8, ncol=2, loc="upper center")


def _waves(axis: Any, found: Profile) -> None:
    around = np.concatenate([DIRECTIONS, DIRECTIONS[1:] + np.pi])
    both = np.concatenate([found.speeds, found.speeds[1:]])
    for k, (label, colour) in enumerate((("fast", style.BLUE), ("slow", style.ORANGE))):
        axis.plot(around, both[:, k], color=colour, label=label)
    unit = "m/s" if found.density != 1.0 else "√(Pa m³/kg) at 1 kg/m³"
    axis.set_title(f"wave speeds, {unit}", pad=24)
    axis.set_rlabel_position(112)
    _few_rings(axis)
    axis.tick_params(labelsize=8)
    axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncol=2, fontsize=8)


def _kinks(axis: Any, found: Profile) -> None:
    """Angles as a line that is broken where the kink changes sides."""
    jumps = np.flatnonzero(np.abs(np.diff(found.kinks)) > 30.0) + 1
    mixity = np.insert(MIXITIES, jumps, np.nan)
    axis.plot(mixity, np.insert(found.kinks, jumps, np.nan), "-o", markersize=3, color=style.BLUE)


def _factors(axis: Any, found: Profile) -> None:
    degrees = np.degrees(DIRECTIONS)
    power = 3 * int(np.floor(np.log10(found.crack.max()) / 3))
    name = r"$K_\mathrm{I}^2/G$"
    axis.plot(degrees, found.hole, color=style.BLUE, label="hole: largest hoop stress")
    other = axis.twinx()
    other.plot(degrees, found.crack / 10.0**power, color=style.ORANGE, label=f"crack: {name}")
    axis.set(
        xlabel="direction of tension, or of the crack, degrees", ylabel="hoop stress over tension",
        title="hole and crack", xticks=[0, 45, 90, 135, 180],
    )  # fmt: skip
    axis.set_ylim(0, 1.45 * found.hole.max())
    other.set_ylim(0, 1.45 * found.crack.max() / 10.0**power)
    other.set_ylabel(f"{name}, $10^{{{power}}}$ Pa" if power else f"{name}, Pa")
    other.grid(visible=False)
    lines = [*axis.lines, *other.lines]
    axis.legend(lines, [line.get_label() for line in lines], fontsize=8, loc="upper center")
