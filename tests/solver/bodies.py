"""Small bodies, random tensors and a dense stiffness written from the energy, for these tests."""

from collections.abc import Callable

import numpy as np
import shapely
from hypothesis import settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from solver import Crack, Family, Region
from solver.geometry import Lattice
from solver.material import ConductiveModuli, ElasticModuli, Moduli, PolarModuli

Array = NDArray[np.float64]

exact = settings(derandomize=True, deadline=None, max_examples=25)
few = settings(derandomize=True, deadline=None, max_examples=8)

entry = st.floats(-1.0, 1.0, allow_nan=False, width=32)

# Eq. 168 of the paper, and its fully anisotropic solid (C, 4C/5, C/5, C/3, C/10, C/6).
DISC = np.array([[5.0, 2.0], [2.0, 1.0]])
FIG_7 = np.array([[1, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])


@st.composite
def voigts(draw: st.DrawFn, floor: float = 0.1) -> Array:
    """Positive definite stiffness of any symmetry, of the order of one."""
    a = np.array([[draw(entry) for _ in range(3)] for _ in range(3)])
    return a @ a.T + floor * np.eye(3)


@st.composite
def conductivities(draw: st.DrawFn, floor: float = 0.1) -> Array:
    """Positive definite conductivity of the order of one."""
    a = np.array([[draw(entry) for _ in range(2)] for _ in range(2)])
    return a @ a.T + floor * np.eye(2)


class Cells(Region):
    """The cells of a boolean array (rows from below), its corner at the origin."""

    def __init__(self, mask: NDArray[np.bool_], spacing: float = 1.0) -> None:
        self.mask, self.spacing = np.asarray(mask, dtype=bool), spacing
        rows, columns = np.nonzero(self.mask)
        boxes = shapely.box(columns, rows, columns + 1, rows + 1)
        self.shape = shapely.transform(shapely.union_all(boxes), lambda xy: xy * spacing)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        rows, columns = self.mask.shape
        return 0.0, 0.0, columns * self.spacing, rows * self.spacing

    def contains(self, x: Array, y: Array) -> NDArray[np.bool_]:
        i = np.floor(np.asarray(x) / self.spacing).astype(int)
        j = np.floor(np.asarray(y) / self.spacing).astype(int)
        rows, columns = self.mask.shape
        inside = (i >= 0) & (i < columns) & (j >= 0) & (j < rows)
        return inside & self.mask[np.clip(j, 0, rows - 1), np.clip(i, 0, columns - 1)]

    def edge_distance(self, x: Array, y: Array) -> Array:
        return shapely.distance(self.shape.boundary, shapely.points(x, y))

    def outline(self, step: float) -> shapely.Geometry:
        return self.shape


class Sites(Cells):
    """Cells whose edges nobody knows: particles join wherever the family says."""

    def outline(self, step: float) -> shapely.Geometry:
        return Region.outline(self, step)


def block(columns: int, rows: int, spacing: float = 1.0) -> Cells:
    """A rectangle of cells."""
    return Cells(np.ones((rows, columns), dtype=bool), spacing)


@st.composite
def masks(draw: st.DrawFn, rows: int = 6, columns: int = 7) -> NDArray[np.bool_]:
    """A random body, holes and loose particles included."""
    bits = draw(st.lists(st.booleans(), min_size=rows * columns, max_size=rows * columns))
    mask = np.array(bits).reshape(rows, columns)
    mask[0, 0] = True
    return mask


def mirrored(half: Array) -> Array:
    """Values of a whole family from those of half its bonds."""
    return np.concatenate([half, half])


def random_moduli(family: Family, kind: str, seed: int) -> Moduli:
    """Any bond moduli, of both signs: the operator does not ask whether they make sense."""
    rng = np.random.default_rng(seed)
    half = family.size // 2
    normal = mirrored(rng.uniform(-1, 2, half))
    if kind == "conductive":
        return ConductiveModuli(normal)
    shear = np.zeros(family.size) if kind == "central" else mirrored(rng.uniform(-1, 1, half))
    if kind == "polar":
        bending = family.spacing**2 * mirrored(rng.uniform(-1, 2, half))
        return PolarModuli(normal, shear, bending)
    return ElasticModuli(normal, shear)


def dense_stiffness(
    lattice: Lattice,
    family: Family,
    moduli: Moduli,
    factor: Callable[[int, int], float] = lambda p, q: 1.0,
) -> Array:
    """Hessian of the energy over the cell, one unordered pair after another.

    ½ |ξ| (k_n s² + k_t γ²) α Λ Δv² for an elastic pair (and k_b χ² of a polar solid's) and
    ½ k g² α Λ Δv² for a conducting one, rotations as θ Δx; `factor` scales single pairs.
    """
    conductive = isinstance(moduli, ConductiveModuli)
    components = 1 if conductive else 3 if moduli.has_shear else 2
    dx, count = family.spacing, lattice.count
    index = {(int(i), int(j)): o for o, (i, j) in enumerate(family.offsets)}
    rows, columns = lattice.rows_columns
    matrix = np.zeros((components * count, components * count))
    for p in range(count):
        for q in range(p + 1, count):
            i, j = int(columns[q] - columns[p]), int(rows[q] - rows[p])
            if (i, j) not in index:
                continue
            o = index[i, j]
            xi = dx * np.hypot(i, j)
            n = np.array([i, j]) * dx / xi
            t = np.array([-n[1], n[0]])
            weight = family.fraction[o] * float(family.influence(np.array(xi / family.horizon)))
            weight *= dx**2 * factor(p, q)

            def row(on_p: list[float], on_q: list[float], p: int = p, q: int = q) -> Array:
                out = np.zeros((components, count))
                out[: len(on_p), p] = on_p
                out[: len(on_q), q] = on_q
                return out.ravel()

            if conductive:
                g = row([-1 / xi], [1 / xi])
                matrix += weight * moduli.conductivity[o] * np.outer(g, g)
                continue
            s = row(list(-n / xi), list(n / xi))
            gamma = row(list(-t / xi), list(t / xi))
            if components == 3:
                gamma[[2 * count + p, 2 * count + q]] = -0.5 / dx
            matrix += weight * xi * moduli.normal[o] * np.outer(s, s)
            matrix += weight * xi * moduli.shear[o] * np.outer(gamma, gamma)
            if isinstance(moduli, PolarModuli):
                chi = row([0, 0, -1 / (xi * dx)], [0, 0, 1 / (xi * dx)])
                matrix += weight * xi * moduli.bending[o] * np.outer(chi, chi)
    return matrix


def cut_by(lattice: Lattice, crack: Crack) -> Callable[[int, int], float]:
    """Factor of a pair that a straight crack may cut, from signs of areas alone.

    A bond is cut if its ends lie on opposite sides (the line itself counts as left) and the
    crack's ends lie strictly on opposite sides of the bond: through the very tip it stays.
    """
    (start, end) = (np.array(point) for point in crack.points)

    def area(a: Array, b: Array, c: Array) -> float:
        return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))

    def factor(p: int, q: int) -> float:
        a, b = lattice.points[p], lattice.points[q]
        sides = (area(start, end, a) >= 0) != (area(start, end, b) >= 0)
        ends = area(a, b, start) * area(a, b, end) < 0
        return 0.0 if sides and ends else 1.0

    return factor


def rotate_4(voigt: Array, angle: float) -> Array:
    """The tensor of a solid turned anticlockwise, index by index."""
    c, s = np.cos(angle), np.sin(angle)
    q = np.array([[c, -s], [s, c]])
    index = [(0, 0), (1, 1), (0, 1)]
    full = np.zeros((2, 2, 2, 2))
    for a, (i, j) in enumerate(index):
        for b, (k, m) in enumerate(index):
            full[i, j, k, m] = full[j, i, k, m] = voigt[a, b]
            full[i, j, m, k] = full[j, i, m, k] = voigt[a, b]
    turned = np.einsum("ai,bj,ck,dl,ijkl->abcd", q, q, q, q, full)
    return np.array([[turned[(*a, *b)] for b in index] for a in index])
