import numpy as np
import pytest

from references.fem.mesh import rectangle
from references.fem.restraint import free_motions, parts_of, require_held, require_temperature

# two triangles that share the vertex (0, 0) only, and the square of two triangles
NODES = np.array([[-1.0, -1], [-1, 1], [0, 0], [1, 1], [1, -1]])
HINGED = np.array([[0, 2, 1], [2, 4, 3]]).T


def held(*where: tuple[int, int], number: int = len(NODES)) -> np.ndarray:
    found = np.zeros((number, 2), dtype=bool)
    for node, component in where:
        found[node, component] = True
    return found


def test_parts_hang_together_by_edges_not_by_vertices() -> None:
    assert len(set(parts_of(HINGED.T).tolist())) == 2
    assert len(set(parts_of(rectangle(1, 1, 0.3).triangles).tolist())) == 1


def test_a_hinge_passes_displacement_but_no_rotation() -> None:
    assert free_motions(NODES, HINGED, held()).number == 4
    first = [(0, 0), (0, 1), (1, 0)]
    found = free_motions(NODES, HINGED, held(*first))
    assert found.number == 1
    assert "rotation about" in found.describe()
    assert free_motions(NODES, HINGED, held(*first, (3, 0))).number == 0
    with pytest.raises(ValueError, match="rotation about"):
        require_held(NODES, HINGED, held(*first))


def test_the_pole_of_a_rotation_is_named() -> None:
    # u1 and u2 of the corner (-1, -1) held: the triangle turns about it
    one = HINGED[:, :1]
    found = free_motions(NODES, one, held((0, 0), (0, 1)))
    assert found.describe() == "rotation about (-1, -1)"
    oblique = free_motions(NODES, one, held((0, 0), (1, 0)))
    assert oblique.describe() == "translation along axis 2"


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_the_unit_of_length_does_not_matter(unit: float) -> None:
    assert free_motions(unit * NODES, HINGED, held((0, 0), (0, 1))).number == 2


def test_a_conductor_needs_one_temperature_for_each_part() -> None:
    cut = rectangle(1, 1, 0.25, cracks=[((0, -0.5), (0, 0.5))])
    known = np.zeros(len(cut.points), dtype=bool)
    known[cut.nodes("left")] = True
    with pytest.raises(ValueError, match=r"part about \(0\.2.*up to a constant"):
        require_temperature(cut.points, cut.triangles.T, known)
    known[cut.nodes("right")] = True
    require_temperature(cut.points, cut.triangles.T, known)
    # heat passes a vertex
    require_temperature(NODES, HINGED, np.arange(len(NODES)) == 0)
