"""How much of a log it takes until a slipped depth is an alarm: ``python -m bench.live.slips``.

A hole is drilled by mud pulse (a sample each 0.055 m, noise 1 mm), and logged again at 0.05 m/s, one sample a second,
at a depth that slipped by +6.3 or -4 m. Its mean radius varies smoothly over 1.5 m; each line has the standard
deviation of that, the length of the second log, and in how many of 16 holes `depth_slipped` or `wall_nearer` (which
names hole.shift, too) began. A wall that grew at random places is a notice, so little relief must not be an alarm.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parents[2] / "tests" / "python" / part) for part in ("", "live")]
from test_wall_watch import BEGAN, log, relief  # noqa: E402

from helibore.live.model.wall_watch import WallMemory  # noqa: E402

TOP = 2004.0


def alarmed(seed: int, scale: float, slipped: float, length: float) -> bool:
    """Whether a slipped log of a hole of some relief begins an alarm."""
    memory, hole = WallMemory(), relief(seed) * scale
    end, _ = log(memory, seed, BEGAN, TOP - 4, TOP + length + 10, 20 / 3600, 10.0, hole=hole)
    _, found = log(memory, seed + 1, end + 3600, TOP + length, TOP, 0.05, 1.0, hole=hole, slipped=slipped)
    return any(text and lasts for _, _, text, lasts in found)


def main() -> None:
    """Print a line for each relief and length."""
    first = int(sys.argv[1]) if sys.argv[1:] else 100
    seeds = range(first, first + 16)
    for scale in (0.2, 0.35, 0.5, 0.75, 1.0):
        spread = 1e3 * np.mean([float(relief(seed).std()) for seed in seeds]) * scale
        for length in (24.0, 48.0, 96.0):
            count = sum(alarmed(seed, scale, 6.3 if seed % 2 else -4.0, length) for seed in seeds)
            print(f"relief {spread:.1f} mm, log of {length:g} m: {count} of {len(seeds)}", flush=True)


if __name__ == "__main__":
    main()
