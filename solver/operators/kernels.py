"""Numba kernels: products of the bond operators with fields on the padded grid.

Arrays and scalars in, arrays out; no logic about scenes. A body is handed over as *segments*,
runs of neighbouring particles in one grid row that share a kind, as rows of an unsigned array

    first cell | length | first packed row | kind | first column of `diagonal`, of `factors` | phase

Kinds: 0 bulk (constant diagonal block, opposite bonds taken together), 1 truncated (own diagonal
block, missing neighbours read as zeros), 2 special (own factors too). Each segment is written by
one thread in a fixed order, so results do not depend on the number of threads. Indices are
unsigned because a signed index may mean "from the end", a test that keeps loops scalar.

Per half offset o with n, t, w = α Λ Δv, lengths in units of the operator's rotation length:
F_p = Σ A (u_p − u_q) + t̂ (θ_p + θ_q), M_p = Σ −t̂·(u_q − u_p) + c (θ_p + θ_q), with
A = (w/|ξ|)(k_n nnᵀ + k_t ttᵀ), t̂ = (w/2) k_t t, c = (w/4)|ξ| k_t (Eqs. 19–20). Bending of polar
solids, (w/|ξ|) k_b, adds to c on the diagonal and takes it from c between particles: the same
arrays, the same kernels.
"""

from __future__ import annotations

import os
from typing import Any

# Waiting OpenMP threads spin for some microseconds, the time between two products, and then
# sleep. On a machine that does anything else besides, a thread that spins for longer uses up the
# time slice of the one it waits for, and a product takes ten times as long; one that sleeps at
# once wakes too late for small products. Read when the OpenMP runtime is loaded, so set before
# Numba loads it.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
os.environ.setdefault("GOMP_SPINCOUNT", "1500")

import numba as nb
import numpy as np

from ..compiled import kernel
from . import lanes
from .lanes import load, store, width

# OpenMP has the cheapest fork and join of Numba's layers; the others are fallbacks.
setattr(nb.config, "THREADING_LAYER_PRIORITY", ["omp", "tbb", "workqueue"])  # noqa: B010

_U = np.uint64
# Contraction to fused multiply-adds only: sums keep their order.
_FAST = {"contract", "nsz"}
#: What counts as zero beside values of size one in single precision.
NEGLIGIBLE = 1e-30
_OPTIONS: Any = {
    "uses": (lanes.__file__,),
    "parallel": True,
    "fastmath": _FAST,
    "nogil": True,
}
# Longest run of special particles, in values of lanes, that is taken lane by lane: what is read
# most, the factors, lies in long rows of which each value reads a piece only. Narrow registers
# lose more by that than they gain.
_LONGEST = np.uint64(2 if lanes.bytes_of_a_register() >= 32 else 0)
#: Half offsets whose bonds are summed by themselves.
_TOGETHER = np.uint64(16)
# Of what kernels call. Arrays are theirs: counting who holds them takes as long as a dozen bonds.
_WITHIN: Any = {
    "uses": (lanes.__file__,),
    "fastmath": _FAST,
    "nogil": True,
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
    "_nrt": False,
}


@kernel(**_OPTIONS)
def elastic_product(grid, segments, steps, blocks, bulk, diagonal, factors, out):
    """Operator rows with three unknowns.

    Parameters
    ----------
    grid : float64 (3, cells)
        u1, u2 and scaled rotation on the padded grid.
    segments : uint64 (s, 7)
    steps : uint64 (h,)
        Distance of each half offset in cells of the flattened grid.
    blocks : float64 (phases, h, 6)
        A11, A12, A22, t̂1, t̂2, c of each half offset.
    bulk : float64 (phases, 6)
        Diagonal block of a bulk particle: 11, 12, 22, 1θ, 2θ, θθ.
    diagonal : float64 (6, d)
    factors : float64 (2h, f)
    out : float64 (3, n)
    """
    wide, half = width(grid), steps.size
    ux, uy, th = grid[0], grid[1], grid[2]
    fx, fy, mo = out[0], out[1], out[2]
    for number in nb.prange(segments.shape[0]):
        s = _U(number)
        cell, size, first = segments[s, 0], segments[s, 1], segments[s, 2]
        kind, column, fcol = segments[s, 3], segments[s, 4], segments[s, 5]
        phase = segments[s, 6]
        if kind != _U(2) or size <= _LONGEST * wide:
            # All lanes of the bulk, then what is left, and what is special: each with its factors.
            masked = size - size % wide if kind != _U(2) else _U(0)
            for j in range(_U(0), masked, wide):
                _elastic_lanes(
                    s, j, None, grid, segments, steps, blocks, bulk, diagonal, factors, out
                )
            for j in range(masked, size, wide):
                used = min(wide, size - j)
                _elastic_lanes(
                    s, j, used, grid, segments, steps, blocks, bulk, diagonal, factors, out
                )
        else:
            # Bond by bond, along all of the run.
            for j in range(size):
                x, y, r = ux[cell + j], uy[cell + j], th[cell + j]
                k = column + j
                fx[first + j] = diagonal[0, k] * x + diagonal[1, k] * y + diagonal[3, k] * r
                fy[first + j] = diagonal[1, k] * x + diagonal[2, k] * y + diagonal[4, k] * r
                mo[first + j] = diagonal[3, k] * x + diagonal[4, k] * y + diagonal[5, k] * r
            for o in range(half):
                a, b, c = blocks[phase, o, 0], blocks[phase, o, 1], blocks[phase, o, 2]
                tx, ty, e = blocks[phase, o, 3], blocks[phase, o, 4], blocks[phase, o, 5]
                ahead, behind = cell + steps[o], cell - steps[o]
                f_ahead, f_behind = factors[o], factors[o + half]
                for j in range(size):
                    g1, g2 = f_ahead[fcol + j], f_behind[fcol + j]
                    x1, x2 = g1 * ux[ahead + j], g2 * ux[behind + j]
                    y1, y2 = g1 * uy[ahead + j], g2 * uy[behind + j]
                    r1, r2 = g1 * th[ahead + j], g2 * th[behind + j]
                    sx, sy, dr = x1 + x2, y1 + y2, r1 - r2
                    fx[first + j] += tx * dr - a * sx - b * sy
                    fy[first + j] += ty * dr - b * sx - c * sy
                    mo[first + j] += e * (r1 + r2) - tx * (x1 - x2) - ty * (y1 - y2)


@kernel(**_WITHIN)
def _elastic_lanes(s, j, used, grid, segments, steps, blocks, bulk, diagonal, factors, out):
    """Rows of neighbours from the j-th of a segment on: all lanes, or the first `used`.

    Only the latter have factors. Component by component, so that all sums stay in registers.
    """
    cell, kind, phase = segments[s, 0] + j, segments[s, 3], segments[s, 6]
    half = steps.size
    x, y, r = load(grid, 0, cell, used), load(grid, 1, cell, used), load(grid, 2, cell, used)
    if kind == _U(0):
        fx = bulk[phase, 0] * x + bulk[phase, 1] * y
        fy = bulk[phase, 1] * x + bulk[phase, 2] * y
        mo = bulk[phase, 5] * r
    else:
        k = segments[s, 4] + j
        xy, xr, yr = (
            load(diagonal, 1, k, used),
            load(diagonal, 3, k, used),
            load(diagonal, 4, k, used),
        )
        fx = load(diagonal, 0, k, used) * x + xy * y + xr * r
        fy = xy * x + load(diagonal, 2, k, used) * y + yr * r
        mo = xr * x + yr * y + load(diagonal, 5, k, used) * r
    fcol = segments[s, 5] + j
    # Some bonds have a sum of their own, so that rounding grows with their number only slowly.
    for block in range(_U(0), half, _TOGETHER):
        px, py, pm = x - x, y - y, r - r
        for o in range(block, min(block + _TOGETHER, half)):
            a, b, c = blocks[phase, o, 0], blocks[phase, o, 1], blocks[phase, o, 2]
            tx, ty, e = blocks[phase, o, 3], blocks[phase, o, 4], blocks[phase, o, 5]
            ahead, behind = cell + steps[o], cell - steps[o]
            one, other = load(grid, 0, ahead, used), load(grid, 0, behind, used)
            if used is not None and kind == _U(2):
                g1, g2 = load(factors, o, fcol, used), load(factors, o + half, fcol, used)
                one, other = g1 * one, g2 * other
            both = one + other
            px, py, pm = px - a * both, py - b * both, pm - tx * (one - other)
            one, other = load(grid, 1, ahead, used), load(grid, 1, behind, used)
            if used is not None and kind == _U(2):
                g1, g2 = load(factors, o, fcol, used), load(factors, o + half, fcol, used)
                one, other = g1 * one, g2 * other
            both = one + other
            px, py, pm = px - b * both, py - c * both, pm - ty * (one - other)
            one, other = load(grid, 2, ahead, used), load(grid, 2, behind, used)
            if used is not None and kind == _U(2):
                g1, g2 = load(factors, o, fcol, used), load(factors, o + half, fcol, used)
                one, other = g1 * one, g2 * other
            apart = one - other
            px, py, pm = px + tx * apart, py + ty * apart, pm + e * (one + other)
        fx, fy, mo = fx + px, fy + py, mo + pm
    first = segments[s, 2] + j
    store(out, 0, first, used, fx)
    store(out, 1, first, used, fy)
    store(out, 2, first, used, mo)


@kernel(**_OPTIONS)
def central_product(grid, segments, steps, blocks, bulk, diagonal, factors, out):
    """Operator rows of an elastic body in which no bond resists shear: two unknowns.

    As `elastic_product` with `grid` (2, cells), `blocks` (phases, h, 3), `bulk` (phases, 3),
    `diagonal` (3, d) and `out` (2, n).
    """
    ux, uy = grid[0], grid[1]
    half = steps.size
    for s in nb.prange(segments.shape[0]):
        cell, size, first = segments[s, 0], segments[s, 1], segments[s, 2]
        kind, column, fcol = segments[s, 3], segments[s, 4], segments[s, 5]
        phase = segments[s, 6]
        fx, fy = out[0], out[1]
        for j in range(size):
            x, y = ux[cell + j], uy[cell + j]
            if kind == _U(0):
                fx[first + j] = bulk[phase, 0] * x + bulk[phase, 1] * y
                fy[first + j] = bulk[phase, 1] * x + bulk[phase, 2] * y
            else:
                k = column + j
                fx[first + j] = diagonal[0, k] * x + diagonal[1, k] * y
                fy[first + j] = diagonal[1, k] * x + diagonal[2, k] * y
        for o in range(half):
            a, b, c = blocks[phase, o, 0], blocks[phase, o, 1], blocks[phase, o, 2]
            ahead, behind = cell + steps[o], cell - steps[o]
            if kind != _U(2):
                for j in range(size):
                    sx = ux[ahead + j] + ux[behind + j]
                    sy = uy[ahead + j] + uy[behind + j]
                    fx[first + j] -= a * sx + b * sy
                    fy[first + j] -= b * sx + c * sy
            else:
                f_ahead, f_behind = factors[o], factors[o + half]
                for j in range(size):
                    g1, g2 = f_ahead[fcol + j], f_behind[fcol + j]
                    sx = g1 * ux[ahead + j] + g2 * ux[behind + j]
                    sy = g1 * uy[ahead + j] + g2 * uy[behind + j]
                    fx[first + j] -= a * sx + b * sy
                    fy[first + j] -= b * sx + c * sy


@kernel(**_OPTIONS)
def conductive_product(grid, segments, steps, blocks, bulk, diagonal, factors, out):
    """Operator rows of conduction: one unknown.

    As `elastic_product` with `grid` (1, cells), `blocks` (phases, h, 1) holding w k/|ξ|², `bulk`
    (phases, 1), `diagonal` (1, d) and `out` (1, n).
    """
    field = grid[0]
    half = steps.size
    for s in nb.prange(segments.shape[0]):
        cell, size, first = segments[s, 0], segments[s, 1], segments[s, 2]
        kind, column, fcol = segments[s, 3], segments[s, 4], segments[s, 5]
        phase = segments[s, 6]
        flow = out[0]
        if kind == _U(0):
            for j in range(size):
                flow[first + j] = bulk[phase, 0] * field[cell + j]
        else:
            for j in range(size):
                flow[first + j] = diagonal[0, column + j] * field[cell + j]
        for o in range(half):
            a = blocks[phase, o, 0]
            ahead, behind = cell + steps[o], cell - steps[o]
            if kind != _U(2):
                for j in range(size):
                    flow[first + j] -= a * (field[ahead + j] + field[behind + j])
            else:
                f_ahead, f_behind = factors[o], factors[o + half]
                for j in range(size):
                    flow[first + j] -= a * (
                        f_ahead[fcol + j] * field[ahead + j]
                        + f_behind[fcol + j] * field[behind + j]
                    )


@kernel(**_OPTIONS)
def scatter(segments, values, grid):
    """Write packed values (components, n) to the padded grid (components, cells)."""
    for s in nb.prange(segments.shape[0]):
        cell, size, first = segments[s, 0], segments[s, 1], segments[s, 2]
        for c in range(grid.shape[0]):
            row, packed = grid[c], values[c]
            for j in range(size):
                row[cell + j] = packed[first + j]


@kernel(**_OPTIONS)
def block_scale(segments, bulk, own, residual, out):
    """Apply a block-diagonal matrix: one block for the bulk, own ones for the other particles.

    Parameters
    ----------
    segments : uint64 (s, 7)
    bulk : float64 (phases, c, c)
    own : float64 (c, c, d)
    residual, out : float64 (c, n)
    """
    size_c = residual.shape[0]
    for s in nb.prange(segments.shape[0]):
        size, first = segments[s, 1], segments[s, 2]
        kind, column, phase = segments[s, 3], segments[s, 4], segments[s, 6]
        for a in range(size_c):
            target = out[a]
            for j in range(size):
                target[first + j] = 0.0
            for b in range(size_c):
                source = residual[b]
                if kind == _U(0):
                    entry = bulk[phase, a, b]
                    for j in range(size):
                        target[first + j] += entry * source[first + j]
                else:
                    entries = own[a, b]
                    for j in range(size):
                        target[first + j] += entries[column + j] * source[first + j]


@kernel(**_OPTIONS)
def narrow(segments, values, unit, out):
    """Packed values (c, n) over a unit in the precision of `out`, negligible ones as zero."""
    for s in nb.prange(segments.shape[0]):
        size, first = segments[s, 1], segments[s, 2]
        for c in range(out.shape[0]):
            given, taken = values[c], out[c]
            for j in range(size):
                value = given[first + j] / unit
                taken[first + j] = value if abs(value) > NEGLIGIBLE else 0.0


@kernel(**_OPTIONS)
def relax(segments, bulk, own, keep, gain, rows, residual, step, x, grid):
    """A step of a smoother with the inverses D⁻¹ of the diagonal blocks.

    The residual loses the rows of the last step, the next is keep·step + gain·D⁻¹·residual; it
    is added to x and shown on the grid.

    Parameters
    ----------
    segments : uint64 (s, 7)
    bulk : float (phases, c, c)
    own : float (c, c, d)
    keep, gain : float
    rows, residual, step, x : float (c, n)
    grid : float (c, cells)
    """
    size_c = residual.shape[0]
    for s in nb.prange(segments.shape[0]):
        cell, size, first = segments[s, 0], segments[s, 1], segments[s, 2]
        kind, column, phase = segments[s, 3], segments[s, 4], segments[s, 6]
        for a in range(size_c):
            left, lost = residual[a], rows[a]
            for j in range(size):
                left[first + j] -= lost[first + j]
        for a in range(size_c):
            next_, total, shown = step[a], x[a], grid[a]
            if keep == 0.0:
                # Whatever is left of an earlier use.
                for j in range(size):
                    next_[first + j] = 0.0
            else:
                for j in range(size):
                    next_[first + j] *= keep
            for b in range(size_c):
                left = residual[b]
                if kind == _U(0):
                    entry = gain * bulk[phase, a, b]
                    for j in range(size):
                        next_[first + j] += entry * left[first + j]
                else:
                    entries = own[a, b]
                    for j in range(size):
                        next_[first + j] += gain * entries[column + j] * left[first + j]
            for j in range(size):
                value = next_[first + j]
                total[first + j] += value
                shown[cell + j] = value


@kernel(**_OPTIONS)
def weighted_rows(rows, pointer, index, weight, values, out):
    """Some rows of a sparse matrix (compressed rows) times each component of (c, columns)."""
    for r in nb.prange(rows.size):
        row = rows[r]
        begin, end = pointer[row], pointer[row + 1]
        if values.shape[0] == 3:
            # Indices and weights are read once for all three.
            x, y, z = 0.0, 0.0, 0.0
            for k in range(begin, end):
                w, column = weight[k], index[k]
                x += w * values[0, column]
                y += w * values[1, column]
                z += w * values[2, column]
            out[0, row], out[1, row], out[2, row] = x, y, z
        else:
            for c in range(values.shape[0]):
                total = 0.0
                for k in range(begin, end):
                    total += weight[k] * values[c, index[k]]
                out[c, row] = total
