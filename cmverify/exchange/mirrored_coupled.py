"""Coupled analyses by finite elements: Joule's heat, strained conductors, motion with heat."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.exchange.finite_elements import Mirror, given, within
from cmverify.exchange.quantities import STRESSES, Quantity, Told, number, stresses

if TYPE_CHECKING:
    from cmverify.exchange.request import Request
    from solver.arrays import Array


def _turned(principal: tuple[float, float], angle_degrees: float) -> Array:
    """The tensor (2, 2) of principal values along turned axes."""
    angle = np.radians(angle_degrees)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return np.asarray(turn @ np.diag(principal) @ turn.T)


def _voigt(expansion: Array) -> Array:
    return np.array([expansion[0, 0], expansion[1, 1], 2 * expansion[0, 1]])


def joule(request: Request, whole: Any, ours: dict[str, Array], *meshes: Mirror) -> Told:
    """Potential, what the current makes of it, temperature, and what it strains."""
    from references.fem.body import Acting, of_solids
    from references.fem.general import solved

    options, points = request.options, whole.points
    angle = options.get("angle_degrees", 0.0)
    rho, k, alpha = (
        _turned(options[name], angle) for name in ("resistivities", "conductivities", "expansions")
    )
    expansion = _voigt(alpha)
    chains = []
    for one in meshes:
        scalar = one.body(1)
        leads = within([(options["plus"], options["voltage"]), (options["minus"], 0.0)])
        current = solved(scalar, of_solids(np.linalg.inv(rho)[None]), leads, Acting())
        heat = solved(
            scalar,
            of_solids(k[None]),
            within([(options["sink"], 0.0)]),
            Acting(volume=[partial(_everywhere, current.heat_at)]),
        )
        acting = one.acting()
        before = acting.strain

        def strain(x: Array, y: Array, which: Any, heat: Any = heat, before: Any = before) -> Array:
            own = np.multiply.outer(expansion, _everywhere(heat.at, x, y))
            return np.asarray(own if before is None else own + before(x, y, which))

        warm = Acting(acting.volume, acting.spread, acting.edge, acting.points, strain)
        mechanics = solved(one.body(2), one.moduli(), one.held(), warm)
        chains.append((current, heat, mechanics))
    (current, heat, mechanics), (current2, heat2, mechanics2) = chains
    fed = ~np.asarray(whole.current.discretisation.held)
    warm_ones = ~np.asarray(whole.heat.discretisation.held)
    free = ~np.asarray(whole.mechanics.discretisation.held)
    both = {
        "potential": (current.at(points), current2.at(points), fed, True),
        "current_density": (current.flux_at(points), current2.flux_at(points), fed, False),
        "joule_heat": (current.heat_at(points), current2.heat_at(points), fed, False),
        "temperature": (heat.at(points), heat2.at(points), warm_ones, True),
        "displacement": (mechanics.at(points), mechanics2.at(points), free, False),
    }
    found = [Quantity(name, ours[name], *rest) for name, rest in both.items()]
    found.append(stresses(ours, mechanics, mechanics2, points, free))
    found.append(number("power supplied", whole.supplied, current.work, current2.work))
    return Told(found)


def _everywhere(function: Callable[[Array], Array], x: Array, y: Array) -> Array:
    """A function of points (n, 2) at places of any shape."""
    return np.asarray(function(np.column_stack([x.ravel(), y.ravel()]))).reshape(x.shape)


def piezoresistive(request: Request, whole: Any, ours: dict[str, Array], *meshes: Mirror) -> Told:
    """The mechanical fields, potentials before and after, and the resistance."""
    from references.analytic.piezoresistive import strained_conductivity
    from references.fem.body import Acting, of_solids
    from references.fem.general import solved

    options, points = request.options, whole.points
    rho = _turned(options["resistivities"], options.get("angle_degrees", 0.0))
    conductivity: Array = np.asarray(np.linalg.inv(rho))
    exponent = _exponent(request, conductivity)
    chains = []
    for one in meshes:
        scalar = one.body(1)
        leads = within([(options["plus"], 1.0), (options["minus"], 0.0)])
        mechanics = solved(one.body(2), one.moduli(), one.held(), one.acting())

        def strained(x: Array, y: Array, which: Any, of: Any = mechanics) -> Array:
            strain = of.gradient_in(np.column_stack([x.ravel(), y.ravel()]))[0]
            found = strained_conductivity(
                conductivity,
                strain.T,
                options["gauge"],
                exponent,
                options.get("law", "conductivity") == "resistivity",
                options.get("length", "reference") == "actual",
            )
            return np.asarray(found.reshape(2, 2, *x.shape))

        bare = solved(scalar, of_solids(conductivity[None]), leads, Acting())
        chains.append((mechanics, bare, solved(scalar, strained, leads, Acting())))
    (mechanics, bare, now), (mechanics2, bare2, now2) = chains
    fed = ~np.asarray(whole.strained.discretisation.held)
    free = ~np.asarray(whole.mechanics.discretisation.held)
    found = [
        Quantity("displacement", ours["displacement"], mechanics.at(points),
                 mechanics2.at(points), free),
        stresses(ours, mechanics, mechanics2, points, free),
        Quantity("potential", ours["potential"], now.at(points), now2.at(points), fed, True),
        Quantity("current_density", ours["current_density"], now.flux_at(points),
                 now2.flux_at(points), fed),
    ]  # fmt: skip
    first = whole.resistances[0], 1.0 / bare.work, 1.0 / bare2.work
    then = whole.resistances[1], 1.0 / now.work, 1.0 / now2.work
    found.append(number("unstrained resistance", *first))
    change = [after / before - 1.0 for after, before in zip(then, first, strict=True)]
    found.append(number("relative change of resistance", *change))
    return Told(found)


def _exponent(request: Request, conductivity: Array) -> int:
    """Of the conductor's angular law: the one asked for, or the smallest that conducts."""
    from references.analytic.piezoresistive import angular_conductivity

    asked = getattr(request.scene.law, "n", None)
    if asked is not None:
        return int(asked)
    angles = np.linspace(0.0, np.pi, 181)
    return next(
        n for n in range(2, 1024, 2) if angular_conductivity(conductivity, n)(angles).min() > -1e-9
    )


def thermoelastic(request: Request, whole: Any, ours: dict[str, Array], *meshes: Mirror) -> Told:
    """Displacement, change of temperature and stress at the end."""
    from references.fem.body import of_solids
    from references.fem.in_time import Start, moved_and_warmed

    options, points = request.options, whole.points
    angle = options.get("angle_degrees", 0.0)
    k, alpha = (_turned(options[name], angle) for name in ("conductivities", "expansions"))
    expansion, sink = _voigt(alpha), options.get("sink")
    material: Any = request.scene.material
    stress = material.voigt @ expansion
    found = []
    for one, finer in zip(meshes, (4, 2), strict=True):
        body, heat, moduli, acting = one.body(2), one.body(1), one.moduli(), one.acting()
        names = (("displacement", 2), ("velocity", 2), ("temperature", 1))
        first, speed, warmth = (
            part.nodal(partial(_initial, options.get(name, 0.0), c))
            for part, (name, c) in zip((body, body, heat), names, strict=True)
        )
        shift, warming = moved_and_warmed(
            body,
            heat,
            body.stiffness(moduli),
            body.mass(one.stored("density")),
            heat.stiffness(of_solids(k[None])),
            heat.mass([options["heat_capacity"]] * len(one.stored("density"))),
            body.coupling(heat, lambda x, y, _: np.multiply.outer(stress, np.ones(x.shape))),
            (body.held(one.held()), _sunk(heat, sink)),
            (body.load(acting, moduli), np.zeros(heat.basis.N)),
            options["reference"],
            Start(first, speed, warmth),
            options["step"] / finer,
            options["steps"] * finer,
        )
        gradient = shift.gradient_at(points)
        strain = np.stack(
            [gradient[:, 0, 0], gradient[:, 1, 1], gradient[:, 0, 1] + gradient[:, 1, 0]]
        )
        warm = warming.at(points)
        strain -= np.multiply.outer(expansion, warm)
        found.append((shift.at(points), warm, (material.voigt @ strain).T))
    (u, warm, fine), (u2, warm2, coarse) = found
    free, unsunk = ~np.asarray(whole.body.held), ~np.asarray(whole.heat.held)
    own = np.stack([ours[name] for name in STRESSES], axis=1)
    return Told(
        [
            Quantity("displacement", ours["displacement"], u, u2, free),
            Quantity("temperature", ours["temperature"], warm, warm2, unsunk),
            Quantity("stress", own, fine, coarse, free),
        ],
        ("finite elements take a quarter of the step, on the coarse mesh half of it",),
    )


def _initial(value: Any, components: int, x: Array, y: Array) -> Array:
    return given(value, x, y, components)


def _sunk(heat: Any, sink: Any) -> Array:
    if sink is None:
        return np.full(heat.basis.N, np.nan)
    return np.asarray(heat.held(within([(sink, 0.0)])))
