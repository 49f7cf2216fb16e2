"""Surface treatments: what is done for families that the body's edge or a crack cuts short.

``none`` nothing; ``volume`` stiffens the bonds that are left (here); ``extrapolated`` lets missing
bonds end at the surface (`solver.bonds.ended`).
"""

from __future__ import annotations

from typing import Literal, get_args

from ..arrays import Array
from ..material import Family

Surface = Literal["none", "volume", "extrapolated"]


def check_surface(surface: str) -> None:
    """Raise ValueError for a treatment that does not exist."""
    if surface not in get_args(Surface):
        raise ValueError(
            f"unknown surface treatment {surface!r}; known: {', '.join(get_args(Surface))}"
        )


def full_volume(family: Family) -> float:
    """Volume of a bulk family in cells, the particle's own cell included."""
    return 1.0 + float(family.fraction.sum())


def volume_factor(family: Family, volume_p: Array, volume_q: Array) -> Array:
    """Volume method (Le and Bobaru 2018): a bond is stiffened by 2 V₀ / (V_p + V_q).

    Parameters
    ----------
    family : Family
    volume_p, volume_q : ndarray
        Volumes (cells) of the families at both ends. A family counts as whole where it is cut
        by nothing but the outer edge of a prescribed layer, which is no physical surface.

    Returns
    -------
    ndarray
        Dimensionless factor ≥ 1.
    """
    return 2.0 * full_volume(family) / (volume_p + volume_q)
