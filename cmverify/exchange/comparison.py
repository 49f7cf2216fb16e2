"""A scene file solved by finite elements as well, and how far the two are apart.

The same body, solids, cracks, supports and loads, on a mesh of quadratic triangles that ends where
the body ends (`references.fem.body`): what is prescribed in a layer is prescribed on the nodes
there. What each analysis compares is in `mirrored`; what finite elements of a Cauchy solid cannot
mirror is refused by name, before any work. How far they are from the truth themselves is told by a
second mesh of twice the size (and, in time, by steps of twice the length).
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.case import Field, FieldSet
from cmverify.exchange.finite_elements import Mirror
from cmverify.exchange.mirrored import MIRRORED, TRIANGLES
from cmverify.exchange.output import Selected
from cmverify.exchange.quantities import STRESSES, Quantity
from cmverify.exchange.refusal import Place
from cmverify.judge.norms import relative_l2

if TYPE_CHECKING:
    from cmverify.exchange.request import Request
    from solver.arrays import Array

#: Most triangles of a mesh, unless an analysis takes fewer.
_TRIANGLES = 40_000
#: Triangles that cost nothing to speak of.
_SOME = 5_000
#: Why there are none of an analysis.
_WITHOUT = {
    "fracture": "what breaks and by which law is the lattice's own: compare its cracks with other "
    "programs' by cmverify compare",
    "quench": "finite elements know no growing crack; compare its heat alone, by [transient]",
}
#: A temperature that varies by less than this share of itself does not vary.
_LEVEL = 1e-12


@dataclass(frozen=True)
class Difference:
    """How far two computations of a quantity are apart, over the particles that are free.

    Temperatures and potentials are taken less the mean of finite elements': where their zero lies
    is a choice.

    Attributes
    ----------
    quantity : str
    l2 : float
        |lattice − finite elements|₂ over |finite elements|₂.
    largest : float
        Largest difference over the largest value of finite elements.
    at : pair of float, m, optional
        Where that is; None of a number, such as a frequency.
    own : float
        As `l2`, of finite elements with themselves on a mesh of twice the size.
    """

    quantity: str
    l2: float
    largest: float
    at: tuple[float, float] | None
    own: float


@dataclass(frozen=True, eq=False)
class Comparison:
    """A scene by finite elements, at the particles.

    Attributes
    ----------
    fields : FieldSet
        Every quantity by both, and their difference.
    differences : list of Difference
    size : float, m
        Of the elements.
    unknowns : int
    notes : tuple of str
        What of the scene finite elements do not know, and do without.
    """

    fields: FieldSet
    differences: list[Difference]
    size: float
    unknowns: int
    notes: tuple[str, ...]

    def write(self, stem: Path) -> tuple[Path, ...]:
        """Write the fields as STEM.fem.vtu and .npz, the differences as STEM.fem.json."""
        from cmverify.exchange.export import write_fields
        from cmverify.run import results
        from solver.result import suffixed

        paths = write_fields(self.fields, suffixed(stem, ".fem"))
        told = {
            "compared with": "scikit-fem, quadratic triangles",
            "element size": self.size,
            "unknowns": self.unknowns,
            "notes": self.notes,
            "differences": [vars(one) for one in self.differences],
        }
        path = suffixed(stem, ".fem.json")
        results.write_text(path, json.dumps(told, indent=1, ensure_ascii=False) + "\n")
        return (*paths, path)


def check(request: Request) -> None:
    """Refuse a scene that finite elements cannot mirror.

    Raises
    ------
    SceneFileError
        Naming what it is.
    """
    from solver import ConductivityTensor, ElasticTensor, ElectricConductivityTensor

    file = request.file

    def refuse(place: Place, what: str) -> None:
        raise request.source.error(place, f"compare = 'fem': finite elements have no {what}")

    if request.analysis not in MIRRORED:
        why = _WITHOUT.get(request.analysis, "no mirror of it is written")
        refuse((request.analysis,), f"[{request.analysis}] here: {why}")
    plain = (ElasticTensor, ConductivityTensor, ElectricConductivityTensor)
    tables: list[tuple[Place, Any]] = [(("material",), request.scene.material)]
    tables += [(("inclusion", i), one.material) for i, one in enumerate(request.scene.inclusions)]
    for place, material in tables:
        if type(material) not in plain:
            # Solids with more to them than a stiffness: polar, chiral, and what may yet come.
            refuse(place, f"{type(material).__name__.removesuffix('Tensor').lower()} solids here")
    for i, support in enumerate(file.support):
        if support.kind in ("pin", "equal") or (support.kind == "lead" and not support.values):
            floating = "floating leads" if support.kind == "lead" else f"kind = {support.kind!r}"
            refuse(("support", i, "kind"), f"{floating} here")
        if set(support.values) == {"rotation"}:
            refuse(("support", i, "rotation"), "rotations to hold")
    for i, load in enumerate(file.load):
        if load.kind == "couple":
            refuse(("load", i, "kind"), "body couples: their solids are no polar ones")
    if request.analysis == "piezoresistive":
        _check_conductor(request, refuse)


def _check_conductor(request: Request, refuse: Callable[[Place, str], None]) -> None:
    """Refuse conductors whose change by strain the continuum does not know."""
    from solver import Cosine

    if not isinstance(request.scene.law, Cosine | None):
        refuse(("discretisation", "law"), "angular law of conductors but the cosine's")
    if request.options.get("length") == "actual":
        for i, load in enumerate(request.file.load):
            if load.kind == "temperature":
                refuse(("load", i, "kind"), "lengths that a temperature changes, beside stretches")


def compare(request: Request, result: Any) -> Comparison:
    """Solve the request's scene by finite elements and compare its result with that.

    Raises
    ------
    SceneFileError
        If `check` says no, or finite elements do.
    """
    check(request)
    scene = request.scene
    area = scene.region.outline(scene.spacing).area
    most = TRIANGLES.get(request.analysis, _TRIANGLES)
    some, fewest = (float(np.sqrt(area / (0.43 * n))) for n in (_SOME, most))
    # Small bodies have room for elements smaller than cells.
    size = max(min(scene.spacing, max(some, scene.spacing / 3)), fewest)
    whole: Any = result.whole if isinstance(result, Selected) else result
    ours = result.everything if isinstance(result, Selected) else result.fields()
    try:
        meshes = [Mirror.of(request, size * factor) for factor in (1.0, 2.0)]
        told = MIRRORED[request.analysis](request, whole, ours, *meshes)
    except (ValueError, FloatingPointError, MemoryError, RuntimeError) as error:
        place = ("support",) if "support" in request.source.data else ("discretisation",)
        raise request.source.error(place, f"finite elements refuse it: {error}") from error
    points = result.points
    differences, items, notes = [], {}, list(told.notes)
    for one in told.quantities:
        found = _difference(one, points)
        if found is None:
            notes.append(
                f"the {one.name} of finite elements vanishes: there is no share of it to tell"
            )
        else:
            differences.append(found)
        for part, mine, other in _parts(one):
            items[part] = Field(part, "", mine, other)
    if any("rotation" in support.values for support in request.file.support):
        notes.append("prescribed rotations are left out: finite elements have none")
    return Comparison(
        FieldSet(points, items, spacing=scene.spacing),
        differences,
        size,
        meshes[0].unknowns,
        tuple(notes),
    )


def _parts(one: Quantity) -> list[tuple[str, Array, Array]]:
    """A quantity as fields of one or two components; numbers are none."""
    if one.free is None or not one.drawn:
        return []
    if one.name != "stress":
        return [(one.name, one.ours, one.fine)]
    return [(part, one.ours[:, k], one.fine[:, k]) for k, part in enumerate(STRESSES)]


def _difference(one: Quantity, points: Array) -> Difference | None:
    """How far a quantity is apart; None where it vanishes."""
    if one.free is None:
        size = float(np.abs(one.fine).max())
        if not size > 0:
            return None
        off, own = (float(np.abs(a - one.fine).max()) / size for a in (one.ours, one.coarse))
        return Difference(one.name, off, off, None, own)
    known = one.free & np.isfinite(one.ours).reshape(len(points), -1).all(axis=1)
    ours, fem, again = (
        a[known].reshape(int(known.sum()), -1) for a in (one.ours, one.fine, one.coarse)
    )
    size = float(np.abs(fem).max(initial=0.0))
    if one.level and size > 0:
        mean = fem.mean()
        ours, fem, again = ours - mean, fem - mean, again - mean
        size = float(np.abs(fem).max()) if np.ptp(fem) > _LEVEL * size else 0.0
    if not size > 0:
        return None
    if one.level:
        off, scale = np.abs(ours - fem).max(axis=1), size
    else:
        off = np.linalg.norm(ours - fem, axis=1)
        scale = float(np.linalg.norm(fem, axis=1).max())
    worst = int(np.argmax(off))
    x, y = points[known][worst]
    return Difference(
        one.name,
        relative_l2(ours, fem),
        float(off[worst]) / scale,
        (float(x), float(y)),
        relative_l2(again, fem),
    )
