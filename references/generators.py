"""How the stored references are made: each function returns arrays and their estimated errors."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from references.analytic.lekhnitskii import crack_tip_displacement, energy_release_rate
from references.analytic.toughness import effective_energy, two_lobe_constants
from references.analytic.voigt import isotropic_voigt, turned_axes
from references.fem.conduction import steady_conduction
from references.fem.cracked_plates import centre_crack, compact_tension, edge_crack
from references.fem.elasticity import solve_elasticity
from references.fem.energy_path import energy_path
from references.fem.heterogeneous import heterogeneous_frequencies, interface_record
from references.fem.kinks import kink_matrix, kink_mesh
from references.fem.mesh import Mesh, Segment, crack_tip_disc, disc, rectangle
from references.fem.mesh_record import MeshRecord
from references.fem.modes import in_plane_modes
from references.fem.pinned import pulled_by_pins
from references.lattice.blocks import BlockLattice, TetrachiralCell, cell_voigt, paper_cell
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


def _homogenised(
    cell: TetrachiralCell, pitches: int, count: int, free: bool, meshes: list[Mesh | MeshRecord]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies of the homogenised square, 40 and 20 elements along its side."""
    side = pitches * cell.pitch
    found = []
    for elements in (40, 20):
        mesh = rectangle(side, side, side / elements)
        meshes.append(mesh)
        clamped = () if free else mesh.outer
        modes = in_plane_modes(mesh, cell_voigt(cell), cell.effective_density, count, clamped)
        found.append(modes.frequencies)
    return found[0], found[1]


def _lattice(
    lattice: BlockLattice, count: int, held: NDArray[np.bool_] | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies of the blocks, twice: the lattice is exact, what errs is the eigensolver.

    The second time it is the sparse one with another shift, also for small lattices.
    """
    return lattice.frequencies(count, held), lattice.frequencies(
        count, held, shift=1e-5, dense=False
    )


def _self_converged(
    axis: Sequence[int], pairs: Mapping[str, Sequence[tuple[NDArray, NDArray]]]
) -> tuple[dict[str, NDArray], dict[str, float]]:
    """Arrays and errors of rows that were computed twice, fine and coarse, in each column."""
    arrays, errors = {"cells": np.array(axis)}, {"cells": 0.0}
    for name, rows in pairs.items():
        fine, coarse = (np.array(side) for side in zip(*rows, strict=True))
        arrays[name] = fine
        errors[name] = max(_difference(fine, coarse), float(np.finfo(float).eps))
    return arrays, errors


def tetrachiral_free(cells: Sequence[int], count: int) -> Generated:
    """Free frequencies of square block lattices: spring beds, meshed interfaces, homogenised."""
    cell = paper_cell()
    pairs: dict[str, list[tuple[NDArray, NDArray]]] = {
        "lattice": [], "heterogeneous": [], "homogenised": []
    }  # fmt: skip
    meshes: list[Mesh | MeshRecord] = [interface_record(cell, across) for across in (8, 6)]
    for n in cells:
        lattice = BlockLattice(cell, n, n)
        pairs["lattice"].append(_lattice(lattice, count))
        fine, coarse = (heterogeneous_frequencies(lattice, count, across=k) for k in (8, 6))
        pairs["heterogeneous"].append((fine, coarse))
        pairs["homogenised"].append(_homogenised(cell, n, count, True, meshes))
    return Generated(*_self_converged(cells, pairs), tuple(meshes), order=2)


def tetrachiral_clamped(cells: Sequence[int], count: int) -> Generated:
    """Outer ring of blocks held, against the continuum clamped at (n − 1) ℓ and at n ℓ."""
    cell = paper_cell()
    pairs: dict[str, list[tuple[NDArray, NDArray]]] = {
        "lattice": [], "continuum_n_minus_1": [], "continuum_n": []
    }  # fmt: skip
    meshes: list[Mesh | MeshRecord] = []
    for n in cells:
        lattice = BlockLattice(cell, n, n)
        pairs["lattice"].append(_lattice(lattice, count, lattice.ring))
        for name, pitches in (("continuum_n_minus_1", n - 1), ("continuum_n", n)):
            pairs[name].append(_homogenised(cell, pitches, count, False, meshes))
    return Generated(*_self_converged(cells, pairs), tuple(meshes), order=2)


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

    The error of F goes with the kink's length ε, so that 2 F(ε) − F(2 ε) is stored. It also
    amplifies the meshes' own errors; the estimate is therefore made of extrapolated values, at
    four angles from end to end of the table at most: their change with a coarser mesh, plus their
    change from (ε, 2 ε) to (2 ε, 4 ε). Straight ahead F is the identity, which is what counts
    there.
    """
    voigt, lengths, angles = MATERIALS[material], (2e-4, 4e-4, 8e-4), np.radians(degrees)
    meshes: list[Mesh] = []

    def factors(angle: float, length: float, growth: float = 0.15) -> NDArray[np.float64]:
        mesh = kink_mesh(angle, length, growth)
        meshes.append(mesh)
        return kink_matrix(voigt, angle, length, mesh=mesh)

    straight = np.abs(angles) < 1e-9
    kinked = np.flatnonzero(~straight)
    sampled = kinked[np.unique(np.linspace(0, len(kinked) - 1, 4).round().astype(int))]
    found, errors = [], []
    for i, angle in enumerate(angles.tolist()):
        short = factors(angle, lengths[0])
        if straight[i]:
            found.append(short)
            errors.append(float(np.abs(short - np.eye(2)).max()))
            continue
        twice = factors(angle, lengths[1])
        extrapolated = 2 * short - twice
        found.append(extrapolated)
        if i in sampled:
            longer = 2 * twice - factors(angle, lengths[2])
            coarse = 2 * factors(angle, lengths[0], 0.25) - factors(angle, lengths[1], 0.25)
            errors.append(
                float(np.abs(extrapolated - coarse).max() + np.abs(extrapolated - longer).max())
            )
    matrices = np.array(found)
    return Generated(
        {"degrees": np.array(degrees, dtype=float), "matrices": matrices},
        {"degrees": 0.0, "matrices": max(errors) / float(np.abs(matrices).max())},
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


def notched_plate(unit: float, young: float, poisson: float, size: float) -> Generated:
    """Stiffness of the notched plate with a hole (Fig. 21), N/m² per unit thickness.

    Row by row: rims that do not turn, the upper one free to slide; rigid pins that turn and do not
    slide (both would leave the plate free to swing about the lower pin).
    """
    voigt = isotropic_voigt(young, poisson)
    centres = ((-2.5 * unit, -8 * unit), (-2.5 * unit, 8 * unit))
    holes = [(*centres[0], unit), (*centres[1], unit), (0.8 * unit, -1.8 * unit, 2 * unit)]
    crack = ((-6.5 * unit, unit), (-4.5 * unit, unit))
    meshes, found = [], []
    for h in (size, 2 * size):
        mesh = rectangle(
            13 * unit, 24 * unit, 8 * h * unit, holes, [crack], 0.1 * h * unit, h * unit, 0.3
        )
        meshes.append(mesh)
        found.append(
            [
                pulled_by_pins(mesh, voigt, centres, turning, not turning).stiffness
                for turning in (False, True)
            ]
        )
    fine, coarse = np.array(found)
    return Generated(
        {"turning": np.array([0.0, 1.0]), "stiffness": fine},
        {"turning": 0.0, "stiffness": _difference(fine, coarse) / 3},
        tuple(meshes),
        2,
    )


def _specimen(
    width: float, ratio: float, count: int, tip_size: float, grown: Sequence[Segment] = ()
) -> tuple[Mesh, tuple[tuple[float, float], tuple[float, float]]]:
    """A compact-tension mesh with `count` elements a side, and the centres of its pins."""
    shift, radius, offset = -0.375 * width, 0.125 * width, 0.275 * width
    centres = ((shift, -offset), (shift, offset))
    mesh = rectangle(
        1.25 * width, 1.2 * width, 1.25 * width / count,
        holes=[(*centre, radius) for centre in centres],
        cracks=[((-0.625 * width, 0.0), (ratio * width + shift, 0.0)), *grown],
        tip_size=tip_size,
        hole_size=2 * radius / count,
    )  # fmt: skip
    return mesh, centres


def _specimen_by_pins(
    material: str,
    degrees: Sequence[float],
    width: float,
    ratio: float,
    count: int,
) -> tuple[Mesh, NDArray[np.float64]]:
    """A mesh with `count` elements a side, and force, K_I, K_II for each turn of the material."""
    mesh, centres = _specimen(width, ratio, count, ratio * width / (100 * count))
    tip = (ratio * width - 0.375 * width, 0.0)
    rows = []
    for angle in degrees:
        voigt = turned_axes(1e9 * MATERIALS[material], -np.radians(angle))
        pulled = pulled_by_pins(mesh, voigt, centres, sliding=False)
        rows.append([pulled.stiffness, *pulled.intensities(tip, 0.0, 0.15 * width)])
    return mesh, np.array(rows)


def compact_tension_by_pins(
    material: str, degrees: Sequence[float], width: float, ratio: float, elements: int
) -> Generated:
    """Compact-tension specimen between rigid pins that turn, with the material's axis turned.

    Pins do not slide: the specimen could swing.

    Per unit displacement of the upper pin and unit thickness: force (N/m²), K_I, K_II (Pa/√m).
    """
    meshes, found = [], []
    for count in (elements, elements // 2):
        mesh, rows = _specimen_by_pins(material, degrees, width, ratio, count)
        meshes.append(mesh)
        found.append(rows)
    fine, coarse = found
    names = ("stiffness", "KI", "KII")
    scale = np.abs(fine).max(axis=0)
    scale[2] = scale[1]
    error = np.abs(fine - coarse).max(axis=0) / scale / 3
    return Generated(
        {"degrees": np.array(degrees, dtype=float)} | dict(zip(names, fine.T, strict=True)),
        {"degrees": 0.0} | dict(zip(names, error.tolist(), strict=True)),
        tuple(meshes),
        2,
    )


def compact_tension_growth(
    material: str, width: float, ratios: Sequence[float], elements: int
) -> Generated:
    """The specimen of `compact_tension_by_pins` with straight cracks of several lengths a/W.

    Per unit displacement of the upper pin and unit thickness: force (N/m²) and K_I (Pa/√m).
    """
    meshes, found = [], []
    for count in (elements, elements // 2):
        rows = []
        for ratio in ratios:
            mesh, values = _specimen_by_pins(material, [0.0], width, ratio, count)
            rows.append(values[0, :2])
            meshes.append(mesh)
        found.append(np.array(rows))
    fine, coarse = found
    error = np.abs(fine / coarse - 1).max(axis=0) / 3
    names = ("stiffness", "KI")
    return Generated(
        {"ratio": np.array(ratios, dtype=float)} | dict(zip(names, fine.T, strict=True)),
        {"ratio": 0.0} | dict(zip(names, error.tolist(), strict=True)),
        tuple(meshes),
        2,
    )


def compact_tension_paths(
    material: str,
    degrees: Sequence[float],
    width: float,
    ratio: float,
    energies: Sequence[float],
    exponent: int,
    step: float,
    steps: int,
    elements: int,
) -> Generated:
    """Paths in the specimen of `compact_tension_by_pins` by `references.fem.energy_path`.

    Parameters
    ----------
    energies : pair of float
        Fracture energies of cuts across and along the fibres, J/m²; `exponent` is that of Eq. 93.

    Returns
    -------
    Generated
        ``path`` (degrees, steps + 1, 2), m from the crack's old tip, ``directions`` (degrees,
        steps), rad, and ``release`` of the first, G over the fracture energy for a unit
        displacement (1/m²). Errors: against half as many elements; the steps' length is not in
        them.
    """
    found = []
    # With the whole path, of each fineness and turn.
    drawn: dict[tuple[int, float], Mesh] = {}
    w1, w2 = two_lobe_constants(energies[0], energies[1], exponent, 1.0)
    tip = (ratio * width - 0.375 * width, 0.0)

    def critical(psi: NDArray[np.float64]) -> NDArray[np.float64]:
        return w2 + (w1 - w2) * np.cos(psi) ** exponent

    for count in (elements, elements // 2):
        rows = []
        for angle in np.radians(degrees):
            voigt = turned_axes(1e9 * MATERIALS[material], -angle)

            def release(  # type: ignore[no-untyped-def]
                points: NDArray[np.float64], voigt=voigt, count=count, angle=angle
            ) -> float:
                ends = [(float(x), float(y)) for x, y in points]
                mesh, centres = _specimen(width, ratio, count, step / count, list(pairwise(ends)))
                drawn[count, float(angle)] = mesh
                pulled = pulled_by_pins(mesh, voigt, centres, sliding=False)
                last = points[-1] - points[-2]
                way = float(np.arctan2(last[1], last[0]))
                KI, KII = pulled.intensities(ends[-1], way, 0.6 * step)
                return energy_release_rate(voigt, KI, KII, way)

            def cost(way: float, angle=angle) -> float:  # type: ignore[no-untyped-def]
                return float(effective_energy(critical, angle - way - np.pi / 2, 1.0)[0])

            # Between straight ahead and beyond the fibres.
            tried = [float(angle) * share for share in (0.5, 0.75, 1.0)]
            rows.append(energy_path(tip, release, cost, step, steps, tried))
        found.append(rows)
    names = ("path", "directions", "release")
    fine, coarse = (
        dict(
            zip(
                names,
                (
                    np.stack([p.points - tip for p in rows]),
                    np.stack([p.directions for p in rows]),
                    np.stack([p.ratios[0] for p in rows]),
                ),
                strict=True,
            )
        )
        for rows in found
    )
    # Quadratic elements: G and what follows from it converge with the square of their size.
    errors = {
        n: float(np.abs(fine[n] - coarse[n]).max() / np.abs(fine[n]).max()) / 3 for n in names
    }
    return Generated(
        {"degrees": np.array(degrees, dtype=float)} | fine,
        {"degrees": 0.0} | errors,
        tuple(drawn.values()),
        2,
    )
