"""Solves again, by FEniCSx, what scikit-fem is heard to solve: on its mesh, and on a finer one."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from references.fem.elasticity import ElasticSolution
from references.fem.evaluation import Field
from references.fem.listening import Heard
from references.fem.mesh import Mesh
from references.fem.modes import Modes
from references.fem.transient import TransientSolution
from references.fenicsx import bridge


class OtherProblemError(ValueError):
    """The problem has something that FEniCSx is not asked for here; the message says what."""


@dataclass(frozen=True)
class Second:
    """A problem solved by both codes.

    Attributes
    ----------
    heard : Heard
        With scikit-fem's answer.
    same, finer : answers of the same kind
        FEniCSx's on the same mesh and on one with each triangle cut in four.
    difference, change : float
        Largest difference of each from scikit-fem's at the vertices of the first mesh, over the
        largest value there; of modes, of the squares of their frequencies. Rigid motions of a body
        that nothing holds do not count.
    nodes, finer_nodes : int
    """

    heard: Heard
    same: Any
    finer: Any
    difference: float
    change: float
    nodes: int
    finer_nodes: int


def _whole(mesh: Mesh, order: int) -> dict[str, Any]:
    """Fields of a `Field` on a mesh."""
    numbering = bridge.number(mesh, order)
    triangles = np.asarray(numbering.problem["triangles"])
    return {
        "mesh": mesh,
        "nodes": numbering.nodes,
        "element_dofs": numbering.element_nodes,
        "triangles": triangles,
        "_locator": None,
    }


def _elasticity(heard: Heard, mesh: Mesh, fine: dict[int, Any]) -> Any:
    given = {**heard.arguments, "mesh": mesh}
    return replace(
        heard.answer, **_whole(mesh, given["order"]), values=bridge.solve_elasticity(**given)
    )


def _conduction(heard: Heard, mesh: Mesh, fine: dict[int, Any]) -> Any:
    given = {**heard.arguments, "mesh": mesh}
    return replace(
        heard.answer, **_whole(mesh, given["order"]), values=bridge.steady_conduction(**given)
    )


def _leads(heard: Heard, mesh: Mesh, fine: dict[int, Any]) -> Any:
    given = heard.arguments
    values = bridge.between_leads(mesh, given["conductivity"], given["leads"], given["order"])
    return replace(heard.answer, **_whole(mesh, given["order"]), values=values)


def _strained(heard: Heard, mesh: Mesh, fine: dict[int, Any]) -> Any:
    given = dict(heard.arguments)
    elastic = given["elastic"]
    if mesh is not elastic.mesh:
        if id(elastic) not in fine:
            raise OtherProblemError("the strains on the finer mesh are not known")
        given["elastic"] = fine[id(elastic)]
    values = bridge.strained_conduction(**given)
    return replace(heard.answer, **_whole(given["elastic"].mesh, elastic.order), values=values)


def _modes(heard: Heard, mesh: Mesh, fine: dict[int, Any]) -> Any:
    given = {**heard.arguments, "mesh": mesh}
    return replace(heard.answer, frequencies=bridge.in_plane_frequencies(**given))


def _transient(heard: Heard, mesh: Mesh, fine: dict[int, Any]) -> Any:
    given = {**heard.arguments, "mesh": mesh}
    edge, source = given.pop("boundary_temperature"), given.pop("source")
    if edge is not None or source is not None or given.pop("outputs") != 1:
        raise OtherProblemError("heated in time, held at an edge, or looked at more than once")
    values = bridge.transient_conduction(**given)
    field_ = replace(heard.answer.fields[-1], **_whole(mesh, given["order"]), values=values)
    return replace(heard.answer, fields=[field_])


def _general(heard: Heard, mesh: Mesh, fine: dict[int, Any]) -> Any:
    given = heard.arguments
    acting = given["acting"]
    loads = (acting.volume, acting.spread, acting.edge, acting.points)
    if any(loads) or acting.strain is not None or given["thickness"] is not None:
        raise OtherProblemError("loads, strains without stress or thicknesses of several solids")
    solid = given["solid"]
    if mesh is not given["mesh"]:
        solid = np.tile(solid, 4)  # as `Mesh.refined` lists a triangle's four parts
    order = given["order"]
    values = bridge.several_solids(mesh, given["tensors"], solid, given["held"], order)
    return replace(heard.answer, **_whole(mesh, order), values=values, solid=solid)


_AGAIN: dict[str, Callable[[Heard, Mesh, dict[int, Any]], Any]] = {
    "solve_elasticity": _elasticity,
    "steady_conduction": _conduction,
    "plate_between_leads": _leads,
    "strained_conduction": _strained,
    "in_plane_modes": _modes,
    "transient_conduction": _transient,
    "solve": _general,
}


def once(heard: Heard) -> Any:
    """FEniCSx's answer on the same mesh: an ear (`references.fem.listening`) that hands it on."""
    return _AGAIN[heard.solver](heard, mesh_of(heard), {})


def mesh_of(heard: Heard) -> Mesh:
    """The mesh that a problem was solved on."""
    given = heard.arguments.get("mesh")
    return given if isinstance(given, Mesh) else heard.answer.mesh


def difference(heard: Heard, other: Any) -> float:
    """See `Second`."""
    if isinstance(other, Modes):
        ratio = other.frequencies**2 / heard.answer.frequencies**2
        return float(np.abs(ratio - 1.0).max())
    ours, theirs = _last(heard.answer), _last(other)
    count = len(mesh_of(heard).points)
    gap = theirs.values[:count] - ours.values[:count]
    if isinstance(other, ElasticSolution) and not _held(heard):
        gap = gap - _rigid_part(ours.nodes[:count], gap)
    return float(np.abs(gap).max() / np.abs(ours.values[:count]).max())


def _last(answer: Any) -> Field:
    return answer.fields[-1] if isinstance(answer, TransientSolution) else answer


def _held(heard: Heard) -> bool:
    held = heard.arguments["displacement"]
    return held is not None and held != {}


def _rigid_part(nodes: NDArray[np.float64], u: NDArray[np.float64]) -> NDArray[np.float64]:
    """The rigid motion nearest to displacements (n, 2)."""
    arm = nodes - nodes.mean(axis=0)
    mean = u.mean(axis=0)
    spin = np.sum(arm[:, 0] * u[:, 1] - arm[:, 1] * u[:, 0]) / np.sum(arm**2)
    return np.asarray(mean + spin * np.stack([-arm[:, 1], arm[:, 0]], axis=1))


@dataclass
class Beside:
    """An ear (`references.fem.listening`) that has FEniCSx solve whatever it hears.

    Attributes
    ----------
    once : bool
        Raise `Enough` at the second problem of a kind: one of each is all that is wanted.
    found : list of Second
    """

    once: bool = False
    found: list[Second] = field(default_factory=list)
    _fine: dict[int, Any] = field(default_factory=dict, repr=False)

    def __call__(self, heard: Heard) -> Any:
        """Solve it again; scikit-fem's answer goes on."""
        if self.once and any(s.heard.solver == heard.solver for s in self.found):
            raise EnoughError
        mesh = mesh_of(heard)
        finer_mesh = mesh.refined()
        solve = _AGAIN[heard.solver]
        same = solve(heard, mesh, self._fine)
        finer = solve(heard, finer_mesh, self._fine)
        self._fine[id(heard.answer)] = finer
        self.found.append(
            Second(
                heard, same, finer, difference(heard, same), difference(heard, finer),
                len(mesh.points), len(finer_mesh.points),
            )
        )  # fmt: skip
        return heard.answer


class EnoughError(Exception):
    """One problem of each kind was heard."""


@dataclass
class Replay:
    """An ear that hands on, call by call, answers that FEniCSx has given."""

    answers: list[Any]

    def __call__(self, heard: Heard) -> Any:
        """The next one."""
        return self.answers.pop(0)
