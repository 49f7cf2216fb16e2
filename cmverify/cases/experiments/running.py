"""Experiments are led alike: a run, its stages, and what every run of them is judged by."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from time import perf_counter, process_time
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cmverify.case import Array, Stage, Stages
from cmverify.run import unfinished

if TYPE_CHECKING:
    from solver import Scene
    from solver.fracture import Growth, Programme

#: What has been dissipated at the stages that are drawn, relative to the end.
SHARES = (0.05, 0.35, 0.7, 1.0)
# A moment is kept when this much more has been dissipated than at the last one.
_GROWTH = 1.15
# Solves between two checkpoints, where a run may keep them.
_EVERY = 50
_MOMENTS = "moments.npz"

DESCRIPTIONS = {
    "balance": "work − stored − dissipated − excess, relative to the work",
    "undercut": "share of G × crack length that broken bonds have not dissipated",
    "cost ratio": "dissipated energy over G × crack length: how wide the band of broken bonds is",
}


@dataclass
class Moment:
    """A state within a run, after so many solves."""

    load_factor: float
    force: float
    dissipated: float
    damage: Array
    solves: int


@dataclass
class Led:
    """A run and what was kept of it on the way."""

    run: Growth
    moments: list[Moment]
    seconds: dict[str, float] = field(default_factory=dict)
    statistics: dict[str, float | int | str] = field(default_factory=dict)

    @property
    def balance(self) -> float:
        """Largest imbalance relative to the work."""
        h = self.run.history
        return float(np.abs(h.imbalance).max() / max(h.work.max(), 1e-300))

    @property
    def length(self) -> float:
        """Length of all that has cracked, m: paths and branches."""
        return float(sum(path.length for path in self.run.paths))

    def stages(
        self,
        label: Callable[[float], str],
        displacement: float,
        force: float,
        solves: Sequence[int] | None = None,
        outlines: tuple[Array, ...] = (),
    ) -> Stages:
        """Stages after so many solves, or at `SHARES` of what was dissipated.

        Parameters
        ----------
        label : callable
            Load factor → what is written over the picture.
        displacement, force : float
            Abscissa per load factor and ordinate per conjugate force of the curve.
        solves : sequence of int, optional
            The first moment kept after each of them.
        outlines : tuple of (k, 2) arrays
        """
        spent = np.array([moment.dissipated for moment in self.moments])
        chosen = [int(np.argmin(np.abs(spent - share * spent[-1]))) for share in SHARES]
        if solves:
            taken = np.array([moment.solves for moment in self.moments])
            last = len(taken) - 1
            chosen = [min(int(np.searchsorted(taken, wanted)), last) for wanted in solves]
        found = [self.moments[k] for k in dict.fromkeys(chosen)]
        lattice = self.run.bonds.lattice
        return Stages(
            "damage",
            lattice.points,
            lattice.spacing,
            tuple(
                Stage(
                    label(m.load_factor),
                    np.array([displacement * m.load_factor, force * m.force]),
                    m.damage,
                )
                for m in found
            ),
            outlines,
        )


def lead(
    scene: Scene,
    toughness: Any,
    programme: Programme,
    *,
    until: Callable[[Growth], bool] | None = None,
    **options: Any,
) -> Led:
    """Run `solver.fracture.grow` and keep moments as the crack grows.

    In a worker of `cmverify run` the state is kept too, and a run that was killed goes on from it
    with the same results to the last bit.
    """
    from solver import fracture

    place = unfinished.place()
    moments = [] if place is None else _read(place / _MOMENTS)
    taken_up: list[int] = []

    def keep(run: Growth) -> None:
        damage = run.damage
        damage[run.loose] = np.nan
        row = run.ledger.row(run.load_factor)
        moments.append(
            Moment(run.load_factor, row["force"], row["dissipated"], damage, len(run.solves))
        )
        if place is not None:
            _write(place / _MOMENTS, moments)

    def watch(run: Growth) -> bool:
        if not taken_up:
            # Moments after the last checkpoint come again.
            taken_up.append(len(run.solves))
            moments[:] = [moment for moment in moments if moment.solves <= len(run.solves)]
        spent = run.ledger.dissipated
        if spent > 0 and (not moments or spent > _GROWTH * moments[-1].dissipated):
            keep(run)
        return until is not None and until(run)

    begun, cpu = perf_counter(), process_time()
    if place is not None:
        options |= {"checkpoint": place / "run.npz", "every": _EVERY}
    run = fracture.grow(scene, toughness, programme, until=watch, **options)
    cpu = process_time() - cpu
    steps = run.steps
    solves = len(steps)
    if not taken_up:
        # It was killed after its end, its last moment kept.
        moments[:] = [moment for moment in moments if moment.solves < solves]
    keep(run)
    since = taken_up[0] if taken_up else solves
    statistics: dict[str, float | int | str] = {
        "solves": solves,
        "iterations": int(steps["iterations"].sum()),
        "bonds a solve": round(len(run.broken_bonds) / solves, 1),
        "CPU s a solve": round(cpu / max(solves - since, 1), 3),
        "share outside products and preconditioner": round(1 - run.body.solving / cpu, 3),
        "ended": run.reason,
    }
    if since > 1:
        statistics["taken up at solve"] = since
    return Led(run, moments, {"solve": perf_counter() - begun}, statistics)


def _write(path: Path, moments: list[Moment]) -> None:
    names = [entry.name for entry in fields(Moment)]
    partial = path.with_suffix(".part.npz")
    arrays: dict[str, Any] = {name: [getattr(m, name) for m in moments] for name in names}
    np.savez(partial, **arrays)
    partial.replace(path)


def _read(path: Path) -> list[Moment]:
    if not path.exists():
        return []
    with np.load(path, allow_pickle=False) as file:
        columns = {entry.name: list(file[entry.name]) for entry in fields(Moment)}
    rows = zip(*columns.values(), strict=True)
    return [
        Moment(float(factor), float(force), float(spent), damage, int(solves))
        for factor, force, spent, damage, solves in rows
    ]


def circle(centre: ArrayLike, radius: float) -> Array:
    """Points of a circle, for outlines, (49, 2)."""
    turn = np.linspace(0.0, 2 * np.pi, 49)
    return np.asarray(centre) + radius * np.column_stack([np.cos(turn), np.sin(turn)])


def uprights(at: Sequence[float], top: float) -> tuple[Array, Array]:
    """Ordinates and abscissae of a reference curve of upright lines up to `top` from a ground."""
    x = np.repeat(np.asarray(at, dtype=float), 3)
    y = np.tile([0.0, top, 0.0], len(at))
    return y, x


def bridging(run: Growth) -> NDArray[np.int64]:
    """Whole bonds across the paths of all cracks, flat indices: they have not been paid for yet.

    Bonds at a small angle to a crack are hardly strained by its opening and break far behind its
    tip, the farther the tougher they are. A bond that crosses the paths twice parts nothing.
    """
    from scipy.spatial import cKDTree

    bonds = run.bonds
    points = bonds.lattice.points
    whole = np.flatnonzero(bonds.strengths.ravel() > 0)
    pieces = [
        np.hstack([path.points[:-1], path.points[1:]]) for path in run.paths if len(path.points) > 1
    ]
    if not pieces:
        return np.zeros(0, dtype=np.int64)
    segments = np.vstack(pieces)
    # The longest bonds reach half a cell beyond the horizon.
    longest = float(bonds.family.length.max())
    reach = longest + float(np.hypot(*(segments[:, 2:] - segments[:, :2]).T).max())
    _, p, q = bonds.ends(whole)
    near = cKDTree(segments[:, :2]).query(points[p], distance_upper_bound=reach)[0] < reach
    whole, first, second = whole[near], points[p[near]], points[q[near]]
    crossed = np.zeros(len(whole), dtype=bool)
    for segment in segments:
        start, end = segment[:2], segment[2:]
        along, bond = end - start, second - first
        sides = _cross(along, first - start) * _cross(along, second - start) < 0
        # The end belongs to the next piece.
        ends = (_cross(bond, start - first) > 0) != (_cross(bond, end - first) > 0)
        crossed ^= sides & ends
    found: NDArray[np.int64] = whole[crossed]
    return found


def _cross(one: Array, other: Array) -> Array:
    return np.asarray(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])


def unmirrored(run: Growth, axis: Sequence[float] = (0.0, 0.0)) -> int:
    """Broken bonds whose image in the line x = axis[0] is whole."""
    lattice, bonds = run.bonds.lattice, run.bonds
    _, p, q = bonds.ends(run.broken_bonds)
    key = np.rint(2 * (lattice.points - lattice.points.min(axis=0)) / lattice.spacing).astype(int)
    width = int(np.rint(4 * (axis[0] - lattice.points[:, 0].min()) / lattice.spacing))
    number = {tuple(k): i for i, k in enumerate(key.tolist())}
    image = np.array([number.get((width - kx, ky), -1) for kx, ky in key.tolist()])
    broken = {frozenset(pair) for pair in zip(p.tolist(), q.tolist(), strict=True)}
    mirrored = {frozenset(pair) for pair in zip(image[p].tolist(), image[q].tolist(), strict=True)}
    return len(broken - mirrored)
