"""Measure how long the HTML report of 420 m of hole takes, with pictures, tables and zones, on all cores.

The hole is simulated, with breakouts, washouts and a gamma image. The bar is 10 s on two cores.

    python -m bench.speed.html_report [metres]
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import helibore as hb
from helibore.plot.html_report import report
from helibore.simulation.tool import Hole, Tool, simulate

BIT = 0.216


def seconds(metres: float = 420.0) -> dict[str, float]:
    """Simulate and rebuild a hole; return the seconds that its report takes, and the sizes of hole and report."""
    run = simulate(Hole.example(2000.0, 2000.0 + metres), Tool(sample_rate=5.0))
    wall = hb.reconstruct(
        hb.Caliper(run.depth, run.toolface, run.radius), bit_diameter=BIT, estimator="inverse-distance"
    )
    wall.images["GR"] = hb.SectorImage(run.gamma_depth, run.gamma, "GR", "gAPI", origin="edge", reference="high-side")
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        report(wall, Path(folder) / "well.html")
        took = time.perf_counter() - start
        return {"metres": metres, "samples": len(run.depth), "seconds": took,
                "bytes": (Path(folder) / "well.html").stat().st_size}  # fmt: skip


if __name__ == "__main__":
    print(seconds(*map(float, sys.argv[1:])))
