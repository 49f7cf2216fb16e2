"""Fields of the closed forms: crack tip, hole, polynomials, conduction, waves."""

from __future__ import annotations

from typing import Any

import numpy as np

from cmverify.case import Measurement
from cmverify.cases.closed_forms.differences import (
    CONDUCTIVITY,
    SEED,
    TENSOR,
    Field,
    around,
    elastic_identities,
    slopes,
)
from cmverify.judge.norms import relative_l2, worst


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
