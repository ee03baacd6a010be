"""A simulated hole, the tool that logs it, and the rig that sends it: data whose true wall is known.

run = hb.simulation.simulate(hb.simulation.Hole.example(2000.0, 2020.0), hb.simulation.Tool())
error = wall.radius - run.hole.radius(wall.toolface, wall.depth)
"""

from __future__ import annotations

from helibore.simulation.hole import Bed, Breakout, Hole, Section, Washout
from helibore.simulation.rig import Faults, Rig
from helibore.simulation.tool import Lift, Simulation, Tool, simulate

__all__ = ["Bed", "Breakout", "Faults", "Hole", "Lift", "Rig", "Section", "Simulation", "Tool", "Washout", "simulate"]
