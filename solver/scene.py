"""Scenes: what is asked, and the two things asked of it most.

A scene derives which unknowns and terms exist, and nothing more. `Scene.discretise` turns it into
arrays and operators (all input is checked there, before anything long begins), and the analyses
work on that `Discretisation`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .analyses.statics import solve
from .problem import Description, Discretisation
from .solution import Solution


@dataclass(frozen=True)
class Scene(Description):
    __doc__ = f"""{Description.__doc__}
    Examples
    --------
    >>> from solver import ConductivityTensor, Scene, Support, disc
    >>> scene = Scene(
    ...     region=disc(1.0), spacing=0.1, material=ConductivityTensor.isotropic(1.0),
    ...     supports=[Support.layer(cells=5.5, temperature=lambda x, y: x)],
    ... )
    >>> bool(abs(scene.solve().temperature - scene.solve().points[:, 0]).max() < 1e-9)
    True
    """

    def discretise(self, sharp_tips: bool = True, constrained: bool = False) -> Discretisation:
        """Check the scene and turn it into arrays and operators.

        Parameters
        ----------
        sharp_tips : bool
            Whether the two faces of a crack share the node of each tip (`solver.geometry.outline`);
            they must not where cracks are to grow.
        constrained : bool
            Whether the caller knows rigid pins and equal unknowns (`Discretisation.of`).

        Raises
        ------
        SceneError, CalibrationError, InadmissibleMaterialError
        """
        return Discretisation.of(self, sharp_tips, constrained)

    def solve(self, tolerance: float = 1e-10, **options: Any) -> Solution:
        """Static (or steady) solution; see `solver.analyses.statics.solve`."""

        return solve(self.discretise(constrained=True), tolerance=tolerance, **options)
