"""Bodies: regions, their particles, their outline, and every question of place."""

from .crack import Crack
from .crack_set import CrackSet
from .edge_quadrature import Quadrature
from .exact import Frame
from .inside import Body
from .lattice import Lattice, select
from .outline import Outline
from .phases import Phases
from .regions import Point, Region, Where
from .shapes import disc, polygon, rectangle
from .spread import on_edges, on_nearest, on_particles
from .strips import volumes

__all__ = [
    "Body",
    "Crack",
    "CrackSet",
    "Frame",
    "Lattice",
    "Outline",
    "Phases",
    "Point",
    "Quadrature",
    "Region",
    "Where",
    "disc",
    "on_edges",
    "on_nearest",
    "on_particles",
    "polygon",
    "rectangle",
    "select",
    "volumes",
]
