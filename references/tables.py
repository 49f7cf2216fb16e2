"""Stored references in the form in which they are used."""

import numpy as np

from references.fem.kinks import KinkTable
from references.generators import MATERIALS
from references.provenance import load


def stored_kinks(material: str) -> KinkTable:
    """Short kinks of a stored material: ``isotropic``, ``silicon`` or ``anisotropic``.

    Materials that are mirror-symmetric in the crack's plane are stored for positive angles only:
    the mirror image changes the sign of what couples the modes.

    Parameters
    ----------
    material : str

    Returns
    -------
    KinkTable
        From −100° to 100°; its tensor is the stored one (GPa; isotropic: E = 1).

    Raises
    ------
    ValueError
        For a material that is not stored.
    DamagedReferenceError
        If the stored files are not what they should be.
    """
    known = ("isotropic", "silicon", "anisotropic")
    if material not in known:
        raise ValueError(f"no kinks are stored for {material!r}, only for {', '.join(known)}")
    stored = load(f"kinks-{material}")
    angles, matrices = np.radians(stored["degrees"]), stored["matrices"]
    if angles[0] >= 0:
        mirrored = matrices[:0:-1] * np.array([[1, -1], [-1, 1]])
        angles = np.concatenate([-angles[:0:-1], angles])
        matrices = np.concatenate([mirrored, matrices])
    return KinkTable(MATERIALS[material], angles, matrices)
