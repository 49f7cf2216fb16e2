"""
A crack that is heard of by its resistance
==========================================

The same bonds that carry force conduct. When they break, the potential over the crack's mouth
rises; from a measured rise the crack's length can be told.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

from solver import (
    Crack,
    ElasticTensor,
    ElectricConductivityTensor,
    Load,
    Programme,
    Scene,
    Support,
    Toughness,
    fracture,
    rectangle,
)
from solver.fracture.crack_length import DropCurve
from solver.fracture.sensing import Sensor

# %%
# The strip of the tutorial before, a crack growing along its middle.
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

# %%
# As a conductor it is the same body with another material. Current enters above the crack's mouth
# and leaves below it; a voltmeter has its probes beside them.
upper, lower = rectangle(3, 3, (-18, 8)), rectangle(3, 3, (-18, -8))
conductor = replace(
    strip,
    material=ElectricConductivityTensor([[2.0, 0.0], [0.0, 1.0]]),
    supports=[Support.where(lambda x, y: (x > 19) & (abs(y) < 1), potential=0.0)],
    loads=[Load.lead(1.0, upper), Load.lead(-1.0, lower)],
)
drop = Sensor(conductor, rectangle(2, 2, (-19, 2)), rectangle(2, 2, (-19, -2)))

run = fracture.grow(
    strip,
    Toughness(1.0),
    Programme(),
    until=lambda run: run.advance >= 12,
    monitors={"drop": drop},
)

# %%
# The electrical problem is solved when the mechanics records a state, on its broken bonds.
length, volts = np.array(run.history.advance) + 15, np.array(run.history["drop"])
curve = DropCurve.of_run(run, "drop", initial=15.0)
fig, ax = plt.subplots(figsize=(5.5, 3.6), layout="constrained")
ax.plot(length, volts / curve.intact, ".", label="while it grew")
relative = np.linspace(*curve.range, 50)
ax.plot([curve.length(r).length for r in relative], relative, label="the curve made of it")
ax.set(xlabel="crack length", ylabel=r"drop $\Delta\varphi / \Delta\varphi_0$")
ax.legend()

# %%
# The other way round: a drop was measured, with some noise. How long is the crack?
middle = 0.5 * sum(curve.range)
told = curve.length(middle, noise=0.002)
print(told)
assert 15 < told.length < 27
