"""What a solid is said to be: engineering constants, turned axes, principal values.

The solver's constructors against compliances written out and against the energy of a strain that
turns with the solid. Everything is exact, nothing is solved.
"""

from __future__ import annotations

import numpy as np

from cmverify.case import Array, Case, Check, Level, Measurement, Method
from cmverify.cases.common import materials
from cmverify.judge.norms import relative_l2, worst

ANGLE = 0.4
E1, E2, G12, NU12 = 140.0, 10.0, 5.0, 0.3


def _turned_strain(strain: Array, angle: float) -> Array:
    """The strain (ε11, ε22, 2 ε12) of a body that was turned anticlockwise with its solid."""
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    e = np.array([[strain[0], strain[2] / 2], [strain[2] / 2, strain[1]]])
    e = turn @ e @ turn.T
    return np.array([e[0, 0], e[1, 1], 2 * e[0, 1]])


def elastic(_: int) -> Measurement:
    """Isotropic and orthotropic solids from their constants, turned, and their axis found."""
    from solver import ElasticTensor
    from solver.material.tensors import stress_rotation

    young, nu = 2.0, 0.3
    stress = ElasticTensor.isotropic(young, nu).compliance
    strain = ElasticTensor.isotropic(young, nu, "strain").compliance
    ortho = ElasticTensor.orthotropic(E1, E2, G12, NU12).compliance
    solid = ElasticTensor(materials.TENSORS["fully anisotropic"])
    generator = np.random.default_rng(2022)
    energy = []
    for e in generator.normal(size=(5, 3)):
        turned = _turned_strain(e, ANGLE)
        energy.append(abs(turned @ solid.rotated(ANGLE).voigt @ turned / (e @ solid.voigt @ e) - 1))
    # A uniaxial stress seen in a basis turned by ψ: cos², sin², −sin cos.
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    axis = ElasticTensor(materials.TENSORS["bone"]).rotated(ANGLE).orthotropy_angle()
    return Measurement(
        0,
        {
            "plane stress": relative_l2(
                [stress[0, 0], stress[0, 1], stress[2, 2]], np.array([1, -nu, 2 * (1 + nu)]) / young
            ),
            "plane strain": relative_l2(
                [strain[0, 0], strain[0, 1], strain[2, 2]],
                np.array([1 - nu**2, -nu * (1 + nu), 2 * (1 + nu)]) / young,
            ),
            "orthotropic": relative_l2(
                [ortho[0, 0], ortho[1, 1], ortho[0, 1], ortho[2, 2]],
                [1 / E1, 1 / E2, -NU12 / E1, 1 / G12],
            ),
            "turned": worst(energy),
            "basis": relative_l2(stress_rotation(ANGLE) @ [1.0, 0.0, 0.0], [c * c, s * s, -s * c]),
            "axis": float("nan") if axis is None else abs(axis - ANGLE),
        },
    )


def conductive(_: int) -> Measurement:
    """A conductor from its principal values, turned, and these found again."""
    from solver import ConductivityTensor

    made = ConductivityTensor.orthotropic(5.0, 2.0, ANGLE)
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    along, across = np.array([c, s]), np.array([-s, c])
    high, low, angle = made.principal()
    return Measurement(
        0,
        {
            "turned": relative_l2(
                [along @ made.matrix @ along, across @ made.matrix @ across], [5, 2]
            ),
            "basis": relative_l2(made.rotated(-ANGLE).matrix, np.diag([5.0, 2.0])),
            "axis": relative_l2([high, low, angle], [5.0, 2.0, ANGLE]),
            "resistivity": relative_l2(made.compliance @ made.matrix, np.eye(2)),
        },
    )


QUANTITIES = {
    "plane stress": "compliances of an isotropic solid in plane stress",
    "plane strain": "compliances of an isotropic solid in plane strain",
    "orthotropic": "compliances 1/E1, 1/E2, −ν12/E1, 1/G12 of an orthotropic solid",
    "turned": "energy of a strain that turns with the solid; conductivities along its axes",
    "basis": "components in turned axes",
    "axis": "angle of the material axis (and principal values) found again",
    "resistivity": "resistivity times conductivity",
}
_CHECKED = {
    "bond/elastic": ("plane stress", "plane strain", "orthotropic", "turned", "basis", "axis"),
    "bond/conductive": ("turned", "basis", "axis", "resistivity"),
}

CASES = (
    Case(
        name="solids",
        title="Solids from their constants, and turned",
        section="Sects. 2.1 and 4.1",
        equations=("Eqs. 43–45", "Eqs. 136–137", "Eqs. 160–162"),
        tags=("elasticity", "conduction", "tensors"),
        shows=(
            "Engineering constants give the stiffness they stand for, and turning a solid turns "
            "its properties with it."
        ),
        methods=(
            Method("bond/elastic", "bond", elastic, dict.fromkeys(Level, (1,))),
            Method("bond/conductive", "bond", conductive, dict.fromkeys(Level, (1,))),
        ),
        checks=tuple(
            Check(method, quantity, {1: 1e-12}, source="definition", exact=True)
            for method, quantities in _CHECKED.items()
            for quantity in quantities
        ),
        quantities=QUANTITIES,
        primary="turned",
        featured="bond/elastic",
        length="a",
        timed=False,
    ),
)
