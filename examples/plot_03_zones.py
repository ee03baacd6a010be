"""
Washouts and breakouts
======================

Zones by the criteria of the trade, the worst first.
"""

import helibore as hb
from helibore.simulation import Breakout, Hole, Tool, Washout, simulate

hole = Hole(
    stop=2012.0,
    washouts=(Washout(2002.0, 2004.0, 0.03),),
    breakouts=(Breakout(2007.0, 2010.0, 40.0, 30.0, 0.025),),
)
measured = simulate(hole, Tool())
wall = hb.reconstruct(hb.Caliper(measured.depth, measured.toolface, measured.radius), bit_diameter=0.216)
found = wall.zones()
for zone in found.by_severity():
    print(f"{zone.start:.1f} to {zone.stop:.1f} m  {zone.kind} ({zone.confidence_text})  {1000 * zone.measure:.0f} mm")
figure = hb.plot.log(wall, title="Washout and breakout", scale=100)
