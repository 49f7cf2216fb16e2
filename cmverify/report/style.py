"""How figures look: one colour, marker and line style a method, readable without colour."""

from __future__ import annotations

from typing import Any

# Okabe and Ito's palette, told apart with every common colour vision.
BLUE, ORANGE, GREEN, PURPLE, SKY, YELLOW, GREY = (
    "#0072B2", "#D55E00", "#009E73", "#B5478A", "#3A9BD9", "#B8860B", "#6B6B6B",
)  # fmt: skip
CYCLE = (BLUE, ORANGE, GREEN, PURPLE, SKY, YELLOW)
MARKERS = ("o", "s", "D", "^", "v", ">")

_KNOWN = {
    # The calibrations may coincide: markers of falling size let all of them be seen.
    "bond/lattice": (BLUE, "o", 9.0),
    "bond/positive": (ORANGE, "s", 6.0),
    "bond/continuum": (GREY, "D", 3.5),
    # Surface treatments.
    "bond/extrapolated": (BLUE, "o", 7.0),
    "bond/volume": (ORANGE, "s", 6.0),
    "bond/none": (GREY, "D", 5.0),
    "bond/lattice extrapolated": (YELLOW, "P", 7.0),
    "bond/lattice none": ("#303030", "X", 6.0),
    "bond/lattice calibrated tip": ("#8C2D04", "*", 9.0),
    "fem/P1": (GREEN, "^", 6.0),
    "fem/P2": (PURPLE, "v", 6.0),
    "fem/P2 graded": (SKY, ">", 6.0),
}

RC: Any = {
    # Drawn with the first, which Matplotlib brings; a browser without it takes the next.
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Verdana", "sans-serif"],
    "font.size": 10.0,
    # Where it always is: to look for a better place measures every tick.
    "axes.titley": 1.0,
    "axes.titlesize": 10.5,
    "axes.labelsize": 10.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#d9dde2",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8.8,
    "lines.linewidth": 1.5,
    "lines.markersize": 5.5,
    "figure.facecolor": "white",
    # Text stays text: outlines of letters are nine tenths of a figure's bytes.
    "svg.fonttype": "none",
    "svg.hashsalt": "cmverify",
    "figure.subplot.left": 0.135,
    "figure.subplot.right": 0.975,
    "figure.subplot.bottom": 0.135,
    "figure.subplot.top": 0.915,
    "axes.formatter.useoffset": False,
}


def of_method(name: str, index: int = 0) -> dict[str, Any]:
    """Keyword arguments of `plot` for a method: finite elements dashed with open markers.

    Methods that many cases share always look the same; others go by their place in the case.
    """
    if name in _KNOWN:
        color, marker, size = _KNOWN[name]
    else:
        turn, place = divmod(index, len(CYCLE))
        color, marker, size = CYCLE[place], MARKERS[(place + turn) % len(MARKERS)], 6.0
    fem = name.startswith(("fem", "fenicsx"))
    return {
        "color": color,
        "marker": marker,
        "markersize": size,
        "linestyle": "--" if fem else "-",
        "markerfacecolor": "white" if fem else color,
        "markeredgewidth": 1.4,
    }


def marker_of_method(name: str, index: int = 0) -> dict[str, Any]:
    """Colour and marker of a method whose computed values stand beside a reference's line."""
    look = of_method(name, index)
    return {"color": look["color"], "marker": look["marker"]}


def of_index(index: int) -> dict[str, Any]:
    """Colour and marker of the i-th curve of a line plot."""
    turn, place = divmod(index, len(CYCLE))
    return {"color": CYCLE[place], "marker": MARKERS[(place + turn) % len(MARKERS)]}
