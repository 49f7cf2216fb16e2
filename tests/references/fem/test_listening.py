"""Who listens hears every problem, and may change its answer; meshes cut in four."""

import numpy as np

from references.fem.conduction import steady_conduction
from references.fem.listening import listening
from references.fem.mesh import crack_tip_disc, rectangle
from references.fem.slit import boundary_edges


def test_an_ear_hears_arguments_and_changes_the_answer():
    mesh, heard = rectangle(1, 1, 0.5), []

    def ear(problem):
        heard.append(problem)
        return "another"

    with listening(ear):
        assert steady_conduction(mesh, np.eye(2), 1.0) == "another"
    (problem,) = heard
    assert problem.solver == "steady_conduction"
    assert problem.arguments["order"] == 2
    assert problem.arguments["mesh"] is mesh
    assert np.allclose(problem.answer.values, 1.0)
    assert steady_conduction(mesh, np.eye(2), 1.0) != "another"


def test_a_refined_mesh_is_the_same_body_with_its_slit_and_edges():
    mesh = crack_tip_disc(0.4, tip_size=0.1)
    fine = mesh.refined()
    assert len(fine.triangles) == 4 * len(mesh.triangles)
    assert np.array_equal(fine.points[: len(mesh.points)], mesh.points)
    assert np.isclose(fine.area, mesh.area, rtol=1e-14)
    a, b, c = (fine.points[fine.triangles[:, i]] for i in range(3))
    assert ((b - a)[:, 0] * (c - a)[:, 1] > (b - a)[:, 1] * (c - a)[:, 0]).all()
    named = np.sort(np.concatenate(list(fine.boundaries.values())), axis=1)
    assert np.array_equal(np.unique(named, axis=0), boundary_edges(fine.triangles))
    # Both faces of the slit keep points of their own.
    faces = fine.points[fine.nodes("crack")]
    assert len(np.unique(faces.round(12), axis=0)) < len(faces)
