"""Transient heat: exact solutions, order in time and space, balance, and runs that are killed."""

import numpy as np
import pytest
from scipy.integrate import trapezoid

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    Load,
    Scene,
    SceneError,
    Support,
    disc,
    rectangle,
    transient,
)
from solver.analyses.heating import Heating
from solver.operators import BondOperator
from tests.solver.bodies import DISC

CAPACITY, BEFORE = 2.0, 0.05


def spreading(x, y, t):
    """An instantaneous point source of strength one at the origin, seen from BEFORE on."""
    inverse, later = np.linalg.inv(DISC), t + BEFORE
    square = inverse[0, 0] * x * x + 2 * inverse[0, 1] * x * y + inverse[1, 1] * y * y
    height = CAPACITY / (4 * np.pi * later * np.sqrt(np.linalg.det(DISC)))
    return height * np.exp(-CAPACITY * square / (4 * later))


def source(n, tolerance=1e-5, **options):
    scene = Scene(
        region=disc(1.0),
        spacing=1 / n,
        m=3,
        material=ConductivityTensor(DISC),
        heat_capacity=CAPACITY,
        supports=[Support.layer(3.5, temperature=spreading)],
    )
    start = lambda x, y: spreading(x, y, 0.0)  # noqa: E731
    return transient.run(scene, start, [0.1], tolerance=tolerance, **options)


def error(run, exact):
    return np.linalg.norm(run.temperature[-1] - exact) / np.linalg.norm(exact)


def test_a_point_source_spreads_at_second_order_in_space():
    errors = []
    for n in (15, 30):
        run = source(n)
        errors.append(error(run, spreading(*run.points.T, 0.1)))
        assert run.statistics.balance < 1e-12
    assert errors[1] < 3e-3
    assert 1.7 < np.log2(errors[0] / errors[1]) < 2.3, errors


def test_steps_are_of_second_order_in_time():
    """On one lattice, so that nothing but time is seen."""
    fine = source(15, step=0.1 / 128).temperature[-1]
    errors = [error(source(15, step=0.1 / k), fine) for k in (4, 8, 16)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all((orders > 1.8) & (orders < 2.2)), errors


def test_the_estimated_error_bounds_the_true_one():
    fine = source(15, step=0.1 / 256).temperature[-1]
    for tolerance in (1e-3, 1e-4):
        run = source(15, tolerance=tolerance)
        true = np.abs(run.temperature[-1] - fine).max()
        assert 0.05 * run.statistics.error < true < 2.0 * run.statistics.error
    assert true < 1e-3


ANGLE, WIDTH, HEIGHT = 0.35, 1.0, 0.6


def cosines(x, y, t, m=2, k=1):
    """A cosine product in an insulated rectangle turned by ANGLE, conducting 3 and 1 along it."""
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    along, across = c * x + s * y + WIDTH / 2, c * y - s * x + HEIGHT / 2
    p, q = m * np.pi / WIDTH, k * np.pi / HEIGHT
    decay = np.exp(-(3 * p * p + q * q) * t / CAPACITY)
    return np.cos(p * along) * np.cos(q * across) * decay


def insulated(n, surface, level=0.0):
    scene = Scene(
        region=rectangle(WIDTH, HEIGHT, angle=ANGLE),
        spacing=1 / n,
        m=3,
        material=ConductivityTensor.orthotropic(3.0, 1.0, ANGLE),
        heat_capacity=CAPACITY,
        surface=surface,
    )
    return transient.run(
        scene, lambda x, y: level + cosines(x, y, 0.0), [0.01, 0.02], tolerance=1e-5
    )


def test_an_insulated_turned_rectangle_at_second_order():
    errors = []
    for n in (40, 80):
        run = insulated(n, "extrapolated")
        errors.append(error(run, cosines(*run.points.T, 0.02)))
        assert run.statistics.balance < 1e-12
        assert np.all(run.supplied == pytest.approx(0.0, abs=1e-12 * CAPACITY * WIDTH * HEIGHT))
    assert errors[1] < 6e-3
    assert 1.7 < np.log2(errors[0] / errors[1]) < 2.4, errors


def test_where_the_temperature_scale_begins_does_not_matter():
    low, high = insulated(20, "volume"), insulated(20, "volume", level=1e4)
    np.testing.assert_allclose(high.temperature - 1e4, low.temperature, atol=1e-6)
    assert high.statistics.steps == low.statistics.steps


def test_heat_balances_and_supports_give_what_their_own_rows_say():
    """Sources, inflow through an edge and a held side, against rows of the whole body."""

    def warming(x, y, t):
        return 1.0 + 20.0 * t + 0.0 * x

    scene = Scene(
        region=rectangle(1.0, 1.0),
        spacing=1 / 12,
        m=2,
        material=ConductivityTensor(DISC),
        heat_capacity=CAPACITY,
        supports=[Support.where(lambda x, y: x < -0.35, temperature=warming)],
        loads=[
            Load.source(lambda x, y, t: np.cos(40 * t) * (1 + y)),
            Load.flux(lambda x, y, t: np.stack([0 * x, -1 - 10 * t + 0 * x], -1)),
        ],
    )
    times = np.linspace(0.0, 0.05, 6)
    run = transient.run(scene, 0.0, times, step=5e-4)
    assert run.statistics.balance < 1e-12
    body = run.body
    whole = BondOperator(body.bonds, body.moduli, np.zeros_like(body.prescribed))
    held = body.prescribed[0]
    fine = transient.run(scene, 0.0, np.linspace(0.0, 0.05, 51), tolerance=1e-4)
    power = []
    for t, field in zip(fine.times, fine.temperature, strict=True):
        then = fine._forcing.at(float(t))
        sources = then.load[0, ~held].sum()
        through = whole.matvec(np.where(held, then.values[0], field))[held].sum()
        power.append((sources + through) * body.scene.spacing**2)
    # The start is rough (the held side jumps by one): compare from the second kept time on.
    from_there = np.searchsorted(fine.times, times[1])
    flowed = trapezoid(power[from_there:], fine.times[from_there:])
    assert flowed == pytest.approx(fine.supplied[-1] - fine.supplied[from_there], rel=1e-3)
    np.testing.assert_allclose(run.supplied[-1], fine.supplied[-1], rtol=1e-3)


def test_where_nothing_is_free_values_are_as_prescribed():
    held = Support.where(lambda x, y: x == x, temperature=lambda x, y, t: x + t)
    scene = Scene(
        rectangle(1, 1), 0.1, ConductivityTensor(DISC), [held], m=2, heat_capacity=CAPACITY
    )
    run = transient.run(scene, 0.0, [0.5, 1.0], step=0.5)
    np.testing.assert_allclose(run.temperature[-1], run.points[:, 0] + 1.0, atol=1e-14)


def test_a_rough_start_is_damped():
    """Cold body, hot rim: nothing leaves the range, however long the steps."""
    scene = Scene(
        region=rectangle(1.0, 1.0),
        spacing=1 / 20,
        m=3,
        material=ConductivityTensor(DISC),
        calibration="positive",
        heat_capacity=1.0,
        supports=[Support.layer(3.5, temperature=1.0)],
    )
    for options in ({"step": 1.0}, {"tolerance": 1e-3}):
        run = transient.run(scene, 0.0, [3.0, 6.0], **options)
        assert abs(run.temperature[-1] - 1.0).max() < (1e-2 if "step" in options else 1e-3)
    middle = transient.run(scene, 0.0, np.geomspace(1e-4, 1e-2, 9), tolerance=1e-4)
    assert middle.temperature.min() > -1e-3
    assert middle.temperature.max() < 1.0 + 1e-3


def test_a_crack_holds_heat_back():
    def run(cracks):
        scene = Scene(
            region=rectangle(1.0, 1.0),
            spacing=1 / 20,
            m=3,
            material=ConductivityTensor.isotropic(1.0),
            heat_capacity=1.0,
            surface="extrapolated",
            cracks=cracks,
            supports=[Support.where(lambda x, y: y < -0.35, temperature=1.0)],
        )
        return transient.run(scene, 0.0, [0.05])

    whole, cut = run([]), run([Crack((-0.6, 0.0), (0.6, 0.0))])
    above = whole.points[:, 1] > 0
    assert whole.temperature[-1][above].max() > 0.1
    assert not cut.temperature[-1][above].any()


class Killed(Exception):
    """Stands for a signal."""


def killer(after):
    calls = []

    def progress(share):
        assert 0 <= share <= 1
        calls.append(share)
        if len(calls) == after:
            raise Killed

    return progress


@pytest.mark.parametrize(("surface", "after"), [("volume", 3), ("extrapolated", 13)])
def test_a_killed_run_goes_on_bit_for_bit(tmp_path, surface, after):
    scene = Scene(
        region=rectangle(1.0, 1.0),
        spacing=1 / 48,
        m=3,
        material=ConductivityTensor(DISC),
        heat_capacity=1.0,
        surface=surface,
        supports=[
            Support.where(lambda x, y: x < -0.45, temperature=lambda x, y, t: np.sin(90 * t) + y)
        ],
    )
    arguments = scene, lambda x, y: x * y, [0.01, 0.03, 0.05]
    probes = [(0.1, 0.2), (0.4, -0.4)]
    whole = transient.run(*arguments, probes=probes, series=tmp_path / "whole")
    state = tmp_path / "state.npz"
    options = {"probes": probes, "checkpoint": state, "every": 4, "series": tmp_path / "part"}
    with pytest.raises(Killed):
        transient.run(*arguments, progress=killer(after), **options)
    found = transient.run(*arguments, **options)
    np.testing.assert_array_equal(found.temperature, whole.temperature)
    np.testing.assert_array_equal(found.history.values, whole.history.values)
    np.testing.assert_array_equal(found.history.times, whole.history.times)
    assert found.statistics.steps == whole.statistics.steps
    assert found.statistics.iterations == whole.statistics.iterations
    np.testing.assert_array_equal(found.supplied, whole.supplied)
    for k in range(3):
        a, b = (tmp_path / f"{stem}_{k:05d}.vtu" for stem in ("whole", "part"))
        assert a.read_bytes() == b.read_bytes()
    # A finished run is not run again, another one is not mistaken for it.
    again = transient.run(*arguments, progress=killer(1), **options)
    np.testing.assert_array_equal(again.temperature, whole.temperature)
    with pytest.raises(SceneError, match="belongs to another"):
        transient.run(*arguments, tolerance=1e-3, **options)
    state.write_bytes(state.read_bytes()[:-200])
    with pytest.raises(SceneError, match=r"damaged|no checkpoint"):
        transient.run(*arguments, **options)


def test_probes_record_every_step_and_fields_have_names():
    run = source(15, probes=[(0.0, 0.0), (0.5, 0.1)])
    assert run.history.values.shape == (run.statistics.steps + 1, 1, 2)
    np.testing.assert_array_equal(
        run.history.values[-1, 0], run.temperature[-1][run.history.particles]
    )
    assert list(run.fields()) == ["temperature"]
    assert run.summary()["steps"] == run.statistics.steps


def test_the_series_can_be_read(tmp_path):
    import xml.etree.ElementTree as ElementTree

    import meshio

    run = source(15, series=tmp_path / "heat")
    found = ElementTree.parse(tmp_path / "heat.pvd").getroot().findall(".//DataSet")
    assert [float(one.get("timestep")) for one in found] == run.times.tolist()
    mesh = meshio.read(tmp_path / found[-1].get("file"))
    np.testing.assert_array_equal(mesh.cell_data["temperature"][0], run.temperature[-1])


def plain(**options):
    settings = {
        "region": rectangle(1.0, 1.0),
        "spacing": 0.1,
        "m": 2,
        "material": ConductivityTensor.isotropic(1.0),
        "heat_capacity": 1.0,
    }
    return Scene(**(settings | options))


@pytest.mark.parametrize(
    ("scene", "arguments", "options", "match"),
    [
        ({"heat_capacity": None}, (0.0, [1.0]), {}, "heat_capacity"),
        (
            {"material": ElasticTensor.isotropic(1.0, 0.3), "heat_capacity": None},
            (0.0, [1.0]),
            {},
            "solver.waves",
        ),
        ({}, (np.zeros(7), [1.0]), {}, "initial temperature needs one value a particle for 100"),
        ({}, (np.nan, [1.0]), {}, "initial temperature is not finite"),
        ({}, (0.0, []), {}, "times must be finite"),
        ({}, (0.0, [2.0, 1.0]), {}, "ascend"),
        ({}, (0.0, [-1.0]), {}, "between the start"),
        ({}, (0.0, [1.0]), {"tolerance": 0.0}, "tolerance"),
        ({}, (0.0, [1.0]), {"step": -1.0}, "step must be a positive time"),
        ({}, (0.0, [1.0]), {"step": 1e-12}, "would not end"),
        ({}, (0.0, [1e-300]), {"step": 1e-300}, "leave the range of numbers"),
        ({}, (0.0, [1.0]), {"step": 1e-300}, "leave the range of numbers"),
        ({}, (0.0, [1.0]), {"probes": [(3.0, 0.0)]}, "not in the body"),
        ({}, (0.0, [1.0]), {"probes": [0.0, 1.0]}, "points"),
        ({}, (0.0, [1.0]), {"series": "/no/such/folder/a"}, "no folder"),
        ({}, (0.0, [1.0]), {"checkpoint": "/no/such/folder/a"}, "no folder"),
        ({}, (0.0, [1.0]), {"checkpoint": "a", "every": 0}, "every so many"),
        (
            {"supports": [Support.layer(1, temperature=lambda x, y, t: x / (t - 1.0 + 0 * x))]},
            (0.0, [0.5, 1.0]),
            {},
            "not finite",
        ),
    ],
)
def test_bad_input_is_refused_before_any_step(monkeypatch, scene, arguments, options, match):
    monkeypatch.setattr(Heating, "_step", lambda *_: pytest.fail("it began to step"))
    with np.errstate(divide="ignore"), pytest.raises(SceneError, match=match):
        transient.run(plain(**scene), *arguments, **options)


def test_what_depends_on_time_is_refused_in_statics():
    scene = plain(supports=[Support.layer(1, temperature=lambda x, y, t: t + x)])
    with pytest.raises(SceneError, match="statics knows no time"):
        scene.solve()
    with pytest.raises(SceneError, match="statics knows no time"):
        plain(
            supports=[Support.layer(1, temperature=0.0)], loads=[Load.source(lambda x, y, t: t)]
        ).solve()


def test_a_default_third_argument_is_no_time():
    scene = plain(supports=[Support.layer(1, temperature=lambda x, y, k=2.0: k * x)])
    assert not scene.timed
    scene.solve()


def test_capacity_belongs_to_conduction_and_is_positive():
    for value in (-1.0, 0.0, np.inf, np.nan, True, "1"):
        with pytest.raises(SceneError, match="heat capacity must be positive"):
            plain(heat_capacity=value)
    with pytest.raises(SceneError, match="an elastic body has no heat capacity"):
        plain(material=ElasticTensor.isotropic(1.0, 0.3))
    with pytest.raises(SceneError, match="a conductive body has no density"):
        plain(density=1.0)


def test_an_edge_whose_temperature_changes():
    """T = x²/2 + (D/c) t in a strip held at both ends' edges: a polynomial, but for the rim."""
    exact = lambda x, y, t: 0.5 * x * x + 1.5 * t / CAPACITY + 0 * y  # noqa: E731
    errors = []
    for n in (10, 20):
        scene = Scene(
            region=rectangle(1.0, 0.5),
            spacing=1 / n,
            m=2,
            material=ConductivityTensor.isotropic(1.5),
            heat_capacity=CAPACITY,
            surface="extrapolated",
            supports=[Support.edge(lambda x, y: abs(x) > 0.5 - 1e-9, temperature=exact)],
        )
        run = transient.run(scene, lambda x, y: exact(x, y, 0.0), [0.3], tolerance=1e-6)
        errors.append(np.abs(run.temperature[-1] - exact(*run.points.T, 0.3)).max())
        assert run.surface_temperature().max() == pytest.approx(exact(0.5, 0.0, 0.3), abs=2e-3)
        assert run.statistics.balance < 1e-10
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] > 2.5, errors
