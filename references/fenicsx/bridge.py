"""Finds FEniCSx and hands it problems; the answers come back in scikit-fem's numbering."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
import skfem
from numpy.typing import ArrayLike, NDArray

from references.analytic.conduction import checked_conductivity
from references.analytic.voigt import checked_voigt
from references.eigen import elastic_part
from references.fem.conduction import Scalar, evaluate
from references.fem.elasticity import (
    ElasticSolution,
    Vector,
    component_dofs,
    evaluate_vector,
    pins,
    strain,
)
from references.fem.evaluation import ELEMENTS, check_order, dirichlet_points, to_skfem
from references.fem.leads import Lead
from references.fem.mesh import Mesh
from references.fem.restraint import require_held, require_temperature, rigid_motions

VARIABLE = "CMVERIFY_FENICSX_PYTHON"
INSTALL = (
    "FEniCSx not found. Python >= 3.12: pip install 'cmverify[fenicsx]'; Debian: apt-get install"
    " python3-dolfinx python3-slepc4py-real; elsewhere point CMVERIFY_FENICSX_PYTHON at an"
    " interpreter that can import dolfinx"
)
_WORKER = Path(__file__).with_name("worker.py")
# what would make a foreign interpreter load our packages or libraries
_FOREIGN = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "LD_LIBRARY_PATH", "PYTHONSAFEPATH")


class FenicsxError(RuntimeError):
    """The worker failed; the message carries its last words."""


@dataclass
class Timing:
    """What problems cost that are solved several times by one worker, without its start.

    Attributes
    ----------
    passes : int
    taken : list of dict
        Of each problem: seconds (passes,) of ``forms``, ``setup`` and ``solve``; ``memory``, bytes
        by which the worker grew at most in the first pass.
    """

    passes: int
    taken: list[dict[str, NDArray[np.float64]]] = field(default_factory=list)


_timing: ContextVar[Timing | None] = ContextVar("_timing", default=None)


@contextmanager
def timed(passes: int) -> Iterator[Timing]:
    """Solve what is handed over within the block so many times, by plain LU, and keep the times.

    Loads of a free body may be out of balance by a thousandth, as scikit-fem's may: interpolated
    tractions are.
    """
    before = _timing.set(timing := Timing(passes))
    try:
        yield timing
    finally:
        _timing.reset(before)


@dataclass(frozen=True)
class Fenicsx:
    """An interpreter that has FEniCSx.

    Attributes
    ----------
    python : str
    found_by : str
        The environment variable, "this interpreter" or "the system's interpreter".
    versions : dict
        Of dolfinx, petsc and slepc4py.
    """

    python: str
    found_by: str
    versions: Mapping[str, str]

    def __str__(self) -> str:
        packages = ", ".join(f"{name} {version}" for name, version in self.versions.items())
        return f"{packages} in {self.python} ({self.found_by})"


def _environment() -> dict[str, str]:
    clean = {k: v for k, v in os.environ.items() if k not in _FOREIGN}
    # MPI refuses root and more ranks than cores unless told; both are usual in containers
    clean.update(
        OMP_NUM_THREADS="1",
        OMPI_ALLOW_RUN_AS_ROOT="1",
        OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
        OMPI_MCA_rmaps_base_oversubscribe="1",
        OMPI_MCA_btl_vader_single_copy_mechanism="none",
    )
    return clean


@cache
def _describe(python: str) -> dict[str, str] | str:
    """Versions that an interpreter reports, or why it has none."""
    try:
        done = subprocess.run(
            [python, str(_WORKER), "--describe"],
            env=_environment(),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return str(error)
    if done.returncode:
        return (done.stderr.strip().splitlines() or ["it failed"])[-1]
    versions: dict[str, str] = json.loads(done.stdout.strip().splitlines()[-1])
    return versions


def find() -> Fenicsx | None:
    """The first interpreter that has FEniCSx, or None.

    Looked for in ``CMVERIFY_FENICSX_PYTHON``, this interpreter, ``/usr/bin/python3``.

    Raises
    ------
    FenicsxError
        If the variable is set but its interpreter cannot import FEniCSx: a wrong setting must not
        pass silently for another installation.
    """
    chosen = os.environ.get(VARIABLE)
    if chosen:
        versions = _describe(chosen)
        if isinstance(versions, str):
            raise FenicsxError(f"{VARIABLE}={chosen} has no usable FEniCSx: {versions}")
        return Fenicsx(chosen, VARIABLE, versions)
    for python, by in (
        (sys.executable, "this interpreter"),
        ("/usr/bin/python3", "the system's interpreter"),
    ):
        versions = _describe(python)
        if not isinstance(versions, str):
            return Fenicsx(python, by, versions)
    return None


def _launcher(python: str, processes: int) -> list[str]:
    if processes == 1:
        return []
    beside = Path(python).with_name("mpirun")
    program = str(beside) if beside.exists() else shutil.which("mpirun")
    if program is None:
        raise FenicsxError("mpirun is not installed: only one process can be used")
    return [program, "-n", str(processes)]


def run(
    problem: Mapping[str, ArrayLike], processes: int = 1, timeout: float = 600.0
) -> dict[str, NDArray[np.float64]]:
    """Hand a problem (see ``worker.py``) to FEniCSx and return its answer.

    Raises
    ------
    FenicsxError
        If FEniCSx is missing, fails, or takes longer than ``timeout`` seconds.
    """
    if processes < 1:
        raise ValueError("at least one process")
    fenicsx = find()
    if fenicsx is None:
        raise FenicsxError(INSTALL)
    timing = _timing.get()
    if timing is not None:
        problem = {**problem, "passes": timing.passes, "refined": False, "slack": 1e-3}
    with tempfile.TemporaryDirectory(prefix="cmverify-") as folder:
        given, answer = Path(folder, "problem.npz"), Path(folder, "answer.npz")
        np.savez(given, **{k: np.asarray(v) for k, v in problem.items()})  # type: ignore[arg-type]
        command = [fenicsx.python, str(_WORKER), str(given), str(answer)]
        try:
            done = subprocess.run(
                _launcher(fenicsx.python, processes) + command,
                env=_environment(),
                cwd=folder,
                capture_output=True,
                text=True,
                timeout=timeout,
                check=False,
            )
        except subprocess.TimeoutExpired as error:
            raise FenicsxError(f"FEniCSx took longer than {timeout:g} s") from error
        if done.returncode or not answer.exists():
            words = "\n".join((done.stderr or done.stdout).strip().splitlines()[-12:])
            raise FenicsxError(f"FEniCSx ({fenicsx}) failed:\n{words}")
        with np.load(answer) as archive:
            found = {name: archive[name] for name in archive.files}
    if int(found["ranks"]) != processes:
        raise FenicsxError(
            f"{processes} ranks were started but {int(found['ranks'])} took part: mpirun belongs"
            " to another MPI than FEniCSx"
        )
    if timing is not None:
        timing.taken.append({key: found[key] for key in ("forms", "setup", "solve", "memory")})
    return found


@dataclass(frozen=True)
class Numbering:
    """Nodes as scikit-fem numbers them, so that answers compare node by node."""

    nodes: NDArray[np.float64]
    element_nodes: NDArray[np.int64]
    on: Mapping[str, NDArray[np.int64]]
    problem: dict[str, ArrayLike]


def number(mesh: Mesh, order: int) -> Numbering:
    check_order(order)
    triangulation, facets = to_skfem(mesh)
    basis = skfem.Basis(triangulation, ELEMENTS[order]())
    nodes = basis.doflocs.T
    problem: dict[str, ArrayLike] = {
        "points": mesh.points,
        "triangles": triangulation.t.T,
        "nodes": nodes,
        "element_nodes": basis.element_dofs.T,
        "order": order,
        "tractions": 0,
    }
    on = {name: basis.get_dofs(found).flatten() for name, found in facets.items()}
    return Numbering(nodes, basis.element_dofs, on, problem)


def steady_conduction(
    mesh: Mesh,
    conductivity: ArrayLike,
    boundary_temperature: Scalar | Mapping[str, Scalar],
    source: Scalar = 0.0,
    order: int = 2,
    processes: int = 1,
) -> NDArray[np.float64]:
    """As :func:`references.fem.conduction.steady_conduction`; nodal temperatures (n,).

    The source is interpolated at the nodes: exact for polynomials up to the elements' order.
    """
    numbering = number(mesh, order)
    x, y = dirichlet_points(mesh, numbering.nodes, numbering.element_nodes).T
    prescribed = np.full((len(x), 1), np.nan)
    if isinstance(boundary_temperature, Mapping):
        given: dict[str, Scalar] = dict(boundary_temperature)
    else:
        given = dict.fromkeys(mesh.outer, boundary_temperature)
    for name, temperature in given.items():
        mesh.nodes(name)
        held = numbering.on[name]
        prescribed[held, 0] = evaluate(temperature, x[held], y[held])
    require_temperature(numbering.nodes, numbering.element_nodes, ~np.isnan(prescribed[:, 0]))
    problem = {
        **numbering.problem,
        "physics": "conduction",
        "tensor": checked_conductivity(conductivity),
        "prescribed": prescribed,
        "source": evaluate(source, x, y),
    }
    return run(problem, processes)["values"][:, 0]


def solve_elasticity(
    mesh: Mesh,
    voigt: ArrayLike,
    displacement: Vector | Mapping[str, Vector] | None = None,
    tractions: Mapping[str, Vector] | None = None,
    body_force: Vector | None = None,
    order: int = 2,
    processes: int = 1,
) -> NDArray[np.float64]:
    """As :func:`references.fem.elasticity.solve_elasticity`; nodal displacements (n, 2).

    Forces and tractions are interpolated at the nodes: exact for polynomials up to the elements'
    order. Loads on a body that nothing holds must balance but for rounding, chords included.

    Raises
    ------
    FenicsxError
        If they do not.
    """
    numbering = number(mesh, order)
    x, y = dirichlet_points(mesh, numbering.nodes, numbering.element_nodes).T
    prescribed = np.full((len(x), 2), np.nan)
    given: dict[str, Vector] = {}
    if isinstance(displacement, Mapping):
        given = dict(displacement)
    elif displacement is not None:
        given = dict.fromkeys(mesh.outer, displacement)
    if not given:
        left, far, across = pins(numbering.nodes)
        prescribed[left] = prescribed[far, across] = 0.0
    for name, wanted in given.items():
        mesh.nodes(name)
        held = numbering.on[name]
        values = evaluate_vector(wanted, x[held], y[held])
        prescribed[held] = np.where(np.isnan(values), prescribed[held], values)
    require_held(numbering.nodes, numbering.element_nodes, ~np.isnan(prescribed))
    problem = {
        **numbering.problem,
        "physics": "elasticity",
        "tensor": checked_voigt(voigt),
        "prescribed": prescribed,
        "tractions": len(tractions or {}),
        "free": not given,
    }
    if body_force is not None:
        problem["source"] = evaluate_vector(body_force, x, y)
    for k, (name, traction) in enumerate((tractions or {}).items()):
        mesh.nodes(name)
        problem[f"traction_edges_{k}"] = mesh.boundaries[name]
        problem[f"traction_values_{k}"] = evaluate_vector(traction, x, y)
    return run(problem, processes)["values"]


def several_solids(
    mesh: Mesh,
    tensors: ArrayLike,
    solid: NDArray[np.int64],
    held: Callable[[NDArray[np.float64], NDArray[np.bool_]], NDArray[np.float64]],
    order: int = 2,
) -> NDArray[np.float64]:
    """As :func:`references.fem.general.solve` without loads; nodal values (n,) or (n, 2)."""
    numbering = number(mesh, order)
    places = dirichlet_points(mesh, numbering.nodes, numbering.element_nodes)
    edge = np.zeros(len(places), dtype=bool)
    edge[numbering.on["edge"]] = True
    moduli = np.asarray(tensors, dtype=float)
    elastic = moduli.shape[-1] == 3
    prescribed = np.asarray(held(places, edge), dtype=float).reshape(len(places), -1)
    need = require_held if elastic else require_temperature
    known = ~np.isnan(prescribed)
    need(numbering.nodes, numbering.element_nodes, known if elastic else known[:, 0])
    problem = {
        **numbering.problem,
        "physics": "elasticity" if elastic else "conduction",
        "element_tensor": moduli[solid][:, None],
        "prescribed": prescribed,
    }
    values = run(problem)["values"]
    return values if elastic else values[:, 0]


def between_leads(
    mesh: Mesh,
    conductivity: ArrayLike,
    leads: Sequence[Lead],
    order: int = 2,
    processes: int = 1,
) -> NDArray[np.float64]:
    """As :func:`references.fem.leads.plate_between_leads` on its mesh; nodal potentials (n,)."""
    numbering = number(mesh, order)
    x, y = numbering.nodes.T
    prescribed = np.full((len(x), 1), np.nan)
    feed = np.zeros((len(mesh.triangles), 1))
    margin, centres = 1e-6 * mesh.size, mesh.points[mesh.triangles].mean(axis=1).T
    for lead in leads:
        if lead.potential is not None:
            prescribed[lead.holds(x, y, margin)] = lead.potential
        if lead.current is not None:
            inside = lead.holds(centres[0], centres[1], 0.0)
            feed[inside] += lead.current / ((lead.x1 - lead.x0) * (lead.y1 - lead.y0))
    if np.isnan(prescribed).all():
        prescribed[np.argmin(x + y)] = 0.0
    require_temperature(numbering.nodes, numbering.element_nodes, ~np.isnan(prescribed[:, 0]))
    problem = {
        **numbering.problem,
        "physics": "conduction",
        "tensor": checked_conductivity(conductivity),
        "prescribed": prescribed,
        "element_source": feed,
    }
    return run(problem, processes)["values"][:, 0]


def strained_conduction(
    elastic: ElasticSolution,
    conductivity: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    inflow: Mapping[str, float],
    processes: int = 1,
) -> NDArray[np.float64]:
    """As :func:`references.fem.piezoresistive.strained_conduction`; nodal potentials (n,).

    The conductivity is taken at the nodes of each triangle and is a polynomial between them.
    """
    mesh, order = elastic.mesh, elastic.order
    numbering = number(mesh, order)
    corners = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    local = np.hstack([corners, (corners + np.roll(corners, -1, axis=1)) / 2])
    local = local[:, : len(numbering.element_nodes)]
    triangulation, _ = to_skfem(mesh)
    motion = skfem.Basis(
        triangulation,
        skfem.ElementVector(ELEMENTS[order]()),
        quadrature=(local, np.full(local.shape[1], 0.5 / local.shape[1])),
    )
    displacement = np.zeros(motion.N)
    displacement[component_dofs(motion)] = elastic.values
    tensor = np.moveaxis(conductivity(strain(motion.interpolate(displacement))), (0, 1), (2, 3))
    prescribed = np.full((len(numbering.nodes), 1), np.nan)
    prescribed[np.argmin(numbering.nodes.sum(axis=1))] = 0.0
    problem = {
        **numbering.problem,
        "physics": "conduction",
        "element_tensor": tensor,
        "prescribed": prescribed,
        "tractions": len(inflow),
    }
    for k, (name, density) in enumerate(inflow.items()):
        mesh.nodes(name)
        problem[f"traction_edges_{k}"] = mesh.boundaries[name]
        problem[f"traction_values_{k}"] = np.full((len(numbering.nodes), 1), density)
    return run(problem, processes)["values"][:, 0]


def transient_conduction(
    mesh: Mesh,
    conductivity: ArrayLike,
    capacity: float,
    initial: Scalar,
    duration: float,
    steps: int,
    order: int = 2,
    processes: int = 1,
) -> NDArray[np.float64]:
    """As :func:`references.fem.transient.transient_conduction`, insulated, without a source.

    Nodal temperatures (n,) at the end.
    """
    numbering = number(mesh, order)
    x, y = dirichlet_points(mesh, numbering.nodes, numbering.element_nodes).T
    problem = {
        **numbering.problem,
        "physics": "transient",
        "tensor": checked_conductivity(conductivity),
        "prescribed": np.full((len(x), 1), np.nan),
        "capacity": float(capacity),
        "initial": evaluate(initial, x, y)[:, None],
        "duration": float(duration),
        "steps": int(steps),
    }
    return run(problem, processes)["values"][:, 0]


def in_plane_frequencies(
    mesh: Mesh,
    voigt: ArrayLike,
    density: float,
    count: int,
    clamped: tuple[str, ...] = (),
    order: int = 2,
    processes: int = 1,
) -> NDArray[np.float64]:
    """As :func:`references.fem.modes.in_plane_modes`; circular frequencies (count,), rad/s."""
    numbering = number(mesh, order)
    prescribed = np.full((len(numbering.nodes), 2), np.nan)
    for name in clamped:
        mesh.nodes(name)
        prescribed[numbering.on[name]] = 0.0
    tensor = checked_voigt(voigt)
    rigid = rigid_motions(numbering.nodes, numbering.element_nodes, ~np.isnan(prescribed))
    extent = np.ptp(mesh.points, axis=0).max()
    problem = {
        **numbering.problem,
        "physics": "modes",
        "tensor": tensor,
        "prescribed": prescribed,
        "density": float(density),
        "count": count + rigid,
        "shift": -float(np.linalg.eigvalsh(tensor)[0] / (density * extent**2)),
    }
    return elastic_part(run(problem, processes)["eigenvalues"], rigid)
