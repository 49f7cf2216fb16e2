"""What meshio leaves the program for is an error in one line, and nothing is printed."""

import meshio
import numpy as np
import pytest

from cmverify.exchange import mesh_file


@pytest.mark.parametrize("name", ["a.vtu", "a.msh", "a.inp", "a.obj", "a.nonsense", "a.xdmf"])
@pytest.mark.parametrize("content", [b"", b"<VTKFile>", b"hello", bytes(range(256))])
def test_no_file_ends_the_program(tmp_path, capsys, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    said = name
    try:
        mesh_file.read(path)  # some formats take nothing for an empty mesh
    except ValueError as error:
        said = str(error)
    assert name in said
    assert "\n" not in said
    assert capsys.readouterr() == ("", "")


def test_a_mesh_is_read(tmp_path):
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    meshio.Mesh(corners, [("triangle", np.array([[0, 1, 2]]))]).write(tmp_path / "a.vtu")
    np.testing.assert_array_equal(mesh_file.read(tmp_path / "a.vtu").points, corners)
