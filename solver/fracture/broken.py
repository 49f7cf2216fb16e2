"""Which bonds have broken, in their order: the one record of it.

Whatever else depends on broken bonds (`Breakable.strengths`, the bonds and the operator of
`Equilibrium`, paths, a checkpoint) is derived from this record, and catches up with it when asked.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Indices, Mask

_RECORD = np.dtype([("bond", "i8"), ("step", "i8"), ("load_factor", "f8"), ("dropped", "?")])


class BrokenBonds:
    """Record of the bonds that carry nothing any more.

    Bonds are flat indices, half offset · N + particle of origin. They are only ever added.
    """

    def __init__(self) -> None:
        self._records: NDArray[Any] = np.zeros(64, dtype=_RECORD)
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def add(
        self, bonds: Indices, step: ArrayLike, load_factor: ArrayLike, dropped: ArrayLike
    ) -> None:
        """More bonds.

        Parameters
        ----------
        bonds : ndarray of int, shape (n,)
        step : int, or one for each
            Number of the solve before which they broke.
        load_factor : float, or one for each
        dropped : bool, or one for each
            Whether they did not break but went with a part that came loose.
        """
        after = self._count + len(bonds)
        if after > len(self._records):
            more = np.zeros(max(after, 2 * len(self._records)), dtype=_RECORD)
            more[: self._count] = self.records
            self._records = more
        new = self._records[self._count : after]
        new["bond"], new["step"], new["load_factor"] = bonds, step, load_factor
        new["dropped"] = dropped
        self._count = after

    @property
    def records(self) -> NDArray[Any]:
        """All of them: fields bond, step, load_factor, dropped."""
        return self._records[: self._count]

    @property
    def by_load(self) -> NDArray[Any]:
        """Records of those that the load broke."""
        return self.records[~self.records["dropped"]]

    def between(self, first: int, last: int | None = None) -> Indices:
        """Bonds from record `first` up to `last` (by default all)."""
        return np.array(self.records["bond"][first:last])

    def mask(self, shape: tuple[int, int]) -> Mask:
        """Those that the load broke, as `Scene.broken` returns them, shape (half, N)."""
        found = np.zeros(shape, dtype=bool)
        found.ravel()[self.by_load["bond"]] = True
        return found
