"""
Along the path of the well
==========================

A survey places the wall in space; ``wall.surface().save("well.glb")`` writes it for 3-D programs.
"""

import matplotlib.pyplot as plt
import numpy as np

import helibore as hb

survey = hb.Survey([0, 400, 900, 1200], [0, 5, 60, 88], [20, 25, 60, 70])
path = survey.path()
position = path.position(np.linspace(0, 1200, 300))

figure = plt.figure(figsize=(6, 5))
axes = figure.add_subplot(projection="3d")
axes.plot(position[:, 1], position[:, 0], -position[:, 2])
axes.set(xlabel="east, m", ylabel="north, m", zlabel="up, m")
