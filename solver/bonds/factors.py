"""Factors on the moduli of single bonds: what a state of the body makes of them.

A bulk bond is an offset with the modulus of its direction. Where something else changes single
bonds (a stretch that changes what they conduct), each has a factor beside its strength, whole
bonds and those that end at the surface alike.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import Array


@dataclass(frozen=True, eq=False)
class Factors:
    """A factor for every bond of a body.

    Attributes
    ----------
    whole : ndarray, shape (family size, N)
        By family index and particle of origin; the two directions of a bond agree.
    ended, chords : ndarray, shapes (k,) and (c,), optional
        Of the bonds that end at the surface, and of what its corners cut out of others.
    edges : ndarray, shape (edges of the outline, family size / 2), optional
        What the membrane along each edge takes for bonds of each half offset.
    """

    whole: Array
    ended: Array | None = None
    chords: Array | None = None
    edges: Array | None = None
