"""Fields of continuum-molecular (micropolar bond-based peridynamic) scenes.

Scene -> Lattice + Family -> Moduli + Bonds -> Operator -> statics -> Solution -> recovery
"""

from . import fracture, recovery
from .analyses import modes, thermoelastic, transient, waves
from .errors import (
    CalibrationError,
    ConvergenceError,
    InadmissibleMaterialError,
    MechanismError,
    NegativeCurvatureError,
    SceneError,
    ToughnessError,
)
from .fracture import Programme, Toughness
from .geometry import Crack, Region, disc, polygon, rectangle
from .material import (
    ChiralTensor,
    ConductivityTensor,
    Cosine,
    ElasticTensor,
    ElectricConductivityTensor,
    ExpansionTensor,
    Family,
    Fourfold,
    Influence,
    Piezoresistance,
    PolarTensor,
    TwoHarmonic,
    UniformShear,
)
from .problem import Discretisation, Inclusion, Load, Support
from .scene import Scene
from .solution import Solution, Statistics
from .strained import strained

__all__ = [
    "CalibrationError",
    "ChiralTensor",
    "ConductivityTensor",
    "ConvergenceError",
    "Cosine",
    "Crack",
    "Discretisation",
    "ElasticTensor",
    "ElectricConductivityTensor",
    "ExpansionTensor",
    "Family",
    "Fourfold",
    "InadmissibleMaterialError",
    "Inclusion",
    "Influence",
    "Load",
    "MechanismError",
    "NegativeCurvatureError",
    "Piezoresistance",
    "PolarTensor",
    "Programme",
    "Region",
    "Scene",
    "SceneError",
    "Solution",
    "Statistics",
    "Support",
    "Toughness",
    "ToughnessError",
    "TwoHarmonic",
    "UniformShear",
    "disc",
    "fracture",
    "modes",
    "polygon",
    "recovery",
    "rectangle",
    "strained",
    "thermoelastic",
    "transient",
    "waves",
]
