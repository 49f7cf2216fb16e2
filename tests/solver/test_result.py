"""Results write what they say, under the names they were given."""

import meshio
import numpy as np
import pytest

from solver import Scene, Support, disc, rectangle
from solver.bonds import Cells
from solver.material import ConductivityTensor, ElasticTensor
from solver.result import FORMAT, Result, Table, suffixed, vtk_mesh


class Two(Result):
    """Two particles, a scalar, a vector and a table."""

    @property
    def points(self):
        return np.array([[0.0, 0.0], [1.0, 0.5]])

    def fields(self):
        return {"T": np.array([1.0, 2.0]), "u": np.array([[1.0, 2.0], [3.0, 4.0]])}

    def summary(self):
        return {"particles": 2}

    def tables(self):
        return {"history": Table(("t", "x"), np.array([[0.0, 1.0], [0.5, 2.0]]))}


def test_dots_in_names_are_no_suffixes(tmp_path):
    assert suffixed(tmp_path / "h_0.05", ".vtu").name == "h_0.05.vtu"
    names = {path.name for stem in ("h_0.1", "h_0.05") for path in Two().write(tmp_path / stem)}
    assert len(names) == 6


def test_files_hold_fields_and_tables(tmp_path):
    vtu, npz, csv = Two().write(tmp_path / "new" / "two")
    found = meshio.read(vtu)
    np.testing.assert_array_equal(found.point_data["u"], [[1, 2, 0], [3, 4, 0]])
    with np.load(npz) as data:
        assert set(data) == {"points", "format", "T", "u"}
        assert data["format"] == FORMAT
        np.testing.assert_array_equal(data["T"], [1.0, 2.0])
    assert csv.read_text().splitlines()[0] == "t,x"
    np.testing.assert_array_equal(np.loadtxt(csv, delimiter=",", skiprows=1), [[0, 1], [0.5, 2]])


def test_solutions_say_what_they_hold():
    layer = Support.layer(2.5, displacement=(0.0, 0.0), rotation=0.0)
    with_rotations = Scene(disc(1.0), 0.25, ElasticTensor.isotropic(1.0, 0.2), [layer], m=2).solve()
    assert set(with_rotations.fields()) == {
        "prescribed", "displacement", "rotation", "stress11", "stress22", "stress12"
    }  # fmt: skip
    without = Scene(disc(1.0), 0.25, ElasticTensor.isotropic(1.0, 1 / 3), [layer], m=2).solve()
    assert "rotation" not in without.fields()
    assert with_rotations.summary()["physics"] == "elasticity"
    ends = Support.where(lambda x, y: abs(x) > 0.8, temperature=lambda x, y: x)
    bar = Scene(rectangle(2.0, 1.0), 0.25, ConductivityTensor.isotropic(1.0), [ends], m=2).solve()
    assert set(bar.fields()) == {"prescribed", "temperature", "flux"}
    for result in (with_rotations, bar):
        count = len(result.points)
        assert all(len(values) == count for values in result.fields().values())


def test_a_result_must_say_its_fields():
    with pytest.raises(TypeError, match="abstract"):
        Result()


def test_unknowns_are_at_the_corners_too_whatever_stands_before_their_names():
    held = Support.layer(1.0, temperature=0.0)
    scene = Scene(rectangle(1.0, 1.0), 0.25, ConductivityTensor.isotropic(1.0), [held], m=2)
    parts = scene.discretise()
    x = parts.lattice.points[:, 0]
    names = "temperature", "unstrained_potential", "mode 1 rotation", "damage"
    mesh = vtk_mesh(parts.lattice.points, dict.fromkeys(names, x), cells=Cells.of(parts.bonds))
    assert set(mesh.cell_data) == set(names)
    assert set(mesh.point_data) == set(names) - {"damage"}
    np.testing.assert_allclose(mesh.point_data["unstrained_potential"], mesh.points[:, 0])
