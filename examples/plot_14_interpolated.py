"""
Other values, by the same neighbours
====================================

Values that were measured with the samples go to the quads by the neighbours and weights of the radius.
"""

import numpy as np

import helibore as hb
from helibore.simulation import Hole, Tool, simulate

measured = simulate(Hole.example(stop=2005.0), Tool())
caliper = hb.Caliper(measured.depth, measured.toolface, measured.radius)
wall = hb.reconstruct(caliper, bit_diameter=0.216)
temperature = 60 + 0.5 * (measured.depth - 2000) + np.cos(np.radians(measured.toolface))
wall.attributes["temperature"] = wall.interpolate_samples(temperature, caliper)
wall.attributes.units["temperature"] = "degC"
print(wall.surface().attributes["temperature"][:3])
figure = hb.plot.overview(wall, title="The wall that carries a temperature")
