"""Answers are read from every kind of file, and what is missing is named in one line."""

import json

import meshio
import numpy as np
import pytest

from cmverify.exchange.answers import AnswerError, read
from cmverify.exchange.statement import LARGEST, Target

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
