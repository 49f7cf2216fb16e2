"""What a provenance record says of a mesh."""

import hashlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from references.fem.mesh import Mesh


@dataclass(frozen=True)
class MeshRecord:
    """A mesh as it is remembered: size, counts and hash.

    Attributes
    ----------
    size : float
        Largest element size, m.
    points, elements : int
    shape : str
        Of the elements: ``triangles`` or ``quadrilaterals``.
    sha256 : str
        Of nodes and elements.
    """

    size: float
    points: int
    elements: int
    shape: str
    sha256: str

    @classmethod
    def of(cls, mesh: "Mesh | MeshRecord") -> "MeshRecord":
        """The record of a triangular mesh (a record is its own)."""
        if isinstance(mesh, MeshRecord):
            return mesh
        return cls(mesh.size, len(mesh.points), len(mesh.triangles), "triangles", mesh.sha256)

    @classmethod
    def of_grid(
        cls, points: NDArray[np.float64], quads: NDArray[np.int64], size: float
    ) -> "MeshRecord":
        """The record of quadrilaterals (m, 4) on points (n, 2)."""
        digest = hashlib.sha256(np.ascontiguousarray(points).tobytes())
        digest.update(np.ascontiguousarray(quads, dtype=np.int64).tobytes())
        return cls(size, len(points), len(quads), "quadrilaterals", digest.hexdigest())

    def as_json(self) -> dict[str, float | int | str]:
        """Plain numbers and strings for the stored record."""
        return {
            "size": self.size,
            "points": self.points,
            self.shape: self.elements,
            "sha256": self.sha256,
        }
