"""What a physics says of itself, so that nobody has to ask which one a scene is about.

A new physics is a new `Physics`, a tensor that names it (`solver.material.tensors`), moduli with
their strains (`solver.material.moduli`) and a calibration; supports, loads, checks, operators,
results and messages follow from these.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array


@dataclass(frozen=True)
class Physics:
    """Unknowns of a particle and what may be said of them.

    Attributes
    ----------
    name, adjective : str
        Such as "elasticity" and "an elastic".
    unknowns : tuple of str
        Symbols, in the order of every array of shape (components, N). A solid may do without the
        last ones: see `missing`.
    turning : tuple of bool
        Which unknowns are rotations. They enter the equations as θ Δx, so that all unknowns and
        all entries carry the same units and no tolerance depends on them; see `scales`.
    fields : mapping from str to tuple of int
        What a solution holds, by name, and the unknowns it consists of.
    supports, loads : mapping from str to tuple of int
        What can be prescribed and what can act, by the keyword of a support and the kind of a
        load, and on which unknowns.
    motions : callable
        (n, 2) positions → (motions, unknowns, n): motions that strain no bond.
    motion_names : tuple of str
    unheld : str
        Sentence about a part that nothing holds, with {place} and {motions}.
    missing : mapping from int to str
        Why a solid may lack an unknown.
    energy_by_length : bool
        Whether the energy of a pair carries |ξ| (Eq. 4), as it does not in conduction (Eq. 112).
    breakable : bool
        Whether bonds store an energy that can break them.
    storage : str
        What a scene says of the body for it to change in time: its density or heat capacity.
    """

    name: str
    adjective: str
    unknowns: tuple[str, ...]
    turning: tuple[bool, ...]
    fields: Mapping[str, tuple[int, ...]]
    supports: Mapping[str, tuple[int, ...]]
    loads: Mapping[str, tuple[int, ...]]
    motions: Callable[[Array], Array]
    motion_names: tuple[str, ...]
    unheld: str
    missing: Mapping[int, str] = field(default_factory=dict)
    energy_by_length: bool = False
    breakable: bool = False
    storage: str = ""

    def scales(self, spacing: float, components: int | None = None) -> Array:
        """What each unknown is multiplied by to enter the equations, (components,): 1 or Δx, m."""
        return np.where(self.turning, spacing, 1.0)[:components]


def _rigid(positions: Array) -> Array:
    """Two translations and the rotation about the origin, θ = 1 rad with it."""
    motions = np.zeros((3, 3, len(positions)))
    motions[0, 0] = motions[1, 1] = 1.0
    motions[2, 0], motions[2, 1], motions[2, 2] = -positions[:, 1], positions[:, 0], 1.0
    return motions


def _level(positions: Array) -> Array:
    """The constant."""
    return np.ones((1, 1, len(positions)))


ELASTICITY = Physics(
    name="elasticity",
    adjective="an elastic",
    unknowns=("u1", "u2", "θ"),
    turning=(False, False, True),
    fields={"displacement": (0, 1), "rotation": (2,)},
    supports={"displacement": (0, 1), "u1": (0,), "u2": (1,), "rotation": (2,)},
    loads={"force": (0, 1), "traction": (0, 1), "couple": (2,), "temperature": (0, 1, 2)},
    motions=_rigid,
    motion_names=("translation along 1", "translation along 2", "rotation"),
    unheld="a rigid motion of {place} is left free ({motions}): statics has no unique solution",
    missing={
        2: "needs bonds with shear stiffness: this solid has none (C66 = C12), its particles do "
        "not resist rotation"
    },
    energy_by_length=True,
    breakable=True,
    storage="density",
)

HEAT = Physics(
    name="heat conduction",
    adjective="a conductive",
    unknowns=("T",),
    turning=(False,),
    fields={"temperature": (0,)},
    supports={"temperature": (0,)},
    loads={"source": (0,), "inflow": (0,)},
    motions=_level,
    motion_names=("level",),
    unheld="no temperature is prescribed on {place}: its level is undetermined",
    storage="heat_capacity",
)

ELECTRICITY = Physics(
    name="electrical conduction",
    adjective="an electrically conductive",
    unknowns=("φ",),
    turning=(False,),
    fields={"potential": (0,)},
    supports={"potential": (0,)},
    loads={"current": (0,), "source": (0,), "inflow": (0,)},
    motions=_level,
    motion_names=("level",),
    unheld="{place} is a floating conductor: no potential is prescribed on it, its level is "
    "undetermined",
)
