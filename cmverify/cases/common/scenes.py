"""Scenes that several cases, studies and benchmarks share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from solver import Scene, Support
    from solver.material import Material


def cracked_disc(
    material: Material,
    n: int,
    layer: Support,
    mouth: tuple[float, float] = (-1.5, 0.0),
    **settings: Any,
) -> Scene:
    """The unit disc at spacing 1/n with a crack from beyond its edge to its centre (Sect. 2.3.1).

    Parameters
    ----------
    material : Material
    n : int
    layer : Support
        What holds its outer layer: the field of the crack's tip, as a rule.
    mouth : pair of float
        Where the crack begins, outside the disc.
    **settings
        Of the scene.
    """
    from solver import Crack, Scene, disc

    return Scene(
        region=disc(1.0),
        spacing=1.0 / n,
        material=material,
        cracks=[Crack(mouth, (0.0, 0.0))],
        supports=[layer],
        **settings,
    )
