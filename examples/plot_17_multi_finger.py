"""
Joints of a casing by a multi-finger caliper
============================================

A caliper of 24 fingers gives a wall like any other tool. Joints and grades are not part of helibore: this recipe finds
the collars, measures each joint, and grades the deepest pit by its share of the pipe's thickness.
"""

import tempfile
from itertools import pairwise
from pathlib import Path

import numpy as np

import helibore as hb

INCH = 0.0254
OUTER, THICKNESS, FINGERS = 7 * INCH, 0.362 * INCH, 24  # 7 in, 26 lb/ft
NOMINAL = OUTER - 2 * THICKNESS
GRADES = ((0.1, "1"), (0.2, "2"), (0.4, "3"), (0.85, "4"), (np.inf, "5"))  # penetration below, of the thickness

# A log to read: collars every 12 m, a pit of 40 % at toolface 90 in the third joint, the tool turning slowly.
depth = np.arange(1000.0, 1060.0, 0.02)
turn = depth * 6 % 360
toolface = (turn[:, None] + np.arange(FINGERS) * 360 / FINGERS) % 360
radius = NOMINAL / 2 + 0.004 * (np.abs((depth - 1006) % 12 - 0.05) < 0.06)[:, None] + np.zeros_like(toolface)
radius += 0.4 * THICKNESS * ((np.abs(depth - 1035) < 0.15)[:, None] & (np.abs(toolface - 90) < 12))
names = ["DEPT", "ROT", *(f"FING{number:02d}" for number in range(1, FINGERS + 1))]
units = ["M", "DEG", *["IN"] * FINGERS]
rows = np.column_stack([depth, turn, radius / INCH])
file = Path(tempfile.mkdtemp()) / "mfc24.las"
curves = "".join(f"{name}.{unit} :\n" for name, unit in zip(names, units, strict=True))
lines = "\n".join(" ".join(f"{value:.4f}" for value in row) for row in rows)
file.write_text(f"~V\nVERS. 2.0 :\nWRAP. NO :\n~W\nNULL. -999.25 :\n~C\n{curves}~A\n{lines}\n")

# The wall: finger k looks k * 360/24 degrees clockwise from the first, whose toolface is ROT.
log = hb.open(file).set()
fingers = log["FING"].values * INCH
md = log.numbers("DEPT")
towards = (log.numbers("ROT")[:, None] + np.arange(FINGERS) * 360 / FINGERS) % 360
wall = hb.reconstruct(
    hb.Caliper(np.repeat(md, FINGERS), towards.ravel(), fingers.ravel()),
    bit_diameter=NOMINAL,
    sectors=48,
    pitch=0.02,
    max_distance=0.1,
)
logs = wall.logs()

# A collar is a short rise of the median radius, at least 6 m from the one above.
mean = np.nanmedian(wall.radius[: len(logs) * 48].reshape(-1, 48), axis=1)
collars: list[float] = []
for place in logs.depth[mean > np.nanmedian(mean) + 0.002]:
    if not collars or place - collars[-1] > 6:
        collars.append(float(place))
# The pit is that of the fingers: a wall averages the samples around each vertex.
print("joint    top  length  least ID  ovality  penetration  depth  toolface  grade")
for number, (top, bottom) in enumerate(pairwise(collars), 1):
    body = np.flatnonzero((md > top + 0.3) & (md < bottom - 0.3))
    rows_of = logs.between(top + 0.3, bottom - 0.3)
    row, finger = np.unravel_index(np.nanargmax(fingers[body]), (body.size, FINGERS))
    share = (fingers[body[row], finger] - np.nanmedian(fingers[body])) / THICKNESS
    grade = next(name for limit, name in GRADES if share < limit)
    print(
        f"{number:5} {top:7.2f} {bottom - top:6.2f} {np.nanmin(rows_of.least_diameter) / INCH:8.3f} "
        f"{np.nanmax(rows_of.ovality_dnv):9.4f} {100 * share:10.1f} % {md[body[row]]:7.2f} "
        f"{towards[body[row], finger]:8.1f} {grade:>6}"
    )
figure = hb.plot.log(wall, title="7 in casing, 24 fingers", scale=200)
