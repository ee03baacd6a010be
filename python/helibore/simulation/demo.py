"""The demonstration: drill a known hole, rebuild its wall from the tool's samples, compare it with the truth.

    simulate  ->  reconstruct  ->  helibore-demo.glb, helibore-demo.png  ->  error against the hole's own formula

It is the shortest complete use of the library. Not here: printing (``cli.demo``) and drawing (``plot``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from helibore.images.sector_image import SectorImage
from helibore.samples.caliper import Caliper
from helibore.simulation.tool import Hole, Simulation, Tool, simulate
from helibore.trajectory.survey import Path, Survey
from helibore.wall.reconstruct import reconstruct
from helibore.wall.wall import Wall


@dataclass(frozen=True)
class Demonstration:
    """The samples and their truth, the wall, and the path it lies on."""

    simulation: Simulation
    wall: Wall
    path: Path


@dataclass(frozen=True)
class Error:
    """Rebuilt minus true radius over all vertices with support, in metres; ``most`` bounds 99 % of them."""

    rms: float
    mean: float
    median: float
    most: float


def drill(seed: int = 0) -> Simulation:
    """Return the samples of 50 m of hole, about 180,000 of them, with a noise of 0.5 mm."""
    return simulate(Hole.example(seed=seed), Tool(), seed=seed)


def rebuild(simulation: Simulation) -> Demonstration:
    """Rebuild the wall of a simulated hole with 64 sectors a turn and a pitch of 0.1 m, with the gamma image on it."""
    caliper = Caliper(simulation.depth, simulation.toolface, simulation.radius, simulation.time)
    wall = reconstruct(caliper, bit_diameter=simulation.hole.bit_diameter)
    wall.images["Gamma ray"] = SectorImage(
        simulation.gamma_depth, simulation.gamma, "Gamma ray", "gAPI", origin="edge", reference="high-side"
    )
    survey = Survey(simulation.station_depth, simulation.inclination, simulation.azimuth)
    return Demonstration(simulation, wall, survey.path())


def error(demonstration: Demonstration) -> Error:
    """Compare the wall with the truth at its own vertices."""
    wall = demonstration.wall
    off = wall.radius - demonstration.simulation.hole.radius(wall.depth, wall.toolface)
    off = off[~np.isnan(off)]
    size = np.abs(off)
    return Error(
        float(np.sqrt(np.mean(off**2))), float(off.mean()), float(np.median(size)), float(np.percentile(size, 99))
    )
