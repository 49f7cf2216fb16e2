"""A square, elastic or conductive, on a coarse lattice."""

from solver import ConductivityTensor, ElasticTensor, Scene, Support, rectangle

SQUARE = rectangle(1.0, 1.0)
SOLID, CONDUCTOR = ElasticTensor.isotropic(1.0, 0.2), ConductivityTensor.isotropic(1.0)
HELD = Support.layer(1, displacement=0.0, rotation=0.0)


def plate(*supports, loads=(), material=SOLID, **options):
    return Scene(
        region=SQUARE,
        spacing=0.1,
        m=2,
        material=material,
        supports=supports,
        loads=loads,
        **options,
    ).discretise()


def wall(*supports):
    return plate(*supports, material=CONDUCTOR)
