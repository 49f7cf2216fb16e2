"""Solves one plane problem with FEniCSx: ``python worker.py problem.npz answer.npz``.

Run by an interpreter that has dolfinx (0.5 to 0.11 and later), which need not have this project:
nothing of it is imported here. Under ``mpirun`` the mesh is distributed over the ranks.

The problem names its nodes itself (vertices, for quadratic elements also mid-sides) and says
which ones each triangle has. dolfinx renumbers everything; nodes are found again triangle by
triangle, by position, so that the doubled nodes of a slit are never confused.

Keys of the problem (n nodes, c components: 1 in conduction, else 2):

=========================  ==================  ====================================================
``physics``                str                 ``conduction``, ``elasticity``, ``modes`` or
                                               ``transient``
``order``                  int                 of the elements, 1 or 2
``points``                 (v, 2)              vertices, m
``triangles``              (M, 3) int          vertices of each triangle
``nodes``                  (n, 2)              the problem's own nodes: vertices, then mid-sides
``element_nodes``          (M, 3 or 6) int     nodes of each triangle, in any order
``tensor``                 (2, 2) or (3, 3)    conductivity, W/(m K), or stiffness (11, 22, 12), Pa
``prescribed``             (n, c)              temperature, K, or displacement, m; NaN where free
``source``                 (n, c), optional    nodal source, W/m³, or body force, N/m³
``element_tensor``         (M, k, d, d)        in place of ``tensor``, where it varies (static
                                               problems): at each triangle's k nodes, or k = 1
``element_source``         (M, 1), optional    source that is even in each triangle, W/m³
``initial_strain``         (M, 1, 3)           of each triangle without stress (11, 22, 2·12),
                                               optional
``free``                   bool, optional      nothing holds the body: loads must balance
``slack``                  float, optional     part of such loads that may be out of balance, 1e-8
                                               without; what is left is spread over the nodes
``passes``                 int, optional       times that it is solved, 1 without
``refined``                bool, optional      whether static solutions are refined, true without
``tractions``              int                 number of loaded boundaries (static problems)
``traction_edges_k``       (e, 2) int          edges of the k-th one, pairs of vertices
``traction_values_k``      (n, c)              its nodal tractions, Pa; used on those edges only
``density``                float               kg/m³ (modes)
``count``                  int                 eigenvalues wanted, rigid motions included (modes)
``shift``                  float               below the lowest eigenvalue, rad²/s² (modes)
``capacity``               float               J/(m³ K) (transient; the body is insulated)
``initial``                (n, 1)              temperature at the start, K (transient)
``duration``               float               s (transient)
``steps``                  int                 equal ones of the trapezoidal rule (transient)
=========================  ==================  ====================================================

Keys of the answer: ``values`` (n, c), or ``eigenvalues`` (count,) ascending, rad²/s²; ``ranks``; of
each pass (passes,) the seconds ``forms`` (compiled, or loaded, and bound to the mesh), ``setup``
(dolfinx's mesh, spaces, conditions, assembly) and ``solve``; and ``memory``, bytes by which the
process grew at most in the first one. What finds nodes and edges again is in none of them.
"""

import contextlib
import json
import signal
import sys
import time

import numpy as np

with contextlib.suppress(ImportError):  # the wheels want to load MPI before anything else does
    import dolfinx_solver  # type: ignore[import-not-found]  # noqa: F401
import dolfinx
import dolfinx.fem.petsc as petsc
import ufl  # type: ignore[import-not-found,import-untyped,unused-ignore]
from dolfinx import fem
from mpi4py import MPI  # type: ignore[import-not-found,unused-ignore]
from petsc4py import PETSc  # type: ignore[import-not-found,unused-ignore]

MODERN = hasattr(fem, "functionspace")  # 0.7 and later


class Watch:
    """Seconds by stage; what is in a stage within another counts for the inner one."""

    def __init__(self):  # type: ignore[no-untyped-def]
        self.seconds = dict.fromkeys(("", "forms", "setup", "solve"), 0.0)
        self.stage, self.since = "", time.perf_counter()

    @contextlib.contextmanager
    def __call__(self, stage):  # type: ignore[no-untyped-def]
        """Count the block for a stage."""
        before = self._turn(stage)
        try:
            yield
        finally:
            self._turn(before)

    def _turn(self, stage):  # type: ignore[no-untyped-def]
        before, now = self.stage, time.perf_counter()
        self.seconds[before] += now - self.since
        self.stage, self.since = stage, now
        return before


watch = Watch()


def compiled(form):  # type: ignore[no-untyped-def]
    """A form that can be assembled."""
    with watch("forms"):
        return fem.form(form)


def most_memory():  # type: ignore[no-untyped-def]
    """The most memory that this process has had, bytes; 0 where the system does not say."""
    # Where Linux keeps it: getrusage counts what the process was before it became this program.
    with contextlib.suppress(OSError, IndexError), open("/proc/self/status") as status:
        return 1024 * int(status.read().split("VmHWM:")[1].split()[0])
    with contextlib.suppress(ImportError):
        import resource

        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return most if sys.platform == "darwin" else 1024 * most
    return 0


def distribute(points, triangles):  # type: ignore[no-untyped-def]
    """The mesh over all ranks; the first one hands it over."""
    comm = MPI.COMM_WORLD
    mine = slice(None) if comm.rank == 0 else slice(0, 0)
    cells, x = triangles[mine].astype(np.int64), points[mine].astype(float)
    if MODERN:
        import basix.ufl  # type: ignore[import-not-found,unused-ignore]

        element = basix.ufl.element("Lagrange", "triangle", 1, shape=(2,))
        return dolfinx.mesh.create_mesh(comm, cells, element, x)
    domain = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.Cell("triangle", geometric_dimension=2), 1))
    return dolfinx.mesh.create_mesh(comm, cells, x, domain)


def function_space(mesh, order, components):  # type: ignore[no-untyped-def]
    """Lagrange elements with one or two components."""
    if MODERN:
        shape = () if components == 1 else (components,)
        return fem.functionspace(mesh, ("Lagrange", order, shape))
    if components == 1:
        return fem.FunctionSpace(mesh, ("Lagrange", order))
    return fem.VectorFunctionSpace(mesh, ("Lagrange", order))


def vector_of(function):  # type: ignore[no-untyped-def]
    """The PETSc vector behind a function."""
    return function.x.petsc_vec if hasattr(function.x, "petsc_vec") else function.vector


class Nodes:
    """The problem's node number of each of dolfinx's nodes on this rank."""

    def __init__(self, mesh, space, nodes, element_nodes):  # type: ignore[no-untyped-def]
        index_map = mesh.topology.index_map(2)
        cells = index_map.size_local + index_map.num_ghosts
        listed = space.dofmap.list
        dofs = np.asarray(listed.array if hasattr(listed, "array") else listed).reshape(cells, -1)
        original = np.asarray(mesh.topology.original_cell_index)[:cells]
        theirs = space.tabulate_dof_coordinates()[:, :2][dofs]
        ours = nodes[element_nodes[original]]
        distance = np.linalg.norm(theirs[:, :, None] - ours[:, None], axis=-1)
        match = distance.argmin(axis=2)
        size = np.abs(ours - ours.mean(axis=1, keepdims=True)).max(axis=(1, 2))
        worst = np.take_along_axis(distance, match[:, :, None], axis=2)[:, :, 0].max(axis=1)
        if np.any(worst > 1e-6 * size):
            raise RuntimeError("dolfinx's nodes do not coincide with those of the problem")
        self.owned = space.dofmap.index_map.size_local
        self.number = np.full(self.owned + space.dofmap.index_map.num_ghosts, -1)
        self.number[dofs] = np.take_along_axis(element_nodes[original], match, axis=1)
        self.present = np.flatnonzero(self.number >= 0)

    def fill(self, function, values):  # type: ignore[no-untyped-def]
        """Set a function's nodal values (n,) or (n, c)."""
        array = function.x.array.reshape(len(self.number), -1)
        array[self.present] = values.reshape(len(values), -1)[self.number[self.present]]

    def gather(self, function, total):  # type: ignore[no-untyped-def]
        """Nodal values in the problem's numbering, on the first rank."""
        array = np.real(function.x.array).reshape(len(self.number), -1)[: self.owned]
        parts = MPI.COMM_WORLD.gather((self.number[: self.owned], array.copy()), root=0)
        if MPI.COMM_WORLD.rank:
            return None
        values = np.full((total, array.shape[1]), np.nan)
        for number, part in parts:
            values[number] = part
        if np.isnan(values).any():
            raise RuntimeError("some nodes of the problem got no value from dolfinx")
        return values


def element_wise(mesh, nodes, element_nodes, values):  # type: ignore[no-untyped-def]
    """A function that may jump between triangles, from its values (M, k, ...) there.

    k is 1 for what is even in each, else the number of the triangle's nodes.
    """
    degree, shape = {1: 0, 3: 1, 6: 2}[values.shape[1]], values.shape[2:]
    if MODERN:
        space = fem.functionspace(mesh, ("DG", degree, shape))
    else:
        family = {0: fem.FunctionSpace, 1: fem.VectorFunctionSpace, 2: fem.TensorFunctionSpace}
        space = family[len(shape)](mesh, ("DG", degree))
    index_map = mesh.topology.index_map(2)
    cells = index_map.size_local + index_map.num_ghosts
    listed = space.dofmap.list
    dofs = np.asarray(listed.array if hasattr(listed, "array") else listed).reshape(cells, -1)
    own = values[np.asarray(mesh.topology.original_cell_index)[:cells]]
    if degree:
        ours = nodes[element_nodes[np.asarray(mesh.topology.original_cell_index)[:cells]]]
        theirs = space.tabulate_dof_coordinates()[:, :2][dofs]
        match = np.linalg.norm(theirs[:, :, None] - ours[:, None], axis=-1).argmin(axis=2)
        own = own[np.arange(cells)[:, None], match]
    function = fem.Function(space)
    array = function.x.array.reshape(-1, max(int(np.prod(shape)), 1))
    array[dofs] = own.reshape(*dofs.shape, -1)
    return function


def locate_facets(mesh, edges):  # type: ignore[no-untyped-def]
    """dolfinx's facets for pairs (k, 2) of the problem's vertices, among this rank's."""
    topology = mesh.topology
    topology.create_entities(1)
    topology.create_connectivity(1, 2)
    topology.create_connectivity(2, 1)
    topology.create_connectivity(1, 0)
    topology.create_connectivity(2, 0)
    cells = topology.index_map(2).size_local + topology.index_map(2).num_ghosts
    geometry = mesh.geometry.dofmap
    geometry = np.asarray(geometry.array if hasattr(geometry, "array") else geometry)
    corners = np.asarray(topology.connectivity(2, 0).array).reshape(cells, 3)
    original = np.zeros(corners.max(initial=-1) + 1, dtype=np.int64)
    original[corners] = np.asarray(mesh.geometry.input_global_indices)[geometry.reshape(cells, 3)]
    pairs = np.sort(original[np.asarray(topology.connectivity(1, 0).array).reshape(-1, 2)], axis=1)
    wanted = {tuple(pair) for pair in np.sort(edges, axis=1).tolist()}
    return np.array(
        [i for i, pair in enumerate(pairs.tolist()) if tuple(pair) in wanted], dtype=np.int32
    )


def prescribe(space, nodes, values):  # type: ignore[no-untyped-def]
    """Dirichlet conditions from nodal values (n, c) with NaN where free."""
    held = fem.Function(space)
    nodes.fill(held, np.nan_to_num(values))
    conditions = []
    components = values.shape[1]
    for c in range(components):
        known = np.zeros(len(nodes.number), dtype=bool)
        known[nodes.present] = ~np.isnan(values[nodes.number[nodes.present], c])
        if components == 1:
            conditions.append(fem.dirichletbc(held, np.flatnonzero(known).astype(np.int32)))
            continue
        # one condition on the component's subspace; its unknowns in both numberings
        sub = space.sub(c)
        collapsed, to_parent = sub.collapse()
        to_parent = np.ravel(to_parent)  # a list of one array in recent versions
        child = np.flatnonzero(known[to_parent // components])
        part = fem.Function(collapsed)
        part.x.array[:] = held.x.array[to_parent]
        pair = [to_parent[child].astype(np.int32), child.astype(np.int32)]
        conditions.append(fem.dirichletbc(part, pair, sub))
    return conditions


def strain(u):  # type: ignore[no-untyped-def]
    """Voigt strain 11, 22, 2·12."""
    g = ufl.grad(u)
    return ufl.as_vector([g[0, 0], g[1, 1], g[0, 1] + g[1, 0]])


def tensor_of(problem, mesh):  # type: ignore[no-untyped-def]
    """Conductivity or stiffness: one for all, or one that varies."""
    if "element_tensor" in problem:
        place = (problem["nodes"], problem["element_nodes"])
        return element_wise(mesh, *place, problem["element_tensor"])
    return fem.Constant(mesh, np.asarray(problem["tensor"], dtype=PETSc.ScalarType))


def energy(problem, mesh, space):  # type: ignore[no-untyped-def]
    """The stiffness form of the problem's physics."""
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    tensor = tensor_of(problem, mesh)
    if str(problem["physics"]) in ("conduction", "transient"):
        return ufl.inner(ufl.dot(tensor, ufl.grad(u)), ufl.grad(v)) * ufl.dx
    return ufl.inner(ufl.dot(tensor, strain(u)), strain(v)) * ufl.dx


def direct_solver(matrix, refined=True):  # type: ignore[no-untyped-def]
    """LU, with refinement by the Krylov method around it."""
    solver = PETSc.KSP().create(matrix.getComm())
    solver.setOperators(matrix)
    solver.setType("fgmres" if refined else "preonly")
    solver.setTolerances(rtol=1e-15, atol=1e-300, max_it=4)
    use_lu(solver.getPC())
    return solver


def use_lu(preconditioner):  # type: ignore[no-untyped-def]
    """LU, by MUMPS where PETSc has it (its own LU knows one rank only)."""
    preconditioner.setType("lu")
    for package in ("mumps", "superlu_dist"):
        if PETSc.Sys.hasExternalPackage(package):
            preconditioner.setFactorSolverType(package)
            return
    if MPI.COMM_WORLD.size > 1:
        raise RuntimeError("this PETSc has no parallel LU: run the worker on one rank")


def balance(load, space, nodes, slack):  # type: ignore[no-untyped-def]
    """Refuse loads with a resultant: three held components would carry it in silence.

    What is within the slack is spread over all nodes.
    """
    comm = MPI.COMM_WORLD
    x = space.tabulate_dof_coordinates()[: nodes.owned, :2]
    away = comm.allreduce(float(np.abs(x).max(initial=0.0)), op=MPI.MAX)
    rigid = np.zeros((nodes.owned, 2, 3))
    rigid[:, 0, 0] = rigid[:, 1, 1] = 1.0
    rigid[:, 0, 2], rigid[:, 1, 2] = -x[:, 1] / away, x[:, 0] / away
    rigid = rigid.reshape(-1, 3)
    total = comm.allreduce(float(np.abs(load.array).sum()))
    resultant = comm.allreduce(rigid.T @ load.array)
    if np.abs(resultant).max() > slack * total:
        raise RuntimeError("nothing holds the body and its loads are not in equilibrium")
    load.array[:] -= rigid @ np.linalg.solve(comm.allreduce(rigid.T @ rigid), resultant)


def solve_static(problem, mesh, space, nodes):  # type: ignore[no-untyped-def]
    """Prescribed values, sources and tractions -> nodal values."""
    v = ufl.TestFunction(space)
    components = problem["prescribed"].shape[1]
    zero = np.zeros(components, dtype=PETSc.ScalarType)
    nothing = fem.Constant(mesh, zero if components > 1 else zero[0])
    right = ufl.inner(nothing, v) * ufl.dx
    if "source" in problem:
        source = fem.Function(space)
        nodes.fill(source, problem["source"])
        right += ufl.inner(source, v) * ufl.dx
    place = (mesh, problem["nodes"], problem["element_nodes"])
    if "element_source" in problem:
        right += ufl.inner(element_wise(*place, problem["element_source"]), v) * ufl.dx
    if "initial_strain" in problem:
        initial = element_wise(*place, problem["initial_strain"])
        right += ufl.inner(ufl.dot(tensor_of(problem, mesh), initial), strain(v)) * ufl.dx
    number = int(problem["tractions"])
    if number:
        with watch(""):  # other programs name edges, and do not look for them
            edges = [locate_facets(mesh, problem[f"traction_edges_{k}"]) for k in range(number)]
        labels = np.repeat(np.arange(number, dtype=np.int32), [len(e) for e in edges])
        facets = np.concatenate(edges)
        order = np.argsort(facets)
        tags = dolfinx.mesh.meshtags(mesh, 1, facets[order], labels[order])
        boundary = ufl.Measure("ds", domain=mesh, subdomain_data=tags)
        for k in range(number):
            pull = fem.Function(space)
            nodes.fill(pull, problem[f"traction_values_{k}"])
            right += ufl.inner(pull, v) * boundary(k)
    form = compiled(energy(problem, mesh, space))
    conditions = prescribe(space, nodes, problem["prescribed"])
    matrix = petsc.assemble_matrix(form, bcs=conditions)
    matrix.assemble()
    load = petsc.assemble_vector(compiled(right))
    petsc.apply_lifting(load, [form], [conditions])
    load.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
    if bool(problem.get("free", False)):
        balance(load, space, nodes, float(problem.get("slack", 1e-8)))
    petsc.set_bc(load, conditions)
    solution = fem.Function(space)
    with watch("solve"):
        direct_solver(matrix, bool(problem.get("refined", True))).solve(load, vector_of(solution))
        solution.x.scatter_forward()
    with watch(""):
        return {"values": nodes.gather(solution, len(problem["nodes"]))}


def solve_modes(problem, mesh, space, nodes):  # type: ignore[no-untyped-def]
    """Lowest eigenvalues of K x = λ M x."""
    from slepc4py import SLEPc  # type: ignore[import-not-found,unused-ignore]

    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    density = fem.Constant(mesh, PETSc.ScalarType(float(problem["density"])))
    conditions = prescribe(space, nodes, problem["prescribed"])
    zero_diagonal = {"diag": 0.0} if MODERN else {"diagonal": 0.0}
    stiffness = petsc.assemble_matrix(compiled(energy(problem, mesh, space)), bcs=conditions)
    stiffness.assemble()
    # no mass where held: those eigenvalues are infinite and out of the way
    inertia = compiled(density * ufl.inner(u, v) * ufl.dx)
    mass = petsc.assemble_matrix(inertia, bcs=conditions, **zero_diagonal)
    mass.assemble()
    solver = SLEPc.EPS().create(MPI.COMM_WORLD)
    solver.setOperators(stiffness, mass)
    solver.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    solver.setDimensions(int(problem["count"]))
    solver.setTarget(float(problem["shift"]))
    solver.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
    solver.setTolerances(1e-13, 1000)
    transform = solver.getST()
    transform.setType(SLEPc.ST.Type.SINVERT)
    transform.setShift(float(problem["shift"]))
    linear = transform.getKSP()
    linear.setType("preonly")
    use_lu(linear.getPC())
    with watch("solve"):
        solver.solve()
    found = solver.getConverged()
    if found < int(problem["count"]):
        raise RuntimeError(f"only {found} eigenvalues of {int(problem['count'])} converged")
    values = np.sort([solver.getEigenvalue(i).real for i in range(found)])
    return {"eigenvalues": values[: int(problem["count"])]}


def solve_transient(problem, mesh, space, nodes):  # type: ignore[no-untyped-def]
    """Crank and Nicolson's rule after two implicit half steps: nodal temperatures at the end."""
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    capacity = fem.Constant(mesh, PETSc.ScalarType(float(problem["capacity"])))
    stiffness = petsc.assemble_matrix(compiled(energy(problem, mesh, space)))
    stiffness.assemble()
    mass = petsc.assemble_matrix(compiled(capacity * ufl.inner(u, v) * ufl.dx))
    mass.assemble()
    steps = int(problem["steps"])
    step = float(problem["duration"]) / steps
    system = mass.copy()
    system.scale(1.0 / step)
    system.axpy(0.5, stiffness)
    solver = direct_solver(system)
    field = fem.Function(space)
    nodes.fill(field, problem["initial"])
    now = system.createVecRight()
    now.array[:] = field.x.array[: nodes.owned]
    right, flow = now.duplicate(), now.duplicate()
    with watch("solve"):
        for i in range(-1, steps):
            # Twice M T/Δt alone: implicit Euler over half a step has the same matrix.
            mass.mult(now, right)
            right.scale(1.0 / step)
            if i > 0:
                stiffness.mult(now, flow)
                right.axpy(-0.5, flow)
            solver.solve(right, now)
    field.x.array[: nodes.owned] = now.array
    with watch(""):
        return {"values": nodes.gather(field, len(problem["nodes"]))}


SOLVERS = {"modes": solve_modes, "transient": solve_transient}


def once(problem):  # type: ignore[no-untyped-def]
    """From arrays to the answer."""
    with watch("setup"):
        mesh = distribute(problem["points"], problem["triangles"])
        space = function_space(mesh, int(problem["order"]), problem["prescribed"].shape[1])
        with watch(""):
            nodes = Nodes(mesh, space, problem["nodes"], problem["element_nodes"])
        return SOLVERS.get(str(problem["physics"]), solve_static)(problem, mesh, space, nodes)


def main(problem_file, answer_file):  # type: ignore[no-untyped-def]
    """Read, solve, write."""
    global watch
    with np.load(problem_file) as archive:
        problem = {name: archive[name] for name in archive.files}
    spent: dict[str, list[float]] = {stage: [] for stage in ("forms", "setup", "solve")}
    before, memory = most_memory(), None
    for _ in range(int(problem.get("passes", 1))):
        watch = Watch()
        answer = once(problem)
        memory = most_memory() - before if memory is None else memory
        for stage, seconds in spent.items():
            seconds.append(watch.seconds[stage])
    if MPI.COMM_WORLD.rank == 0:
        answer.update({stage: np.array(seconds) for stage, seconds in spent.items()})
        answer["memory"] = np.array(memory)
        answer["ranks"] = np.array(MPI.COMM_WORLD.size)
        np.savez(answer_file, **answer)


if __name__ == "__main__":
    if sys.argv[1:] == ["--describe"]:
        import slepc4py  # type: ignore[import-not-found,unused-ignore]

        if np.issubdtype(PETSc.ScalarType, np.complexfloating):
            sys.exit("PETSc was built for complex numbers; a real build is needed")
        versions = {"dolfinx": dolfinx.__version__, "slepc4py": slepc4py.__version__}
        print(json.dumps({**versions, "petsc": ".".join(map(str, PETSc.Sys.getVersion()))}))
    else:
        if sys.platform == "linux":
            import ctypes

            # The system ends this process with the one that waits for its answer.
            ctypes.CDLL(None).prctl(1, int(signal.SIGKILL))
        main(*sys.argv[1:])
