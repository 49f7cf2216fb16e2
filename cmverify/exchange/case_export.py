"""`cmverify export`: a case's problem in plain files, for any other program (format 1).

=================  ===============================================================================
``case.json``      what the problem is: body, cracks, solid, unknowns and units, remarks, what is
                   judged (keys, columns, norms, bounds), and what each file holds
``particles.npz``  our lattice: ``points`` (N, 2); ``area`` (N,), m²; for every unknown ``held_…``
                   and ``value_…`` (N,); ``load`` (N, c) per volume, all loads of the problem on
                   particles, edges included
``bonds.npz``      pairs of particles within the horizon that nothing parts: ``i``, ``j`` (B,) and
                   ``fraction`` (B,), the part of a cell of j that counts
``boundary.npz``   ``points`` (K, 2) along the body's edges, a quarter of a cell apart or less,
                   ``normals`` (K, 2) outward, ``weights`` (K,), m, ``ring`` (K,); for every
                   unknown ``value_…`` (K,), NaN where free; ``traction`` (K, c) per area of edge
``reference.npz``  for each target its ``KEY`` and, if it is a field, ``KEY_points`` and
                   ``KEY_times``
``particles.vtu``  the lattice for ParaView; ``reference.vtu`` the fields of the reference
=================  ===============================================================================

Rotations are rad, whatever a file's lattice is.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from cmverify.case import Array, Case, Check
from cmverify.exchange.statement import Pose, Statement, Target, laid_out

if TYPE_CHECKING:
    from solver.problem import Discretisation

#: Of the files; raised when a name, a shape or a unit changes.
FORMAT = 1
_PER_CELL = 4
_SYMBOLS = {"θ": "rotation", "φ": "potential"}


def pose_of(case: Case, name: str | None) -> Pose:
    """The problem of that name, the case's first for None.

    Raises
    ------
    ValueError
        Naming what there is.
    """
    if not case.poses:
        raise ValueError(
            f"{case.name} is no problem that another program could be told: it poses none "
            f"(cmverify export lists those that do)"
        )
    if name is None:
        return case.poses[0]
    for pose in case.poses:
        if pose.name == name:
            return pose
    known = ", ".join(repr(pose.name) for pose in case.poses if pose.name)
    raise ValueError(f"{case.name} has no problem {name!r}; it has {known or 'only one'}")


def bounds_of(case: Case, method: str, n: int) -> dict[str, Check]:
    """What holds of a method at a resolution, by quantity: checks with an absolute bound."""
    found = [c for c in case.checks if c.method == method and c.bound_at(n) is not None]
    return {check.quantity: check for check in found}


def files_in(folder: Path) -> list[Path]:
    """The files that an export writes, whether they are there or not."""
    names = [f"{name}.npz" for name in ("particles", "bonds", "boundary", "reference")]
    return [folder / name for name in ("case.json", *names, "particles.vtu", "reference.vtu")]


def write_case(case: Case, pose: Pose, n: int, folder: Path) -> list[Path]:
    """Write all files of a case at spacing length/n; returns their paths.

    Raises
    ------
    ValueError
        If the body has inclusions: the files know one solid.
    """
    from solver.result import write_arrays

    statement = pose.state(n)
    if statement.scene.inclusions:
        raise ValueError(f"{case.name} is of several solids, and the files hold one")
    parts = laid_out(statement.scene)
    folder.mkdir(parents=True, exist_ok=True)
    names = [_SYMBOLS.get(u, u) for u in statement.scene.physics.unknowns][: len(parts.values)]
    particles = _particles(parts, names, _loads(statement.scene))
    reference = _reference(statement.targets)
    archives = {
        "particles": particles,
        "bonds": _bonds(parts),
        "boundary": _boundary(parts, names),
        "reference": reference,
    }
    paths = []
    for name, arrays in archives.items():
        paths.append(_save(folder / f"{name}.npz", {"format": np.array(FORMAT), **arrays}))
    drawn = {k: np.asarray(a, dtype=float) for k, a in particles.items() if k != "points"}
    paths.append(_vtu(write_arrays, particles["points"], drawn, folder / "particles"))
    fields = [t for t in statement.targets if t.points is not None and t.times is None]
    if fields:
        there = fields[0].points
        assert there is not None
        paths.append(_vtu(write_arrays, there, _drawn(fields, there), folder / "reference"))
    text = json.dumps(_description(case, pose, n, statement, parts, names), indent=1)
    from cmverify.run.results import write_text

    write_text(folder / "case.json", text)
    return [folder / "case.json", *paths]


def _save(path: Path, arrays: dict[str, Any]) -> Path:
    from solver.result import replacing

    with replacing(path) as partial, open(partial, "wb") as stream:
        np.savez_compressed(stream, **arrays)
    return path


def _vtu(write: Callable[..., Any], points: Array, arrays: dict[str, Array], stem: Path) -> Path:
    """Only the .vtu: the .npz beside it has its own form."""
    import tempfile

    with tempfile.TemporaryDirectory(dir=stem.parent) as place:
        made, _ = write(points, arrays, Path(place) / stem.name)
        return Path(made).replace(stem.with_name(stem.name + ".vtu"))


def _drawn(targets: list[Target], there: Array) -> dict[str, Array]:
    """Reference fields at the same points, vectors and columns of others."""
    found: dict[str, Array] = {}
    for target in targets:
        if target.points is None or not np.array_equal(target.points, there):
            continue
        if target.reference.ndim == 2 and target.reference.shape[1] != 2:
            found |= dict(zip(target.names, target.reference.T, strict=True))
        else:
            found[target.key] = target.reference
    return found


def _loads(scene: Any) -> Array:
    """All that acts on particles, (components, N): as if the body ended at its outermost cells."""
    from dataclasses import replace

    if not scene.loads:
        return np.zeros((0, 0))
    edges_held = any(support.nodes is not None for support in scene.supports)
    plain = scene if edges_held else replace(scene, surface="none")
    return np.asarray(laid_out(plain).load)


def _particles(parts: Discretisation, names: list[str], load: Array) -> dict[str, Array]:
    lattice, scales = parts.lattice, parts.moduli.scales(parts.scene.spacing)
    found: dict[str, Array] = {
        "points": lattice.places,
        "area": parts.volumes * lattice.spacing**2,
    }
    for k, name in enumerate(names):
        found[f"held_{name}"] = parts.prescribed[k]
        found[f"value_{name}"] = np.where(parts.prescribed[k], parts.values[k] / scales[k], np.nan)
    count = len(names)
    # A couple is per spacing, as θ Δx is what it acts on.
    acting = load[:count] * scales[:count, None] if load.size else np.zeros((count, lattice.count))
    return {**found, "load": acting.T}


def _bonds(parts: Discretisation) -> dict[str, Array]:
    """Half of the bonds, each once."""
    lattice, family = parts.lattice, parts.family
    rows, columns = lattice.rows_columns
    number = lattice.number()
    i, j, fraction = [], [], []
    for k in range(len(family.offsets) // 2):
        dx, dy = family.offsets[k]
        whole = parts.bonds.strength(k) > 0.0
        i.append(np.flatnonzero(whole))
        j.append(number[rows[whole] + dy, columns[whole] + dx])
        fraction.append(np.full(int(whole.sum()), family.fraction[k]))
    return {n: np.concatenate(a) for n, a in zip("ij", (i, j), strict=True)} | {
        "fraction": np.concatenate(fraction)
    }


def _boundary(parts: Discretisation, names: list[str]) -> dict[str, Array]:
    """Edges of the body, what is held on them, and what acts."""
    from solver.problem import loading

    scene, lattice = parts.scene.at(0.0), parts.lattice
    step = lattice.spacing / _PER_CELL
    places, normals, weights, ring = [], [], [], []
    for k, line in enumerate(_rings(scene.region.outline(step))):
        corners = line[:-1]
        sides = np.diff(line, axis=0)
        lengths = np.hypot(*sides.T)
        counts = np.maximum(np.ceil(lengths / step - 1e-9), 1).astype(int)
        side = np.repeat(np.arange(len(counts)), counts)
        share = np.concatenate([(np.arange(c) + 0.5) / c for c in counts])
        places.append(corners[side] + share[:, None] * sides[side])
        outward = np.column_stack([sides[:, 1], -sides[:, 0]]) / lengths[:, None]
        normals.append(outward[side])
        weights.append((lengths / counts)[side])
        ring.append(np.full(len(side), k))
    points = np.concatenate(places)
    found: dict[str, Array] = {
        "points": points,
        "normals": np.concatenate(normals),
        "weights": np.concatenate(weights),
        "ring": np.concatenate(ring),
    }
    held = _held(parts, points, len(names))
    for k, name in enumerate(names):
        found[f"value_{name}"] = held[k]
    traction = np.zeros((len(points), len(names)))
    rules = loading.edge_loads(scene, lattice)
    if rules:
        from scipy.spatial import KDTree

        for rule in rules:
            near = KDTree(points).query(rule.places)[1]
            np.add.at(traction[:, : rule.force.shape[1]], near, rule.force)
        traction /= found["weights"][:, None]
    return {**found, "traction": traction}


def _held(parts: Discretisation, points: Array, count: int) -> Array:
    """Prescribed values at edge points, (count, K): those of the support of the nearest particle.

    Functions are asked at the points themselves; what is no function has one value.
    """
    from solver.problem.values import evaluate

    scene, lattice = parts.scene.at(0.0), parts.lattice
    nearest = lattice.tree.query(points - np.asarray(lattice.shift))[1]
    found = np.full((count, len(points)), np.nan)
    for support in scene.supports:
        if support.constrains or support.nodes is not None:
            continue
        selected = support.select(lattice)
        # A few particles that hold a body in place are no boundary condition.
        if selected.sum() < 3:
            continue
        there = selected[nearest]
        for unknown, value, component, width in support.columns(scene.physics):
            if unknown < count and there.any() and (callable(value) or np.ndim(value) < 2):
                values = evaluate(value, points[there], width, "a prescribed value")
                found[unknown, there] = values[:, component]
    return found


def _rings(shape: Any) -> list[Array]:
    """Closed lines of all edges, the body on their left."""
    from shapely.geometry.polygon import orient

    bodies = shape.geoms if hasattr(shape, "geoms") else [shape]
    found = []
    for body in bodies:
        turned = orient(body)
        found += [np.array(line.coords) for line in (turned.exterior, *turned.interiors)]
    return found


def _reference(targets: tuple[Target, ...]) -> dict[str, Array]:
    found: dict[str, Array] = {}
    for target in targets:
        found[target.key] = target.reference
        if target.points is not None:
            found[f"{target.key}_points"] = target.points
        if target.times is not None:
            found[f"{target.key}_times"] = target.times
    return found


def _material(material: Any) -> dict[str, Any]:
    for name in ("voigt", "matrix"):
        if (matrix := getattr(material, name, None)) is not None:
            order = "11, 22, 12 (shear strain 2 ε12)" if name == "voigt" else "1, 2"
            found = {"kind": type(material).__name__, "matrix": np.asarray(matrix).tolist()}
            return {**found, "order": order}
    raise ValueError(f"a {type(material).__name__} has no matrix to write")


def _description(
    case: Case, pose: Pose, n: int, statement: Statement, parts: Discretisation, names: list[str]
) -> dict[str, Any]:
    scene = statement.scene
    bounds = bounds_of(case, pose.method, n)
    return {
        "format": FORMAT,
        "program": f"cmverify {version('cmverify')}",
        "case": case.name,
        "problem": pose.name,
        "title": case.title,
        "section": case.section,
        "resolution": n,
        "spacing": scene.spacing,
        "length": case.length,
        "physics": scene.physics.name,
        "unknowns": names,
        "material": _material(scene.material),
        "density": scene.density,
        "heat_capacity": scene.heat_capacity,
        "body": {
            "shape": repr(scene.region),
            "wkt": shapely.to_wkt(scene.region.outline(scene.spacing / _PER_CELL), 17),
        },
        "cracks": [[list(p) for p in crack.points] for crack in scene.cracks],
        "horizon": scene.m * scene.spacing,
        "particles": parts.lattice.count,
        "loads_at": "t = 0; see the remarks" if scene.timed else "all times",
        "remarks": list(statement.remarks),
        "judged": [
            {
                "key": target.key,
                "columns": list(target.names),
                "shape": list(target.reference.shape),
                "unit": target.unit,
                "needed": target.needed,
                "error": target.norm,
                "quantity": target.quantity,
                "means": case.quantities[target.quantity],
                **_bound(bounds.get(target.quantity), n),
            }
            for target in statement.targets
        ],
        "bounds_of": pose.method,
        "answer": (
            "cmverify compare CASE FILE: .npz with points (N, 2) and the keys above (numbers need "
            "no points; seconds and unknowns are welcome), .csv with columns x, y and those above, "
            ".vtu, or .pvd. Values at reference points are taken as they are, others interpolated."
        ),
    }


def _bound(check: Check | None, n: int) -> dict[str, Any]:
    if check is None:
        return {"at_most": None}
    return {"at_most": check.bound_at(n), "because": check.source}
