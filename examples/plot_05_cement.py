"""
Cement around a casing
======================

The annulus between the measured wall and a casing of 5 1/2 in.
"""

import matplotlib.pyplot as plt

import helibore as hb
from helibore.simulation import Hole, Tool, simulate

measured = simulate(Hole.example(stop=2020.0), Tool())
wall = hb.reconstruct(hb.Caliper(measured.depth, measured.toolface, measured.radius), bit_diameter=0.216)
room = wall.logs().annulus(casing=5.5 * 0.0254)
print(f"{room.cement(excess=0.1):.3f} cubic metres with ten percent on top")

figure, axes = plt.subplots(figsize=(4, 6))
axes.plot(room.from_bottom, wall.logs().depth)
axes.invert_yaxis()
axes.set(xlabel="cement from the bottom, cubic metres", ylabel="depth, m")
