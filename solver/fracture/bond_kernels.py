"""Numba kernels over single bonds: energies of all bonds of a body, bond by bond or summed.

Arrays and scalars in, arrays out. Bonds are counted once, by half offset o and particle of
origin p, and p's neighbour along o is `steps[o]` cells further on the flattened padded grid.
Segments are runs of neighbouring particles of one grid row, (first cell, length, first particle).
Every entry is written by one thread, so results do not depend on the number of threads.

Polar bonds, which store ½ |ξ| k_b χ² too, and bonds that temperatures strain have kernels of their
own: the others pay nothing for it. Only mechanical strain stores energy.
"""

from __future__ import annotations

from typing import Any

import numba as nb

from ..compiled import kernel
from ..material import strains
from ..material.strains import bent, sheared, stretched

_OPTIONS: Any = {"parallel": True, "fastmath": {"contract", "nsz"}, "nogil": True}


@kernel(uses=(strains.__file__,), **_OPTIONS)
def bond_energies(grid, segments, steps, geometry, factors, tension, out):
    """Weighted energy f (a s² + b γ²) of every bond, zero where tension is asked for and s < 0.

    Parameters
    ----------
    grid : float64 (3, cells)
        u1, u2 and the rotation times the spacing.
    segments : uint64 (s, 3)
    steps : uint64 (h,)
    geometry : float64 (h, 5)
        n1, n2, |ξ|/(2 Δx), a, b of each half offset. s and γ are not divided by |ξ|: that belongs
        into a and b.
    factors : float64 (h, N)
        0 for bonds that do not exist.
    tension : bool
    out : float64 (h, N)
    """
    ux, uy, th = grid[0], grid[1], grid[2]
    for s in nb.prange(segments.shape[0]):
        cell, size, first = segments[s, 0], segments[s, 1], segments[s, 2]
        for o in range(steps.size):
            nx, ny, half = geometry[o, 0], geometry[o, 1], geometry[o, 2]
            a, b = geometry[o, 3], geometry[o, 4]
            ahead = cell + steps[o]
            row, factor = out[o], factors[o]
            for j in range(size):
                dx, dy = ux[ahead + j] - ux[cell + j], uy[ahead + j] - uy[cell + j]
                axial = stretched(nx, ny, dx, dy)
                shear = sheared(nx, ny, dx, dy, half * (th[ahead + j] + th[cell + j]))
                value = factor[first + j] * (a * axial * axial + b * shear * shear)
                row[first + j] = 0.0 if tension and axial < 0.0 else value


@kernel(uses=(strains.__file__,), **_OPTIONS)
def bond_work(grid, other, segments, steps, geometry, factors, out):
    """Σ f (a s s' + b γ γ') over the bonds of each segment, for two fields.

    As `bond_energies`, with the second field `other` (3, cells) and `out` (s,).
    """
    ux, uy, th = grid[0], grid[1], grid[2]
    vx, vy, ph = other[0], other[1], other[2]
    for s in nb.prange(segments.shape[0]):
        cell, size, first = segments[s, 0], segments[s, 1], segments[s, 2]
        total = 0.0
        for o in range(steps.size):
            nx, ny, half = geometry[o, 0], geometry[o, 1], geometry[o, 2]
            a, b = geometry[o, 3], geometry[o, 4]
            ahead = cell + steps[o]
            factor = factors[o]
            for j in range(size):
                dx, dy = ux[ahead + j] - ux[cell + j], uy[ahead + j] - uy[cell + j]
                ex, ey = vx[ahead + j] - vx[cell + j], vy[ahead + j] - vy[cell + j]
                shear = sheared(nx, ny, dx, dy, half * (th[ahead + j] + th[cell + j]))
                sheer = sheared(nx, ny, ex, ey, half * (ph[ahead + j] + ph[cell + j]))
                axial = stretched(nx, ny, dx, dy) * stretched(nx, ny, ex, ey)
                total += factor[first + j] * (a * axial + b * shear * sheer)
        out[s] = total


@kernel(uses=(strains.__file__,), **_OPTIONS)
def rich_energies(grid, free, segments, steps, geometry, factors, tension, out):
    """As `bond_energies`, with c χ² and less the strains that cost nothing.

    Parameters
    ----------
    free : float64 (2, h, N), or (2, h, 0) without
        |ξ| times the stretch and the shear that a temperature causes by itself.
    geometry : float64 (h, 6)
        As there, and c.
    """
    ux, uy, th = grid[0], grid[1], grid[2]
    warm = free.shape[2] > 0
    for s in nb.prange(segments.shape[0]):
        cell, size, first = segments[s, 0], segments[s, 1], segments[s, 2]
        for o in range(steps.size):
            nx, ny, half = geometry[o, 0], geometry[o, 1], geometry[o, 2]
            a, b, c = geometry[o, 3], geometry[o, 4], geometry[o, 5]
            ahead = cell + steps[o]
            row, factor = out[o], factors[o]
            for j in range(size):
                dx, dy = ux[ahead + j] - ux[cell + j], uy[ahead + j] - uy[cell + j]
                axial = stretched(nx, ny, dx, dy)
                shear = sheared(nx, ny, dx, dy, half * (th[ahead + j] + th[cell + j]))
                if warm:
                    axial -= free[0, o, first + j]
                    shear -= free[1, o, first + j]
                bend = bent(th[ahead + j] - th[cell + j])
                value = a * axial * axial + b * shear * shear + c * bend * bend
                row[first + j] = 0.0 if tension and axial < 0.0 else factor[first + j] * value


@kernel(uses=(strains.__file__,), **_OPTIONS)
def rich_work(grid, free, other, more, segments, steps, geometry, factors, out):
    """As `bond_work`, with c χ χ' and less what costs nothing of both fields.

    `free` as for `rich_energies` belongs to the first field, `more` to the second.
    """
    ux, uy, th = grid[0], grid[1], grid[2]
    vx, vy, ph = other[0], other[1], other[2]
    warm, both = free.shape[2] > 0, more.shape[2] > 0
    for s in nb.prange(segments.shape[0]):
        cell, size, first = segments[s, 0], segments[s, 1], segments[s, 2]
        total = 0.0
        for o in range(steps.size):
            nx, ny, half = geometry[o, 0], geometry[o, 1], geometry[o, 2]
            a, b, c = geometry[o, 3], geometry[o, 4], geometry[o, 5]
            ahead = cell + steps[o]
            factor = factors[o]
            for j in range(size):
                dx, dy = ux[ahead + j] - ux[cell + j], uy[ahead + j] - uy[cell + j]
                ex, ey = vx[ahead + j] - vx[cell + j], vy[ahead + j] - vy[cell + j]
                shear = sheared(nx, ny, dx, dy, half * (th[ahead + j] + th[cell + j]))
                sheer = sheared(nx, ny, ex, ey, half * (ph[ahead + j] + ph[cell + j]))
                axial, along = stretched(nx, ny, dx, dy), stretched(nx, ny, ex, ey)
                if warm:
                    axial -= free[0, o, first + j]
                    shear -= free[1, o, first + j]
                if both:
                    along -= more[0, o, first + j]
                    sheer -= more[1, o, first + j]
                bend = bent(th[ahead + j] - th[cell + j]) * bent(ph[ahead + j] - ph[cell + j])
                total += factor[first + j] * (a * axial * along + b * shear * sheer + c * bend)
        out[s] = total
