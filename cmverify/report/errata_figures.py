"""Three figures of the audit: what somebody gets who follows the print."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib.figure import Figure

from cmverify.report import style

SIZE = (5.4, 3.4)


def disc() -> Figure:
    """Temperature of the disc along the axis x1 = 0."""
    import sympy as sp

    from references.errata import disc as paper

    x1, x2 = sp.symbols("x1 x2", real=True)
    printed = paper.field(sp.Rational(1, 5))
    fields = {
        "Eq. 169 as printed": (printed, style.ORANGE, "--"),
        "solution with its boundary values": (paper.solution_as_printed(), style.BLUE, "-"),
        "corrected (x₂³/3)": (paper.field(paper.last_coefficient()), style.GREEN, "-"),
    }
    height = np.linspace(-1, 1, 201)
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=SIZE)
        axis = figure.add_subplot()
        for label, (field, colour, line) in fields.items():
            values = sp.lambdify((x1, x2), field)(0.0, height)
            axis.plot(height, values, line, color=colour, label=label)
        left = sp.lambdify((x1, x2), paper.balance(printed))(0.0, height)
        axis.plot(height, left / 4, ":", color=style.GREY, label="div(D∇T) of the print, over 4")
        axis.set(xlabel="$x_2/a$ at $x_1 = 0$", ylabel="T (K)")
        axis.legend()
    return figure


def tetrachiral() -> Figure:
    """Free frequencies of the block lattice and of the homogenised square."""
    from references.errata.blocks import frequencies

    found = frequencies()
    looks = {
        "blocks": ("25 × 25 blocks", style.GREY, "D"),
        "corrected": ("homogenised, Eq. 87 corrected", style.BLUE, "o"),
        "printed": ("homogenised, Eq. 87 as printed", style.ORANGE, "s"),
    }
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=SIZE)
        axis = figure.add_subplot()
        sizes = {"blocks": 10.0, "corrected": 5.0, "printed": 6.0}
        for key, (label, colour, marker) in looks.items():
            modes = np.arange(1, len(found[key]) + 1)
            axis.plot(modes, found[key] / 1e3, marker, color=colour, label=label, ms=sizes[key])
        axis.set(xlabel="mode", ylabel="circular frequency (10³ rad/s)", ylim=(0, None))
        axis.legend(loc="lower right")
    return figure


def half_a_stiffness() -> Figure:
    """Frequencies of a cloud of particles, by Eq. 37 as printed and by its energy."""
    from references.errata import cloud, discrete
    from references.errata.expression import evaluate

    printed = evaluate(discrete.STIFFNESS, cloud.cloud_names(), exact=False)
    right, given = (
        np.sqrt(np.maximum(np.linalg.eigvalsh((k + k.T) / 2), 0.0))
        for k in (cloud.energy_hessian(), printed)
    )
    with matplotlib.rc_context(style.RC):
        figure = Figure(figsize=SIZE)
        axis = figure.add_subplot()
        reach = np.array([0.0, right[-1]])
        axis.plot(reach, reach, "-", color=style.GREY, label="equal")
        axis.plot(reach, reach / np.sqrt(2), "--", color=style.GREY, label="0.707 times")
        axis.plot(right, given, "o", color=style.ORANGE, label="Eq. 37 as printed")
        axis.set(xlabel="frequency, second derivative of the energy", ylabel="frequency as printed")
        axis.legend()
    return figure
