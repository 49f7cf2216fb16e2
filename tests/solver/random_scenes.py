"""Small scenes of every kind, sensible and not: what a user may ask, and what an answer may be.

Bodies are holed, slotted, turned, united, of several solids and of any thickness; solids isotropic
or not, polar or not.

An answer is finite wherever nothing was set aside, and comes without a warning of NumPy's; a
refusal is one line of an error that the solver raised on purpose.
"""

import traceback
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from numpy.random import Generator

import solver
from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    ElectricConductivityTensor,
    ExpansionTensor,
    Inclusion,
    Load,
    PolarTensor,
    Programme,
    Scene,
    Support,
    disc,
    errors,
    modes,
    polygon,
    rectangle,
    transient,
    waves,
)
from solver.analyses import stepping
from solver.fracture import grow

PHYSICS = ("elastic", "heat", "electric")
ANALYSES = ("solve", "modes", "transient", "waves", "grow")
ROOM = Path(solver.__file__).parent
KNOWN = tuple(e for e in vars(errors).values() if isinstance(e, type))
# Exponents of ten of moduli, loads and values that are not plain.
FAR = (9, -9, 45, -45, 45, -45, 60, -60, 150, -150, 200, -200, 300, -300)


def pick(rng: Generator, *options: Any) -> Any:
    return options[rng.integers(len(options))]


def size(rng: Generator) -> float:
    return 10.0 ** pick(rng, *FAR) if rng.random() < 0.12 else 1.0


def region(rng: Generator, h: float) -> Any:
    """A body of one to some fifty cells, perhaps holed, slotted, turned or cut through."""
    w, t = rng.integers(1, 11), rng.integers(1, 8)
    if rng.random() < 0.3:
        w, t = w + rng.uniform(-0.4, 0.9), t + rng.uniform(-0.4, 0.9)
    kind = rng.integers(5)
    angle = pick(rng, 0.0, 0.0, 0.4, np.pi / 4)
    if kind == 0:
        body = disc(0.5 * h * max(w, 1.5))
    elif kind == 1:
        corners = rng.uniform(0.3, 1.0, 5) * 0.6 * h * max(w, 3)
        turn = np.sort(rng.uniform(0, 2 * np.pi, 5))
        body = polygon([(r * np.cos(a), r * np.sin(a)) for r, a in zip(corners, turn, strict=True)])
    else:
        body = rectangle(w * h, t * h, angle=angle)
    if rng.random() < 0.25:
        body = body - disc(h * rng.uniform(0.3, 2.5), tuple(rng.uniform(-2, 2, 2) * h))
    if rng.random() < 0.2:
        slot = rectangle(pick(rng, 0.1, 0.5, 1.0) * h, h * w, tuple(rng.uniform(-2, 2, 2) * h))
        body = body - slot
    kind = rng.integers(12)
    if kind == 0:
        body = body | part(rng, h)
    elif kind == 1:
        # Beside each other, edge to edge or nearly so.
        x0, _, x1, _ = body.bounds
        gap = pick(rng, 0.0, 0.0, 1e-9, -1e-9, 0.3, -0.3) * h
        body = body | body.moved((x1 - x0 + gap, pick(rng, 0.0, 0.5 * h)))
    elif kind == 2:
        body = body & part(rng, h)
    return body


def part(rng: Generator, h: float) -> Any:
    """A shape that takes a part of most bodies."""
    place = tuple(pick(rng, np.zeros(2), rng.uniform(-3, 3, 2), rng.integers(-3, 4, 2)) * h)
    kind = rng.integers(5)
    if kind == 0:
        return disc(h * pick(rng, 0.4, 1.0, 2.0, rng.uniform(0.5, 4)), place)
    if kind == 1:
        return rectangle(20 * h, pick(rng, 0.2, 1.0, 2.0) * h, place)
    if kind == 2:
        return rectangle(40 * h, 20 * h, (place[0], place[1] + 10 * h), pick(rng, 0.0, 0.3))
    w, t = pick(rng, rng.integers(1, 6, 2), rng.uniform(0.3, 6, 2)) * h
    body = rectangle(w, t, place, pick(rng, 0.0, 0.0, 0.4))
    return body - disc(0.3 * h, place) if kind == 3 else body


def material(rng: Generator, physics: str) -> Any:
    scale = size(rng)
    if physics == "elastic":
        kind = rng.integers(7)
        if kind == 6:
            bending = scale * 10.0 ** rng.uniform(-4, 1) * pick(rng, 1.0, 1e-18, 1e6)
            elastic = ElasticTensor.isotropic(scale, pick(rng, 0.2, 0.0, 0.3, 0.33333333))
            return PolarTensor(elastic, bending * np.array([[1, 0.2], [0.2, pick(rng, 0.5, 1.0)]]))
        if kind > 2:
            nu = pick(rng, 0.2, 1 / 3, 0.33333333, 0.3, 0.45, -0.3, 0.0)
            return ElasticTensor.isotropic(scale, nu, pick(rng, "stress", "strain"))
        if kind == 1:
            a = rng.uniform(-1, 1, (3, 3))
            return ElasticTensor(scale * (a @ a.T + 0.3 * np.eye(3)))
        if kind == 2:
            return ElasticTensor(scale * np.array([[140.0, 3, 0], [3, 10, 0], [0, 0, 5]]))
        return ElasticTensor(
            scale * np.array([[1, 0.2, 0.1], [0.2, 0.8, 1 / 6], [0.1, 1 / 6, 1 / 3]])
        )
    tensor = ConductivityTensor if physics == "heat" else ElectricConductivityTensor
    a = rng.uniform(-1, 1, (2, 2))
    return tensor(scale * (a @ a.T + 0.2 * np.eye(2)))


def where(rng: Generator, h: float) -> Any:
    """A part of the plane; some miss the body."""
    x0, y0 = rng.uniform(-2, 2, 2) * h
    return pick(
        rng,
        lambda x, y: x < x0,
        lambda x, y: y > y0,
        lambda x, y: np.arange(len(x)) == len(x) // 2,
        lambda x, y: x == x,
        disc(2 * h, (x0, y0)),
        rectangle(3 * h, 30 * h, (x0, 0.0)),
    )


def support(rng: Generator, physics: str, h: float) -> Support:
    value = float(rng.normal()) * pick(rng, 0.0, 1.0, size(rng)) * h
    if physics != "elastic":
        name = "temperature" if physics == "heat" else "potential"
        given: dict[str, Any] = {name: pick(rng, value, lambda x, y: value + x)}
        kind = rng.integers(6)
        if kind == 0:
            return Support.layer(cells=pick(rng, 0.5, 1.5, 3), **given)
        if kind == 1:
            return Support.edge(where(rng, h), **given)
        if kind == 2 and physics == "electric":
            return Support.lead(where(rng, h), potential=value)
        return Support.where(where(rng, h), **given)
    given = pick(
        rng,
        {"displacement": (value, 0.0)},
        {"displacement": 0.0, "rotation": 0.0},
        {"u1": value},
        {"u2": lambda x, y: value + 0.1 * x},
        {"u1": 0.0, "rotation": 0.0},
        {"rotation": value},
    )
    kind = rng.integers(12)
    if kind == 0:
        return Support.layer(cells=pick(rng, 0.5, 1.5, 3), **given)
    if kind == 1:
        return Support.edge(where(rng, h), **given)
    if kind == 2:
        return Support.pin(where(rng, h), **pick(rng, {}, {"displacement": 0.0}))
    if kind == 3:
        return Support.equal(where(rng, h), pick(rng, "u1", "u2"))
    return Support.where(where(rng, h), **given)


def clamp(rng: Generator, physics: str, h: float) -> Support:
    """What holds most bodies."""
    names = {"elastic": "displacement", "heat": "temperature", "electric": "potential"}
    x0 = rng.uniform(-1, 1) * h
    return Support.where(lambda x, y: x <= max(x0, x.min()), **{names[physics]: 0.0})


def load(rng: Generator, physics: str, h: float) -> Load:
    a, b, c = rng.normal(size=3) * pick(rng, 1.0, 1.0, size(rng))
    there = pick(rng, None, where(rng, h))
    place = tuple(rng.uniform(-2, 2, 2) * h)
    if physics == "elastic":
        kind = rng.integers(16)
        if kind == 0:
            return Load.body_force((a, b), there)
        if kind == 1:
            return Load.couple(a, there)
        if kind == 2:
            return Load.point((a, b), place)
        if kind == 3:
            return Load.line((a, b), place, (place[0] + 3 * h, place[1]))
        if kind == 4:
            return Load.temperature(a, ExpansionTensor.isotropic(1e-5))
        return Load.stress((a, b, c), there)
    if physics == "electric" and rng.random() < 0.3:
        return pick(rng, Load.current(a, there), Load.lead(a, where(rng, h)))
    return pick(rng, Load.source(a, there), Load.flux((a, b), there))


def broken(rng: Generator, share: float) -> Callable[..., Any]:
    seed = int(rng.integers(1 << 30))

    def gone(lattice: Any, family: Any) -> Any:
        shape = family.size // 2, lattice.count
        return np.random.default_rng(seed).random(shape) < share

    return gone


def inclusion(rng: Generator, physics: str, h: float, own: Any, storage: str | None) -> Inclusion:
    solid = pick(rng, own, material(rng, physics), material(rng, physics))
    options: dict[str, Any] = {}
    if storage and rng.random() < 0.5:
        options[storage] = size(rng) * rng.uniform(0.1, 10)
    if rng.random() < 0.3:
        options["thickness"] = size(rng) * rng.uniform(0.1, 10)
    if rng.random() < 0.7 and physics == "elastic":
        options["expansion"] = ExpansionTensor.isotropic(2e-5)
    return Inclusion(part(rng, h), solid, **options)


def thickness(rng: Generator, h: float) -> Any:
    """A number, a step, a taper, one that ends in nothing or is not known everywhere."""
    x0, thick = rng.uniform(-2, 2) * h, size(rng) * rng.uniform(0.1, 10)
    return pick(
        rng,
        thick,
        lambda x, y: np.where(x < x0, thick, 0.1 * thick),
        lambda x, y: thick * (1 + 0.1 * np.sin(x / h)),
        lambda x, y: thick * np.exp(y / h),
        lambda x, y: thick * (x - x0) / h,
        lambda x, y: np.sqrt(x - x0),
    )


def scene(rng: Generator, physics: str, timed: bool = False) -> Scene:
    h = 10.0 ** pick(rng, 0, 0, 0, 0, 0, 0, -9, 3, -3)
    options: dict[str, Any] = {}
    solid, storage = material(rng, physics), None
    if rng.random() < 0.25:
        options["cracks"] = [
            Crack(*map(tuple, rng.uniform(-5, 5, (pick(rng, 2, 3), 2)) * h))
            for _ in range(rng.integers(1, 3))
        ]
    if rng.random() < 0.15:
        options["cracks"] = [Crack((-20 * h, 0.1 * h), (20 * h, 0.1 * h))]
    if rng.random() < 0.15:
        options["broken"] = broken(rng, pick(rng, 0.1, 0.4, 0.9))
    if rng.random() < 0.3:
        options["phase"] = tuple(rng.uniform(0, 1, 2))
    if timed:
        storage = "density" if physics == "elastic" else "heat_capacity"
        options[storage] = size(rng)
    if rng.random() < 0.35:
        count = pick(rng, 1, 1, 2, 3)
        options["inclusions"] = [inclusion(rng, physics, h, solid, storage) for _ in range(count)]
    if rng.random() < 0.2:
        options["thickness"] = thickness(rng, h)
    supports = [support(rng, physics, h) for _ in range(pick(rng, 0, 0, 1, 1, 2))]
    if rng.random() < 0.7:
        supports.insert(0, clamp(rng, physics, h))
    return Scene(
        region(rng, h),
        h,
        solid,
        supports,
        [load(rng, physics, h) for _ in range(rng.integers(0, 3))],
        m=pick(rng, 1, 1.5, 2, 2.5, 3, 3, 4),
        calibration=pick(rng, "lattice", "lattice", "positive", "continuum"),
        area_rule=pick(rng, "partial", "partial", "full", "exact"),
        surface=pick(rng, "none", "volume", "extrapolated", "extrapolated"),
        loose=pick(rng, "refuse", "drop", "drop"),
        **options,
    )


def ask(rng: Generator, physics: str, analysis: str) -> Any:
    """Make a scene and solve it, or do something else with it."""
    timed = analysis in ("modes", "transient", "waves")
    asked = scene(rng, physics, timed)
    if analysis == "solve":
        return asked.solve()
    if analysis == "modes":
        return modes.solve(asked, int(rng.integers(1, 5)))
    if analysis == "transient":
        span = pick(rng, 1.0, size(rng))
        return transient.run(asked, pick(rng, 0.0, lambda x, y: x), [0.5 * span, span], step=span)
    if analysis == "waves":
        # Nobody waits for a long run here: it is refused like an endless one.
        with mock.patch.object(stepping, "_MOST", 1e4):
            return waves.run(
            asked, (0.0, 0.0), pick(rng, 1e-3, 1.0), velocity=(1.0, 0.0),
            scheme=(scheme := pick(rng, "verlet", "newmark")),
            rotations="condensed" if scheme == "newmark" else pick(rng, "condensed", "inertia"),
            step=pick(rng, None, 1e-3),
        )  # fmt: skip
    toughness = np.full(asked.family().size, pick(rng, 1.0, size(rng)))
    programme = pick(rng, Programme(), Programme(control="following"), Programme(stop=2.0))
    return grow(asked, toughness, programme, max_solves=6, tension_only=pick(rng, True, False))


def fault(seed: int, physics: str, analysis: str) -> str | None:
    """What is wrong with the answer to a random scene, None if nothing is."""
    rng = np.random.default_rng(seed)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            result = ask(rng, physics, analysis)
            solved = result.fields()
            result.summary()
        except KNOWN as error:
            return None if len(str(error).splitlines()) == 1 else f"no one line: {error!r}"
        except (ValueError, TypeError) as error:
            # An argument's own check: raised by a line of the solver's, in one line.
            last = traceback.extract_tb(error.__traceback__)[-1]
            own = ROOM in Path(last.filename).parents and "raise" in (last.line or "")
            if own and len(str(error).splitlines()) == 1:
                return None
            return traceback.format_exc(limit=-5)
        except Exception:
            return traceback.format_exc(limit=-5)
    aside = getattr(result, "loose", None)
    body = result.body.sound if analysis == "grow" else getattr(result, "body", None)
    if body is not None:
        gone = np.isnan(body.values).any(axis=0)
        aside = gone if aside is None else aside | gone
    for name, values in solved.items():
        bad = ~np.isfinite(values).reshape(len(values), -1).all(axis=1)
        if analysis == "solve":
            aside = np.isnan(result.unknowns).any(axis=0)
        if aside is not None:
            bad &= ~np.asarray(aside)
        if bad.any() and not (name == "rotation" and np.isnan(values).all()):
            return f"{name} is not finite at {bad.sum()} of {len(bad)} particles"
    return None
