"""A scene file solved by finite elements as well, and how far the two are apart.

The same body, solids, cracks, supports and loads, on a mesh of quadratic triangles that ends where
the body ends (`references.fem.general`): what is prescribed in a layer is prescribed on the nodes
there. What finite elements of a Cauchy solid cannot mirror is refused by name, before any work.
How far they are from the truth themselves is told by a second mesh of twice the size.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cmverify.case import Field, FieldSet
from cmverify.exchange import finite_elements
from cmverify.exchange.output import Selected
from cmverify.exchange.refusal import Place
from cmverify.judge.norms import relative_l2

if TYPE_CHECKING:
    from cmverify.exchange.request import Request
    from solver.arrays import Array

#: Most triangles of a mesh.
_TRIANGLES = 40_000
_STRESSES = ("stress11", "stress22", "stress12")


@dataclass(frozen=True)
class Difference:
    """How far two computations of a quantity are apart, over the particles that are free.

    Attributes
    ----------
    quantity : str
    l2 : float
        |lattice − finite elements|₂ over |finite elements|₂.
    largest : float
        Largest difference over the largest value of finite elements.
    at : pair of float, m
        Where that is.
    own : float
        As `l2`, of finite elements with themselves on a mesh of twice the size.
    """

    quantity: str
    l2: float
    largest: float
    at: tuple[float, float]
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

    if request.analysis != "solve":
        refuse(
            (request.analysis,), f"[{request.analysis}] here: statics and steady conduction only"
        )
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
    size = max(scene.spacing, float(np.sqrt(area / (0.43 * _TRIANGLES))))
    try:
        fine, coarse = (finite_elements.solved(request, size * factor) for factor in (1.0, 2.0))
    except (ValueError, FloatingPointError, MemoryError, RuntimeError) as error:
        place = ("support",) if "support" in request.source.data else ("discretisation",)
        raise request.source.error(place, f"finite elements refuse it: {error}") from error
    points = result.points
    whole: Any = result.whole if isinstance(result, Selected) else result
    # Layers whose rotations are left free are held all the same.
    free = ~np.asarray(whole.discretisation.held)
    elastic = len(scene.physics.unknowns) > 1
    ours = result.everything if isinstance(result, Selected) else result.fields()
    unknown = next(name for name in scene.physics.fields if name in ours)
    stress = next((name for name in ("stress11", "flux", "current_density") if name in ours), None)
    theirs: dict[str, tuple[Array, Array, Array]] = {
        unknown: (ours[unknown], fine.at(points), coarse.at(points))
    }
    if stress is not None:
        flux, rough = fine.flux_at(points), coarse.flux_at(points)
        if elastic:
            theirs["stress"] = (np.stack([ours[name] for name in _STRESSES], axis=1), flux, rough)
        else:
            theirs[stress] = (ours[stress], flux, rough)
    differences, items, notes = [], {}, []
    for name, values in theirs.items():
        own, reference, _ = values
        known = free & np.isfinite(own).reshape(len(points), -1).all(axis=1)
        if np.abs(reference[known]).max(initial=0.0) > 0:
            differences.append(_difference(name, *(one[known] for one in (*values, points))))
        else:
            notes.append(f"the {name} of finite elements vanishes: there is no share of it to tell")
        for part, mine, other in _parts(name, own, reference):
            items[part] = Field(part, "", mine, other)
    if any("rotation" in support.values for support in request.file.support):
        notes.append("prescribed rotations are left out: finite elements have none")
    return Comparison(
        FieldSet(points, items, spacing=scene.spacing),
        differences,
        size,
        int(fine.values.size),
        tuple(notes),
    )


def _parts(name: str, own: Array, reference: Array) -> list[tuple[str, Array, Array]]:
    """A quantity as fields of one or two components."""
    if own.ndim == 1 or own.shape[1] == 2:
        return [(name, own, reference)]
    return [(part, own[:, k], reference[:, k]) for k, part in enumerate(_STRESSES)]


def _difference(name: str, own: Array, fem: Array, again: Array, points: Array) -> Difference:
    """How far a quantity is apart that does not vanish."""
    off = np.linalg.norm((own - fem).reshape(len(points), -1), axis=1)
    scale = float(np.linalg.norm(fem.reshape(len(points), -1), axis=1).max(initial=0.0))
    worst = int(np.argmax(off))
    at = (float(points[worst, 0]), float(points[worst, 1]))
    largest = float(off[worst]) / scale
    return Difference(name, relative_l2(own, fem), largest, at, relative_l2(again, fem))
