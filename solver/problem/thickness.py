"""Bodies whose thickness differs from place to place: grooves, bands, tapers.

All that the plane problem says per unit thickness is multiplied by the thickness there: the
stiffness of bonds, mass, heat capacity, loads in the body and on its edges, the energy that
breaking a bond takes. With the thickness in m, forces and energies are then N and J.

* A thickness that is a number, of the scene or of an inclusion, multiplies the moduli of that
  phase. Where it jumps, at an interface, the jump is exact (`solver.geometry.phases`).
* One that is a function is constant on each cell. A bond runs through several of them, and what
  it carries is the same in all: its thickness is the mean in series, 1/t = Σ share/t over the
  shares of its length. So a body that changes along its load is exact, step or not; where it
  changes across, the error is of first order in the horizon at a step, and of second where it is
  smooth. Steps belong to inclusions therefore.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from ..arrays import Array, Indices
from ..bonds import Bonds, Factors
from ..errors import SceneError
from ..geometry import Lattice
from ..geometry.edge_quadrature import Quadrature
from ..magnitude import LENGTHS, outside, require_positive
from .values import evaluate

# Share of a cell within an edge at which its thickness is asked.
_WITHIN = 1e-3


class Composite(Protocol):
    """What of a scene is asked here and by `inclusions`, which lie below it."""

    @property
    def spacing(self) -> float:
        """Δx, m."""

    @property
    def thickness(self) -> float | Callable[..., Any] | None:
        """Of the body, m."""

    @property
    def inclusions(self) -> Sequence[Any]:
        """Parts of other solids, `solver.problem.inclusions.Inclusion`."""

    @property
    def factors(self) -> Callable[..., Any] | None:
        """On single bonds."""


def check(scene: Composite) -> None:
    """Refuse what is no thickness.

    Raises
    ------
    SceneError
    """
    own = [inclusion.thickness for inclusion in scene.inclusions]
    for given in (scene.thickness, *own):
        if given is not None and not callable(given):
            require_positive(given, "the thickness", "m", LENGTHS)
    if callable(scene.thickness) and any(given is not None for given in own):
        raise SceneError(
            "give the thickness as a function of the scene, or as numbers of it and its inclusions"
        )
    if any(callable(given) for given in own):
        raise SceneError("the thickness of an inclusion is a number")
    if scene.factors is not None and callable(scene.thickness):
        raise SceneError("factors on single bonds are not known with a thickness that varies")


def varies(scene: Composite) -> bool:
    """Whether the scene says anything of a thickness."""
    return scene.thickness is not None or any(i.thickness is not None for i in scene.inclusions)


def of_phases(scene: Composite) -> Array:
    """Thickness of every phase as far as it is a number, shape (phases,); 1 where it is not."""
    own = 1.0 if scene.thickness is None or callable(scene.thickness) else scene.thickness
    each = [own if i.thickness is None else i.thickness for i in scene.inclusions]
    return np.array([own, *each], dtype=np.float64)


def at(scene: Composite, places: Array) -> Array:
    """Thickness at places of the body, (n, 2) in the user's coordinates; shape (n,)."""
    if callable(scene.thickness):
        found = evaluate(scene.thickness, places, 1, "the thickness")[:, 0]
        if not (found > 0).all():
            x, y = places[np.argmin(found)]
            raise SceneError(f"the thickness is {found.min():g} m at ({x:g}, {y:g})")
        for thick in (found.min(initial=1.0), found.max(initial=1.0)):
            if wrong := outside(float(thick), LENGTHS):
                raise SceneError(f"the thickness is {wrong}")
        return found
    each = of_phases(scene)
    found = np.full(len(places), each[0])
    for inclusion, thick in zip(scene.inclusions, each[1:], strict=True):
        found[inclusion.region.contains(*places.T)] = thick
    return found


def of_particles(scene: Composite, lattice: Lattice) -> Array:
    """Thickness of every particle's cell, shape (N,), remembered."""
    key = "thickness", id(scene.thickness)
    if key not in lattice.known:
        lattice.known[key] = scene, at(scene, lattice.places)
    found: Array = lattice.known[key][1]
    return found


def loaded(scene: Composite, rule: Quadrature) -> Quadrature:
    """What acts on edges, times their thickness."""
    if not varies(scene):
        return rule
    thick = at(scene, rule.places - _WITHIN * scene.spacing * rule.normals)
    return rule.carrying(rule.density * thick[:, None])


def factors(scene: Composite, lattice: Lattice, bonds: Bonds) -> Factors | None:
    """Thickness of every bond where it is a function, see above."""
    if not callable(scene.thickness):
        return None
    family, thick = bonds.family, of_particles(scene, lattice)
    flexible = _everywhere(lattice, 1.0 / thick)
    rows, columns = lattice.rows_columns
    whole = np.empty((family.size, lattice.count))
    half = family.size // 2
    for o, offset in enumerate(family.offsets):
        total = np.zeros(lattice.count)
        for (dx, dy), share in zip(*_shares(*map(int, offset)), strict=True):
            total += share * flexible[rows + dy, columns + dx]
        whole[o] = 1.0 / total
    # Sums the other way round differ by rounding.
    for o, (dx, dy) in enumerate(family.offsets[:half]):
        whole[o + half] = lattice.to_grid(whole[o])[rows - dy, columns - dx]
    whole[half:][whole[half:] == 0.0] = 1.0
    ended = bonds.ended
    if ended is None:
        return Factors(whole)
    found = np.ones(len(ended)) if ended.factor is None else ended.factor.copy()
    for o, offset in enumerate(family.offsets):
        mine = np.nonzero(ended.offset == o)[0]
        if not len(mine):
            continue
        cells, ends = _cells(*map(int, offset))
        part = np.clip(ended.length[mine] / family.length[o], 1e-9, 1.0)
        p = ended.particle[mine]
        total = np.zeros(len(mine))
        for (dx, dy), (a, b) in zip(cells, ends, strict=True):
            share = (np.minimum(b, part) - np.minimum(a, part)) / part
            total += share * flexible[rows[p] + dy, columns[p] + dx]
        found[mine] /= total
    near, outline = bonds.lattice.tree, ended.outline
    chords = None
    if ended.chords is not None:
        first, last = (
            outline.nodes[outline.edges[ended.chords.edge[:, k]]].mean(axis=1) for k in (0, 1)
        )
        chords = thick[near.query(0.5 * (first + last))[1]] if len(first) else np.zeros(0)
    middle = thick[near.query(outline.nodes[outline.edges].mean(axis=1))[1]]
    return Factors(whole, found, chords, np.repeat(middle[:, None], half, axis=1))


def _everywhere(lattice: Lattice, values: Array) -> Array:
    """Values of particles on the padded grid, empty cells with those of the nearest."""
    grid = np.zeros(lattice.shape)
    grid[lattice.mask] = values
    nearest = distance_transform_edt(~lattice.mask, return_distances=False, return_indices=True)
    return np.asarray(grid[tuple(nearest)])


@cache
def _cells(dx: int, dy: int) -> tuple[tuple[tuple[int, int], ...], tuple[tuple[float, float], ...]]:
    """Cells that a bond runs through from its first on, and where it enters and leaves each."""
    borders = [(k + 0.5) / abs(d) for d in (dx, dy) for k in range(abs(d))]
    marks = sorted({0.0, 1.0, *borders})
    cells, ends = [], []
    for a, b in pairwise(marks):
        if b - a > 1e-12:
            middle = 0.5 * (a + b)
            cells.append((round(middle * dx), round(middle * dy)))
            ends.append((a, b))
    return tuple(cells), tuple(ends)


def _shares(dx: int, dy: int) -> tuple[tuple[tuple[int, int], ...], NDArray[np.float64]]:
    """Cells that a bond runs through and the shares of its length in them."""
    cells, ends = _cells(dx, dy)
    return cells, np.array([b - a for a, b in ends])


def scaled(loads: Array, scene: Composite, lattice: Lattice, particles: Indices) -> Array:
    """Loads of some particles, (n, components), times their thickness."""
    if not varies(scene):
        return loads
    return np.asarray(loads * of_particles(scene, lattice)[particles, None])
