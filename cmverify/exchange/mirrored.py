"""What a lattice and finite elements both say of a scene, analysis by analysis.

Each function takes the request, the lattice's result and the scene on a fine and on a coarse mesh,
and gives quantities at the particles (or numbers) three times: by the lattice, by the fine mesh and
by the coarse one. What depends on time is taken with fewer steps on the coarse mesh, too.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.exchange import mirrored_coupled
from cmverify.exchange.finite_elements import Mirror, given
from cmverify.exchange.modes_paired import Paired, paired
from cmverify.exchange.quantities import STRESSES, Quantity, Told, stresses

if TYPE_CHECKING:
    from cmverify.exchange.request import Request
    from solver.arrays import Array

#: Steps of heat: in each of eight pieces of the first interval, on the coarse mesh; twice as many
#: on the fine one.
_STEPS = 4
#: Most steps of a motion on the coarse mesh.
_MOST_STEPS = 5_000


def statics(request: Request, whole: Any, ours: dict[str, Array], *meshes: Mirror) -> Told:
    """A field and its stress or flux."""
    from references.fem.general import solved

    physics = request.scene.physics
    components = 2 if len(physics.unknowns) > 1 else 1
    fine, coarse = (
        solved(one.body(components), one.moduli(), one.held(), one.acting()) for one in meshes
    )
    # Layers whose rotations are left free are held all the same.
    points, free = whole.points, ~np.asarray(whole.discretisation.held)
    unknown = next(name for name in physics.fields if name in ours)
    found = [
        Quantity(unknown, ours[unknown], fine.at(points), coarse.at(points), free, components == 1)
    ]
    if components == 2:
        if STRESSES[0] in ours:
            found.append(stresses(ours, fine, coarse, points, free))
        return Told(found)
    for name in ("flux", "current_density"):
        if name in ours:
            flux = fine.flux_at(points), coarse.flux_at(points)
            found.append(Quantity(name, ours[name], *flux, free))
    return Told(found)


def modes(request: Request, whole: Any, ours: dict[str, Array], *meshes: Mirror) -> Told:
    """Frequencies of modes whose shapes are alike, and the shapes."""
    from references.fem.vibrations import vibrations

    count, points = len(whole.frequencies), whole.points
    free = ~np.asarray(whole.discretisation.held) & np.isfinite(whole.mass)
    weight = np.where(free, np.nan_to_num(whole.mass), 0.0)
    more = count + 6 + count // 4
    found: list[Paired] = []
    shapes = np.nan_to_num(whole.shapes)
    for one in meshes:
        known = vibrations(one.body(2), one.moduli(), one.stored("density"), one.held(), more)
        if known.rigid != whole.rigid:
            raise ValueError(
                f"the lattice has {whole.rigid} rigid motions and the mesh {known.rigid}: supports "
                f"or cracks hold other parts of it"
            )
        found.append(paired(whole.frequencies, shapes, known.frequencies, known.at(points), weight))
    fine, coarse = found
    quantities, notes = [], []
    for k in range(count):
        number = k + 1
        if not (fine.alike[k] and coarse.alike[k]):
            notes.append(
                f"mode {number} ({whole.frequencies[k]:.4g} rad/s) has no shape of finite elements "
                f"like it (largest share {max(0.0, fine.share[k]):.0%}): its frequency is not "
                f"compared"
            )
            continue
        frequency = (whole.frequencies[[k]], fine.frequencies[[k]], coarse.frequencies[[k]])
        quantities.append(Quantity(f"mode {number} frequency", *frequency))
        shape = (shapes[k], fine.shapes[k], coarse.shapes[k])
        quantities.append(Quantity(f"mode {number} displacement", *shape, free))
    return Told(quantities, tuple(notes))


def transient(request: Request, whole: Any, ours: dict[str, Array], *meshes: Mirror) -> Told:
    """Temperatures at all the times, and at the end."""
    from references.fem.in_time import warmed

    options, points = request.options, whole.points
    start, times = float(options.get("start", 0.0)), [float(t) for t in whole.times]
    timed = request.scene.timed
    found = []
    for one, steps in zip(meshes, (2 * _STEPS, _STEPS), strict=True):
        body, moduli = one.body(1), one.moduli()
        fields = warmed(
            body,
            moduli,
            one.stored("heat_capacity"),
            body.nodal(lambda x, y: given(options["initial"], x, y, 1, start)),
            _then(one.supported, 1, timed, start),
            _then(one.loaded, 1, timed, start),
            times,
            start,
            steps,
        )
        found.append(np.stack([field.at(points) for field in fields]))
    free = ~np.asarray(whole.body.held)
    fine, coarse = found
    last = (ours["temperature"], fine[-1], coarse[-1], free, True)
    if len(times) == 1:
        return Told([Quantity("temperature", *last)])
    every = (whole.temperature.T, fine.T, coarse.T, free, True)
    return Told(
        [
            Quantity("temperature at all times", *every, drawn=False),
            Quantity("temperature", *last),
        ]
    )


def waves(request: Request, whole: Any, ours: dict[str, Array], *meshes: Mirror) -> Told:
    """Displacements at all the times, and displacement and velocity at the end."""
    from references.fem.motion import moved

    options, points, scene = request.options, whole.points, request.scene
    start, times = float(options.get("start", 0.0)), [float(t) for t in whole.times]
    alpha, beta = (float(part) for part in options.get("damping", (0.0, 0.0)))
    step, span = float(whole.statistics.step), times[-1] - start
    if span > _MOST_STEPS * step:
        less = "longer steps" if options.get("scheme") == "newmark" else "scheme = 'newmark'"
        raise ValueError(
            f"half of the lattice's step would be {2 * span / step:.2g} steps of theirs, and they "
            f"take {2 * _MOST_STEPS:g}: end earlier, or take {less}"
        )
    moving = any(support.timed for support in scene.supports)
    driven = any(load.timed for load in scene.loads)
    found = []
    for one, share in zip(meshes, (0.5, 1.0), strict=True):
        body = one.body(2)
        first, speed = (
            body.nodal(partial(_at_start, options.get(name, (0.0, 0.0)), start))
            for name in ("initial", "velocity")
        )
        fields = moved(
            body,
            body.stiffness(one.moduli()),
            body.mass(one.stored("density")),
            (alpha, beta),
            (first, speed),
            _then(one.supported, 2, moving, start),
            _then(one.loaded, 2, driven, start),
            times,
            share * step,
            start,
        )
        found.append([np.stack([part.at(points) for part in parts]) for parts in fields])
    fine, coarse = (np.stack(each) for each in found)
    free = ~np.asarray(whole.body.held)
    told = [
        Quantity("displacement", ours["displacement"], fine[-1, 0], coarse[-1, 0], free),
        Quantity("velocity", ours["velocity"], fine[-1, 1], coarse[-1, 1], free),
    ]
    if len(times) > 1:
        a, b, c = (
            np.moveaxis(part, 0, 1).reshape(len(points), -1)
            for part in (whole.displacement, fine[:, 0], coarse[:, 0])
        )
        told.insert(0, Quantity("displacement at all times", a, b, c, free, drawn=False))
    notes = ["finite elements take half of the step, on the coarse mesh the whole"]
    if options.get("rotations") == "inertia":
        notes.append("finite elements of a Cauchy solid have no rotations, and no inertia of them")
    return Told(told, tuple(notes))


def _at_start(value: Any, start: float, x: Array, y: Array) -> Array:
    return given(value, x, y, 2, start)


def _then(
    of: Callable[[int, float], Array], components: int, timed: bool, start: float
) -> Callable[[float], Array]:
    """What a scene says at a time; what does not depend on it is found once."""
    if timed:
        return partial(of, components)
    always = of(components, start)
    return lambda _: always


#: By the analysis' name.
MIRRORED: dict[str, Callable[..., Told]] = {
    "solve": statics,
    "modes": modes,
    "transient": transient,
    "waves": waves,
    "thermoelastic": mirrored_coupled.thermoelastic,
    "joule": mirrored_coupled.joule,
    "piezoresistive": mirrored_coupled.piezoresistive,
}
#: Most triangles: where each step is a solve, or three fields hang together.
TRIANGLES = {"transient": 20_000, "waves": 8_000, "thermoelastic": 8_000, "modes": 20_000}
