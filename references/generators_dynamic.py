"""Stored references of what moves or changes in time: see `generators`."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from references.analytic.lamb import edge_displacement, ricker
from references.analytic.voigt import isotropic_voigt, turned_axes
from references.fem.mesh import Mesh, rectangle
from references.fem.modes import in_plane_modes
from references.fem.transient import transient_conduction
from references.provenance import Generated

#: Features of a plate: what its mesh has, and what is stored for it.
FEATURES = ("", "hole", "crack")


def plate_stiffness(plate: Mapping[str, Any]) -> NDArray[np.float64]:
    """Plane stress: ``nu`` of an isotropic solid of E = 1, or ``lamina`` and ``degrees``.

    A lamina is (E1, E2, G12, ν12), turned anticlockwise.
    """
    if "nu" in plate:
        return isotropic_voigt(1.0, plate["nu"])
    e1, e2, g12, nu12 = plate["lamina"]
    compliance = np.array([[1 / e1, -nu12 / e1, 0], [-nu12 / e1, 1 / e2, 0], [0, 0, 1 / g12]])
    return turned_axes(np.linalg.inv(compliance), -np.radians(plate["degrees"]))


def plate_mesh(feature: str, elements: int, hole: float, crack: float) -> Mesh:
    """A unit square; a hole of radius `hole` or a crack of length `crack` in its middle."""
    if feature == "hole":
        holes = [(0.0, 0.0, hole)]
        return rectangle(1.0, 1.0, 1 / elements, holes, hole_size=0.2 / elements)
    if feature == "crack":
        cracks = [((-crack / 2, 0.0), (crack / 2, 0.0))]
        return rectangle(1.0, 1.0, 1 / elements, cracks=cracks, tip_size=0.1 / elements**2)
    return rectangle(1.0, 1.0, 1 / elements)


def free_plates(
    numbers: Sequence[int],
    plates: Sequence[Mapping[str, Any]],
    count: int,
    hole: float,
    crack: float,
    elements: int,
) -> Generated:
    """Frequencies of free unit squares of unit density (`plate_stiffness`, `plate_mesh`).

    `numbers` chooses among the plates. ``feature`` is the place in `FEATURES`.
    """
    meshes: dict[tuple[str, int], Mesh] = {}
    tensors, features, pairs = [], [], []
    for number in numbers:
        plate = plates[number]
        feature, voigt = plate.get("feature", ""), plate_stiffness(plate)
        rows = []
        for fineness in (elements, elements // 2):
            key = feature, fineness
            if key not in meshes:
                meshes[key] = plate_mesh(*key, hole, crack)
            rows.append(in_plane_modes(meshes[key], voigt, 1.0, count).frequencies)
        tensors.append(voigt)
        features.append(FEATURES.index(feature))
        pairs.append(rows)
    fine, coarse = np.moveaxis(np.array(pairs), 1, 0)
    # Second order in a frequency at the least (a hole drawn by chords): a third is left.
    error = float(np.abs(fine / coarse - 1.0).max()) / 3
    return Generated(
        {
            "numbers": np.array(numbers),
            "voigt": np.array(tensors),
            "feature": np.array(features),
            "frequencies": fine,
        },
        {"numbers": 0.0, "voigt": 0.0, "feature": 0.0, "frequencies": error},
        tuple(meshes.values()),
        2,
    )


def _warm(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Warm above, cold below, no gradient across the edges."""
    return np.asarray(0.5 + 0.5 * np.sin(np.pi * y))


def cracked_square_cools(
    conductivity: list[list[float]],
    capacity: float,
    tip: float,
    duration: float,
    grids: Sequence[int],
    size: float,
    steps: int,
) -> Generated:
    """An insulated unit square with a crack along y = 0 from its left edge to x = `tip`.

    It starts at 1/2 + sin(π y)/2; the temperature at the end is stored at the centres of the cells
    of square grids.
    """
    meshes, found = [], []
    for scale in (1, 2):
        mesh = rectangle(
            1.0, 1.0, scale * size, cracks=[((-0.5, 0.0), (tip, 0.0))], tip_size=size**2 * scale
        )
        meshes.append(mesh)
        found.append(
            transient_conduction(mesh, conductivity, capacity, _warm, duration, steps // scale)
        )
    arrays, errors = {}, {}
    for n in grids:
        line = (np.arange(n) + 0.5) / n - 0.5
        points = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
        fine, coarse = (run.at(points)[0] for run in found)
        arrays[f"grid_{n}"] = fine
        errors[f"grid_{n}"] = float(np.abs(fine - coarse).max() / np.abs(fine).max()) / 3
    return Generated(arrays, errors, tuple(meshes), 2)


def lamb_pulse(
    receivers: Sequence[float],
    poisson: float,
    half_width: float,
    frequency: float,
    delay: float,
    end: float,
    instants: int,
) -> Generated:
    """Displacement of a half-plane's edge under a strip of pressure, in Ricker's wavelet of time.

    Plane strain, μ = ρ = 1 and a pressure of one: lengths are shear wavelengths of the pulse's
    frequency if that is one. Twice, by two paths of integration in complex time.
    """
    pulse, times = ricker(frequency, delay), np.linspace(0.0, end, instants)
    lame = (2.0 * poisson / (1.0 - 2.0 * poisson), 1.0)
    high, low = (
        np.array(
            [
                edge_displacement(x, times, pulse, scale / frequency, lame, 1.0, half_width)
                for x in receivers
            ]
        )
        for scale in (0.3, 0.2)
    )
    error = float(np.abs(high - low).max() / np.abs(high).max())
    return Generated(
        {"receivers": np.array(receivers), "times": times[None].repeat(len(receivers), 0),
         "displacement": high},
        {"receivers": 0.0, "times": 0.0, "displacement": max(error, float(np.finfo(float).eps))},
    )  # fmt: skip
