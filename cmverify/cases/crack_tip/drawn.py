"""Fields and lines of the crack tip that the report draws (Figs. 7–9)."""

from __future__ import annotations

import numpy as np

from cmverify.case import Array, Curve, Field, FieldSet, LinePlot
from cmverify.cases.common import adapters
from cmverify.cases.crack_tip.problem import Problem


def fields(
    points: Array,
    free: np.ndarray,
    computed: Array,
    reference: Array,
    stress: Array,
    stress22: Array,
    n: int,
) -> FieldSet:
    length, tension = "K√a/C", "K/√a"
    items = {
        "u1": Field("$u_1$", length, computed[free, 0], reference[free, 0]),
        "u2": Field("$u_2$", length, computed[free, 1], reference[free, 1]),
        "stress22": Field("$\\sigma_{22}$", tension, stress[free], stress22[free]),
    }
    return FieldSet(points[free], items, spacing=1.0 / n)


def lines(
    problem: Problem,
    points: Array,
    free: np.ndarray,
    computed: Array,
    reference: Array,
    stress: Array,
    stress22: Array,
    n: int,
) -> tuple[LinePlot, ...]:
    inner, spacing = points[free], 1.0 / n
    plots = [
        LinePlot(
            f"Displacement $u_{i + 1}$ along three abscissae (Fig. 7)",
            "$x_1/a$",
            f"$u_{i + 1}$ (K√a/C)",
            adapters.curves_along_rows(
                inner, computed[free, i], reference[free, i], (-0.5, 0.0, 0.5), spacing
            ),
        )
        for i in (0, 1)
    ]
    upper = adapters.row(inner, 0.0, spacing)
    front = upper[(inner[upper, 0] > 0.0) & (inner[upper, 0] <= 0.5)]
    face = upper[inner[upper, 0] < 0.0]
    x = inner[:, 0]
    # The closed form is steep: draw it finely, from the first particle on.
    dense = np.linspace(0.5 * spacing, 1.0, 800)
    row = np.full_like(dense, inner[upper[0], 1])
    if problem.KI:
        near = dense <= 0.5
        exact = problem.scale * problem.stress22(dense[near], row[near])
        plots.append(
            LinePlot(
                "Stress $\\sigma_{22}$ ahead of the tip (Fig. 8)",
                "$x_1/a$",
                "$\\sigma_{22}$ (K/√a)",
                (Curve("$x_2 = 0$", x[front], stress[free][front], exact, dense[near]),),
                over_resolutions=True,
            )
        )
    # Mode I opens the crack, mode II slides its faces: the component that is not small.
    i = 1 if problem.KI else 0
    behind = -dense[dense < 1.0 - adapters.LAYER_CELLS / n]
    exact = problem.scale * problem.displacement(behind, row[: len(behind)])[:, i]
    plots.append(
        LinePlot(
            f"Displacement $u_{i + 1}$ along the crack's upper face (Fig. 9)",
            "$x_1/a$",
            f"$u_{i + 1}$ (K√a/C)",
            (Curve("upper face", x[face], computed[free, i][face], exact, behind),),
            over_resolutions=True,
        )
    )
    return tuple(plots)
