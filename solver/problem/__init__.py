"""What is asked: supports, loads, checks that all is held, and the scene as arrays."""

from .description import Description
from .discretisation import Discretisation
from .forcing import Forcing
from .inclusions import Inclusion
from .loads import Load
from .supports import Support

__all__ = ["Description", "Discretisation", "Forcing", "Inclusion", "Load", "Support"]
