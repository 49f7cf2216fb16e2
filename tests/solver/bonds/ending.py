"""Bodies whose bonds end at their surface, for tests of those."""

import numpy as np

from solver import ElasticTensor, Family, Load, Scene, Support, polygon
from solver.bonds import Bonds
from solver.geometry import Lattice
from solver.material import ElasticModuli, calibrate
from solver.operators import BondOperator
from tests.solver.bodies import FIG_7

NOTCHED = polygon([(0, 0), (1.0, 0.1), (0.9, 0.9), (0.45, 0.55), (0.05, 1.0)])
SOLID = ElasticTensor(FIG_7)


def body(region, spacing, m, material=SOLID, cracks=(), calibration="lattice", area_rule="partial"):
    """Operator of a free body with ended bonds."""
    family = Family(m, spacing, area_rule)
    lattice = Lattice(region, spacing, family.reach)
    bonds = Bonds(lattice, family, cracks, "extrapolated")
    moduli = calibrate(family, material, calibration)
    components = 1
    if isinstance(moduli, ElasticModuli):
        components = 3 if moduli.has_shear else 2
    return BondOperator(bonds, moduli, np.zeros((components, lattice.count), dtype=bool))


def linear_fields(points, components, spacing):
    """Rigid and homogeneous fields, (fields, components, n), rotations as the curl says."""
    x, y = points.T
    one, zero = np.ones_like(x), np.zeros_like(x)
    if components == 1:
        return np.array([[one], [x], [y]])
    fields = [(one, zero, 0), (zero, one, 0), (x, zero, 0), (zero, y, 0), (y, zero, -0.5)]
    fields.append((zero, x, 0.5))
    return np.array([[u, v, w * spacing * one][:components] for u, v, w in fields])


# ---- what it buys -------------------------------------------------------------------------------

STRESS = np.array([1.0, 0.3, -0.4])


def homogeneous_error(region, n, surface, load=1.0, m=3, phase=None):
    """Relative error of the displacement of a body that its edges pull."""
    strain = np.linalg.solve(FIG_7, STRESS)

    def exact_field(x, y):
        return np.stack(
            [strain[0] * x + 0.5 * strain[2] * y, 0.5 * strain[2] * x + strain[1] * y], axis=-1
        )

    def near(column):
        return lambda x, y: (abs(x - (column + 0.5) / n) < 0.1 / n) & (abs(y - 0.5 / n) < 0.1 / n)

    far = n // 4
    supports = [
        Support.where(near(-far), displacement=exact_field),
        Support.where(near(far), u2=lambda x, y: exact_field(x, y)[..., 1]),
    ]
    loads = [Load.stress(tuple(load * STRESS))]
    scene = Scene(region, 1 / n, SOLID, supports, loads, m=m, surface=surface, phase=phase)
    solution = scene.solve(tolerance=1e-9)
    expected = exact_field(*solution.points.T)
    error = np.linalg.norm(solution.displacement - expected) / np.linalg.norm(expected)
    return error, solution
