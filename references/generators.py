"""How the stored references are made: each function returns arrays and their estimated errors."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from references.analytic.lekhnitskii import crack_tip_displacement
from references.fem.conduction import steady_conduction
from references.fem.cracked_plates import centre_crack, compact_tension, edge_crack
from references.fem.elasticity import solve_elasticity
from references.fem.heterogeneous import heterogeneous_frequencies
from references.fem.kinks import kink_matrix, kink_mesh
from references.fem.mesh import Mesh, crack_tip_disc, disc, rectangle
from references.fem.modes import in_plane_frequencies, in_plane_modes
from references.lattice.blocks import BlockLattice, cell_voigt, paper_cell
from references.provenance import Generated

# Voigt stiffnesses, order 11, 22, 12.
MATERIALS: dict[str, NDArray[np.float64]] = {
    # plane stress, E = 1, ν = 0.3
    "isotropic": np.array([[1, 0.3, 0], [0.3, 1, 0], [0, 0, 0.35]]) / 0.91,
    # Eq. 106, GPa
    "silicon": np.array([[141.1, 39.3, 0], [39.3, 141.1, 0], [0, 0, 79.6]]),
    # Sect. 2.3.1 with C = 100 GPa (Eq. 107 prints it rounded)
    "anisotropic": 100
    * np.array([[1, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]]),
    # Eq. 108, cortical bone, GPa
    "bone": np.array([[25, 5.89, 0], [5.89, 16.25, 0], [0, 0, 6.65]]),
    # strongly orthotropic, GPa
    "carbon-epoxy": np.array([[140.0, 3, 0], [3, 10, 0], [0, 0, 5]]),
}


def _difference(fine: NDArray, coarse: NDArray) -> float:
    return float(np.abs(fine - coarse).max() / np.abs(fine).max())


def particles(spacing: float) -> NDArray[np.float64]:
    """Centres of the cells of the unit disc, half-integer multiples of the spacing."""
    half = int(np.ceil(1 / spacing))
    line = (np.arange(-half, half) + 0.5) * spacing
    x, y = np.meshgrid(line, line)
    grid = np.column_stack([x.ravel(), y.ravel()])
    return grid[np.hypot(*grid.T) <= 1]


def tetrachiral_free(cells: Sequence[int], count: int) -> Generated:
    """Free frequencies of square block lattices: spring beds, meshed interfaces, homogenised."""
    cell = paper_cell()
    voigt = cell_voigt(cell)
    found: dict[str, list[NDArray]] = {"lattice": [], "heterogeneous": [], "homogenised": []}
    coarse: dict[str, list[NDArray]] = {"heterogeneous": [], "homogenised": []}
    for n in cells:
        lattice, side = BlockLattice(cell, n, n), n * cell.pitch
        found["lattice"].append(lattice.frequencies(count))
        for into, across, elements in ((found, 8, 40), (coarse, 6, 20)):
            into["heterogeneous"].append(heterogeneous_frequencies(lattice, count, across=across))
            into["homogenised"].append(
                in_plane_frequencies(
                    voigt, side, side, cell.effective_density, count, elements=elements
                )
            )
    arrays = {name: np.array(rows) for name, rows in found.items()}
    errors = {name: _difference(arrays[name], np.array(rows)) for name, rows in coarse.items()}
    return Generated(
        {"cells": np.array(cells), **arrays}, {"cells": 0.0, "lattice": 1e-10, **errors}, order=2
    )


def tetrachiral_clamped(cells: Sequence[int], count: int) -> Generated:
    """Outer ring of blocks held, against the continuum clamped at (n − 1) ℓ and at n ℓ."""
    cell = paper_cell()
    voigt = cell_voigt(cell)
    rows: dict[str, list[NDArray]] = {"lattice": [], "continuum_n_minus_1": [], "continuum_n": []}
    coarse: list[NDArray] = []
    for n in cells:
        lattice = BlockLattice(cell, n, n)
        rows["lattice"].append(lattice.frequencies(count, lattice.ring))
        for into, side, elements in (
            (rows["continuum_n_minus_1"], n - 1, 40),
            (rows["continuum_n"], n, 40),
            (coarse, n, 20),
        ):
            length = side * cell.pitch
            into.append(
                in_plane_frequencies(
                    voigt, length, length, cell.effective_density, count, False, elements
                )
            )
    arrays = {"cells": np.array(cells), **{k: np.array(v) for k, v in rows.items()}}
    error = _difference(arrays["continuum_n"], np.array(coarse))
    errors = {"cells": 0.0, "lattice": 1e-10, "continuum_n_minus_1": error, "continuum_n": error}
    return Generated(arrays, errors, order=2)


def stress_intensity_table(
    geometry: str, ratios: Sequence[float], materials: Sequence[str], elements: int
) -> Generated:
    """K_I and K_II over their customary scale, for cracks along axis 1 and tension along axis 2.

    ``centre``: square plate 2 W × 2 W, half crack a, scale σ √(πa). ``edge``: plate W × 2 W,
    crack a, scale σ √(πa). ``compact``: ASTM E399 proportions, scale P / √W.
    """

    meshes: dict[str, Mesh] = {}

    def one(voigt: NDArray, ratio: float, fineness: int) -> list[float]:
        scale = np.sqrt(np.pi * ratio)
        if geometry == "centre":
            k = centre_crack(voigt, 2.0, 2.0, ratio, elements=fineness)
        elif geometry == "edge":
            k = edge_crack(voigt, 1.0, 2.0, ratio, elements=fineness)
        elif geometry == "compact":
            k, scale = compact_tension(voigt, 1.0, ratio, elements=fineness), 1.0
        else:
            raise ValueError(f"unknown geometry {geometry!r}: centre, edge or compact")
        meshes[k.mesh.sha256] = k.mesh
        return [k.KI / scale, k.KII / scale]

    arrays: dict[str, NDArray] = {"ratios": np.array(ratios)}
    errors = {"ratios": 0.0}
    for name in materials:
        fine, coarse = (
            np.array([one(MATERIALS[name], r, n) for r in ratios])
            for n in (elements, elements // 2)
        )
        # second order at least: half the mesh size leaves at most a third of the difference
        arrays[name], errors[name] = fine, _difference(fine, coarse) / 3
    return Generated(arrays, errors, tuple(meshes.values()), 2)


def kink_factors(material: str, degrees: Sequence[float]) -> Generated:
    """F(ω) of short kinks (see `references.fem.kinks`), extrapolated to vanishing length.

    The error goes with the kink's length: 2 F(ε) − F(2 ε).
    """
    voigt, meshes, found = MATERIALS[material], [], []
    for angle in np.radians(degrees):
        pair = [kink_mesh(angle, e) for e in (2e-4, 4e-4)]
        found.append([kink_matrix(voigt, angle, mesh=mesh) for mesh in pair])
        meshes += pair
    short, twice = np.moveaxis(np.array(found), 1, 0)
    straight = np.abs(np.array(degrees)) < 1e-9
    matrices = np.where(straight[:, None, None], short, 2 * short - twice)
    coarse = kink_matrix(voigt, np.radians(degrees[0]), 2e-4, growth=0.25)
    # of the mesh, and of the extrapolation
    error = max(_difference(short[0], coarse), 0.1 * _difference(short, twice))
    return Generated(
        {"degrees": np.array(degrees, dtype=float), "matrices": matrices},
        {"degrees": 0.0, "matrices": error},
        tuple(meshes),
        2,
    )


def crack_tip_samples(material: str, spacing: float, size: float) -> Generated:
    """Crack-tip disc by graded quadratic elements, sampled at the particles; C = 1."""
    voigt = MATERIALS[material] / 100
    points = particles(spacing)
    arrays, errors = {"points": points}, {"points": 0.0}
    meshes = [crack_tip_disc(h, tip_size=1e-2 * h**2, growth=3 * h) for h in (size, 2 * size)]
    for mode, name in (((1.0, 0.0), "mode_I"), ((0.0, 1.0), "mode_II")):

        def field(x, y, mode=mode):  # type: ignore[no-untyped-def]
            return crack_tip_displacement(voigt, x, y, *mode)

        fine, coarse = (solve_elasticity(mesh, voigt, field).at(points) for mesh in meshes)
        arrays[name], errors[name] = fine, _difference(fine, coarse) / 3
    return Generated(arrays, errors, tuple(meshes), 2)


def heated_disc_samples(spacing: float, size: float) -> Generated:
    """exp(x − 2y) cos y in the disc with D = [[5, 2], [2, 1]], sampled at the particles."""
    points = particles(spacing)
    meshes = (disc(size), disc(2 * size))

    def edge(x: NDArray, y: NDArray) -> NDArray:
        return np.exp(x - 2 * y) * np.cos(y)

    fine, coarse = (steady_conduction(m, [[5, 2], [2, 1]], edge).at(points) for m in meshes)
    return Generated(
        {"points": points, "temperature": fine},
        {"points": 0.0, "temperature": _difference(fine, coarse) / 7},
        meshes,
        2,
    )


def square_modes(material: str, count: int) -> Generated:
    """Free and clamped frequencies of a unit square of unit density, tensor over 100."""
    meshes = (rectangle(1, 1, 1 / 40), rectangle(1, 1, 1 / 20))
    voigt = MATERIALS[material] / 100
    arrays, errors = {}, {}
    for name, clamped in (("free", ()), ("clamped", meshes[0].outer)):
        fine, coarse = (in_plane_modes(m, voigt, 1.0, count, clamped).frequencies for m in meshes)
        arrays[name], errors[name] = fine, _difference(fine, coarse) / 3
    return Generated(arrays, errors, meshes, 2)


def pulled_plate_with_hole(material: str, half_width: float, size: float) -> Generated:
    """Square plate with a hole of unit radius, unit traction along axis 2.

    Displacement around the hole (rigid motion: mean displacement and rotation of the edge points
    removed) and stress along the net section y = 0.
    """
    voigt = MATERIALS[material] / 100
    degrees = np.arange(0, 360, 5.0)
    edge = np.column_stack([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    across = np.linspace(1.02, half_width - 0.02, 40)
    section = np.column_stack([across, np.zeros_like(across)])
    found = []
    meshes = tuple(
        rectangle(2 * half_width, 2 * half_width, 10 * h, [(0, 0, 1)], hole_size=h, growth=6 * h)
        for h in (size, 2 * size)
    )
    for mesh in meshes:
        s = solve_elasticity(mesh, voigt, tractions={"top": (0, 1), "bottom": (0, -1)})
        u = s.at(edge)
        u -= u.mean(axis=0)
        spin = np.sum(edge[:, 0] * u[:, 1] - edge[:, 1] * u[:, 0]) / len(edge)
        u -= spin * np.column_stack([-edge[:, 1], edge[:, 0]])
        found.append((u, s.stress_at(section)))
    (u, stress), (u_coarse, stress_coarse) = found
    return Generated(
        {"degrees": degrees, "edge_displacement": u, "section": across, "section_stress": stress},
        {
            "degrees": 0.0,
            "edge_displacement": _difference(u, u_coarse) / 3,
            "section": 0.0,
            "section_stress": _difference(stress, stress_coarse) / 3,
        },
        meshes,
        2,
    )
