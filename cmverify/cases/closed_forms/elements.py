"""Finite elements, on fields that they are exact for."""

from __future__ import annotations

import numpy as np

from cmverify.case import Array, Measurement
from cmverify.cases.closed_forms.differences import CONDUCTIVITY, TENSOR, around
from cmverify.judge.norms import relative_l2, worst


def elements(_: int) -> Measurement:
    """Finite elements on fields that they can be exact for: linear ones, under their tractions."""
    from references.fem.conduction import steady_conduction
    from references.fem.elasticity import solve_elasticity
    from references.fem.mesh import rectangle

    body = rectangle(2.0, 1.0, 0.4)
    s11, s22, s12 = stress = np.array([1.0, -0.4, 0.3])
    e11, e22, shear = np.linalg.solve(TENSOR, stress)
    sides = {"left": (-1, 0), "right": (1, 0), "bottom": (0, -1), "top": (0, 1)}
    tractions = {
        name: (s11 * n1 + s12 * n2, s12 * n1 + s22 * n2) for name, (n1, n2) in sides.items()
    }
    x, y = around(0.4, 12)
    points = np.column_stack([x, y])
    found = {"stress": 0.0, "strain": 0.0, "flux": 0.0, "temperature": 0.0}
    for order in (1, 2):
        loaded = solve_elasticity(body, TENSOR, tractions=tractions, order=order)
        du = loaded.gradient_at(points)
        strain = np.stack([du[:, 0, 0], du[:, 1, 1], du[:, 0, 1] + du[:, 1, 0]], axis=-1)
        # Rigid motions aside, displacements are their differences.
        u = loaded.at(points) - loaded.at(-points)
        w = 0.5 * (du[0, 1, 0] - du[0, 0, 1])
        slope = np.array([[e11, shear / 2 - w], [shear / 2 + w, e22]])
        heat = steady_conduction(body, CONDUCTIVITY, lambda x, y: x - 2 * y, order=order)
        flux = np.broadcast_to(-CONDUCTIVITY @ [1.0, -2.0], (len(x), 2))
        for name, error in (
            ("stress", relative_l2(loaded.stress_at(points), np.broadcast_to(stress, (12, 3)))),
            ("strain", relative_l2(strain, np.broadcast_to([e11, e22, shear], (12, 3)))),
            ("difference", relative_l2(u, 2 * points @ slope.T)),
            ("flux", relative_l2(heat.flux_at(points), flux)),
            ("temperature", relative_l2(heat.at(points), x - 2 * y)),
        ):
            found[name] = worst((found.get(name, 0.0), error))
    return Measurement(loaded.unknowns, found | in_time(points))


def in_time(points: Array) -> dict[str, float]:
    """Fields that grow with t² and t, linear in space: their steps are exact of those, too."""
    from references.fem.body import Acting, Body, of_solids
    from references.fem.in_time import warmed
    from references.fem.motion import moved
    from references.fem.polygons import polygons

    square = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    mesh = polygons([(square, [])], 0.5)
    body, heat = (Body(mesh, c, np.zeros(len(mesh.triangles), dtype=np.int64)) for c in (2, 1))
    slope, alpha, density, capacity = np.array([[0.3, -0.1], [0.2, 0.5]]), 0.4, 1.5, 2.0
    moving = moved(
        body,
        body.stiffness(of_solids(TENSOR[None])),
        body.mass([density]),
        (alpha, 0.1),
        (np.zeros(body.basis.N), np.zeros(body.basis.N)),
        lambda t: body.held(lambda n, e: np.where(e[:, None], t**2 * n @ slope.T, np.nan)),
        lambda t: body.load(
            Acting(
                volume=[lambda x, y: density * (2 + 2 * alpha * t) * np.tensordot(slope, [x, y], 1)]
            )
        ),
        [0.2],
        0.1,
    )
    warming = warmed(
        heat,
        of_solids(CONDUCTIVITY[None]),
        [capacity],
        np.zeros(heat.basis.N),
        lambda t: heat.held(lambda n, e: np.where(e, t * n @ [1.0, -2.0], np.nan)[:, None]),
        lambda t: heat.load(Acting(volume=[lambda x, y: capacity * (x - 2 * y)])),
        [0.2],
        steps=1,
    )
    return {
        "motion": relative_l2(moving[0][0].at(points), 0.04 * points @ slope.T),
        "heat in time": relative_l2(warming[0].at(points), 0.2 * points @ [1.0, -2.0]),
    }
