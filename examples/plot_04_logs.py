"""
Logs of every turn
==================

Diameters, ovality and volume, as a data frame or as LAS.
"""

import matplotlib.pyplot as plt

import helibore as hb
from helibore.simulation import Hole, Tool, simulate

measured = simulate(Hole.example(stop=2020.0), Tool())
wall = hb.reconstruct(hb.Caliper(measured.depth, measured.toolface, measured.radius), bit_diameter=0.216)
logs = wall.logs()

figure, axes = plt.subplots(figsize=(4, 7))
for name, label in (("c1", "largest"), ("equivalent_diameter", "by area"), ("inscribed_diameter", "what passes")):
    axes.plot(1000 * getattr(logs, name), logs.depth, label=label)
axes.axvline(216, color="grey", linestyle="--", label="bit")
axes.invert_yaxis()
axes.set(xlabel="diameter, mm", ylabel="depth, m")
axes.legend()
print(f"{logs.volume.sum():.3f} cubic metres")
