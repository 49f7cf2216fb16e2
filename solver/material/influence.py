"""Influence functions Λ: how the strength of a bond falls with its length (Sect. 2).

Calibration needs their radial moments: in elasticity N = δ³ Ξ with Ξ = (π/128) ∫₀¹ ρ² Λ dρ
(π/384 for Λ = 1, Eq. 57), in conduction N_T = δ² Ξ_T with Ξ_T = (π/16) ∫₀¹ ρ Λ dρ
(π/32 for Λ = 1, Eq. 147), ρ = |ξ|/δ.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import Array


@dataclass(frozen=True)
class Influence:
    """A dimensionless Λ(ρ) of the relative bond length ρ = |ξ|/δ.

    Parameters
    ----------
    name : str
        What reports call it.
    function : callable
        Λ(ρ) for ρ ≥ 0, vectorised. Bonds a little longer than the horizon exist (partial
        cells), so it is also evaluated there and clipped at zero.
    """

    name: str
    function: Callable[[Array], Array]

    def __call__(self, rho: Array) -> Array:
        """Return Λ(ρ) ≥ 0, with the shape of `rho`."""
        return np.maximum(self.function(np.asarray(rho, dtype=np.float64)), 0.0)

    def moment(self, power: int) -> float:
        """∫₀¹ ρ^power Λ(ρ) dρ."""
        # Some per cent of what importing the solver takes, for calibrations that few scenes use.
        from scipy.integrate import quad

        return float(quad(lambda r: r**power * float(self(np.array(r))), 0.0, 1.0)[0])


CONSTANT = Influence("constant", lambda r: np.ones_like(r))
CONICAL = Influence("conical", lambda r: 1.0 - r)
GAUSSIAN = Influence("gaussian", lambda r: np.exp(-4.0 * r * r))

_BY_NAME = {i.name: i for i in (CONSTANT, CONICAL, GAUSSIAN)}


def influence(choice: str | Influence) -> Influence:
    """Look an influence function up by name, or pass one through.

    Raises
    ------
    ValueError
        If the name is unknown.
    """
    if isinstance(choice, Influence):
        return choice
    if choice not in _BY_NAME:
        raise ValueError(f"unknown influence function {choice!r}; known: {', '.join(_BY_NAME)}")
    return _BY_NAME[choice]
