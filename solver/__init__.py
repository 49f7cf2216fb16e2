"""Fields of continuum-molecular (micropolar bond-based peridynamic) scenes.

Scene -> Lattice + Family -> Moduli + Bonds -> Operator -> statics -> Solution -> recovery
"""

from . import fracture, recovery
from .errors import (
    CalibrationError,
    ConvergenceError,
    InadmissibleMaterialError,
    MechanismError,
    NegativeCurvatureError,
    SceneError,
    ToughnessError,
)
from .fracture.programme import Programme
from .fracture.toughness import Toughness
from .geometry.regions import Crack, Region, disc, polygon, rectangle
from .material.family import Family
from .material.influence import Influence
from .material.laws import Cosine, Fourfold, TwoHarmonic, UniformShear
from .material.tensors import ConductivityTensor, ElasticTensor
from .problem.conditions import Load, Support
from .scene import Discretisation, Scene
from .solution import Solution, Statistics

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
