"""Bodies drawn elsewhere: meshes (.msh and what else meshio reads), gmsh scripts (.geo), DXF.

Of a mesh the body is what its triangles and quadrilaterals cover, of a drawing what its closed
curves enclose: a curve within another is a hole, one within a hole an island. Lengths are metres
but for a `scale`; a DXF file that states its unit needs none.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import reduce
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from solver import Region

#: Ends of curves nearer than this share of the drawing's size are one.
_JOINED = 1e-7
# Nodes on the outline of a cell: its corners, then the middles of its sides.
_NODES = {"triangle": 3, "triangle6": 6, "triangle7": 6, "quad": 4, "quad8": 8, "quad9": 8}
# Chords of a curved side, and how far from straight one may be, in its length.
_CHORDS, _STRAIGHT = 16, 1e-9
# What a gmsh script may do beside drawing: run programs, read and write files.
_FORBIDDEN = (
    "SystemCall", "NonBlockingSystemCall", "OnelabRun", "OnelabExecute", "Include", "Merge",
    "MergeFile", "Open", "OpenFile", "ShapeFromFile", "Print", "Printf", "Save", "Plugin",
    "CreateDir", "UnlinkFile", "Exit", "Abort",
)  # fmt: skip
_INSTALL = "reading DXF needs the library ezdxf: pip install 'cmverify[dxf]'"


def region(
    path: Path, part: str | None = None, scale: float | None = None, chord: float = 1.0
) -> Region:
    """The body that a file draws.

    Parameters
    ----------
    path : Path
        .msh, .geo, .dxf, or another mesh that meshio reads (.vtu, .inp, …).
    part : str, optional
        Physical group (gmsh) or layer (DXF) that is meant; everything by default.
    scale : float, optional
        Metres for each unit of length of the file: 1, or what a DXF file says.
    chord : float, m
        Length of the chords, about, that a curve of a gmsh script or a drawing is made of.

    Raises
    ------
    ValueError
        If the file cannot be read, is of no known kind, draws nothing that encloses an area, has
        an outline that is not closed or crosses itself, or has no such part.
    """
    kind = path.suffix.lower()
    if not path.is_file():
        raise ValueError(f"there is no file {path}")
    if kind == ".dxf":
        shape = _dxf(path, part, scale, chord)
    else:
        shape = _covered(_meshed(path, part, chord / (scale or 1.0)), scale or 1.0)
    shape = shapely.normalize(shape)
    if shape.is_empty or not shape.area > 0:
        raise ValueError(f"{path.name} draws nothing that encloses an area")
    return of_shape(shape)


def of_shape(shape: shapely.Geometry) -> Region:
    """A region of shapely polygons, each with its holes."""
    from solver import polygon
    from solver.geometry.regions import without_middles

    found: Region | None = None
    for part in shapely.get_parts(shape):
        box = np.asarray(part.bounds)
        tolerance = 1e-12 * float(np.ptp(box.reshape(2, 2), axis=0).max())
        part = without_middles(part, tolerance)
        body: Region = polygon(shapely.get_coordinates(part.exterior)[:-1])
        for hole in part.interiors:
            body = body - polygon(shapely.get_coordinates(hole)[:-1])
        found = body if found is None else found | body
    assert found is not None
    return found


# ---- meshes and gmsh scripts ------------------------------------------------------------

Cells = tuple["NDArray[np.float64]", list["NDArray[np.int64]"]]


def _meshed(path: Path, part: str | None, chord: float) -> Cells:
    """Points (n, 3) and blocks of plane cells of a file, see `_shapes`."""
    if path.suffix.lower() == ".geo":
        return _geo(path, part, chord)
    from cmverify.exchange import mesh_file

    mesh = mesh_file.read(path)
    chosen = _group(mesh, part, path.name)
    blocks = []
    for number, block in enumerate(mesh.cells):
        if block.type.rstrip("0123456789") in ("triangle", "quad") and len(block.data):
            if block.type not in _NODES:
                raise ValueError(
                    f"{path.name} has cells of higher order ({block.type}): write its mesh with "
                    f"cells of first or second order"
                )
            data = np.asarray(block.data, dtype=np.int64)[:, : _NODES[block.type]]
            blocks.append(data if chosen is None else data[chosen[number]])
    points = np.asarray(mesh.points, dtype=np.float64)
    if not all(np.isfinite(points[block]).all() for block in blocks):
        raise ValueError(f"{path.name} has a point that is not finite")
    return points, blocks


def _group(mesh: Any, part: str | None, name: str) -> list[NDArray[np.bool_]] | None:
    """Which cells of each block belong to a physical group of surfaces."""
    if part is None:
        return None
    groups = {key: tag for key, (tag, dimension) in mesh.field_data.items() if dimension == 2}
    tags = mesh.cell_data.get("gmsh:physical")
    if tags is None or part not in groups:
        raise ValueError(f"{name} has no physical surface {part!r}; it has {_listed(groups)}")
    return [np.asarray(one) == groups[part] for one in tags]


def _geo(path: Path, part: str | None, chord: float) -> Cells:
    from references.fem.gmsh_session import MeshingUnavailableError, session

    script = path.read_bytes()
    text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", script.decode("utf-8", "replace"), flags=re.DOTALL)
    for word in _FORBIDDEN:
        if re.search(rf"\b{word}\b", text):
            raise ValueError(f"{path.name} uses {word}: no script is run that does more than draw")
    options = {"Mesh.MeshSizeMax": chord, "Mesh.RandomSeed": 1, "General.AbortOnError": 2}
    try:
        with TemporaryDirectory() as folder, session(options) as gmsh:
            # Of a last line without an end gmsh reads the first statement alone.
            ended = Path(folder, path.name)
            ended.write_bytes(script + b"\n")
            gmsh.merge(str(ended))
            gmsh.model.mesh.generate(1)
            _require_simple(gmsh, path.name)
            gmsh.model.mesh.generate(2)
            groups = {
                gmsh.model.getPhysicalName(dim, tag): (dim, tag)
                for dim, tag in gmsh.model.getPhysicalGroups(2)
            }
            if part is not None and part not in groups:
                raise ValueError(
                    f"{path.name} has no physical surface {part!r}; it has {_listed(groups)}"
                )
            surfaces = (
                [tag for _, tag in gmsh.model.getEntities(2)]
                if part is None
                else gmsh.model.getEntitiesForPhysicalGroup(*groups[part])
            )
            tags, flat, _ = gmsh.model.mesh.getNodes()
            number = np.zeros(int(max(tags, default=0)) + 1, dtype=np.int64)
            number[np.asarray(tags, dtype=np.int64)] = np.arange(len(tags))
            blocks = []
            for surface in surfaces:
                for kind, corners in ((2, 3), (3, 4)):
                    nodes = gmsh.model.mesh.getElementsByType(kind, surface)[1]
                    if len(nodes):
                        cells = number[np.asarray(nodes, dtype=np.int64)]
                        blocks.append(cells.reshape(-1, corners))
            return np.asarray(flat).reshape(-1, 3), blocks
    except MeshingUnavailableError as error:
        raise ValueError(str(error)) from error
    except ValueError:
        raise
    except Exception as error:  # gmsh raises bare exceptions
        raise ValueError(f"gmsh does not mesh {path.name}: {error}") from error


def _require_simple(gmsh: Any, name: str) -> None:
    """Refuse surfaces whose curves, meshed, cross: gmsh would look for triangles without end."""
    tags, flat, _ = gmsh.model.mesh.getNodes()
    place = dict(
        zip(np.asarray(tags).tolist(), np.asarray(flat).reshape(-1, 3)[:, :2], strict=True)
    )
    for surface in gmsh.model.getEntities(2):
        curves = {abs(tag) for _, tag in gmsh.model.getBoundary([surface], oriented=False)}
        ends = [
            place[node]
            for curve in sorted(curves)
            for node in gmsh.model.mesh.getElementsByType(1, curve)[1].tolist()
        ]
        lines = shapely.linestrings(np.reshape(ends, (-1, 2, 2)))
        one, other = shapely.STRtree(lines).query(lines, predicate="crosses")
        if len(one):
            x, y = shapely.get_coordinates(lines[one[0]].intersection(lines[other[0]]))[0]
            raise ValueError(
                f"{name}: the outline of surface {surface[1]} crosses itself at ({x:g}, {y:g})"
            )


def _covered(cells: Cells, scale: float) -> shapely.Geometry:
    """What plane cells cover."""
    points, blocks = cells
    if not blocks:
        raise ValueError("the file has no triangles or quadrilaterals: mesh the surface first")
    used = points[np.unique(np.concatenate([block.ravel() for block in blocks]))]
    if points.shape[1] > 2 and np.ptp(used[:, 2]) > 1e-9 * np.ptp(used[:, :2], axis=0).max():
        raise ValueError("the file's cells do not lie in a plane z = constant")
    faces = [face for block in blocks for face in _shapes(scale * points[block][:, :, :2])]
    return shapely.coverage_union_all(faces)


def _shapes(nodes: NDArray[np.float64]) -> list[shapely.Geometry]:
    """Polygons of cells (k, 3, 4, 6 or 8, 2): corners in turn, then middles of sides, if any."""
    if nodes.shape[1] < 6:
        return list(shapely.polygons(nodes))
    corners, middles = np.split(nodes, 2, axis=1)
    ends = np.roll(corners, -1, axis=1)
    off = np.linalg.norm(middles - 0.5 * (corners + ends), axis=2)
    bent = off > _STRAIGHT * np.linalg.norm(ends - corners, axis=2)
    found = list(shapely.polygons(corners[~bent.any(axis=1)]))
    for k in np.flatnonzero(bent.any(axis=1)):
        sides = [
            _side(*side) if curved else side[0][None]
            for side, curved in zip(
                zip(corners[k], middles[k], ends[k], strict=True), bent[k], strict=True
            )
        ]
        found.append(shapely.Polygon(np.concatenate(sides)))
    return found


def _side(start: Any, middle: Any, end: Any) -> NDArray[np.float64]:
    """Points of a quadratic side but its last one; those of its neighbour are the same bits."""
    swapped = tuple(start) > tuple(end)
    a, b = (end, start) if swapped else (start, end)
    s = (np.arange(_CHORDS + 1) / _CHORDS)[:, None]
    points = a * (1 - s) * (1 - 2 * s) + middle * (4 * s * (1 - s)) + b * (s * (2 * s - 1))
    return points[:0:-1] if swapped else points[:-1]


# ---- drawings ---------------------------------------------------------------------------


def _dxf(path: Path, part: str | None, scale: float | None, chord: float) -> shapely.Geometry:
    try:
        import ezdxf
        from ezdxf import units
    except ImportError as error:
        raise ValueError(_INSTALL) from error
    try:
        drawing = ezdxf.readfile(path)
    except Exception as error:  # files of any content
        said = " ".join(str(error).split()) or type(error).__name__
        raise ValueError(f"{path.name} is no DXF file: {said}") from error
    if scale is None:
        unit = units.InsertUnits(drawing.units)
        metre = units.InsertUnits(units.M)
        scale = units.conversion_factor(unit, metre) if drawing.units else 1.0
    lines, layers, left_out = [], set(), set()
    for entity in drawing.modelspace():
        layers.add(entity.dxf.layer)
        if part is not None and entity.dxf.layer != part:
            continue
        # Chords lie less than a thousandth of their length off the curve.
        for kind, points in _curves(entity, 1e-3 * chord / scale):
            if len(points) > 1:
                lines.append(scale * np.array([(p.x, p.y) for p in points]))
            else:
                left_out.add(kind)
    if part is not None and part not in layers:
        raise ValueError(f"{path.name} has no layer {part!r}; it has {_listed(layers)}")
    if not lines:
        what = f" (only {_listed(left_out)})" if left_out else ""
        raise ValueError(f"{path.name} draws no curves{what}")
    return enclosed(lines)


def _curves(entity: Any, off: float) -> Iterator[tuple[str, list[Any]]]:
    """Kinds and points of the curves of an entity; no points of texts, dimensions and the like."""
    kind = entity.dxftype()
    if kind == "LINE":
        yield kind, [entity.dxf.start, entity.dxf.end]
    elif kind in ("CIRCLE", "ARC", "ELLIPSE", "SPLINE"):
        yield kind, list(entity.flattening(off))
    elif kind in ("LWPOLYLINE", "POLYLINE", "INSERT"):
        for part in entity.virtual_entities():
            yield from _curves(part, off)
    else:
        yield kind, []


def enclosed(lines: Iterable[Any]) -> shapely.Geometry:
    """What closed curves enclose, the inner ones being holes.

    Parameters
    ----------
    lines : iterable of (k, 2) arrays
        Curves, whole or in pieces that meet at their ends, in any order and direction.

    Raises
    ------
    ValueError
        If a curve is not closed, or crosses itself or another.
    """
    pieces = _joined([np.asarray(line, dtype=np.float64) for line in lines])
    merged = shapely.line_merge(shapely.multilinestrings(pieces))
    faces = []
    for chain in shapely.get_parts(merged):
        x, y = shapely.get_coordinates(chain)[-1]
        if not chain.is_closed:
            raise ValueError(f"the outline is not closed: a curve ends at ({x:g}, {y:g})")
        face = shapely.Polygon(chain)
        if not face.is_valid:
            raise ValueError(f"the outline crosses itself: {shapely.is_valid_reason(face)}")
        faces.append(face)
    edges = [face.exterior for face in faces]
    for k, edge in enumerate(edges):
        for other in edges[:k]:
            if edge.crosses(other) or edge.overlaps(other) or edge.equals(other):
                x, y = shapely.get_coordinates(edge.intersection(other))[0]
                raise ValueError(f"two curves of the outline cross or coincide at ({x:g}, {y:g})")
    return reduce(shapely.symmetric_difference, faces)


def _joined(lines: list[Any]) -> list[shapely.LineString]:
    """Curves whose ends are the same points where they meet within rounding."""
    from scipy.spatial import KDTree

    ends = np.concatenate([line[[0, -1]] for line in lines])
    near = _JOINED * float(np.ptp(np.concatenate(lines), axis=0).max())
    first = np.arange(len(ends))
    for i, j in sorted(KDTree(ends).query_pairs(near)):
        first[j] = min(first[j], first[i])
    ends = ends[first].reshape(-1, 2, 2)
    found = []
    for line, (start, end) in zip(lines, ends, strict=True):
        line[0], line[-1] = start, end
        found.append(shapely.LineString(line))
    return found


def _listed(names: Iterable[str]) -> str:
    return ", ".join(sorted(names)) or "none"
