"""Drill a known hole, rebuild its wall from the tool's samples, and compare the wall with the truth.

    simulate  ->  reconstruct  ->  helibore-demo.glb, helibore-demo.png  ->  error against the formula of the hole

This is a short, complete use of the library. ``helibore demo`` writes the files and prints the error.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from helibore.images.sector_image import SectorImage
from helibore.samples.caliper import Caliper
from helibore.simulation.tool import Hole, Simulation, Tool, simulate
from helibore.trajectory.survey import Path, Survey
from helibore.wall.wall import Wall, wall_of


@dataclass(frozen=True)
class Demonstration:
    """The simulated samples with the true hole, the wall rebuilt from them, and the path of the wall."""

    simulation: Simulation
    wall: Wall
    path: Path


@dataclass(frozen=True)
class Error:
    """Statistics of the differences, rebuilt minus true radius, at all vertices that have a radius; metres.

    ``rms`` and ``mean`` are those of the differences. ``median`` is the median of their absolute values, and ``most``
    is the 99th percentile of their absolute values.
    """

    rms: float
    mean: float
    median: float
    most: float


def drill(seed: int = 0) -> Simulation:
    """Return about 180,000 samples of 50 m of hole, with a noise of 0.5 mm."""
    return simulate(Hole.example(seed=seed), Tool(), seed=seed)


def rebuild(simulation: Simulation) -> Demonstration:
    """Rebuild the wall of a simulated hole (64 sectors a turn, pitch 0.1 m) and put the gamma image on it."""
    caliper = Caliper(simulation.depth, simulation.toolface, simulation.radius, simulation.time)
    wall = wall_of(caliper, bit_diameter=simulation.hole.bit_diameter)
    depth, gamma, name = simulation.gamma_depth, simulation.gamma, "Gamma ray"
    wall.images[name] = SectorImage(depth, gamma, name, "gAPI", origin="edge", reference="high-side")
    survey = Survey(simulation.station_depth, simulation.inclination, simulation.azimuth)
    return Demonstration(simulation, wall, survey.path())


def error(demonstration: Demonstration) -> Error:
    """Return the error of the wall: its radius at each vertex compared with the true radius there."""
    wall = demonstration.wall
    off = wall.radius - demonstration.simulation.hole.radius(wall.depth, wall.toolface)
    off = off[~np.isnan(off)]
    size = np.abs(off)
    return Error(
        float(np.sqrt(np.mean(off**2))), float(off.mean()), float(np.median(size)), float(np.percentile(size, 99))
    )
