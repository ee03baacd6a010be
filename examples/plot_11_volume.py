"""
Thickened for simulation
========================

Shells of hexahedra around the hole, ready for VTK: ``volume.save("well.vtu")``.
"""

import matplotlib.pyplot as plt

import helibore as hb
from helibore.simulation import Hole, Tool, simulate

measured = simulate(Hole.example(stop=2003.0), Tool())
wall = hb.reconstruct(hb.Caliper(measured.depth, measured.toolface, measured.radius), bit_diameter=0.216, sectors=24)
volume = wall.volume(shells=(0.02, 0.06))
print(volume)

figure, axes = plt.subplots(figsize=(4, 4))
points = volume.vertices
first = points[:, 2] < points[:, 2].min() + 0.1
axes.scatter(points[first, 1], points[first, 0], s=6)
axes.set(aspect="equal", xlabel="east, m", ylabel="north, m")
