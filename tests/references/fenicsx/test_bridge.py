"""scikit-fem against FEniCSx: same mesh, same element, two codes."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from references.fem.conduction import steady_conduction
from references.fem.elasticity import solve_elasticity
from references.fem.general import Acting, solve
from references.fem.leads import Lead, plate_between_leads
from references.fem.listening import listening
from references.fem.mesh import crack_tip_disc, disc, rectangle
from references.fem.modes import in_plane_modes
from references.fem.piezoresistive import strained_conduction
from references.fem.polygons import polygons
from references.fem.transient import transient_conduction
from references.fenicsx import again, bridge
from references.generators_dynamic import plate_mesh
from references.provenance import load

C = np.array([[1, 1 / 5, 1 / 10], [1 / 5, 4 / 5, 1 / 6], [1 / 10, 1 / 6, 1 / 3]])
D = np.array([[5.0, 2.0], [2.0, 1.0]])
SQUARE = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


@pytest.fixture(scope="module", autouse=True)
def fenicsx() -> bridge.Fenicsx:
    found = bridge.find()
    if found is None:
        pytest.skip(bridge.INSTALL)
    return found


def relative(found: NDArray, exact: NDArray) -> float:
    return float(np.abs(found - exact).max() / np.abs(exact).max())


@pytest.mark.parametrize("order", [1, 2])
def test_conduction(order: int) -> None:
    def boundary(x: NDArray, y: NDArray) -> NDArray:
        return np.exp(x - 2 * y) * np.cos(y)

    mesh = disc(0.15)
    ours = steady_conduction(mesh, D, boundary, lambda x, y: 1 + 0.8 * y, order)
    theirs = bridge.steady_conduction(mesh, D, boundary, lambda x, y: 1 + 0.8 * y, order)
    assert relative(theirs, ours.values) < 1e-11


@pytest.mark.parametrize("order", [1, 2])
def test_crack_tip_disc_with_its_doubled_nodes(order: int) -> None:
    def boundary(x: NDArray, y: NDArray) -> NDArray:
        # opens the slit: the two mouths move apart
        half = np.arctan2(y, x) / 2
        return np.stack([0.3 * np.cos(half), np.sin(half)], axis=-1)

    mesh = crack_tip_disc(0.15, tip_size=0.01)
    ours = solve_elasticity(mesh, C, boundary, order=order)
    theirs = bridge.solve_elasticity(mesh, C, boundary, order=order)
    assert relative(theirs, ours.values) < 1e-11


def test_tractions_forces_and_free_components() -> None:
    mesh = rectangle(2, 1, 0.2, holes=[(0.3, 0.1, 0.2)])
    data = {
        "displacement": {"left": (0.0, np.nan), "bottom": (np.nan, 0.1)},
        "tractions": {"right": (1.0, 0.2), "hole0": lambda x, y: np.stack([y, -x], axis=-1)},
        "body_force": lambda x, y: np.stack([x * y, 1 - x], axis=-1),
    }
    ours = solve_elasticity(mesh, C, **data)  # type: ignore[arg-type]
    assert relative(bridge.solve_elasticity(mesh, C, **data), ours.values) < 1e-11  # type: ignore[arg-type]


@pytest.mark.parametrize("clamped", [(), ("left", "bottom")])
def test_frequencies(clamped: tuple[str, ...]) -> None:
    mesh = rectangle(1, 1, 0.15)
    ours = in_plane_modes(mesh, C, 2.0, 6, clamped).frequencies
    theirs = bridge.in_plane_frequencies(mesh, C, 2.0, 6, clamped)
    assert np.abs(theirs**2 / ours**2 - 1).max() < 1e-10


@pytest.mark.parametrize("feature", ["", "hole", "crack"])
def test_stored_frequencies_of_free_plates(feature: str) -> None:
    """SLEPc on dolfinx's matrices: as scikit-fem's on the same mesh, as stored but for the mesh."""
    stored = load("free-plates")
    given = stored.record["arguments"]
    row = next(k for k, p in enumerate(given["plates"][3:], 3) if p.get("feature", "") == feature)
    mesh = plate_mesh(feature, 16, given["hole"], given["crack"])
    voigt = stored["voigt"][row]
    theirs = bridge.in_plane_frequencies(mesh, voigt, 1.0, given["count"])
    ours = in_plane_modes(mesh, voigt, 1.0, given["count"]).frequencies
    assert np.abs(theirs / ours - 1).max() < 1e-10
    # Errors fall by four: a mesh of 16 has seven times those of one of 40, and features more.
    assert np.abs(theirs / stored["frequencies"][row] - 1).max() < 10 * stored.error("frequencies")


def test_the_stored_cooling_of_a_cracked_square() -> None:
    stored = load("cracked-square-cools")
    given = stored.record["arguments"]

    def warm(x: NDArray, y: NDArray) -> NDArray:
        return 0.5 + 0.5 * np.sin(np.pi * y)

    tip = given["tip"]
    mesh = rectangle(1.0, 1.0, 0.05, cracks=[((-0.5, 0.0), (tip, 0.0))], tip_size=2e-3)
    data = (given["conductivity"], given["capacity"], warm, given["duration"], 50)
    ours = transient_conduction(mesh, *data).fields[-1]
    theirs = bridge.transient_conduction(mesh, *data)
    assert relative(theirs, ours.values) < 1e-10
    line = (np.arange(20) + 0.5) / 20 - 0.5
    points = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    again = replace(ours, values=theirs, _locator=None).at(points)
    assert relative(again, stored["grid_20"]) < 2e-3
    off = bridge.transient_conduction(mesh, data[0], 1.01 * data[1], *data[2:])
    assert relative(off, ours.values) > 1e-4


def test_two_ranks() -> None:
    mesh = crack_tip_disc(0.15)

    def boundary(x: NDArray, y: NDArray) -> NDArray:
        half = np.arctan2(y, x) / 2
        return np.stack([0.3 * np.cos(half), np.sin(half)], axis=-1)

    force = (0.2, -0.1)
    ours = solve_elasticity(mesh, C, boundary, body_force=force)
    theirs = bridge.solve_elasticity(mesh, C, boundary, body_force=force, processes=2)
    assert relative(theirs, ours.values) < 1e-11
    modes = in_plane_modes(mesh, C, 1.0, 4).frequencies
    assert np.allclose(bridge.in_plane_frequencies(mesh, C, 1.0, 4, processes=2), modes, rtol=1e-10)
    cooling = (mesh, D, 2.0, lambda x, y: x * y, 0.1, 4)
    ours = transient_conduction(*cooling).fields[-1].values
    assert relative(bridge.transient_conduction(*cooling, processes=2), ours) < 1e-10


def test_one_per_cent_is_seen() -> None:
    mesh = disc(0.3)
    ours = steady_conduction(mesh, D, lambda x, y: x * x)
    off = bridge.steady_conduction(mesh, D * [[1.01, 1], [1, 1]], lambda x, y: x * x)
    assert relative(off, ours.values) > 1e-5


def test_a_lost_rigid_motion_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh, run = rectangle(1, 1, 0.3), bridge.run

    def loses_one(problem: Any, processes: int = 1) -> Any:
        answer = run(problem, processes)
        return {**answer, "eigenvalues": answer["eigenvalues"][1:]}

    monkeypatch.setattr(bridge, "run", loses_one)
    with pytest.raises(FloatingPointError, match="one was lost"):
        bridge.in_plane_frequencies(mesh, C, 1.0, 3)


def test_free_rigid_motions_are_refused_before_any_work() -> None:
    mesh = rectangle(1, 1, 0.3)
    with pytest.raises(ValueError, match="translation along axis 2"):
        bridge.solve_elasticity(mesh, C, {"left": (0, np.nan)}, {"right": (1, 0)})
    cut = rectangle(1, 1, 0.25, cracks=[((0, -0.5), (0, 0.5))])
    with pytest.raises(ValueError, match="up to a constant"):
        bridge.steady_conduction(cut, D, {"left": 0.0})
    with pytest.raises(ValueError, match="this one has 6"):
        bridge.in_plane_frequencies(cut, C, 1.0, 3)


def test_loads_that_do_not_balance_are_refused_where_nothing_holds_the_body() -> None:
    mesh = rectangle(1, 1, 0.3)
    pulled = {"left": (-1.0, 0.0), "right": (1.0, 0.0)}
    ours = solve_elasticity(mesh, C, tractions=pulled)
    assert relative(bridge.solve_elasticity(mesh, C, tractions=pulled), ours.values) < 1e-11
    for wrong in ({"right": (1.0 + 1e-6, 0.0)}, {"left": (-1.0, -1e-6), "right": (1.0, 1e-6)}):
        with pytest.raises(bridge.FenicsxError, match="not in equilibrium"):
            bridge.solve_elasticity(mesh, C, tractions={**pulled, **wrong})


def test_a_field_that_jumps_across_both_faces() -> None:
    def jumping(x: NDArray, y: NDArray) -> NDArray:
        return np.sqrt(np.hypot(x, y)) * np.sin(np.arctan2(y, x) / 2)

    mesh = crack_tip_disc(0.15, tip_size=0.01)
    data = {"circle": jumping, "crack": jumping}
    ours = steady_conduction(mesh, np.eye(2), data)
    assert relative(bridge.steady_conduction(mesh, np.eye(2), data), ours.values) < 1e-11
    q = np.array([[-0.5, 1e-9], [-0.5, -1e-9], [0.3, 0.2]])
    assert np.abs(ours.at(q) - jumping(*q.T)).max() < 1e-3


def test_a_worker_that_fails_says_why() -> None:
    mesh = disc(0.5)
    problem = {
        "points": mesh.points,
        "triangles": mesh.triangles,
        "nodes": mesh.points + 0.1,
        "element_nodes": mesh.triangles,
        "order": 1,
        "physics": "conduction",
        "tensor": D,
        "prescribed": np.zeros((len(mesh.points), 1)),
        "tractions": 0,
    }
    with pytest.raises(bridge.FenicsxError, match="do not coincide"):
        bridge.run(problem)


def test_passes_are_timed_apart_and_give_the_same() -> None:
    mesh = rectangle(1, 1, 0.3)
    pulled = {"left": (-1.0, 0.0), "right": (1.0, 0.0)}
    usual = bridge.solve_elasticity(mesh, C, tractions=pulled)
    nearly = {**pulled, "right": (1.0 + 1e-6, 0.0)}
    with bridge.timed(3) as timing:
        assert relative(bridge.solve_elasticity(mesh, C, tractions=pulled), usual) < 1e-10
        assert relative(bridge.solve_elasticity(mesh, C, tractions=nearly), usual) < 1e-5
        bridge.in_plane_frequencies(mesh, C, 1.0, 3)
    assert len(timing.taken) == 3
    for taken in timing.taken:
        for stage in ("forms", "setup", "solve"):
            assert taken[stage].shape == (3,)
            assert (taken[stage] > 0).all()
        assert taken["memory"] >= 0


def heard(solve: Any) -> list[again.Second]:
    ear = again.Beside()
    with listening(ear):
        solve()
    return ear.found


@pytest.mark.parametrize("held", [False, True])
def test_leads_of_given_current_or_potential_at_a_slit(held: bool) -> None:
    ways = [{"potential": 1.0}, {"potential": 0.0}] if held else [{"current": 2.0}, {"current": -2}]
    leads = [Lead(0.5, 0.1, 0.7, 0.3, **ways[0]), Lead(-0.7, -0.3, -0.5, -0.1, **ways[1])]
    slit = ((-1.0, 0.0), (0.2, 0.0))
    (second,) = heard(lambda: plate_between_leads(2, 1, 0.1, D, leads, slit))
    assert second.difference < 1e-10
    assert 1e-4 < second.change < 0.05


@pytest.mark.parametrize("size", [2, 3])
def test_several_solids(size: int) -> None:
    mesh = polygons([(SQUARE, [SQUARE / 3]), (SQUARE / 3, [])], 0.3)
    solid = (np.abs(mesh.points[mesh.triangles].mean(axis=1)).max(axis=1) < 1 / 3).astype(np.int64)
    tensors = np.stack([np.eye(size), 7 * np.eye(size)]) + 0.2

    def held(nodes: NDArray, edge: NDArray) -> NDArray:
        wanted = np.stack([nodes[:, 0] ** 2, nodes[:, 0] * nodes[:, 1]][: size - 1], axis=1)
        return np.where(edge[:, None], wanted, np.nan)

    (second,) = heard(lambda: solve(mesh, tensors, solid, held, Acting()))
    assert second.difference < 1e-10
    assert 1e-4 < second.change < 0.05
    assert len(second.finer.solid) == 4 * len(solid)


def test_conduction_of_a_strained_body_on_both_meshes() -> None:
    """Its strains on the finer mesh are those of the elastic problem before it."""
    mesh = rectangle(2, 1, 0.25, holes=[(0, 0, 0.2)])

    def law(e: NDArray) -> NDArray:
        eye = np.eye(2).reshape(2, 2, *[1] * (e.ndim - 1))
        return eye * (1 + 3 * e[0] + e[1] ** 2) + 0 * e[0]

    def solve() -> None:
        pulled = solve_elasticity(mesh, C, tractions={"left": (-0.1, 0), "right": (0.1, 0)})
        strained_conduction(pulled, law, {"left": 1.0, "right": -1.0})

    pulled, second = heard(solve)
    assert pulled.difference < 1e-10
    # A quadratic law of strains that are linear in each triangle: nothing is lost.
    assert second.difference < 1e-10
    assert 1e-6 < second.change < 0.02
    assert second.finer.mesh is pulled.finer.mesh
