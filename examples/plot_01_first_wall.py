"""
A wall from samples
===================

A tool turns while it advances. helibore rebuilds the wall from its samples.
"""

import helibore as hb
from helibore.simulation import Hole, Tool, simulate

measured = simulate(Hole.example(stop=2010.0), Tool())
caliper = hb.Caliper(measured.depth, measured.toolface, measured.radius, measured.time)
wall = hb.reconstruct(caliper, bit_diameter=0.216)
print(wall.summary().mean_diameter, "m")
figure = hb.plot.overview(wall, title="Simulated hole")
