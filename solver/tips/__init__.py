"""Tips of cracks as calibrated defects: what is added to the bonds around them, and why.

Beside a tip the field varies as √r within the horizon, and no family of bonds can follow it: what
reaches the far field is that of a tip that lies elsewhere. Here the stiffness that the particles
near the tip have among themselves is changed once, so that they answer the tip's two singular
fields as the solid does. The change is a symmetric matrix on some fifty particles; it depends on
the solid, the family, the crack's direction and the place of the tip in its cell, and on nothing
else, so that it serves every crack and every spacing.
"""

from .calibration import calibrated_tip
from .patch import SIZE, TipCalibrationError

__all__ = ["SIZE", "TipCalibrationError", "calibrated_tip"]
