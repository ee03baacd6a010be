"""
From a data frame and back
==========================

Rows with a missing value are left out and counted.
"""

import matplotlib.pyplot as plt
import numpy as np

import helibore as hb

rng = np.random.default_rng(1)
frame = {"MD": 3280 + np.arange(4000) * 0.005, "TF": np.arange(4000) * 1.1, "R": 4.3 + 0.1 * rng.standard_normal(4000)}
frame["R"][::50] = np.nan
units = {"depth": "ft", "toolface": "rad", "radius": "in"}
caliper = hb.Caliper.from_table(frame, depth="MD", toolface="TF", radius="R", units=units)
print(caliper.left_out, "rows left out")

wall = hb.reconstruct(caliper, bit_diameter=8.5 * 0.0254)
vertices = {"depth": wall.depth, "radius": wall.radius, "support": wall.support}

figure, axes = plt.subplots(figsize=(5, 4))
drawn = axes.scatter(wall.toolface, vertices["depth"], c=1000 * vertices["radius"], s=4)
axes.invert_yaxis()
axes.set(xlabel="toolface, degrees", ylabel="depth, m")
figure.colorbar(drawn, label="radius, mm")
