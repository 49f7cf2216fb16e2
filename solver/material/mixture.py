"""Bodies of several solids: every particle's bonds have the moduli of its own solid.

No bond joins two solids: where it meets the interface it ends, and so does the one from the other
side (`solver.geometry.phases`). So no mean of moduli is needed. None would do: of the state on
both sides of an interface the strain along it is continuous and the traction across it, so that
bonds along would need the mean of the moduli, bonds across that of the compliances, and oblique
ones something between that depends on the load.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Indices
from ..errors import InadmissibleMaterialError, SceneError
from .moduli import Moduli
from .physics import Physics
from .stability import Stability

_CENTRAL = (
    "one solid of this body has bonds that resist shear and another has none (C66 = C12, ν = 1/3 "
    "in plane stress): their particles have different unknowns. Change it a little (ν = 0.3333)"
)


@dataclass(frozen=True, eq=False)
class Mixture(Moduli):
    """Moduli of several solids on one lattice.

    Attributes
    ----------
    solids : tuple of Moduli
        Of every phase, all with the same strains.
    of : ndarray of int, shape (N,)
        Phase of each particle.

    Raises
    ------
    SceneError
        If the solids' particles do not have the same unknowns.
    """

    solids: tuple[Moduli, ...]
    of: Indices

    def __post_init__(self) -> None:
        if any("s+γ" in moduli.strains for moduli in self.solids):
            raise SceneError(
                "chiral solids have no inclusions yet, nor are they any: what their points' turns "
                "do at interfaces is not known"
            )
        if len({moduli.strains for moduli in self.solids}) > 1:
            raise SceneError(_CENTRAL)
        if "χ" in self.strains:
            raise SceneError(
                "polar solids have no inclusions yet: their rotations would have to be continuous "
                "at interfaces, and their couples balanced"
            )

    @property
    def each(self) -> tuple[Moduli, ...]:
        return self.solids

    @property
    def physics(self) -> Physics:
        return self.solids[0].physics

    @property
    def strains(self) -> tuple[str, ...]:
        return self.solids[0].strains

    @property
    def components(self) -> int:
        return self.solids[0].components

    @property
    def stiffness(self) -> Array:
        raise SceneError(
            "this is known for bodies of one material only, and the scene has inclusions"
        )

    @cached_property
    def _stacked(self) -> Array:
        return np.stack([moduli.stiffness for moduli in self.solids])

    def of_offset(self, o: int) -> Array:
        return np.asarray(self._stacked[self.of, :, o].T)

    def of_bonds(self, offset: Indices, phase: Indices | None) -> Array:
        if phase is None:
            return self.stiffness  # which refuses
        return np.asarray(self._stacked[phase, :, offset].T)

    @property
    def non_negative(self) -> bool:
        return all(moduli.non_negative for moduli in self.solids)

    def homogeneous(self, normal: Array) -> Array:
        return self.solids[0].homogeneous(normal)

    def wave_rows(self, direction: Array) -> Array:
        return self.solids[0].wave_rows(direction)

    def uniaxial(self, along: Array) -> Array:
        return self.solids[0].uniaxial(along)

    def absolute(self) -> Mixture:
        return Mixture(tuple(moduli.absolute() for moduli in self.solids), self.of)

    def scaled(self, factor: Array) -> Mixture:
        return Mixture(tuple(moduli.scaled(factor) for moduli in self.solids), self.of)


def together(found: tuple[Stability, ...]) -> Stability:
    """Stability of a body of several solids: that of the least stable.

    Raises
    ------
    SceneError
        If some have rotations and others have none.
    InadmissibleMaterialError
        If rotations are stiff in one solid and of negative stiffness in another.
    """
    found_kinds = {stability.kind for stability in found}
    if "central" in found_kinds and len(found_kinds) > 1:
        raise SceneError(_CENTRAL)
    if len(found_kinds) > 1:
        kinds = ", ".join(stability.kind for stability in found)
        raise InadmissibleMaterialError(
            f"the solids of this body are of different kinds ({kinds}): where C66 < C12 (ν > 1/3 "
            f"in plane stress) rotations are condensed out, which has no meaning beside a solid "
            f"with C66 > C12. Use finite elements for this pair"
        )
    return min(found, key=lambda stability: stability.margin)
