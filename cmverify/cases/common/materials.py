"""The solids that cases and studies share, by name: plane Voigt matrices in order 11, 22, 12."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from cmverify.case import Array

if TYPE_CHECKING:
    from solver.material import Calibration

#: What cases and studies compare, in the order in which figures show them.
CALIBRATIONS: tuple[Calibration, ...] = ("lattice", "positive", "continuum")

#: Stiffness in GPa where the source gives units; only ratios matter to a lattice.
TENSORS: dict[str, Array] = {
    # Eq. 106, a wafer of silicon
    "silicon": np.array([[141.1, 39.3, 0.0], [39.3, 141.1, 0.0], [0.0, 0.0, 79.6]]),
    # Eq. 108, bovine cortical bone (Van-Buskirk et al. 1981)
    "bone": np.array([[25.0, 5.89, 0.0], [5.89, 16.25, 0.0], [0.0, 0.0, 6.65]]),
    # Sect. 2.3.1 with C = 100 GPa; Eq. 107 prints it rounded
    "fully anisotropic": 100.0
    * np.array([[1, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]]),
    # the representative anisotropic solid of Fig. 2, C1111 = 1
    "Fig. 2": np.array([[1, 1 / 5, 1 / 10], [1 / 5, 1, 1 / 5], [1 / 10, 1 / 5, 1 / 3]]),
    # a unidirectional carbon/epoxy ply: C11, C22, C12, C66 = 140, 10, 3, 5
    "carbon/epoxy": np.array([[140.0, 3.0, 0.0], [3.0, 10.0, 0.0], [0.0, 0.0, 5.0]]),
}


def isotropic(poisson: float, plane: Literal["stress", "strain"] = "stress") -> Array:
    """Isotropic stiffness with Young's modulus 1."""
    from references.analytic.voigt import isotropic_voigt

    return isotropic_voigt(1.0, poisson, plane)


def orthotropic(e1: float, e2: float, g12: float, nu12: float) -> Array:
    """Plane-stress stiffness of an orthotropic solid along its own axes."""
    compliance = np.array([[1 / e1, -nu12 / e1, 0], [-nu12 / e1, 1 / e2, 0], [0, 0, 1 / g12]])
    return np.linalg.inv(compliance)


def turned(voigt: Array, degrees: float) -> Array:
    """The solid turned anticlockwise, in the reference basis."""
    from references.analytic.voigt import turned_axes

    return turned_axes(voigt, -np.radians(degrees))


def tetrachiral() -> Array:
    """The paper's block lattice (Sect. 2.3.3), homogenised: E = 10 MPa, ν = 1/2, tan β = 1/2."""
    from references.analytic.tetrachiral import effective_voigt, interface_stiffness

    beta, side = np.arctan(0.5), 0.02
    length = (1 - np.tan(beta)) * side
    return effective_voigt(*interface_stiffness(10e6, 0.5, length, side / 500), beta)


def bone_fracture_energies() -> tuple[float, float]:
    """Fracture energies of cortical bone across and along its fibres, J/m² (Sect. 3.1.2).

    From K_cl = 6.5 and K_cr = 4.0 MPa√m (Behiri and Bonfield 1989) by the generalised
    Sih–Paris–Irwin modulus (Eq. 109, whose first line wants the roots in the axes of its crack: a
    crack across the fibres runs along axis 2).
    """
    from references.analytic.lekhnitskii import energy_release_rate

    pascal = 1e9 * TENSORS["bone"]
    across = energy_release_rate(pascal, 6.5e6, 0.0, np.pi / 2)
    return across, energy_release_rate(pascal, 4.0e6, 0.0)


def conductivity(ratio: float, angle: float) -> Array:
    """Conductivity with principal values `ratio` (along `angle`, rad) and 1, shape (2, 2)."""
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    return turn @ np.diag([ratio, 1.0]) @ turn.T


def named(name: str) -> Array:
    """A solid of this module by name, as the command line knows it.

    Besides the names of `TENSORS` and ``tetrachiral``: ``isotropic:NU[:stress|strain]`` and
    ``C11,C22,C12,C66[,C16,C26]``, each optionally followed by ``@DEGREES``.

    Raises
    ------
    ValueError
        If the name means nothing.
    """
    base, _, angle = name.partition("@")
    try:
        voigt = _base(base.strip())
        return turned(voigt, float(angle)) if angle else voigt
    except ValueError as error:
        known = ", ".join([*TENSORS, "tetrachiral"])
        raise ValueError(
            f"no solid is called {name!r} ({error}); known: {known}, isotropic:NU[:strain], or "
            f"C11,C22,C12,C66[,C16,C26]; @DEGREES turns it"
        ) from error


def _base(name: str) -> Array:
    if name in TENSORS:
        return TENSORS[name]
    if name == "tetrachiral":
        return tetrachiral()
    if name.startswith("isotropic:"):
        _, poisson, *plane = name.split(":")
        return isotropic(float(poisson), "strain" if plane == ["strain"] else "stress")
    numbers = [float(part) for part in name.split(",")]
    if len(numbers) not in (4, 6):
        raise ValueError("four or six moduli are needed")
    c11, c22, c12, c66, c16, c26 = (*numbers, 0.0, 0.0)[:6]
    return np.array([[c11, c12, c16], [c12, c22, c26], [c16, c26, c66]])
