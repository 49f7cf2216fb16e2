"""When an unfinished solve knows which bonds break next.

Within an avalanche nothing of an equilibrium is kept but what it says of the bonds: which of them
are overloaded, and which of these are the most loaded. Conjugate gradients may end as soon as
another iteration changes no answer: when the last one has moved the bonds by much less than those
are apart that break and those that stay. The next solve goes on from there, and the books do not
care: they count what a step sets free from the residuals at both of its ends.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Indices
from ..material.strains import elongations
from .breaking import TIE, Breakable

# Utilisation, over what breaks a bond, from which on a bond is watched, and beyond which one that
# was not shows that the watch was too narrow.
_WATCHED, _SEEN = 0.25, 0.9
# What later iterations may still change, in changes of the last one: 0.1 to 1 was measured.
_NOISE = 3.0


class Decision:
    """Follows the most loaded bonds from iterate to iterate.

    Parameters
    ----------
    bonds : Breakable
        Neither bent nor heated; those that break have been taken out.
    utilisation : ndarray, shape (half, N)
        Before that.
    least : float
        Utilisation from which on a bond breaks.
    size : int
        Most bonds of a batch.

    Attributes
    ----------
    made : bool
        Whether it is known which bonds break next.
    """

    def __init__(self, bonds: Breakable, utilisation: Array, least: float, size: int) -> None:
        self._least, self._size = least, size
        watched = np.nonzero(utilisation.ravel() >= _WATCHED * least)[0]
        #: Flat indices of the bonds that are watched, ascending.
        self.watched: Indices = watched[bonds.strengths.ravel()[watched] != 0]
        _, *ends = bonds.ends(self.watched)
        #: Particles at their ends.
        self.particles: Indices
        self.particles, at = np.unique(np.concatenate(ends), return_inverse=True)
        self._ends = at.reshape(2, -1)
        nx, ny, self._half, *self._load = bonds.loads(self.watched)
        self._normal, self._tension = np.stack([nx, ny]), bonds.tension_only
        self._last: Array | None = None
        self.made = False

    def __call__(self, values: Array) -> bool:
        """Whether another iterate, values of `particles` of shape (components, p), decides it."""
        now = self._utilisation(values)
        if self._last is not None:
            noise = _NOISE * float(np.abs(now - self._last).max(initial=0.0))
            self.made = parted(now, self._least, self._size, noise)
        self._last = now
        return self.made

    def _utilisation(self, values: Array) -> Array:
        """Of the bonds that are watched, as `Breakable.utilisation`."""
        p, q = self._ends
        turn = self._half * (values[2, q] + values[2, p] if len(values) > 2 else 0.0)
        axial, shear = elongations(("s", "γ"), self._normal, values[:2, q] - values[:2, p], turn)
        found = self._load[0] * axial**2 + self._load[1] * shear**2
        return np.where(axial < 0.0, 0.0, found) if self._tension else found

    def saw(self, utilisation: Array) -> bool:
        """Whether all bonds that are about to break have been watched."""
        loaded = np.nonzero(utilisation.ravel() >= _SEEN * self._least)[0]
        return bool(np.isin(loaded, self.watched, assume_unique=True).all())


def parted(utilisation: Array, least: float, size: int, noise: float) -> bool:
    """Whether the next batch is the same whatever noise does to the bonds.

    Parameters
    ----------
    utilisation : ndarray, shape (n,)
    least, size
        See `breaking.next_batch`.
    noise : float
        Largest error of a utilisation.
    """
    low, high = least * (1 - 2 * TIE) - noise, least * (1 - 0.5 * TIE) + noise
    if len(utilisation) > size:
        first, next_ = -np.sort(np.partition(-utilisation, size)[: size + 1])[size - 1 :]
        if next_ >= low:
            # More than a batch is overloaded: its last bond must stand apart from the next.
            return bool(next_ + 2 * noise <= first * (1 - 2 * TIE) and first >= high)
    return not bool(((utilisation > low) & (utilisation < high)).any())
