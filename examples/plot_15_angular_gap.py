"""
How sparse the samples are
==========================

Distance to the nearest sample and the angular gap, one value a vertex.
"""

import matplotlib.pyplot as plt
import numpy as np

import helibore as hb
from helibore.simulation import Hole, Tool, simulate

measured = simulate(Hole.example(stop=2006.0), Tool(stick_slip=1.0, sample_rate=4.0))
wall = hb.reconstruct(hb.Caliper(measured.depth, measured.toolface, measured.radius), bit_diameter=0.216)
whole = len(wall) // 64 * 64

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 5), sharey=True)
for axes, values, label in ((left, 1000 * wall.nearest, "nearest, mm"), (right, wall.angular_gap, "angular gap, deg")):
    shown = np.asarray(values)[:whole].reshape(-1, 64)
    drawn = axes.imshow(shown, extent=(0, 360, wall.depth[-1], wall.depth[0]), aspect="auto")
    axes.set_xlabel("toolface, degrees")
    figure.colorbar(drawn, ax=axes, label=label)
left.set_ylabel("depth, m")
