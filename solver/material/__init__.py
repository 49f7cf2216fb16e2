"""Solids and bonds: tensors, families, laws, calibrated moduli, and which of them are stable."""

from .admission import calibrated, remedy, require_admissible
from .calibration import Calibration, calibrate, representable, representable_by_directions
from .expansion import ExpansionTensor
from .family import AreaRule, Family
from .influence import CONSTANT, Influence
from .laws import AngularLaw, Cosine, Fourfold, TwoHarmonic, UniformShear
from .mixture import Mixture, together
from .moduli import (
    ChiralModuli,
    ConductiveModuli,
    ElasticModuli,
    ElectricModuli,
    Moduli,
    PolarModuli,
    bond_weights,
    effective_tensor,
    stretch_rows,
)
from .piezoresistance import Piezoresistance
from .stability import Stability, assess
from .symbol import acoustic_tensor, brillouin_zone, condensed_symbol, margins
from .tensors import (
    BendingTensor,
    ChiralTensor,
    ConductivityTensor,
    ElasticTensor,
    ElectricConductivityTensor,
    Material,
    Plane,
    PolarTensor,
    stress_rotation,
)

__all__ = [
    "CONSTANT",
    "AngularLaw",
    "AreaRule",
    "BendingTensor",
    "Calibration",
    "ChiralModuli",
    "ChiralTensor",
    "ConductiveModuli",
    "ConductivityTensor",
    "Cosine",
    "ElasticModuli",
    "ElasticTensor",
    "ElectricConductivityTensor",
    "ElectricModuli",
    "ExpansionTensor",
    "Family",
    "Fourfold",
    "Influence",
    "Material",
    "Mixture",
    "Moduli",
    "Piezoresistance",
    "Plane",
    "PolarModuli",
    "PolarTensor",
    "Stability",
    "TwoHarmonic",
    "UniformShear",
    "acoustic_tensor",
    "assess",
    "bond_weights",
    "brillouin_zone",
    "calibrate",
    "calibrated",
    "condensed_symbol",
    "effective_tensor",
    "margins",
    "remedy",
    "representable",
    "representable_by_directions",
    "require_admissible",
    "stress_rotation",
    "stretch_rows",
    "together",
]
