"""Answers are read from every kind of file, and what is missing is named in one line."""

import json

import meshio
import numpy as np
import pytest

from cmverify.exchange.answers import AnswerError, read
from cmverify.exchange.statement import ABSOLUTE, LARGEST, LINES, Target

POINTS = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
U = Target(
    "displacement", "displacement", "m", np.ones((4, 2)), points=POINTS, columns=("u1", "u2")
)
T = Target("temperature", "temperature", "K", np.ones(4), points=POINTS, columns=("T",))
F = Target("frequencies", "frequency", "rad/s", np.ones(3), LARGEST)
H = Target("u2", "displacement", "m", np.ones((5, 4)), points=POINTS, times=np.linspace(0, 1, 5))
VALUES = np.arange(8.0).reshape(4, 2)


def test_an_archive_is_taken_as_it_is(tmp_path):
    path = tmp_path / "mine.npz"
    np.savez(path, points=POINTS, displacement=VALUES, seconds=2.0, unknowns=8)
    answer = read(path, [U])
    assert answer.name == "mine"
    assert answer.seconds == 2.0
    assert answer.unknowns == 8
    assert np.array_equal(answer.values["displacement"], VALUES)


def test_columns_make_a_field(tmp_path):
    path = tmp_path / "mine.csv"
    rows = np.column_stack([POINTS, VALUES])
    np.savetxt(path, rows, delimiter=",", header="x, y, u1, u2", comments="")
    assert np.array_equal(read(path, [U]).values["displacement"], VALUES)
    assert np.array_equal(read(path, [U]).points, POINTS)


def test_numbers_need_no_points(tmp_path):
    table, plain = tmp_path / "f.csv", tmp_path / "f.json"
    table.write_text("frequencies\n1\n2\n3\n")
    plain.write_text(json.dumps({"frequencies": [1, 2, 3], "code": "ours"}))
    for path in (table, plain):
        assert np.array_equal(read(path, [F]).values["frequencies"], [1, 2, 3])


def test_meshes_bring_their_triangles_and_lose_their_third_component(tmp_path):
    solid = np.column_stack([POINTS, np.zeros(4)])
    data = {"displacement": np.column_stack([VALUES, np.zeros(4)])}
    path = tmp_path / "mesh.vtu"
    meshio.Mesh(solid, [("quad", np.array([[0, 1, 3, 2]]))], point_data=data).write(path)
    answer = read(path, [U])
    assert np.array_equal(answer.values["displacement"], VALUES)
    assert np.array_equal(answer.triangles, [[0, 1, 3], [0, 3, 2]])


def test_data_of_cells_sits_in_their_middles(tmp_path):
    solid = np.column_stack([POINTS, np.zeros(4)])
    cells = [("triangle", np.array([[0, 1, 2], [1, 3, 2]]))]
    path = tmp_path / "cells.vtu"
    meshio.Mesh(solid, cells, cell_data={"T": [np.array([1.0, 2.0])]}).write(path)
    answer = read(path, [T])
    assert np.allclose(answer.points, [[1 / 3, 1 / 3], [2 / 3, 2 / 3]])
    assert answer.triangles is None
    assert np.array_equal(answer.values["temperature"], [1.0, 2.0])


def series(folder, count=6):
    lines = []
    for k in range(count):
        solid = np.column_stack([POINTS, np.zeros(4)])
        name = f"step{k}.vtu"
        cells = [("triangle", np.array([[0, 1, 2], [1, 3, 2]]))]
        data = {"u2": np.full(4, 0.2 * k), "T": np.full(4, float(k))}
        meshio.Mesh(solid, cells, point_data=data).write(folder / name)
        lines.append(f'<DataSet timestep="{0.2 * k}" part="0" file="{name}"/>')
    path = folder / "run.pvd"
    path.write_text(
        f'<VTKFile type="Collection"><Collection>{"".join(lines)}</Collection></VTKFile>'
    )
    return path


def test_a_series_gives_all_times_or_its_last(tmp_path):
    path = series(tmp_path)
    answer = read(path, [H])
    assert answer.times == pytest.approx(np.arange(6) * 0.2)
    assert answer.values["u2"].shape == (6, 4)
    assert answer.values["u2"][3, 0] == pytest.approx(0.6)
    assert np.array_equal(read(path, [T]).values["temperature"], np.full(4, 5.0))


def test_rows_of_times_are_sorted(tmp_path):
    path = tmp_path / "history.csv"
    rows = [(t, x, y, t + x) for x, y in POINTS for t in (0.0, 0.5, 1.0)]
    np.savetxt(path, rows, delimiter=",", header="t,x,y,u2", comments="")
    answer = read(path, [H])
    assert np.allclose(answer.values["u2"], answer.times[:, None] + answer.points[:, 0])


@pytest.mark.parametrize(
    ("held", "target", "said"),
    [
        (
            {"points": POINTS, "u": VALUES},
            U,
            r"displacement \(in columns: u1, u2\); it holds",
        ),
        ({"displacement": VALUES}, U, "no points"),
        ({"points": POINTS, "displacement": VALUES[:3]}, U, "needs the shape"),
        ({"points": POINTS[:, :1], "displacement": VALUES}, U, r"points need the shape \(N, 2\)"),
        ({"points": POINTS * np.nan, "displacement": VALUES}, U, "not finite"),
        ({"points": POINTS, "displacement": VALUES * 1j}, U, "real numbers"),
        ({"points": POINTS, "displacement": VALUES, "seconds": -1.0}, U, "positive numbers"),
        (
            {"points": POINTS, "displacement": VALUES, "triangles": [[0, 1, 9]]},
            U,
            "a point that there is not",
        ),
        ({"frequencies": np.ones(4)}, F, "needs 3 numbers"),
        ({"frequencies": np.array([1.0, np.nan, 2.0])}, F, "no finite number"),
        ({"points": POINTS, "u2": np.ones(4)}, H, "no times"),
        ({"points": POINTS, "u2": np.ones((2, 4)), "times": [1.0, 0.0]}, H, "ascending"),
    ],
)
def test_what_is_wrong_is_said_in_a_line(tmp_path, held, target, said):
    path = tmp_path / "bad.npz"
    np.savez(path, **held)
    with pytest.raises(AnswerError, match=said) as refusal:
        read(path, [target])
    assert "\n" not in str(refusal.value)


def test_files_that_are_none_are_refused(tmp_path):
    torn = tmp_path / "torn.npz"
    torn.write_bytes(b"PK\x03\x04 half an archive")
    for path, said in (
        (torn, "cannot be read"),
        (tmp_path / "gone.npz", "no such file"),
        (tmp_path / "fields.xlsx", "an answer is a"),
    ):
        with pytest.raises(AnswerError, match=said):
            read(path, [U])
    path = series(tmp_path, 4)
    (tmp_path / "step2.vtu").unlink()
    with pytest.raises(AnswerError, match=r"step2.vtu, which is not there"):
        read(path, [H])


# ---- slabs and paths --------------------------------------------------------------------


def slab(values, layers=3):
    """Points and values of layers above each other, the upper ones first."""
    heights = np.repeat(np.arange(layers)[::-1], len(POINTS))
    return np.column_stack([np.tile(POINTS, (layers, 1)), heights]), np.tile(values, (layers, 1))


def test_slabs_are_averaged_over_their_layers_in_every_kind_of_file(tmp_path):
    points, values = slab(VALUES)
    values[4:8] += 0.01  # one layer in three
    np.savez(tmp_path / "a.npz", points=points, displacement=values)
    rows = np.column_stack([points, values])
    head = {"delimiter": ",", "header": "x,y,z,u1,u2", "comments": ""}
    np.savetxt(tmp_path / "a.csv", rows, **head)
    data = {"displacement": np.column_stack([values, 9.0 * np.arange(12)])}
    mesh = meshio.Mesh(points, [("wedge", np.array([[8, 9, 10, 4, 5, 6]]))], point_data=data)
    mesh.write(tmp_path / "a.vtu")
    for suffix in (".npz", ".csv", ".vtu"):
        answer = read(tmp_path / f"a{suffix}", [U])
        assert answer.points == pytest.approx(POINTS)
        assert answer.values["displacement"] == pytest.approx(VALUES + 0.01 / 3)
        assert answer.notes == (
            "the mean over 3 layers in z is judged; they differ from it by 9.5e-04 of the largest "
            "value at most",
        )
    values[4:8] += 0.2
    np.savez(tmp_path / "a.npz", points=points, displacement=values)
    with pytest.raises(AnswerError, match=r"layers z of its displacement differ .* by 1\.9%"):
        read(tmp_path / "a.npz", [U])
    np.savez(tmp_path / "a.npz", points=points[:-1], displacement=values[:-1])
    with pytest.raises(AnswerError, match="do not stand above each other"):
        read(tmp_path / "a.npz", [U])


def test_layers_in_time_are_averaged_too(tmp_path):
    points, values = slab(np.arange(4.0)[:, None])
    np.savez(tmp_path / "a.npz", points=points, times=H.times, u2=np.tile(values[:, 0], (5, 1)))
    answer = read(tmp_path / "a.npz", [H])
    assert np.array_equal(answer.values["u2"], np.tile(np.arange(4.0), (5, 1)))


def test_a_crack_s_path_is_read_as_such_or_as_points(tmp_path):
    angle = Target("angle", "largest", "°", np.array([45.0]), ABSOLUTE,
                   read=lambda path: np.degrees(np.arctan2(*path[-1:, ::-1].T)))  # fmt: skip
    line = Target("path", "path", "m", POINTS[:2], LINES, needed=False, read=lambda path: path)
    path = np.array([[0.0, 0.0], [1.0, 0.9], [2.0, 2.0]])
    np.savez(tmp_path / "a.npz", path=path)
    (tmp_path / "b.json").write_text(json.dumps({"path": path.tolist(), "angle": [40.0]}))
    np.savetxt(tmp_path / "c.csv", path, delimiter=",", header="x,y", comments="")
    for name, expected in (("a.npz", 45.0), ("b.json", 40.0), ("c.csv", 45.0)):
        answer = read(tmp_path / name, [angle, line])
        assert answer.values["angle"] == pytest.approx([expected])
        assert np.array_equal(answer.values["path"], path)
    (tmp_path / "d.json").write_text(json.dumps({"angle": [40.0]}))
    assert set(read(tmp_path / "d.json", [angle, line]).values) == {"angle"}


ROWS = "0,0,1\n1,0,1\n0,1,1\n1,1,1\n"


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.csv", b"", "a header of names and rows"),
        ("a.csv", b"\n\n", "a header of names and rows"),
        ("a.csv", b"x,y,T\n", "a header of names and rows"),
        ("a.csv", ("x,y,T,T\n" + ROWS.replace("1\n", "1,2\n")).encode(), "two columns 'T'"),
        ("a.csv", ("x,y,T\n" + ROWS).replace(",", ";").encode(), "parted by commas, not by ';'"),
        ("a.csv", ("x,y,T\n" + ROWS).replace(",", "\t").encode(), "parted by commas"),
        ("a.csv", ("x,y,T,\xb0\n" + ROWS).encode("latin-1"), r"a\.csv:1: the file is not UTF-8"),
        ("a.csv", ("x,y,T\n" + ROWS).encode("utf-16"), "not UTF-8"),
        ("a.json", b'{"points": [[0, 0]], "T": [1], "T": [2]}', "says 'T' twice"),
        ("a.json", b'{"T": "\xff"}', r"a\.json:1: the file is not UTF-8"),
        ("a.vtu", b"<VTKFile>", "cannot be read as a mesh"),
    ],
)
@pytest.mark.filterwarnings("error")
def test_files_that_say_nothing_or_two_things_are_refused(tmp_path, name, content, message):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(AnswerError, match=message) as caught:
        read(path, [T])
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)


def test_blank_lines_and_other_ends_of_lines_are_no_rows(tmp_path):
    path = tmp_path / "a.csv"
    path.write_bytes(("\ufeff\nx,y,T\n\n" + ROWS + "\n\n").replace("\n", "\r\n").encode())
    assert np.array_equal(read(path, [T]).values["temperature"], np.ones(4))
