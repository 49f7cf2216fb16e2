"""
A plate with a crack
====================

A square plate with a slanted crack is pulled at its top and bottom edge. A bond that would pass
through the crack does not exist; nothing else tells the lattice that there is one.
"""

import matplotlib.pyplot as plt
import numpy as np

from solver import Crack, ElasticTensor, Load, Scene, Support, recovery, rectangle

# %%
# The solid is cortical bone, stiff along axis 1. The plate is held at three points, just enough to
# keep it from moving away, and its edges are pulled by tractions: ``surface="extrapolated"`` ends
# bonds at the edges and at the faces of the crack, so that loads act where the body ends.


def at(place_x, place_y):
    """The one particle nearest to a place."""

    def nearest(x, y):
        distance = np.hypot(x - place_x, y - place_y)
        return distance == distance.min()

    return nearest


plate = Scene(
    region=rectangle(1.0, 1.0),
    spacing=1 / 60,
    m=3,
    surface="extrapolated",
    material=ElasticTensor.orthotropic(E1=18.4e9, E2=8.51e9, G12=4.91e9, nu12=0.43),
    cracks=[Crack((-0.2, -0.1), (0.2, 0.1))],
    supports=[
        Support.where(at(-0.49, 0.0), displacement=0.0),
        Support.where(at(0.49, 0.0), u2=0.0),
    ],
    loads=[Load.stress((0.0, 1e6, 0.0), where=lambda x, y: abs(y) > 0.4999)],
)
solution = plate.solve()
print(solution.statistics.iterations, "iterations,", solution.statistics.unknowns, "unknowns")

# %%
# Fields come at the particles, as arrays. The stress is recovered from the forces in the bonds.
stress = recovery.stress(solution, rule="family")
x, y = solution.points.T

fig, axes = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
for ax, values, name in (
    (axes[0], 1e6 * solution.displacement[:, 1], "$u_2$ (µm)"),
    (axes[1], stress[:, 1, 1] / 1e6, r"$\sigma_{22}$ (MPa)"),
):
    low, high = np.percentile(values, (0.5, 99.5))
    dots = ax.scatter(x, y, c=values, s=6, marker="s", vmin=low, vmax=high)
    ax.plot([-0.2, 0.2], [-0.1, 0.1], "k", lw=1)
    ax.set(aspect="equal", xlabel="$x_1$ (m)", ylabel="$x_2$ (m)")
    fig.colorbar(dots, ax=ax, label=name)

# %%
# Is it right? What the cut through the middle carries must be what the edges are pulled by.
row = abs(y) == abs(y).min()
force = stress[row, 1, 1].sum() * plate.spacing / 2  # two rows lie nearest to the middle
print(f"force through the middle {force / 1e6:.3f} MN/m, applied 1 MN/m")
assert abs(force / 1e6 - 1) < 0.05
