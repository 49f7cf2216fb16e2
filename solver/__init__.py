"""Fields of continuum-molecular (micropolar bond-based peridynamic) scenes.

Scene -> Lattice + Family -> Moduli + Bonds -> Operator -> statics -> Solution -> recovery
"""

from . import fracture, recovery
from .conditions import Load, Support
from .errors import (
    CalibrationError,
    ConvergenceError,
    InadmissibleMaterialError,
    MechanismError,
    NegativeCurvatureError,
    SceneError,
    ToughnessError,
)
from .family import Family
from .influence import Influence
from .laws import Cosine, Fourfold, TwoHarmonic, UniformShear
from .programme import Programme
from .regions import Crack, Region, disc, polygon, rectangle
from .scene import Discretisation, Scene
from .solution import Solution, Statistics
from .tensors import ConductivityTensor, ElasticTensor
from .toughness import Toughness

__all__ = [
    "CalibrationError",
    "ConductivityTensor",
    "ConvergenceError",
    "Cosine",
    "Crack",
    "Discretisation",
    "ElasticTensor",
    "Family",
    "Fourfold",
    "InadmissibleMaterialError",
    "Influence",
    "Load",
    "MechanismError",
    "NegativeCurvatureError",
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
    "polygon",
    "recovery",
    "rectangle",
]
