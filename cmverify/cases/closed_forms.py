"""The closed forms that judge everything else, judged by what they have to satisfy.

Derivatives are central differences of fourth order, energies and fluxes are integrated: nothing
of a formula is used to check it. A closed form that is wrong by a per cent in one of its parts
(displacement, stress, rotation, flux, source, a constant) breaks an identity here, before any
solver is compared with it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from cmverify.case import Array, Case, Check, Level, Measurement, Method
from cmverify.cases.common import materials
from cmverify.judge.norms import relative_l2, worst

STEP = 1e-3  # of the differences; their error is some 1e-12 of the fourth derivative
SEED = 2022
TENSOR = materials.TENSORS["fully anisotropic"] / 100.0
CONDUCTIVITY = np.array([[5.0, 2.0], [2.0, 1.0]])  # Eq. 168
Field = Callable[[Array, Array], Array]


def slopes(function: Field, x: Array, y: Array, step: float = STEP) -> Array:
    """∂f/∂x and ∂f/∂y along a new last axis, by differences of fourth order."""

    def along(dx: float, dy: float) -> Array:
        near = function(x + dx, y + dy) - function(x - dx, y - dy)
        far = function(x + 2 * dx, y + 2 * dy) - function(x - 2 * dx, y - 2 * dy)
        return np.asarray((8 * near - far) / (12 * step))

    return np.stack([along(step, 0.0), along(0.0, step)], axis=-1)


def elastic_identities(
    voigt: Array, displacement: Field, stress: Field, x: Array, y: Array
) -> dict[str, float]:
    """Hooke's law between displacement and stress, and balance of the stress, relative."""
    du = slopes(displacement, x, y)
    strain = np.stack([du[..., 0, 0], du[..., 1, 1], du[..., 0, 1] + du[..., 1, 0]], axis=-1)
    ds = slopes(stress, x, y)
    force = np.stack([ds[..., 0, 0] + ds[..., 2, 1], ds[..., 2, 0] + ds[..., 1, 1]], axis=-1)
    return {
        "Hooke": relative_l2(stress(x, y), strain @ voigt),
        "balance": float(np.linalg.norm(force) / np.linalg.norm(ds)),
    }


def around(radius: float = 0.5, count: int = 40) -> tuple[Array, Array]:
    """Points on a circle, none of them on the negative axis 1."""
    angle = -np.pi + (np.arange(count) + 0.5) * 2 * np.pi / count
    return radius * np.cos(angle), radius * np.sin(angle)


def crack_tip(_: int) -> Measurement:
    """The field of Sih, Paris and Irwin, for K_I = 1 and K_II = 1/2."""
    from references.analytic import lekhnitskii
    from references.analytic.crack_series import crack_tip_term
    from references.analytic.interaction import intensities

    K = (1.0, 0.5)
    u: Field = lambda x, y: lekhnitskii.crack_tip_displacement(TENSOR, x, y, *K)  # noqa: E731
    s: Field = lambda x, y: lekhnitskii.crack_tip_stress(TENSOR, x, y, *K)  # noqa: E731
    x, y = around()
    du = slopes(u, x, y)
    gradient = lekhnitskii.crack_tip_gradient(TENSOR, x, y, *K)
    rotation = lekhnitskii.crack_tip_rotation(TENSOR, x, y, *K)
    r = np.array([0.1, 0.5, 2.0])
    ahead, face = s(r, 0 * r), s(-r, 1e-12 * r)
    # Irwin: closing the crack by Δ does the work ½ ∫ σ(r) Δu(Δ − r) dr, of 1/√r and √(Δ − r).
    jump = (u(np.array([-1.0]), np.array([1e-15])) - u(np.array([-1.0]), np.array([-1e-15])))[0]
    closed = np.pi / 4 * (ahead[1, 1] * jump[1] + ahead[1, 2] * jump[0]) * np.sqrt(r[1])
    term = crack_tip_term(TENSOR, x, y, 1)
    # A ring of 0.4 to 0.8, by the midpoint rule in polar coordinates.
    radii = 0.4 + 0.4 * (np.arange(80) + 0.5) / 80
    angle = -np.pi + (np.arange(360) + 0.5) * 2 * np.pi / 360
    R, W = np.meshgrid(radii, angle, indexing="ij")
    px, py = R * np.cos(W), R * np.sin(W)
    weight = R * (0.4 / 80) * (2 * np.pi / 360)
    found = intensities(
        TENSOR, np.stack([px, py], -1), slopes(u, px, py, 1e-4), weight, 0.0, 0.4, 0.8
    )
    return Measurement(
        0,
        {
            **elastic_identities(TENSOR, u, s, x, y),
            "gradient": relative_l2(gradient, du),
            "rotation": relative_l2(rotation, 0.5 * (du[..., 1, 0] - du[..., 0, 1])),
            "K of the stress": relative_l2(
                ahead[:, 1:] * np.sqrt(2 * np.pi * r)[:, None], np.broadcast_to(K, (3, 2))
            ),
            "edge": float(np.abs(face[:, 1:]).max() / np.abs(face[:, 0]).max()),
            "closure": abs(closed / lekhnitskii.energy_release_rate(TENSOR, *K) - 1.0),
            "term of order 1": relative_l2(K[0] * term[0] + K[1] * term[1], u(x, y)),
            "interaction": relative_l2(found, K),
        },
    )


def hole(_: int) -> Measurement:
    """Lekhnitskii's plate with a round hole under a remote stress of all components."""
    from references.analytic.hole import edge_hoop_stress, hole_displacement, hole_stress

    remote = (1.0, -0.4, 0.25)
    u: Field = lambda x, y: hole_displacement(TENSOR, x, y, 1.0, 1.0, remote)  # noqa: E731
    s: Field = lambda x, y: hole_stress(TENSOR, x, y, 1.0, 1.0, remote)  # noqa: E731
    nx, ny = around(1.0)
    edge = s(nx, ny)
    traction = np.stack([edge[:, 0] * nx + edge[:, 2] * ny, edge[:, 2] * nx + edge[:, 1] * ny], -1)
    far = s(*around(1e6))
    pulled = hole_stress(TENSOR, nx, ny, 1.0, 1.0, (1.0, 0.0, 0.0))
    hoop = pulled[:, 0] * ny**2 + pulled[:, 1] * nx**2 - 2 * pulled[:, 2] * nx * ny
    return Measurement(
        0,
        {
            **elastic_identities(TENSOR, u, s, *around(1.7)),
            "edge": float(np.abs(traction).max()),
            "far": relative_l2(far, np.broadcast_to(remote, far.shape)),
            "hoop": relative_l2(edge_hoop_stress(TENSOR, np.arctan2(ny, nx)), hoop),
        },
    )


def polynomials(_: int) -> Measurement:
    """Polynomial displacements, in equilibrium and under a body force."""
    from references.analytic.elasticity import (
        PolynomialDisplacement,
        combine,
        equilibrium_polynomials,
    )

    generator = np.random.default_rng(SEED)
    fields = [f for degree in (1, 2, 3, 4) for f in equilibrium_polynomials(TENSOR, degree)]
    exact = combine(fields, generator.normal(size=len(fields)).tolist())
    x, y = around()
    du = slopes(exact.displacement, x, y)
    forced = PolynomialDisplacement(TENSOR, generator.normal(size=(2, 4, 4)))
    ds = slopes(forced.stress, x, y)
    force = -np.stack([ds[..., 0, 0] + ds[..., 2, 1], ds[..., 2, 0] + ds[..., 1, 1]], axis=-1)
    return Measurement(
        0,
        {
            **elastic_identities(TENSOR, exact.displacement, exact.stress, x, y),
            "rotation": relative_l2(exact.rotation(x, y), 0.5 * (du[..., 1, 0] - du[..., 0, 1])),
            "body force": relative_l2(forced.body_force(x, y), force),
        },
    )


def _flux_of(function: Field) -> Field:
    return lambda x, y: -slopes(function, x, y) @ CONDUCTIVITY


def conduction(_: int) -> Measurement:
    """Temperatures, fluxes and sources of every closed form of conduction."""
    from references.analytic import conduction as forms

    steady: list[Any] = [
        forms.disc_cubic(),
        forms.disc_cubic_printed(),
        forms.disc_exponential(),
        forms.PointSource(CONDUCTIVITY, 3.0, (2.0, 0.1)),
    ]
    x, y = around()
    gradient, flux, source = [], [], []
    for f in steady:
        gradient.append(relative_l2(f.gradient(x, y), slopes(f.value, x, y)))
        flux.append(relative_l2(f.flux(x, y), _flux_of(f.value)(x, y)))
        dq = slopes(f.flux, x, y)
        given = np.broadcast_to(f.source(x, y), x.shape)
        missing = given - dq[..., 0, 0] - dq[..., 1, 1]
        source.append(float(np.linalg.norm(missing) / np.linalg.norm(dq)))
    printed = relative_l2(forms.disc_cubic_printed().source(x, y), 0.8 * y)
    # The first two by Eq. 169 at a point, with x2³/3 and x2³/5.
    values = [f.value(np.array(0.3), np.array(-0.2)) for f in steady[:2]]
    apart = abs((values[0] - values[1]) / ((1 / 3 - 1 / 5) * (-0.2) ** 3) - 1.0)
    own = np.exp(x - 2 * y) * np.cos(y)
    # Through a circle about it flows what a point source gives off.
    point = steady[-1]
    cx, cy = around(0.3, 400)
    through = point.flux(cx + 2.0, cy + 0.1)
    power = float((through[:, 0] * cx + through[:, 1] * cy).sum() * 2 * np.pi / 400)
    pulse = forms.InstantaneousSource(CONDUCTIVITY, 3.0, 0.7)
    side = np.linspace(-12.0, 12.0, 401)
    X, Y = np.meshgrid(side, side)
    heat = 0.7 * pulse.value(X, Y, 0.4).sum() * (side[1] - side[0]) ** 2
    late, early = (pulse.value(x, y, 0.4 + dt) for dt in (1e-4, -1e-4))
    rate = (late - early) / 2e-4
    dq = slopes(lambda a, b: pulse.flux(a, b, 0.4), x, y)
    return Measurement(
        0,
        {
            "gradient": worst(gradient),
            "flux": worst(flux),
            "source": worst(source),
            "printed source": printed,
            "coefficient": float(apart),
            "exponential": relative_l2(steady[2].value(x, y), own),
            "power": abs(power / 3.0 - 1.0),
            "heat": float(abs(heat / 3.0 - 1.0)),
            "rate": relative_l2(pulse.rate(x, y, 0.4), rate),
            "storage": relative_l2(-(dq[..., 0, 0] + dq[..., 1, 1]), 0.7 * rate),
            "pulse flux": relative_l2(
                pulse.flux(x, y, 0.4), _flux_of(lambda a, b: pulse.value(a, b, 0.4))(x, y)
            ),
        },
    )


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


def waves(_: int) -> Measurement:
    """Plane waves in an anisotropic solid, and the half-plane under a pulse (Lamb)."""
    from scipy.integrate import quad, simpson

    from references.analytic import christoffel, lamb

    # A plane wave u = d f(n·x − c t): the traction C : (n ⊗ d) on n carries ρ c² d.
    density, angle = 7.0, np.linspace(0.0, np.pi, 24, endpoint=False)
    n = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    d = christoffel.polarisations(TENSOR, angle)
    speed = christoffel.wave_speeds(TENSOR, density, angle)
    strain = np.stack(
        [
            n[:, :1] * d[:, 0],
            n[:, 1:] * d[:, 1],
            n[:, 1:] * d[:, 0] + n[:, :1] * d[:, 1],
        ],
        axis=1,
    )
    stress = np.einsum("ij,ajk->aik", TENSOR, strain)
    traction = np.stack(
        [
            n[:, :1] * stress[:, 0] + n[:, 1:] * stress[:, 2],
            n[:, :1] * stress[:, 2] + n[:, 1:] * stress[:, 1],
        ],
        axis=1,
    )

    # Lamb's edge: its Laplace transform in time against Rayleigh's integral over wave numbers,
    # w(x, s) = Q(s)/(π μ) ∫ α k_S² cos(k x) / [(2k² + k_S²)² − 4k² α β] dk over k > 0.
    lame, rho, s, x, half, width = (2 / 3, 1.3), 1.1, 2.0, 1.0, 0.4, 0.5
    c_p, c_s = np.sqrt((lame[0] + 2 * lame[1]) / rho), np.sqrt(lame[1] / rho)

    def pulse(t: Any) -> Any:
        return np.exp(-(((t - 2.0) / width) ** 2))

    def transform(k: float) -> float:
        alpha, beta = np.sqrt(k * k + (s / c_p) ** 2), np.sqrt(k * k + (s / c_s) ** 2)
        shear = (s / c_s) ** 2
        return float(alpha * shear / ((2 * k * k + shear) ** 2 - 4 * k * k * alpha * beta))

    def line(distance: float) -> float:
        return float(quad(transform, 0.0, np.inf, weight="cos", wvar=distance)[0])

    t = np.linspace(0.0, 9.0, 61)
    seen = lamb.edge_displacement(x, t, pulse, width, lame, rho, half)
    found = simpson(seen * np.exp(-s * t), x=t)
    nodes, weights = np.polynomial.legendre.leggauss(7)
    strip = half * sum(w * line(x - half * q) for q, w in zip(nodes, weights, strict=True))
    source = simpson(pulse(t) * np.exp(-s * t), x=t)
    wanted = source * strip / (np.pi * lame[1])

    # Rayleigh's wave leaves the edge free: its pole is the root of the transform's denominator.
    c_r = lamb.rayleigh_speed(c_p, c_s)
    fast, slow = np.sqrt(1 - (c_r / c_p) ** 2), np.sqrt(1 - (c_r / c_s) ** 2)
    return Measurement(
        0,
        {
            "polarised": relative_l2(traction, density * speed[:, None, :] ** 2 * d),
            "half-plane": float(abs(found / wanted - 1.0)),
            "Rayleigh": float(abs((2 - (c_r / c_s) ** 2) ** 2 - 4 * fast * slow)),
        },
    )


def elements(_: int) -> Measurement:
    """Finite elements on fields that they can be exact for: linear ones, under their tractions."""
    from references.fem.conduction import steady_conduction
    from references.fem.elasticity import solve_elasticity
    from references.fem.mesh import rectangle

    body = rectangle(2.0, 1.0, 0.4)
    s11, s22, s12 = stress = np.array([1.0, -0.4, 0.3])
    e11, e22, shear = np.linalg.solve(TENSOR, stress)
    sides = {"left": (-1, 0), "right": (1, 0), "bottom": (0, -1), "top": (0, 1)}
    tractions = {
        name: (s11 * n1 + s12 * n2, s12 * n1 + s22 * n2) for name, (n1, n2) in sides.items()
    }
    x, y = around(0.4, 12)
    points = np.column_stack([x, y])
    found = {"stress": 0.0, "strain": 0.0, "flux": 0.0, "temperature": 0.0}
    for order in (1, 2):
        loaded = solve_elasticity(body, TENSOR, tractions=tractions, order=order)
        du = loaded.gradient_at(points)
        strain = np.stack([du[:, 0, 0], du[:, 1, 1], du[:, 0, 1] + du[:, 1, 0]], axis=-1)
        # Rigid motions aside, displacements are their differences.
        u = loaded.at(points) - loaded.at(-points)
        w = 0.5 * (du[0, 1, 0] - du[0, 0, 1])
        slope = np.array([[e11, shear / 2 - w], [shear / 2 + w, e22]])
        heat = steady_conduction(body, CONDUCTIVITY, lambda x, y: x - 2 * y, order=order)
        flux = np.broadcast_to(-CONDUCTIVITY @ [1.0, -2.0], (len(x), 2))
        for name, error in (
            ("stress", relative_l2(loaded.stress_at(points), np.broadcast_to(stress, (12, 3)))),
            ("strain", relative_l2(strain, np.broadcast_to([e11, e22, shear], (12, 3)))),
            ("difference", relative_l2(u, 2 * points @ slope.T)),
            ("flux", relative_l2(heat.flux_at(points), flux)),
            ("temperature", relative_l2(heat.at(points), x - 2 * y)),
        ):
            found[name] = worst((found.get(name, 0.0), error))
    return Measurement(loaded.unknowns, found)


DIFFERENCES = "identity; differences of fourth order with a margin"
METHODS: dict[str, tuple[Callable[[int], Measurement], dict[str, float], str]] = {
    "crack tip": (
        crack_tip,
        {
            "Hooke": 1e-9, "balance": 1e-9, "gradient": 1e-9, "rotation": 1e-9, "edge": 1e-9,
            "K of the stress": 1e-9, "closure": 1e-6, "term of order 1": 1e-9, "interaction": 1e-3,
        },
        DIFFERENCES,
    ),
    "hole": (
        hole, dict.fromkeys(("Hooke", "balance", "edge", "far", "hoop"), 1e-9), DIFFERENCES
    ),
    "polynomials": (
        polynomials,
        dict.fromkeys(("Hooke", "balance", "rotation", "body force"), 1e-9),
        DIFFERENCES,
    ),
    "conduction": (
        conduction,
        {
            **dict.fromkeys(
                (
                    "gradient", "flux", "source", "printed source", "coefficient", "exponential",
                    "power", "pulse flux",
                ),
                1e-8,
            ),
            "rate": 1e-6, "storage": 1e-6, "heat": 2e-6,
        },
        DIFFERENCES,
    ),
    "toughness": (
        toughness,
        dict.fromkeys(("two lobes", "four lobes", "quadrature", "turned"), 1e-6),
        "a plain sum over angles",
    ),
    "tensors": (
        tensors,
        dict.fromkeys(
            ("turned energy", "plane stress", "plane strain", "speeds", "blocks", "interface"),
            1e-10,
        ),
        "definition",
    ),
    "waves": (
        waves,
        {"polarised": 1e-10, "half-plane": 1e-5, "Rayleigh": 1e-9},
        "balance of a plane wave; Rayleigh's integral in Laplace's transform",
    ),
    "finite elements": (
        elements,
        dict.fromkeys(("stress", "strain", "difference", "flux", "temperature"), 1e-10),
        "linear fields are exact on any mesh",
    ),
    "cracks": (
        cracks,
        {
            "hoop factors": 1e-9, "mode II": 1e-3, "hoop maximum": 1e-3, "largest release": 0.2,
            "release at 0": 2e-3, "compact": 1e-3, "drop": 1e-6,
        },
        "isotropic bodies, maxima, ASTM E399, the far field",
    ),
}  # fmt: skip

QUANTITIES = {
    "Hooke": "stress against the stiffness times the differences of the displacement",
    "balance": "divergence of the stress over the size of its derivatives",
    "gradient": "gradient against differences",
    "rotation": "rotation against half the curl of the differences",
    "body force": "body force against the divergence of the stress",
    "K of the stress": "σ₂₂ √(2πr) and σ₁₂ √(2πr) ahead of the tip against K_I and K_II",
    "edge": "traction on the free edge, relative",
    "closure": "energy release rate against the work that closes the crack (Irwin)",
    "term of order 1": "the series' term of order 1 against the field of the tip",
    "interaction": "the interaction integral on a fine ring against the K prescribed",
    "far": "stress far from the hole against the remote one",
    "hoop": "hoop stress at the edge against the stress there",
    "flux": "flux against −D times differences",
    "source": "source against the divergence of the flux, over the size of its derivatives",
    "printed source": "the source that Eq. 169 as printed needs against 0.8 x₂",
    "coefficient": "difference of the cubics with x₂³/3 and x₂³/5",
    "exponential": "exp(x₁ − 2x₂) cos x₂ itself",
    "power": "flux through a circle about a point source against its power",
    "heat": "heat of a pulse over the plane against what was released",
    "rate": "rate of a pulse's temperature against differences in time",
    "storage": "divergence of the pulse's flux against ρc times that rate",
    "pulse flux": "flux of a pulse against −D times differences",
    "two lobes": "what cuts along and across cost with the constants of Eqs. 97–99",
    "four lobes": "the same with those of Eq. 103",
    "quadrature": "Eq. 92 by threefold quadrature",
    "turned": "the law's effective fracture energy at other angles",
    "turned energy": "energy of a strain in turned axes",
    "plane stress": "strains of an isotropic solid under uniaxial stress, plane stress",
    "plane strain": "the same in plane strain",
    "speeds": "squares of the wave speeds of an isotropic solid",
    "polarised": "traction of a plane wave against ρ c² times its displacement",
    "half-plane": "Laplace transform of Lamb's edge displacement against Rayleigh's integral",
    "Rayleigh": "Rayleigh's determinant at the speed of his wave",
    "blocks": "Eqs. 87–90 against the homogenised cell of the rigid-block lattice",
    "interface": "Eq. 86 for round numbers",
    "hoop factors": "hoop factors of mode I in an isotropic body against cos³(ω/2)",
    "mode II": "hoop kink angle of mode II against −70.53° in an isotropic body, degrees",
    "hoop maximum": "shear factor in the direction of the largest hoop factor, over that",
    "largest release": "distance of the stored table's maximum from that of a parabola, degrees",
    "release at 0": "the stored table's release rate without a kink against the closed form",
    "compact": "shape factor of the compact specimen at a/W = 1/2 against ASTM E399's 9.66",
    "stress": "stress of finite elements under the tractions of a homogeneous one",
    "strain": "its strain",
    "difference": "differences of its displacement, rigid motions aside",
    "temperature": "temperature of finite elements, linear field",
    "drop": "Johnson's potential drop far from the crack",
}

CASES = (
    Case(
        name="closed-forms",
        title="Closed forms and stored tables, by identities",
        section="Sects. 2.3, 3 and 4.3",
        tags=("references",),
        shows=(
            "What judges the solver satisfies its own equations: displacement, stress, rotation, "
            "flux and source of every closed form belong together, and their constants are right."
        ),
        methods=tuple(
            Method(f"reference/{name}", "exact", run, dict.fromkeys(Level, (1,)))
            for name, (run, _, _) in METHODS.items()
        ),
        checks=tuple(
            Check(f"reference/{name}", quantity, {1: bound}, source=source, exact=True)
            for name, (_, bounds, source) in METHODS.items()
            for quantity, bound in bounds.items()
        ),
        quantities=QUANTITIES,
        primary="Hooke",
        featured="reference/crack tip",
        length="a",
        timed=False,
    ),
)
