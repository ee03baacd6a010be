"""
How far from the truth
======================

The simulated hole knows its own radius, so every vertex has an error.
"""

import matplotlib.pyplot as plt
import numpy as np

import helibore as hb
from helibore.simulation import Hole, Tool, simulate

hole = Hole.example(stop=2010.0)
measured = simulate(hole, Tool())
wall = hb.reconstruct(hb.Caliper(measured.depth, measured.toolface, measured.radius), bit_diameter=0.216)
error = 1000 * (wall.radius - hole.radius(wall.depth, wall.toolface))

figure, axes = plt.subplots(figsize=(6, 3))
axes.hist(error, bins=np.linspace(-3, 3, 121))
axes.set_xlabel("rebuilt less true radius, mm")
axes.set_ylabel("vertices")
print(f"root mean square {np.sqrt(np.mean(error**2)):.2f} mm")
