"""
A pulse in an anisotropic plate
===============================

A plate of carbon fibres is struck at its middle. The front that runs away is not a circle: waves
are fast along the fibres.
"""

import matplotlib.pyplot as plt
import numpy as np

from solver import ElasticTensor, Load, Scene, rectangle, waves

# %%
# The load is a function of (x, y, t). Nothing holds the plate: it need not be held, it moves. With
# the default calibration this solid would be refused: its lattice is unstable at m = 3, and the
# error names the calibration that is not.
STIFF = ElasticTensor.orthotropic(E1=140e9, E2=10e9, G12=5e9, nu12=0.3)
RHO, WIDTH = 1600.0, 0.3
along = np.sqrt(STIFF.voigt[0, 0] / RHO)
end = 0.8 * (WIDTH / 2) / along


def blow(x, y, t):
    pulse = np.exp(-(((t - 0.2 * end) / (0.06 * end)) ** 2))
    spot = np.exp(-(x**2 + y**2) / (2 * 0.006**2))
    return np.stack([spot * pulse * 1e10] * 2, axis=-1)


plate = Scene(
    region=rectangle(WIDTH, WIDTH),
    spacing=WIDTH / 90,
    m=3,
    material=STIFF,
    calibration="positive",
    density=RHO,
    loads=[Load.body_force(blow)],
)
run = waves.run(plate, initial=0.0, end=end, times=[0.5 * end, end])
print(
    f"{run.statistics.steps} steps of {run.statistics.step:.2e} s, drift {run.statistics.drift:.1e}"
)

# %%
x, y = run.points.T
fig, axes = plt.subplots(1, 2, figsize=(8, 3.6), layout="constrained")
for ax, moved, t in zip(axes, run.displacement, run.times, strict=True):
    size = np.hypot(*moved.T)
    ax.scatter(x, y, c=size, s=5, marker="s", vmax=np.percentile(size, 99))
    ax.set(aspect="equal", title=f"{1e6 * t:.1f} µs", xlabel="$x_1$ (m)")

# %%
# What the load's work became is kinetic and strain energy, to rounding.
assert run.statistics.drift < 1e-6
