"""Bodies drawn elsewhere are the bodies that were drawn, or are refused by name."""

import builtins
from itertools import pairwise

import meshio
import numpy as np
import pytest
import shapely

from cmverify.exchange import outline_file, scene_file
from cmverify.exchange.refusal import SceneFileError
from references.fem.gmsh_session import session

GEO = """
lc = 0.2;
Point(1) = {0, 0, 0, lc}; Point(2) = {2, 0, 0, lc};
Point(3) = {2, 1, 0, lc}; Point(4) = {0, 1, 0, lc};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Point(5) = {1, 0.5, 0, lc}; Point(6) = {1.25, 0.5, 0, lc}; Point(7) = {0.75, 0.5, 0, lc};
Circle(5) = {6, 5, 7}; Circle(6) = {7, 5, 6};
Curve Loop(1) = {1, 2, 3, 4}; Curve Loop(2) = {5, 6};
Plane Surface(1) = {1, 2}; Plane Surface(2) = {2};
Physical Surface("plate") = {1}; Physical Surface("core") = {2};
"""

SCENE = """
[discretisation]
spacing = 0.1
m = 3
[[region]]
shape = "file"
path = "body.geo"
part = "plate"
scale = 0.5
[material]
kind = "isotropic"
E = 1.0
nu = 0.2
[[support]]
where = "x < 0.15"
displacement = [0.0, 0.0]
"""


def area(region):
    return region.outline(1.0).area


def gridded(corner=(0.0, 0.0), hole=True):
    """A 3 × 3 mesh of unit squares, with or without its middle, z = 2."""
    x, y = np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij")
    points = np.stack([x + corner[0], y + corner[1], 2 + 0 * x], axis=-1).reshape(-1, 3)
    cells = [
        [4 * i + j, 4 * i + 4 + j, 4 * i + 5 + j, 4 * i + 1 + j]
        for i in range(3)
        for j in range(3)
        if not (hole and i == j == 1)
    ]
    return points, np.array(cells)


@pytest.mark.parametrize("suffix", ["msh", "vtu", "inp"])
def test_a_mesh_is_what_its_cells_cover(tmp_path, suffix):
    points, cells = gridded()
    path = tmp_path / f"body.{suffix}"
    blocks = [
        ("quad", cells[:4]),
        ("triangle", cells[4:][:, :3]),
        ("triangle", cells[4:][:, [0, 2, 3]]),
    ]
    meshio.Mesh(points, blocks).write(path, file_format="gmsh22" if suffix == "msh" else None)
    body = outline_file.region(path, scale=0.5)
    assert area(body) == pytest.approx(8 * 0.25, rel=1e-14)
    assert body.bounds == (0.0, 0.0, 1.5, 1.5)
    # Corners alone are left: nodes on straight edges are none.
    assert len(body.body.vertices) == len(body.hole.vertices) == 4
    assert not body.contains(np.array([0.75]), np.array([0.75]))[0]


def test_a_gmsh_script_is_drawn_by_parts(tmp_path):
    path = tmp_path / "body.geo"
    path.write_text(GEO)
    plate, core = (outline_file.region(path, part, chord=0.02) for part in ("plate", "core"))
    # Chords of a circle: short by h²/6R² of its area.
    circle = np.pi * 0.25**2
    assert area(core) == pytest.approx(circle, rel=0.02**2 / (6 * 0.25**2) * 1.1)
    assert area(plate) + area(core) == pytest.approx(2.0, rel=1e-12)
    assert area(outline_file.region(path, chord=0.1)) == pytest.approx(2.0, rel=1e-12)
    with session({"Mesh.MeshSizeMax": 0.1}) as gmsh:
        gmsh.merge(str(path))
        gmsh.model.mesh.generate(2)
        gmsh.write(str(tmp_path / "body.msh"))
    meshed = outline_file.region(tmp_path / "body.msh", "core")
    assert area(meshed) == pytest.approx(circle, rel=0.03)
    for file in (path, tmp_path / "body.msh"):
        with pytest.raises(ValueError, match="no physical surface 'x'; it has core, plate"):
            outline_file.region(file, "x")
    (tmp_path / "scene.toml").write_text(SCENE)
    scene, _ = scene_file.read(tmp_path / "scene.toml")
    assert scene.region.bounds == pytest.approx((0.0, 0.0, 1.0, 0.5))


@pytest.mark.parametrize("word", ["SystemCall", "Merge", "Exit", "Printf"])
def test_a_script_that_does_more_than_draw_is_not_run(tmp_path, word):
    path, trace = tmp_path / "body.geo", tmp_path / "trace"
    path.write_text(f'// harmless: Save\n{GEO}\n{word} "touch {trace}";')
    with pytest.raises(ValueError, match=rf"uses {word}"):
        outline_file.region(path)
    assert not trace.exists()


@pytest.mark.parametrize("dropped", [0, 1])
def test_a_script_without_a_last_end_of_line_is_read_whole(tmp_path, dropped):
    """gmsh drops what follows the first statement of such a line: here the hole."""
    lines = (
        'SetFactory("OpenCASCADE");\nRectangle(1) = {0, 0, 0, 2, 1};\n'
        "Disk(2) = {1, 0.5, 0, 0.25}; BooleanDifference{Surface{1}; Delete;}{Surface{2}; Delete;}\n"
    )
    (tmp_path / "body.geo").write_text(lines[: len(lines) - dropped], encoding="utf-8")
    found = outline_file.region(tmp_path / "body.geo", chord=0.02)
    assert area(found) == pytest.approx(2 - np.pi / 16, rel=1e-3)


def test_a_script_whose_outline_crosses_itself_is_refused_at_once(tmp_path):
    bow = GEO.replace("{1, 1, 0, lc}", "").replace(
        "Point(3) = {2, 1, 0, lc}; Point(4) = {0, 1, 0, lc};",
        "Point(4) = {2, 1, 0, lc}; Point(3) = {0, 1, 0, lc};",
    )
    bow = bow.replace(
        "Plane Surface(1) = {1, 2}; Plane Surface(2) = {2};", "Plane Surface(1) = {1};"
    )
    (tmp_path / "body.geo").write_text(bow.split("Physical")[0], encoding="utf-8")
    with pytest.raises(ValueError, match=r"surface 1 crosses itself at \(1, 0\.5\)"):
        outline_file.region(tmp_path / "body.geo", chord=0.3)


@pytest.mark.parametrize("sides", [3, 4])
def test_sides_of_second_order_are_curved(tmp_path, sides):
    """A quarter of a ring, a cell each 15°, middles on the circles; corners alone lose 1 %."""
    steps = np.deg2rad(np.linspace(0, 90, 13))

    def at(radius, number):
        return (radius * np.cos(steps[number]), radius * np.sin(steps[number]), 0.0)

    points, cells = [], []
    for k in range(0, 12, 2):
        if sides == 4:
            own = [at(1, k), at(2, k), at(2, k + 2), at(1, k + 2)]
            own += [at(1.5, k), at(2, k + 1), at(1.5, k + 2), at(1, k + 1)]
        else:
            own = [(0, 0, 0), at(2, k), at(2, k + 2), at(1, k), at(2, k + 1), at(1, k + 2)]
        cells.append(len(points) + np.arange(len(own)))
        points += own
    kind = "quad8" if sides == 4 else "triangle6"
    meshio.write_points_cells(tmp_path / "ring.vtu", np.array(points), [(kind, np.array(cells))])
    exact = np.pi * (0.75 if sides == 4 else 1.0)
    found = outline_file.region(tmp_path / "ring.vtu")
    assert area(found) == pytest.approx(exact, rel=1e-4)
    assert len(shapely.get_parts(found.outline(1.0))) == 1


def test_cells_of_third_order_and_points_that_are_none_are_refused(tmp_path):
    points, cells = gridded()
    cubic = np.random.default_rng(0).random((10, 3)) * [1, 1, 0]
    meshio.write_points_cells(
        tmp_path / "body.msh", cubic, [("triangle10", np.arange(10)[None])], file_format="gmsh22"
    )
    with pytest.raises(ValueError, match="higher order"):
        outline_file.region(tmp_path / "body.msh")
    points[0, 0] = np.nan
    meshio.write_points_cells(tmp_path / "body.vtu", points, [("quad", cells)])
    with pytest.raises(ValueError, match="not finite"):
        outline_file.region(tmp_path / "body.vtu")


def test_what_is_no_mesh_is_refused(tmp_path):
    path = tmp_path / "body.msh"
    with pytest.raises(ValueError, match="there is no file"):
        outline_file.region(path)
    path.write_text("nonsense")
    with pytest.raises(ValueError, match=r"body\.msh cannot be read as a mesh"):
        outline_file.region(path)
    (tmp_path / "body.step").write_text("x")
    with pytest.raises(ValueError, match=r"body\.step"):
        outline_file.region(tmp_path / "body.step")
    (tmp_path / "body.geo").write_text("Point(1) = {0, 0")
    with pytest.raises(ValueError, match=r"gmsh does not mesh|no triangles"):
        outline_file.region(tmp_path / "body.geo")
    points, cells = gridded()
    meshio.Mesh(points * [1, 1, 0] + [0, 0, 1] * points[:, :1], [("quad", cells)]).write(
        path, file_format="gmsh"
    )
    with pytest.raises(ValueError, match="do not lie in a plane"):
        outline_file.region(path)
    meshio.Mesh(points, [("line", cells[:, :2])]).write(path, file_format="gmsh")
    with pytest.raises(ValueError, match="mesh the surface first"):
        outline_file.region(path)


# ---- drawings ---------------------------------------------------------------------------


def drawing(path, unit=0, open_by=0.0):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new(units=unit)
    space = document.modelspace()
    # A plate 40 × 20 of lines in no order, one with rounding at its end; a slot with round ends.
    space.add_line((0, 0), (40, 0))
    space.add_line((0, 20), (0, 0))
    space.add_line((40, 20 - open_by), (40, 1e-9))
    space.add_line((40, 20), (0, 20))
    space.add_lwpolyline(
        [(10, 8, 0), (20, 8, 1), (20, 12, 0), (10, 12, 1)], format="xyb", close=True
    )
    space.add_circle((30, 10), 3, dxfattribs={"layer": "hole"})
    space.add_circle((30, 10), 1, dxfattribs={"layer": "island"})
    space.add_text("40 × 20")
    document.saveas(path)
    return path


@pytest.mark.parametrize(("unit", "scale"), [(4, 1e-3), (5, 1e-2), (0, 1.0)])
def test_a_drawing_is_what_its_curves_enclose_in_its_unit(tmp_path, unit, scale):
    body = outline_file.region(drawing(tmp_path / "body.dxf", unit), chord=0.5 * scale)
    slot, ring = 40 + np.pi * 4, np.pi * (9 - 1)
    assert area(body) == pytest.approx((800 - slot - ring) * scale**2, rel=2e-5)
    x, y = scale * np.array([[1.0, 15, 28, 30], [1.0, 10, 10, 10]])
    assert body.contains(x, y).tolist() == [True, False, False, True]
    twice = outline_file.region(tmp_path / "body.dxf", scale=2 * scale, chord=scale)
    assert area(twice) == pytest.approx(4 * area(body), rel=1e-9)
    hole = outline_file.region(tmp_path / "body.dxf", "hole", chord=0.1 * scale)
    assert area(hole) == pytest.approx(np.pi * 9 * scale**2, rel=1e-4)


def test_what_encloses_nothing_is_refused_with_its_place(tmp_path):
    path = drawing(tmp_path / "body.dxf", open_by=0.5)
    with pytest.raises(ValueError, match=r"not closed: a curve ends at \(40, (19.5|20)\)"):
        outline_file.region(path)
    with pytest.raises(ValueError, match=r"no layer 'x'; it has 0, hole, island"):
        outline_file.region(path, "x")
    path.write_text("nonsense")
    with pytest.raises(ValueError, match=r"body\.dxf is no DXF file"):
        outline_file.region(path)


def test_without_its_library_a_drawing_is_refused_with_the_line_that_installs_it(
    tmp_path, monkeypatch
):
    (tmp_path / "body.dxf").touch()
    (tmp_path / "scene.toml").write_text(
        SCENE.replace("body.geo", "body.dxf").replace('part = "plate"\n', "")
    )
    original = builtins.__import__

    def without(name, *args, **kwargs):
        if name.startswith("ezdxf"):
            raise ImportError(name)
        return original(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(
        SceneFileError, match=r"scene\.toml:5: \[region.*pip install 'cmverify\[dxf\]'"
    ):
        scene_file.read(tmp_path / "scene.toml")


SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0)]


@pytest.mark.parametrize("seed", range(6))
def test_curves_in_pieces_enclose_what_they_enclose_whole(seed):
    """Cut anywhere, turned round and shuffled."""
    chance = np.random.default_rng(seed)
    rings = [np.array(SQUARE, float), 0.5 * np.array(SQUARE, float) + 1.0]
    pieces = []
    for ring in rings:
        cuts = np.unique(np.r_[0, chance.integers(1, 4, 3), 4])
        parts = [ring[a : b + 1] for a, b in pairwise(cuts)]
        pieces += [part[::-1] if chance.random() < 0.5 else part for part in parts]
    order = chance.permutation(len(pieces))
    shape = outline_file.enclosed([pieces[k] for k in order])
    assert shape.area == pytest.approx(12.0, rel=1e-14)
    assert shapely.equals(shape, outline_file.enclosed(rings))


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([SQUARE, [(x + 1, y + 1) for x, y in SQUARE]], "cross or coincide"),
        ([SQUARE, SQUARE], "coincide|not closed|crosses"),
        ([[(0, 0), (4, 4), (4, 0), (0, 4), (0, 0)]], "crosses itself"),
        ([SQUARE[:-1]], "not closed"),
    ],
)
def test_curves_that_cross_or_are_open_are_refused(lines, message):
    with pytest.raises(ValueError, match=message):
        outline_file.enclosed(lines)
