"""
A crack grows
=============

A bond breaks when the energy stored in it reaches a critical value, which follows from the solid's
fracture energy G. Between two breaks the body is linear, so the load jumps from event to event, and
all energies can be booked.
"""

import matplotlib.pyplot as plt
import numpy as np

from solver import (
    Crack,
    ElasticTensor,
    Programme,
    Scene,
    Support,
    Toughness,
    fracture,
    rectangle,
)

# %%
# A long strip is held at its top and bottom, which move apart. There the energy that a growing
# crack releases does not depend on its length: G = σ v with the stress far ahead and the opening v.
strip = Scene(
    region=rectangle(40, 24),
    spacing=1.0,
    m=3,
    material=ElasticTensor.orthotropic(2.0, 1.0, 0.5, 0.2),
    supports=[
        Support.where(
            lambda x, y: abs(y) > 8.5,
            rotation=0.0,
            displacement=lambda x, y: np.stack([0 * y, np.sign(y)], axis=-1),
        )
    ],
    cracks=[Crack((-21, 0), (-5, 0))],
)
run = fracture.grow(strip, Toughness(1.0), Programme(), until=lambda run: run.advance >= 6)

# %%
history = run.history
fig, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
x, y = run.solution.points.T
axes[0].scatter(x, y, c=run.damage, s=8, marker="s", cmap="magma_r")
axes[0].plot(*run.path.T, "c.-", lw=1)
axes[0].set(aspect="equal", title="damage and path")
axes[1].plot(history.load_factor, ".-", lw=0.8)
axes[1].set(xlabel="event", ylabel="load factor")

# %%
# Work is stored, dissipated by bonds, or left over where a bond was overloaded when it broke; what
# is not accounted for is rounding.
print(f"imbalance {abs(history.imbalance).max() / history.work.max():.1e} of the work")
assert run.advance >= 6
assert abs(history.imbalance).max() < 1e-6 * history.work.max()
