"""
A gamma image on the wall
=========================

A sector image lies on the same helix as the radius.
"""

import helibore as hb
from helibore.simulation.demonstration import drill, rebuild

demonstration = rebuild(drill())
wall = demonstration.wall
print(wall.images["Gamma ray"].values.shape, "rows and sectors")
figure = hb.plot.log(wall, title="Radius and gamma", start=2005.0, stop=2020.0, scale=100)
