"""Stored references in which one field changes another: see `generators`."""

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from references.analytic.piezoresistive import strained_conductivity
from references.fem.elasticity import solve_elasticity
from references.fem.leads import Lead, LeadSolution, plate_between_leads
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


def cracked_leads(
    width: float,
    resistivities: list[float],
    degrees: list[float],
    tips: list[int],
    lead: list[int],
    probe: list[int],
    elements: int,
) -> Generated:
    """Drop of the compact specimen between leads, slits along its middle: V for 1 A per m.

    The specimen is 1.25 × 1.2 `width`, lengths are in units of width/40 from its middle: the tips
    of slits that open at the left edge, and (left, bottom, side) of the upper lead and probe, which
    the lower ones mirror. Row by row of `degrees`, the turn of the first resistivity from the slit:
    ``mouth`` between the probes, ``leads`` between the leads themselves. The r^(1/2) of a tip makes
    uniform elements first order: what two meshes leave is taken off.
    """
    unit, meshes = width / 40, []

    def square(place: list[int], upper: bool) -> tuple[float, float, float, float]:
        x, y, side = place
        low = y if upper else -y - side
        return x * unit, low * unit, (x + side) * unit, (low + side) * unit

    def mean(plate: LeadSolution, place: list[int], upper: bool) -> float:
        x0, y0, x1, y1 = square(place, upper)
        share = (np.arange(12) + 0.5) / 12
        x, y = np.meshgrid(x0 + share * (x1 - x0), y0 + share * (y1 - y0))
        return float(plate.at(np.column_stack([x.ravel(), y.ravel()])).mean())

    found = []
    for count in (elements, 2 * elements):
        values = np.empty((len(degrees), len(tips), 2))
        for i, degree in enumerate(degrees):
            tensor = _turned(resistivities, np.radians(degree))
            for k, tip in enumerate(tips):
                plate = plate_between_leads(
                    1.25 * width, 1.2 * width, unit / count, tensor,
                    [Lead(*square(lead, True), current=1.0),
                     Lead(*square(lead, False), current=-1.0)],
                    ((-0.625 * width, 0.0), (tip * unit, 0.0)),
                )  # fmt: skip
                values[i, k] = [mean(plate, p, True) - mean(plate, p, False) for p in (probe, lead)]
        meshes.append(plate.mesh)
        found.append(values)
    coarse, fine = found
    limit = 2 * fine - coarse
    error = float(np.abs((fine - coarse) / limit).max()) / elements
    lengths = (np.array(tips) + 15.0) / 40.0
    return Generated(
        {"degrees": np.array(degrees), "ratios": np.tile(lengths, (len(degrees), 1)),
         "mouth": limit[:, :, 0], "leads": limit[:, :, 1]},
        {"degrees": 0.0, "ratios": 0.0, "mouth": error, "leads": error},
        tuple(meshes),
        2,
    )  # fmt: skip
