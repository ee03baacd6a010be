"""From the samples of a caliper to a wall: an empty wall and one append. `hb.reconstruct` takes readings, too."""

from __future__ import annotations

from typing import Any

from helibore.base.settings import Settings
from helibore.samples.caliper import Caliper
from helibore.trajectory.survey import Path
from helibore.wall.estimates import find_kriging_range, in_depth_order
from helibore.wall.wall import Wall


def reconstruct(
    caliper: Caliper, *, bit_diameter: float, path: Path | None = None, threads: int | None = None, **settings: Any
) -> Wall:
    """Rebuild the wall of a hole from its samples; parameters as in `helibore.reconstruct`."""
    if settings.get("estimator") == "kriging" and settings.get("kriging_range") is None:
        checked = Settings(bit_diameter=bit_diameter, **settings)
        Wall(**vars(checked) | {"kriging_range": 1.0})  # the core checks the other settings
        settings["kriging_range"] = find_kriging_range(in_depth_order(caliper), checked)
    wall = Wall(bit_diameter=bit_diameter, threads=threads, basis=caliper.basis, **settings)
    wall.append(caliper.depth, caliper.toolface, caliper.radius, caliper.time, arm=caliper.arm)
    wall.path = path
    return wall
