"""Ask FEniCSx a case of cmverify: quadratic elements, the hole as a mesh has it.

    cmverify export isotropic-hole --out problem
    python fenicsx_hole.py problem 0.05 fields.npz      # by an interpreter that has dolfinx
    cmverify compare isotropic-hole fenicsx=fields.npz

Body, solid and what is held come from the exported files, and values go back at the very points
that are judged.
"""

import contextlib
import json
import re
import sys
import time
from pathlib import Path

import gmsh
import numpy as np
from scipy.interpolate import CubicSpline

with contextlib.suppress(ImportError):  # the wheels want to load MPI before anything else does
    import dolfinx_solver  # noqa: F401
import ufl
from dolfinx import fem, geometry, mesh
from dolfinx.fem.petsc import LinearProblem
from dolfinx.io import gmsh as gmshio
from mpi4py import MPI


def body(width: float, radius: float, size: float) -> mesh.Mesh:
    """A square with a round hole, finer at the hole, of curved triangles."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    square = gmsh.model.occ.addRectangle(-width / 2, -width / 2, 0, width, width)
    hole = gmsh.model.occ.addDisk(0, 0, 0, radius, radius)
    gmsh.model.occ.cut([(2, square)], [(2, hole)])
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(2, [tag for _, tag in gmsh.model.getEntities(2)])
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", max(int(6.3 * radius / size) * 2, 12))
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(2)
    found = gmshio.model_to_mesh(gmsh.model, MPI.COMM_SELF, 0, gdim=2).mesh
    gmsh.finalize()
    return found


def held(edge: np.lib.npyio.NpzFile, x: np.ndarray) -> np.ndarray:
    """What the case holds at points (3, n) of the square's sides: splines along each side."""
    points, found = edge["points"], np.zeros((2, x.shape[1]))
    for axis in (0, 1):
        for side in (points.min(axis=0)[axis], points.max(axis=0)[axis]):
            there, here = np.abs(points[:, axis] - side) < 1e-9, np.abs(x[axis] - side) < 1e-9
            order = np.argsort(points[there, 1 - axis])
            for k, name in enumerate(("value_u1", "value_u2")):
                spline = CubicSpline(points[there, 1 - axis][order], edge[name][there][order])
                found[k, here] = spline(x[1 - axis, here])
    return found


def main(folder: str, size: str, answer: str) -> None:
    """Solve the problem in `folder` on triangles of about that size."""
    problem = json.loads(Path(folder, "case.json").read_text(encoding="utf-8"))
    edge, reference = (np.load(Path(folder, f"{n}.npz")) for n in ("boundary", "reference"))
    width = np.ptp(edge["points"][:, 0])
    radius = float(re.search(r"radius=([\d.]+)", problem["body"]["shape"])[1])
    domain = body(width, radius, float(size))
    begun = time.perf_counter()
    space = fem.functionspace(domain, ("Lagrange", 2, (2,)))
    matrix = ufl.as_matrix(problem["material"]["matrix"])
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    strain = [ufl.as_vector((w[0].dx(0), w[1].dx(1), w[0].dx(1) + w[1].dx(0))) for w in (u, v)]
    value = fem.Function(space)
    value.interpolate(lambda x: held(edge, x))
    rim = mesh.locate_entities_boundary(
        domain, 1, lambda x: np.abs(x[:2]).max(axis=0) > 0.4999 * width
    )
    fixed = fem.dirichletbc(value, fem.locate_dofs_topological(space, 1, rim))
    nothing = ufl.inner(fem.Constant(domain, np.zeros(2)), v) * ufl.dx
    solved = LinearProblem(
        ufl.inner(matrix * strain[0], strain[1]) * ufl.dx, nothing, bcs=[fixed],
        petsc_options={"ksp_type": "preonly", "pc_type": "lu"}, petsc_options_prefix="hole",
    ).solve()  # fmt: skip
    seconds = time.perf_counter() - begun
    points = reference["displacement_points"]
    solid = np.column_stack([points, np.zeros(len(points))])
    tree = geometry.bb_tree(domain, 2)
    near = geometry.compute_colliding_cells(
        domain, geometry.compute_collisions_points(tree, solid), solid
    )
    cells = np.array([near.links(i)[0] for i in range(len(points))], dtype=np.int32)
    unknowns = 2 * space.dofmap.index_map.size_global
    np.savez(
        answer,
        points=points,
        displacement=solved.eval(solid, cells),
        seconds=seconds,
        unknowns=unknowns,
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
