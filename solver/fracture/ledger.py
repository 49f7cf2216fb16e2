"""Books of a fracture run: energies as they occur, and the history of every equilibrium."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Array, Indices
from .breaking import Breakable
from .damaged_body import Equilibrium, Step

# Share of the sound body's energy at unit load that is the solver's noise: one bond holds 1e-6.
_PARTED = 1e-10
# Share of the energy of particles that move alone that is rounding, and how many times its
# tolerance the solver may leave in a strain.
_RIGID, _TIMES = 1e-15, 3.0


def same(one: tuple[Array, Array, int], other: tuple[Array, Array, int]) -> bool:
    """Whether two states are one: the very arrays of unknowns and free strains, as many bonds."""
    return one[0] is other[0] and one[1] is other[1] and one[2] == other[2]


class Ledger:
    """Energies of a body whose bonds break, J per unit thickness.

    Attributes
    ----------
    work : float
        Of supports and loads, and of what temperatures expand.
    dissipated : float
        w_c α Λ Δv Δv of all broken bonds.
    excess : float
        What breaking set free beyond that.
    """

    def __init__(self, body: Equilibrium, bonds: Breakable) -> None:
        self.body, self.bonds = body, bonds
        self.work = self.dissipated = self.excess = 0.0
        self.deflection = self.whole = 0.0
        # The work of the supports, and what all bonds hold, and of which answer with how many
        # bonds gone.
        self._supports: tuple[tuple[Array, Array, int], float] | None = None
        self._held_by_all: tuple[tuple[Array, Array, int], float] | None = None

    def opened(self) -> None:
        """The first equilibrium at unit load is known."""
        self.deflection, self.whole = self._load_work(), self._stored()

    @property
    def unstrained(self) -> bool:
        """Whether the load moves the body and does not strain it, up to the solver's noise.

        Judged by what its springs would store if each particle moved alone: of that a bar of 10⁴
        cells, pulled, holds 1e-8, and a cantilever of 1000 × 5 cells 1e-11.
        """
        operator = self.body.operator
        alone = np.abs(np.diagonal(operator.bulk_blocks, axis1=1, axis2=2)).max(axis=0)
        moved = (alone @ np.nan_to_num(self.body.unknowns) ** 2).sum()
        noise = max(_RIGID, (_TIMES * self.body.tolerance) ** 2)
        return abs(self._stored()) <= noise * float(moved) * self.body.sound.family.cell_area

    @property
    def unloaded(self) -> bool:
        """Whether the unit load strains the body no more, up to the solver's noise."""
        return abs(self._stored()) <= _PARTED * abs(self.whole)

    def _load_work(self) -> float:
        """Σ f·u Δv of the loads at unit load, prescribed unknowns left out."""
        start = self.body.sound
        acting = start.load if start.acting is None else start.acting
        if not acting.any():
            return self.body.surface_load_work()
        free = np.where(self.body.prescribed, 0.0, acting)
        found = float((free * np.nan_to_num(self.body.unknowns)).sum()) * start.family.cell_area
        return found + self.body.surface_load_work()

    def _support_work(self) -> float:
        """Σ R·u Δv of the supports at unit load.

        From bond forces, not from the stored energy: the mutual energy of the present field and
        the field that is the prescribed values and zero elsewhere.
        """
        state = self._state()
        # Asked for before the load changes and when that is recorded.
        if self._supports is None or not same(self._supports[0], state):
            prescribed = np.where(self.body.sound.prescribed, self.body.sound.values, 0.0)
            bonds = self.bonds.stored(state[0], prescribed)
            self._supports = state, 2.0 * (bonds + self.body.surface_energy(prescribed))
        return self._supports[1]

    def _stored(self) -> float:
        """Energy of all bonds at unit load."""
        state = self._state()
        if self._held_by_all is None or not same(self._held_by_all[0], state):
            self._held_by_all = state, self.bonds.stored(state[0]) + self.body.surface_energy()
        return self._held_by_all[1]

    def _state(self) -> tuple[Array, Array, int]:
        return self.body.unknowns, self.bonds.free, len(self.bonds.broken)

    def move(self, before: float, after: float) -> None:
        """The load factor changes while no bond breaks."""
        done = self._support_work() + self.deflection
        if self.bonds.free.shape[2]:
            # Supports and loads do Σ L k (ε − e)·ε, expansion the rest of twice what is stored.
            done += self.bonds.expansion_work(self.body.unknowns, self.bonds.free)
        self.work += 0.5 * (after**2 - before**2) * done

    def warmed(self, expansion: float) -> None:
        """Temperatures have changed while no bond broke and all loads stood still, at factor 1.

        `expansion` is what it did against the bonds.
        """
        deflection = self._load_work()
        self.work += expansion + deflection - self.deflection
        self.deflection = deflection

    def broken(self, bonds: Indices, load_factor: float) -> None:
        """Bonds are about to break under this load factor."""
        cost = float(self.bonds.cost_of(bonds).sum())
        self.dissipated += cost
        self.excess += self._held(bonds, load_factor) - cost

    def dropped(self, bonds: Indices, load_factor: float) -> None:
        """Bonds of parts that are set aside go, without cost."""
        self.excess += self._held(bonds, load_factor)

    def parted(self, load_factor: float) -> None:
        """What cracks have cut of the bonds that end at the surface, without cost."""
        self.excess += load_factor**2 * self.body.released_by_parting
        self.body.released_by_parting = 0.0

    def _held(self, bonds: Indices, load_factor: float) -> float:
        return load_factor**2 * float(self.bonds.energy_of(self.body.unknowns, bonds).sum())

    def solved(self, step: Step, load_factor: float) -> None:
        """A new equilibrium was found at this factor."""
        deflection = self._load_work()
        self.work += load_factor**2 * (deflection - self.deflection)
        self.excess += load_factor**2 * step.released
        self.deflection = deflection

    def row(self, load_factor: float) -> dict[str, float]:
        """What the history holds of it, see `History`."""
        return {
            "force": load_factor * self._support_work(),
            "displacement": load_factor * self.deflection,
            "work": self.work,
            "stored": load_factor**2 * self._stored(),
            "dissipated": self.dissipated,
            "excess": self.excess,
        }


class History:
    """One value a record of everything that is recorded, as arrays.

    Records are made when the load has arrived at an event and when the body has come to rest
    after it (``settled``), both of them equilibria without an overloaded bond or about to break
    one; where the load follows the crack, before every batch.

    Notes
    -----
    load_factor
        Load factor λ.
    force
        What is conjugate to λ in the work of the supports, dW = force dλ: Σ R·Û, with the
        prescribed values Û at λ = 1. For a grip moved by λ u it is u times the grip's force.
    displacement
        The same of loads, Σ F·u with the loads F at λ = 1.
    work, stored, dissipated, excess
        J per unit thickness.
    broken, loose, solves, iterations
        Bonds, particles set aside, solves and iterations so far.
    advance, tip_x, tip_y
        Of the furthest crack tip, m; see `solver.fracture.crack_path`.
    settled
        1 at rest, 0 where a run ended in the middle of an avalanche.
    """

    NAMES = (
        "load_factor",
        "force",
        "displacement",
        "work",
        "stored",
        "dissipated",
        "excess",
        "broken",
        "loose",
        "solves",
        "iterations",
        "advance",
        "tip_x",
        "tip_y",
        "settled",
    )

    def __init__(self, monitors: Sequence[str] = ()) -> None:
        taken = set(monitors) & set(self.NAMES)
        if taken:
            raise ValueError(f"monitors need names of their own, not {', '.join(sorted(taken))}")
        self.names = (*self.NAMES, *monitors)
        self.rows: list[list[float]] = []

    def add(self, **values: float) -> None:
        """Another record."""
        self.rows.append([float(values[name]) for name in self.names])

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, name: str) -> Array:
        """A column by name."""
        k = self.names.index(name)
        return np.array([row[k] for row in self.rows])

    def __getattr__(self, name: str) -> Array:
        if name.startswith("_") or name not in self.__dict__.get("names", ()):
            raise AttributeError(name)
        return self[name]

    @property
    def array(self) -> Array:
        """All records, shape (records, names)."""
        return np.array(self.rows).reshape(-1, len(self.names))

    @property
    def imbalance(self) -> Array:
        """work − stored − dissipated − excess, J per unit thickness: rounding and tolerance."""
        return self["work"] - self["stored"] - self["dissipated"] - self["excess"]
