"""A crack in an anisotropic disc that grows under a mixed-mode K-field (Sect. 3.1.1, Figs. 24–27).

A disc of radius a with a crack to its centre carries the displacement and rotation of the
asymptotic field in a layer at its edge. The load follows the crack: it is what the weakest bond
of the batch that breaks can bear, so that a batch of one bond goes along the equilibrium path and
a larger one overdrives the crack. All directions are measured from the crack's, whatever its angle
to the lattice. The toughness is the same in all directions, as in the paper. Units: a = 1, GPa,
G = 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cmverify.case import Array
from cmverify.cases.common import materials
from cmverify.cases.common.scenes import cracked_disc

if TYPE_CHECKING:
    from solver import ElasticTensor, Scene
    from solver.bonds import Surface
    from solver.fracture import Growth, ToughnessCalibration
    from solver.fracture.programme import Control

#: Name here, in `cmverify.cases.common.materials`, in `references.tables.stored_kinks`.
MATERIALS = {"silicon": "silicon", "fully anisotropic": "anisotropic"}
ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 75.0, 90.0)  # α_K, degrees
#: Kinks grow to a quarter of the radius: the edge of the paper's square of side a/2.
REACH = 0.25


@dataclass(frozen=True)
class Kink:
    """One crack to be grown.

    Attributes
    ----------
    material : str
        Its angles by the energy criterion are stored for "silicon" and "fully anisotropic"; any
        other that `materials.named` knows can be grown too.
    mixity : float
        α_K = atan(K_II/K_I), degrees.
    n : int
        Spacing a/n.
    m : int
    front : float
        Bonds that break together, in units of what a straight cut breaks per cell of its length.
        A crack led by few bonds at a time locks onto the rows of the lattice; one led by many
        is driven harder than its toughness asks for.
    turn : float
        Angle of the crack (and of the material with it) to the lattice's axis 1, degrees.
    surface : "none", "volume" or "extrapolated"
    toughness : "lattice", "even" or "directions"
        Whether all bonds share one w_c, those along the lattice's rows are levelled, or cuts along
        every direction of bonds cost the same.
    control : "following" or "fixed"
        With ``fixed`` the load never falls: it rises to the next event and stays until no bond is
        overloaded, and the batch matters little.
    mirrored : bool
        Material and load reflected at the crack's line.
    """

    material: str
    mixity: float
    n: int
    m: int = 5
    front: float = 1.0
    turn: float = 0.0
    surface: Surface = "volume"
    toughness: ToughnessCalibration = "lattice"
    control: Control = "following"
    mirrored: bool = False

    @property
    def voigt(self) -> Array:
        """Stiffness in the crack's axes, GPa."""
        voigt = materials.named(self.material)
        if self.mirrored:
            flip = np.array([1.0, 1.0, -1.0])
            voigt = voigt * np.outer(flip, flip)
        return voigt

    @property
    def factors(self) -> tuple[float, float]:
        """K_I and K_II, of size one, GPa √a."""
        angle = np.radians(-self.mixity if self.mirrored else self.mixity)
        return float(np.cos(angle)), float(np.sin(angle))

    @property
    def axes(self) -> Array:
        """Columns: the crack's axes in those of the lattice."""
        c, s = np.cos(np.radians(self.turn)), np.sin(np.radians(self.turn))
        return np.array([[c, -s], [s, c]])

    def displacement(self, x: Array, y: Array) -> Array:
        """Of the K-field, in the lattice's axes, (..., 2)."""
        from references.analytic.lekhnitskii import crack_tip_displacement

        own = np.stack([x, y], axis=-1) @ self.axes
        return (
            crack_tip_displacement(self.voigt, own[..., 0], own[..., 1], *self.factors)
            @ self.axes.T
        )

    def rotation(self, x: Array, y: Array) -> Array:
        """Of the K-field, rad."""
        from references.analytic.lekhnitskii import crack_tip_rotation

        own = np.stack([x, y], axis=-1) @ self.axes
        return crack_tip_rotation(self.voigt, own[..., 0], own[..., 1], *self.factors)

    def solid(self) -> ElasticTensor:
        """The material in the lattice's axes."""
        from solver import ElasticTensor

        return ElasticTensor(self.voigt).rotated(np.radians(self.turn))


@dataclass(frozen=True)
class Grown:
    """A crack that has grown.

    Attributes
    ----------
    kink : Kink
    path : (n, 2) array
        From the old tip, in the crack's axes.
    marks : (k, 2) array
        Midpoints of broken bonds between nearest neighbours, in the crack's axes.
    run : Growth
    """

    kink: Kink
    path: Array
    marks: Array
    run: Growth


def scene_of(kink: Kink) -> Scene:
    """The disc before its crack grows, under a K-field of size one."""
    from solver import Support

    mouth = -1.5 * kink.axes[:, 0]
    return cracked_disc(
        kink.solid(),
        kink.n,
        Support.layer(cells=kink.m + 0.5, displacement=kink.displacement, rotation=kink.rotation),
        (float(mouth[0]), float(mouth[1])),
        m=kink.m,
        calibration="lattice",
        surface=kink.surface,
    )


def grow_kink(kink: Kink, reach: float = REACH) -> Grown:
    """Let the crack grow until its path leaves the circle of radius `reach` about the old tip."""
    from solver import Programme, Toughness
    from solver.fracture import grow
    from solver.fracture.crack_path import SHORT

    scene = scene_of(kink)
    run = grow(
        scene,
        Toughness(1.0, calibration=kink.toughness),
        Programme(control=kink.control),
        batch=batch(kink),
        tolerance=1e-6,
        until=lambda run: run.advance >= reach,
        max_solves=4_000,
    )
    broken = run.broken_bonds
    short = run.bonds.lengths(broken) <= SHORT * scene.spacing
    return Grown(kink, run.path @ kink.axes, run.midpoints[short] @ kink.axes, run)


def batch(kink: Kink) -> int:
    """Bonds that break together: `front` times those that a level cut breaks per cell.

    Bonds count by their area fractions: 84 of them at m = 5.
    """
    from solver import Family

    family = Family(kink.m)
    cut = float(family.fraction @ np.abs(family.offsets[:, 1])) / 2
    return max(1, round(kink.front * cut))
