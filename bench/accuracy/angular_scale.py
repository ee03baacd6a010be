"""Measure how much ``angular_scale`` helps where a shape continues along the hole.

    python -m bench.accuracy.angular_scale

Washouts, breakouts and spirals continue for decimetres along the hole, while a lobe ends within centimetres around the
hole. ``angular_scale`` stretches the arc in the distance, so that neighbours come from above and below first. The
benchmark measures 28 m of ``helibore.simulation.hole.Hole.example`` (oval, spiral, rough, washed and broken out) with
tools of various sample density and 0.5 mm of noise. It prints the rms of rebuilt minus true radius, mm. The default
scale is 1, true arcs, which favours no direction; the published method has 2.
"""

from __future__ import annotations

import numpy as np

import helibore as hb
from helibore.simulation.hole import Hole

SCALES = (1.0, 2.0, 4.0, 8.0)
TOOLS = {  # samples a turn, m a turn
    "64 a turn, turns 20 mm apart": (64, 0.02), "32 a turn, 20 mm": (32, 0.02), "10 a turn, 4 mm": (10, 0.004),
    "8 a turn, 50 mm": (8, 0.05), "16 a turn, 100 mm": (16, 0.1), "4 a turn, 152 mm": (4, 0.1524),
}  # fmt: skip


def errors(hole: Hole, samples: int, height: float, seed: int) -> list[float]:
    """Return the rms error of the wall for each scale, mm; toolfaces of samples vary by a quarter of their step."""
    rng = np.random.default_rng(seed)
    number = np.arange(int(30.0 / height * samples))
    depth = hole.start + 5.0 + number * height / samples
    toolface = (number + rng.uniform(-0.25, 0.25, number.size)) * 360.0 / samples
    radius = hole.radius(depth, toolface % 360.0) + rng.normal(0.0, 0.0005, number.size)
    caliper = hb.Caliper(depth, toolface, radius)
    found = []
    for scale in SCALES:
        wall = hb.reconstruct(
            caliper, bit_diameter=hole.bit_diameter, sectors=64, pitch=0.05, angular_scale=scale,
            estimator="inverse-distance",
            start_depth=hole.start + 6.0, stop_depth=hole.start + 34.0,
        )  # fmt: skip
        off = wall.radius - hole.radius(wall.depth, wall.toolface)
        found.append(1e3 * float(np.sqrt(np.nanmean(off**2))))
    return found


if __name__ == "__main__":
    print(f"{'angular_scale':30s}" + "".join(f"{scale:8.0f}" for scale in SCALES) + "   mm rms, mean of 3 holes")
    for name, tool in TOOLS.items():
        rows = [errors(Hole.example(2000.0, 2050.0, seed=seed), *tool, seed) for seed in (1, 2, 3)]
        print(f"{name:30s}" + "".join(f"{error:8.3f}" for error in np.mean(rows, axis=0)))
