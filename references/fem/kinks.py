"""Energy release rate of a short kink, by finite elements, for any plane anisotropic tensor.

The energy criterion (the crack kinks where G is largest) stands beside the hoop-stress criterion.
A disc carries the crack-tip field of K_I, K_II on its circle; a kink far shorter than the disc's
radius leaves the old tip at an angle. The stress intensity factors at the kink's tip are linear in
the old ones,

    k(ω) = F(ω) K,    G(ω) = kᵀ A(ω) k,

so that one mesh and two load cases serve every mixity at that angle. For an isotropic body F is
Amestoy and Leblond's (Int. J. Solids Struct. 29 (1992) 465).
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from references.analytic.lekhnitskii import crack_tip_displacement, energy_release_rate
from references.fem.elasticity import solve_elasticity
from references.fem.interaction import stress_intensity
from references.fem.mesh import Mesh, crack_tip_disc, disc


def kink_mesh(angle: float, kink: float = 1e-4, growth: float = 0.15) -> Mesh:
    """Unit disc with a crack from (−1, 0) to its centre and a kink from there.

    Parameters
    ----------
    angle : float
        ω of the kink, rad, |ω| < 2.6; for ω = 0 there is none.
    kink : float
        Its length.
    growth : float
        Of the elements away from the two tips, per unit length.

    Raises
    ------
    ValueError
        For an angle that folds the kink back onto the crack, or a kink that is not short.
    """
    if not abs(angle) < 2.6:
        raise ValueError("the kink's angle must lie between −2.6 and 2.6 rad")
    if not 1e-5 <= kink <= 0.1:
        raise ValueError("the kink must be short: 1e-5 to 0.1 of the disc's radius")
    if abs(angle) < 1e-9:
        return crack_tip_disc(0.15, tip_size=kink / 100, growth=growth)
    tip = (kink * float(np.cos(angle)), kink * float(np.sin(angle)))
    cracks = [((-1.0, 0.0), (0.0, 0.0)), ((0.0, 0.0), tip)]
    return disc(0.15, cracks=cracks, tip_size=kink / 100, growth=growth)


def kink_matrix(
    voigt: ArrayLike,
    angle: float,
    kink: float = 1e-4,
    growth: float = 0.15,
    mesh: Mesh | None = None,
) -> NDArray[np.float64]:
    """F(ω): stress intensity factors at the tip of a short kink for unit K_I and unit K_II.

    Parameters
    ----------
    voigt : (3, 3) array_like
        The old crack lies along the negative axis 1.
    angle, kink, growth : float
        See :func:`kink_mesh`; F is right to about the kink's length.
    mesh : Mesh, optional
        That of :func:`kink_mesh` if it is there already.

    Returns
    -------
    (2, 2) float array
        k_I, k_II (rows) in the kink's own axes for K_I = 1 and K_II = 1 (columns).
    """
    mesh = kink_mesh(angle, kink, growth) if mesh is None else mesh
    tip = mesh.tips[0]
    # a kink that turns back comes near the old crack, which the ring must not touch
    ring = kink * (0.7 if abs(angle) <= np.pi / 2 else min(0.7, 0.9 * float(np.sin(abs(angle)))))
    columns = []
    for mode in ((1.0, 0.0), (0.0, 1.0)):

        def field(x, y, mode=mode):  # type: ignore[no-untyped-def]
            return crack_tip_displacement(voigt, x, y, *mode)

        solution = solve_elasticity(mesh, voigt, field)
        found = stress_intensity(solution, tip, float(angle), ring)
        columns.append([found.KI, found.KII])
    return np.array(columns).T


def _quadratic(
    voigt: NDArray[np.float64], k1: NDArray[np.float64], k2: NDArray[np.float64]
) -> NDArray[np.float64]:
    """G for factors in the reference axes, opening along axis 2 and sliding along axis 1."""
    opening, sliding, both = (
        energy_release_rate(voigt, *mode) for mode in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0))
    )
    return opening * k1**2 + sliding * k2**2 + (both - opening - sliding) * k1 * k2


@dataclass(frozen=True)
class KinkTable:
    """F(ω) at some angles, with a polynomial through them.

    F is analytic in ω, and each of its meshes errs by some 1e-4 in its own way: a least-squares
    polynomial (degree 12 for a table of 19 angles or more) averages that out; the angle of the
    largest G, where G is flat, needs it.

    Attributes
    ----------
    voigt : (3, 3) float array
    angles : (k,) float array
        Ascending, rad.
    matrices : (k, 2, 2) float array
    """

    voigt: NDArray[np.float64]
    angles: NDArray[np.float64]
    matrices: NDArray[np.float64]

    def at(self, angle: NDArray[np.float64]) -> NDArray[np.float64]:
        """F (..., 2, 2) at angles inside the table."""
        middle, half = self.angles[[0, -1]].mean(), np.ptp(self.angles) / 2
        degree = min(12, max(3, 2 * len(self.angles) // 3))
        coefficients = chebyshev.chebfit(
            (self.angles - middle) / half, self.matrices.reshape(-1, 4), degree
        )
        values = chebyshev.chebval((np.asarray(angle, dtype=float) - middle) / half, coefficients)
        return np.moveaxis(values, 0, -1).reshape(*np.shape(angle), 2, 2)

    def energy_release_rate(self, KI: float, KII: float, angle: ArrayLike) -> NDArray[np.float64]:
        """G of a short kink at angles inside the table, J/m² (shape of ``angle``).

        Raises
        ------
        ValueError
            For an angle outside the table.
        """
        wanted = np.asarray(angle, dtype=float)
        if wanted.min() < self.angles[0] or wanted.max() > self.angles[-1]:
            raise ValueError("the angle lies outside the table")
        k1, k2 = np.moveaxis(self.at(wanted) @ [KI, KII], -1, 0)
        c, s = np.cos(wanted), np.sin(wanted)
        # G is a quadratic form of the kink's factors that turns with it like a tensor (half the
        # inverse of Barnett and Lothe's): sliding along the kink, opening across it.
        return _quadratic(self.voigt, k2 * s + k1 * c, k2 * c - k1 * s)

    def kink_angle(self, KI: float, KII: float) -> float:
        """Angle of the largest G, rad; faces that would close (k_I < 0) do not count.

        Raises
        ------
        ValueError
            If the largest G lies at the table's edge, or no angle opens the kink.
        """
        fine = np.linspace(self.angles[0], self.angles[-1], 721)
        opening = (self.at(fine) @ [KI, KII])[:, 0] > 0
        if not opening.any():
            raise ValueError("no kink in the table's range opens under this load")
        rate = np.where(opening, self.energy_release_rate(KI, KII, fine), -np.inf)
        best = int(rate.argmax())
        if best in (0, len(fine) - 1):
            raise ValueError("the largest energy release rate lies at the table's edge: widen it")
        around = fine[best - 1 : best + 2]
        # vertex of the parabola through the three largest
        a, b, _ = np.polyfit(around - fine[best], rate[best - 1 : best + 2], 2)
        return float(fine[best] - b / (2 * a)) if np.isfinite(a) and a < 0 else float(fine[best])


def kink_table(
    voigt: ArrayLike, angles: ArrayLike, kink: float = 1e-4, growth: float = 0.15
) -> KinkTable:
    """F(ω) at the given ascending angles (see :func:`kink_matrix`)."""
    ordered = np.asarray(angles, dtype=float)
    if ordered.ndim != 1 or len(ordered) < 4 or (np.diff(ordered) <= 0).any():
        raise ValueError("a table needs four ascending angles at least")
    matrices = np.stack([kink_matrix(voigt, float(w), kink, growth) for w in ordered])
    return KinkTable(np.asarray(voigt, dtype=float), ordered, matrices)
