"""Stored references in which one field changes another: see `generators`."""

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from references.analytic.piezoresistive import strained_conductivity
from references.fem.elasticity import solve_elasticity
from references.fem.mesh import rectangle
from references.fem.piezoresistive import strained_conduction
from references.generators import MATERIALS
from references.provenance import Generated


def _turned(resistivities: Sequence[float], angle: float) -> NDArray[np.float64]:
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    return turn @ np.diag(1.0 / np.asarray(resistivities)) @ turn.T


def _strained(
    tensor: NDArray[np.float64],
    scale: float,
    gauge: float,
    exponent: int,
    resistive: bool,
    actual: bool,
    strain: NDArray[np.float64],
) -> NDArray[np.float64]:
    return strained_conductivity(tensor, scale * strain, gauge, exponent, resistive, actual)


def strained_plate(
    material: str,
    resistivities: list[float],
    angle: float,
    exponent: int,
    gauge: float,
    resistive: bool,
    actual: bool,
    degrees: list[float],
    probe: float,
    size: float,
) -> Generated:
    """Square plate, 4 wide, with a hole of unit radius under a unit tension along axis 1.

    A unit current runs along 0 and 90 degrees from edge to edge; the potential between probes at
    ± `probe` on the middle line along it, and its relative change per unit of tension.
    """
    tension = 2e-3
    voigt = MATERIALS[material] / MATERIALS[material][0, 0]
    tensor = _turned(resistivities, angle)
    meshes = tuple(
        rectangle(4.0, 4.0, 8 * h, [(0, 0, 1)], hole_size=h, growth=6 * h) for h in (size, 2 * size)
    )
    found = []
    for mesh in meshes:
        pulled = solve_elasticity(
            mesh, voigt, tractions={"left": (-tension, 0), "right": (tension, 0)}
        )
        rows = []
        for degree in degrees:
            along = degree == 0.0
            names = ("left", "right") if along else ("bottom", "top")
            probes = np.array([[probe, 0.0], [-probe, 0.0]])[:, :: 1 if along else -1]
            drops = []
            for scale in (0.0, 1.0):
                law = partial(_strained, tensor, scale, gauge, exponent, resistive, actual)
                flow = {names[0]: 1.0, names[1]: -1.0}
                up, down = strained_conduction(pulled, law, flow).at(probes)
                drops.append(down - up)
            rows.append((drops[0], (drops[1] / drops[0] - 1.0) / tension))
        found.append(np.array(rows))
    fine, coarse = found
    error = np.abs(fine - coarse).max(axis=0) / np.abs(fine).max(axis=0)
    return Generated(
        {"degrees": np.array(degrees), "drop": fine[:, 0], "change": fine[:, 1]},
        {"degrees": 0.0, "drop": float(error[0]), "change": float(error[1])},
        meshes,
        2,
    )
