import builtins
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from references.fem.mesh import (
    MeshingUnavailableError,
    crack_tip_disc,
    disc,
    load_gmsh,
    rectangle,
)
from references.fem.slit import boundary_edges


def test_disc_nodes_lie_on_the_circle_and_area_is_the_polygons() -> None:
    mesh = disc(0.1, radius=2.0)
    rim = mesh.nodes("circle")
    assert np.allclose(np.hypot(*mesh.points[rim].T), 2.0, atol=1e-12)
    n = len(rim)
    assert mesh.area == pytest.approx(0.5 * n * 4 * np.sin(2 * np.pi / n), rel=1e-3)
    edges = mesh.points[mesh.triangles] - np.roll(mesh.points[mesh.triangles], 1, axis=1)
    assert np.linalg.norm(edges, axis=-1).max() < 1.6 * 0.1


def test_the_slit_has_two_faces_that_share_only_the_tip() -> None:
    mesh = crack_tip_disc(0.1)
    faces = mesh.nodes("crack")
    coordinates = mesh.points[faces]
    unique, count = np.unique(np.round(coordinates, 12), axis=0, return_counts=True)
    tip = np.hypot(*unique.T) < 1e-12
    assert np.array_equal(count[tip], [1])
    assert (count[~tip] == 2).all()
    assert np.allclose(mesh.tips, [[0, 0]])
    # every triangle at a doubled node lies on one side only
    centroid = mesh.points[mesh.triangles].mean(axis=1)
    for node in faces[np.hypot(*coordinates.T) > 1e-12]:
        sides = np.sign(centroid[(mesh.triangles == node).any(axis=1), 1])
        assert len(set(sides)) == 1


def test_an_opened_mesh_keeps_its_area_and_counts_both_faces() -> None:
    plain, cracked = rectangle(2, 2, 0.2), rectangle(2, 2, 0.2, cracks=[((-0.4, 0), (0.4, 0.3))])
    assert cracked.area == pytest.approx(plain.area, rel=1e-12)
    assert len(cracked.tips) == 2
    assert len(cracked.boundaries["crack"]) % 2 == 0
    total = sum(len(e) for e in cracked.boundaries.values())
    assert total == len(boundary_edges(cracked.triangles))


def test_a_kinked_crack_opens_at_the_kink() -> None:
    mesh = rectangle(2, 2, 0.2, cracks=[((-1, 0), (0, 0)), ((0, 0), (0.1, 0.1))], tip_size=0.02)
    assert np.allclose(mesh.tips, [[0.1, 0.1]])
    assert (np.hypot(*mesh.points.T) < 1e-12).sum() == 2


def test_grading_makes_small_elements_at_the_tip() -> None:
    mesh = crack_tip_disc(0.2, tip_size=0.002)
    edge = mesh.points[mesh.boundaries["crack"]]
    length = np.hypot(*(edge[:, 0] - edge[:, 1]).T)
    at_tip = np.hypot(*edge.T).min(axis=0) < 1e-9
    assert length[at_tip].max() < 0.004
    assert length.max() > 0.05


def test_holes_are_named_boundaries() -> None:
    mesh = rectangle(2, 1, 0.1, holes=[(-0.5, 0, 0.2), (0.5, 0, 0.1)], hole_size=0.02)
    assert np.allclose(np.hypot(*(mesh.points[mesh.nodes("hole0")] - [-0.5, 0]).T), 0.2)
    assert np.allclose(np.hypot(*(mesh.points[mesh.nodes("hole1")] - [0.5, 0]).T), 0.1)
    assert mesh.area == pytest.approx(2 - np.pi * 0.05, rel=1e-3)


def test_the_same_call_makes_the_same_mesh_in_threads_too() -> None:
    with ThreadPoolExecutor(2) as pool:
        hashes = list(pool.map(lambda _: crack_tip_disc(0.2).sha256, range(4)))
    assert len(set(hashes)) == 1


def test_somebody_elses_gmsh_session_is_left_as_it_was() -> None:
    gmsh = load_gmsh()
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("Mesh.Algorithm", 5)
        gmsh.model.add("theirs")
        disc(0.5)
        assert gmsh.model.getCurrent() == "theirs"
        assert "cmverify-reference" not in gmsh.model.list()
        assert gmsh.option.getNumber("Mesh.Algorithm") == 5
    finally:
        gmsh.finalize()
    disc(0.5)
    assert not gmsh.isInitialized()


def test_a_missing_system_library_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def broken(name: str, *rest: Any, **named: Any) -> Any:
        if name == "gmsh":
            raise OSError("libGLU.so.1: cannot open shared object file: No such file or directory")
        return real(name, *rest, **named)

    monkeypatch.setattr(builtins, "__import__", broken)
    monkeypatch.setattr("ctypes.util.find_library", lambda name: None if name == "GLU" else "yes")
    with pytest.raises(MeshingUnavailableError, match=r"libGLU\.so\.1.*install libglu1-mesa"):
        disc(0.5)


def test_a_mesh_does_not_depend_on_the_unit_of_length() -> None:
    hole = [(0.4, 0.1, 0.2)]
    metres = rectangle(2, 1, 0.2, hole, [((-1, 0), (-0.5, 0))], 0.02)
    small = rectangle(2e-3, 1e-3, 2e-4, [(4e-4, 1e-4, 2e-4)], [((-1e-3, 0), (-5e-4, 0))], 2e-5)
    assert np.allclose(small.points, 1e-3 * metres.points, atol=1e-15)
    assert np.allclose(disc(2.0, 10.0).points, 10 * disc(0.2).points)


def test_bad_shapes_are_refused() -> None:
    with pytest.raises(ValueError, match="element size"):
        disc(-0.1)
    with pytest.raises(ValueError, match="outside the disc"):
        disc(0.1, cracks=[((0, 0), (2, 0))])
    with pytest.raises(ValueError, match="does not lie in the rectangle"):
        rectangle(1, 1, 0.1, holes=[(0.4, 0, 0.2)])
    with pytest.raises(ValueError, match="no boundary 'rim'"):
        disc(0.5).nodes("rim")
    with pytest.raises(ValueError, match="two different finite ends"):
        disc(0.1, cracks=[((0, 0), (0, 0))])
    with pytest.raises(ValueError, match="shorter than two elements"):
        rectangle(2, 2, 0.5, cracks=[((0, 0), (0.1, 0))])
