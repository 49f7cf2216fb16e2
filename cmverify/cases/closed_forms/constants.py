"""Constants: laws of toughness, turned tensors, kinks, shape factors."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from cmverify.case import Array, Measurement
from cmverify.cases.closed_forms.differences import TENSOR
from cmverify.cases.common import materials
from cmverify.judge.norms import relative_l2, worst


def toughness(_: int) -> Measurement:
    """Constants of the laws of w_c and the integrals of Eq. 92, by a plain sum over angles."""
    from references.analytic import toughness as forms

    psi = (np.arange(200_000) + 0.5) / 200_000 * np.pi - np.pi / 2

    def cost(critical: Callable[[Array], Array], axis: float) -> float:
        """h δ³/3 ∫ w_c(ψ − ζ) cos ψ dψ over the half circle (the errata prove it of Eq. 92)."""
        return float((critical(psi - axis) * np.cos(psi)).mean() * np.pi / 3)

    two, four = [], []
    for n in (2, 4, 8):
        w1, w2 = forms.two_lobe_constants(1.8, 1.0, n, 1.0)
        law = partial(lambda w1, w2, n, a: w2 + (w1 - w2) * np.cos(a) ** n, w1, w2, n)
        two += [abs(cost(law, 0.0) / 1.8 - 1), abs(cost(law, np.pi / 2) - 1)]
    w1, w2 = forms.fourfold_constants(0.84, 1.0, 1.0)
    law4 = partial(lambda w1, w2, a: w2 + (w1 - w2) * np.cos(2 * a) ** 4, w1, w2)
    four += [abs(cost(law4, 0.0) / 0.84 - 1), abs(cost(law4, np.pi / 4) - 1)]
    zeta = np.array([0.0, 0.4, 1.1])
    wanted = [cost(law, z) for z in zeta]
    return Measurement(
        0,
        {
            "two lobes": worst(two),
            "four lobes": worst(four),
            "quadrature": abs(forms.fracture_energy(law, 1.0) / wanted[0] - 1.0),
            "turned": relative_l2(forms.effective_energy(law, zeta, 1.0), wanted),
        },
    )


def tensors(_: int) -> Measurement:
    """Turned axes, isotropic solids, speeds of waves, the homogenised block lattice."""
    from references.analytic import christoffel, tetrachiral, voigt
    from references.lattice.blocks import cell_voigt, paper_cell

    angle = 0.3
    c, s = np.cos(angle), np.sin(angle)
    basis = np.array([[c, s], [-s, c]])  # components in axes turned anticlockwise
    strain = np.array([[1.0, 0.3], [0.3, -0.4]])
    own = basis @ strain @ basis.T

    def vector(e: Array) -> Array:
        return np.array([e[0, 0], e[1, 1], 2 * e[0, 1]])

    before = vector(strain) @ TENSOR @ vector(strain)
    after = vector(own) @ voigt.turned_axes(TENSOR, angle) @ vector(own)
    # Uniaxial stress: strain 1/E along it and −ν/E across; in plane strain with σ33 = ν (σ11 + …).
    young, nu, density = 2.0, 0.3, 7.0
    stress = np.linalg.inv(voigt.isotropic_voigt(young, nu, "stress"))
    plane = np.linalg.inv(voigt.isotropic_voigt(young, nu, "strain"))
    wanted = np.array([1.0, -nu, 2 * (1 + nu)]) / young
    strained = np.array([1 - nu**2, -nu * (1 + nu), 2 * (1 + nu)]) / young
    stiffness = voigt.isotropic_voigt(young, nu)
    fast, slow = np.moveaxis(christoffel.wave_speeds(stiffness, density, np.array([0.2])), -1, 0)
    speeds = np.array([young / (1 - nu**2), young / (2 * (1 + nu))]) / density
    cell = paper_cell()
    kn, kt = tetrachiral.interface_stiffness(10e6, 0.25, 0.01, 1e-4)
    given = tetrachiral.effective_voigt(*cell.springs[:2], cell.angle)
    return Measurement(
        0,
        {
            "turned energy": float(abs(after / before - 1.0)),
            "plane stress": relative_l2([stress[0, 0], stress[0, 1], stress[2, 2]], wanted),
            "plane strain": relative_l2([plane[0, 0], plane[0, 1], plane[2, 2]], strained),
            "speeds": relative_l2([fast[0] ** 2, slow[0] ** 2], speeds),
            "blocks": relative_l2(given, cell_voigt(cell)),
            # A layer of thickness t and length l: E/(1 − ν²) l/t and G l/t.
            "interface": relative_l2([kn, kt], [100 * 10e6 / (1 - 0.0625), 100 * 10e6 / 2.5]),
        },
    )


def cracks(_: int) -> Measurement:
    """Kinks, the compact specimen, the potential drop across a crack."""
    from references.analytic import compact_tension, kinking, lekhnitskii, potential_drop
    from references.tables import stored_kinks

    isotropic = materials.isotropic(0.3)
    hoop, _shear = kinking.hoop_factors(isotropic, np.array([0.0, 0.4]), 1.0, 0.0)
    # In isotropic bodies K_ww = cos³(ω/2) in mode I and the kink of mode II is at −70.53°.
    sliding = kinking.hoop_kink_angle(isotropic, 0.0, 1.0)
    own = kinking.hoop_kink_angle(TENSOR, 1.0, 0.3)
    around_it = kinking.hoop_factors(TENSOR, own + np.array([-1e-4, 0.0, 1e-4]), 1.0, 0.3)
    table = stored_kinks("anisotropic")
    rate0 = table.energy_release_rate(1.0, 0.3, np.array([0.0]))[0]
    best = table.kink_angle(1.0, 0.3)
    rates = table.energy_release_rate(1.0, 0.3, best + np.radians([-0.5, 0.0, 0.5]))
    flat = (rates[2] - rates[0]) / (2 * rates[1] - rates[0] - rates[2])
    # Image of the strip: φ = Re arccosh-like map; a probe far away reads the uncracked strip's
    # drop and −(2 W/π) log cos(π a/2W) more.
    far, ratio = 30.0, 0.4
    drop = potential_drop.johnson(ratio, far)
    more = 1.0 - np.log(np.cos(0.5 * np.pi * ratio)) / (0.5 * np.pi * far)
    return Measurement(
        0,
        {
            "hoop factors": relative_l2(hoop, np.cos([0.0, 0.2]) ** 3),
            "mode II": abs(np.degrees(sliding) + np.degrees(np.arccos(1 / 3))),
            "hoop maximum": float(abs(around_it[1][1]) / around_it[0][1]),
            "largest release": float(abs(0.5 * flat * 0.5)),
            "release at 0": float(
                abs(rate0 / lekhnitskii.energy_release_rate(table.voigt, 1.0, 0.3) - 1.0)
            ),
            # ASTM E399 tabulates 9.66 at a/W = 1/2.
            "compact": float(abs(compact_tension.shape_factor(0.5) / 9.66 - 1.0)),
            "drop": float(abs((drop - 1.0) / (more - 1.0) - 1.0)),
        },
    )
