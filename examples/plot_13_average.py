"""
Only an average caliper
=======================

A mean diameter makes a round wall, and every output says so.
"""

import numpy as np

import helibore as hb

depth = np.arange(1500.0, 1515.0, 0.15)
diameter = 0.2159 + 0.02 * np.exp(-(((depth - 1507) / 2) ** 2))
wall = hb.reconstruct(hb.Caliper.from_average(depth, diameter), bit_diameter=0.2159)
print(wall.basis)
figure = hb.plot.log(wall, title="An average caliper", scale=100)
