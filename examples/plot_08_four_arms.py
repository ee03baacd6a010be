"""
A tool with four arms
=====================

Four arms see four lines of the wall. The logs take their diameters from the arms; the picture marks what lies between.
"""

import numpy as np

import helibore as hb

turn = np.arange(600)
depth = np.repeat(1000 + turn * 0.05, 4)
arm = np.tile(np.arange(4), turn.size)
toolface = (arm * 90.0 + depth * 12.0) % 360  # one turn in 30 m
a, b = 0.120, 0.108  # half axes of an ellipse
angle = np.radians(toolface)
radius = a * b / np.hypot(b * np.cos(angle), a * np.sin(angle))

wall = hb.Wall(bit_diameter=0.216)
wall.append(depth, toolface, radius, arm=arm % 2)
for warning in wall.summary().warnings:
    print(warning)
figure = hb.plot.log(wall, title="Four arms in an ellipse", scale=200)
