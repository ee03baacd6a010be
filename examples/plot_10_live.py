"""
While the hole is drilled
=========================

Every append says which vertices changed. The end has the same bits as one batch with its settings.
"""

import matplotlib.pyplot as plt

import helibore as hb
from helibore.simulation import Hole, Tool, simulate

measured = simulate(Hole.example(stop=2005.0), Tool())
columns = measured.depth, measured.toolface, measured.radius, measured.time
wall = hb.Wall(bit_diameter=0.216)
sizes, settled = [], []
for start in range(0, measured.depth.size, 500):
    change = wall.append(*(values[start : start + 500] for values in columns))
    sizes.append(len(wall))
    settled.append(change.settled)
assert wall.radius.tobytes() == hb.reconstruct(hb.Caliper(*columns), **vars(wall.settings)).radius.tobytes()

figure, axes = plt.subplots(figsize=(6, 3))
axes.step(range(len(sizes)), sizes, label="vertices")
axes.step(range(len(sizes)), settled, label="final")
axes.set_xlabel("appends of 500 samples")
axes.legend()
