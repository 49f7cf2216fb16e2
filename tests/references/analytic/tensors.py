"""Random positive definite tensors for the identity tests."""

import numpy as np
from hypothesis import strategies as st

entry = st.floats(-1.0, 1.0, allow_nan=False, width=32)


@st.composite
def random_voigt(draw, floor: float = 0.1):
    """A stiffness A A^T + floor I: any symmetry class, condition number up to a few hundred."""
    a = np.array([[draw(entry) for _ in range(3)] for _ in range(3)])
    return a @ a.T + floor * np.eye(3)


@st.composite
def random_conductivity(draw, floor: float = 0.05):
    """A symmetric positive definite 2x2 conductivity."""
    a = np.array([[draw(entry) for _ in range(2)] for _ in range(2)])
    return a @ a.T + floor * np.eye(2)
