"""
Modes of a free plate
=====================

An orthotropic square, free on all sides, vibrates in its plane. Rigid motions are found and
counted; copies of double frequencies are not lost.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

from solver import ElasticTensor, Scene, modes, rectangle

# %%
plate = Scene(
    region=rectangle(0.5, 0.5),
    spacing=0.5 / 30,
    m=3,
    surface="extrapolated",
    material=ElasticTensor.orthotropic(E1=140e9, E2=40e9, G12=20e9, nu12=0.3).rotated(np.pi / 6),
    density=1600.0,
)
found = modes.solve(plate, 4)
print(found.rigid, "rigid motions")
for frequency in found.frequencies:
    print(f"{frequency / (2 * np.pi):8.1f} Hz")

# %%
x, y = found.points.T
fig, axes = plt.subplots(1, 4, figsize=(10, 2.9), layout="constrained")
for ax, shape, frequency in zip(axes, found.shapes, found.frequencies, strict=True):
    size = 0.05 / abs(shape).max()
    ax.scatter(
        x + size * shape[:, 0], y + size * shape[:, 1], c=np.hypot(*shape.T), s=5, marker="s"
    )
    ax.set(aspect="equal", title=f"{frequency / (2 * np.pi):.0f} Hz")
    ax.set_axis_off()

# %%
# The same plate at half the spacing: how far is it from converged?
finer = modes.solve(replace(plate, spacing=0.5 / 60), 4)
change = abs(found.frequencies / finer.frequencies - 1)
print("change with half the spacing:", ", ".join(f"{100 * c:.2f} %" for c in change))
assert found.rigid == 3
assert change.max() < 0.02
