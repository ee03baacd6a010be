"""
A gamma image on the wall
=========================

A sector image lies on the same helix as the radius.
"""

import helibore as hb
from helibore.simulation import simulate

run = simulate()
wall = hb.reconstruct(hb.Caliper(run.depth, run.toolface, run.radius), bit_diameter=run.hole.bit_diameter)
wall.images["Gamma ray"] = hb.SectorImage(
    run.gamma_depth, run.gamma, name="Gamma ray", unit="gAPI", origin="edge", reference="high-side"
)
print(wall.images["Gamma ray"].values.shape, "rows and sectors")
figure = hb.plot.log(wall, title="Radius and gamma", start=2005.0, stop=2020.0, scale=100)
