"""Array types of the solver; docstrings say shapes and units."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Of single or double precision.
Float = NDArray[np.floating]
Mask = NDArray[np.bool_]
Indices = NDArray[np.int64]
