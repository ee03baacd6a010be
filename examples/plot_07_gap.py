"""
What was not measured
=====================

Where no sample is in reach, the wall has no radius, and the picture is grey.
"""

import numpy as np

import helibore as hb
from helibore.simulation import Hole, Tool, simulate

measured = simulate(Hole.example(stop=2008.0), Tool())
there = np.abs(measured.depth - 2004.0) > 0.6
caliper = hb.Caliper(measured.depth[there], measured.toolface[there], measured.radius[there])
wall = hb.reconstruct(caliper, bit_diameter=0.216, max_distance=0.2)
print(f"{100 * wall.summary().without_radius:.1f} % of the vertices have no radius")
figure = hb.plot.log(wall, title="A gap of 1.2 m", scale=50)
