"""A wall with a gap and two images with gaps, for the tests of pictures."""

from __future__ import annotations

from typing import Any

import numpy as np

import helibore as hb
from helibore.simulation.tool import Hole, Tool, simulate

BIT = 0.216


def image_of(depth: Any, values: Any, name: str = "GR", unit: str = "gAPI", **extra: Any) -> hb.SectorImage:
    return hb.SectorImage(depth, values, name, unit, **({"origin": "edge", "reference": "high-side"} | extra))


def plotted_wall() -> hb.Wall:
    """22 m of hole with a gap of 4 m, a gamma image with gaps, and a resistivity image."""
    run = simulate(Hole.example(2000.0, 2022.0), Tool(sample_rate=5.0))
    there = (run.depth < 2012) | (run.depth > 2016)
    made = hb.reconstruct(
        hb.Caliper(run.depth[there], run.toolface[there], run.radius[there]), bit_diameter=BIT, sectors=32
    )
    gamma = run.gamma.copy()
    gamma[40:60] = np.nan
    made.images["GR"] = image_of(run.gamma_depth, gamma)
    resistivity = np.exp(0.02 * run.gamma)
    made.images["RES"] = image_of(run.gamma_depth, resistivity, "RES", "ohm.m", origin="centre")
    return made
