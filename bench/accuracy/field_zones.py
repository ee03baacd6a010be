"""List the zones of field data: a cased hole, where there are none, and a hole that two calipers measured.

    python -m bench.accuracy.field_zones

Volve F-12, 2010: passes of an X-Y caliper in casing. Volve F-15 B: vertical and horizontal diameters of 8.5 in hole by
density and by ultrasonic caliper. A line has the zones, and the excess of the volume as the summary states it, the
range of it where most of the hole is interpolated.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

import helibore as hb
from bench.accuracy import leave_one_pass_out as f12
from helibore.base.arrays import Floats
from helibore.base.units import INCH

DATA = f12.FILE.parent
F15 = "15_9-F-15_B__WLC_PETROPHYSICAL_COMPOSITE_1.json"
STEP = 0.1524  # metres from row to row of F-15
TENTH_INCH = 0.1 * INCH


def show(name: str, wall: hb.Wall) -> None:
    zones = [
        f"{zone.kind} ({zone.confidence_text}) {zone.start:.1f} to {zone.stop:.1f} m" for zone in wall.zones().zones
    ]
    logs = wall.logs()
    bit = logs.bit_diameter
    excess = [100 * (np.nanmean(of**2) / bit**2 - 1) for of in (logs.equivalent_diameter, *logs.diameter_range)]
    text = f"{', '.join(zones) or 'no zones'}; C1 {1e3 * np.nanmedian(logs.c1):.1f} mm"
    print(f"{name}: {text}, excess {excess[0]:.1f} %, range {excess[1]:.1f} to {excess[2]:.1f} %", flush=True)


def diameters(path: Path, tool: str) -> tuple[Floats, Floats, Floats]:
    """Return depth, vertical and horizontal diameter, metres."""
    [log] = json.loads(path.read_text())
    names = [curve["name"] for curve in log["curves"]]
    rows = [[row[names.index(name)] for name in ("DEPT", f"{tool}VE", f"{tool}HO")] for row in log["data"]]
    found = np.array(sorted(row for row in rows if None not in row))
    depth, vertical, horizontal = found.T * np.array([[TENTH_INCH], [INCH], [INCH]])
    fair = (np.minimum(vertical, horizontal) > 0.15) & (np.maximum(vertical, horizontal) < 0.5)
    return depth[fair], vertical[fair], horizontal[fair]


def main() -> None:
    depth, toolface, radius, passes, arm, _ = f12.read(f12.FILE)
    for number in np.unique(passes):
        of = passes == number
        samples = hb.Caliper(depth[of], toolface[of], radius[of], arm=arm[of])
        show(
            f"F-12, pass {number}",
            hb.reconstruct(samples, bit_diameter=2 * float(np.median(radius[of])), estimator="inverse-distance"),
        )
    for tool, name in (("DC", "density"), ("UC", "ultrasonic")):
        of_row, vertical, horizontal = diameters(DATA / F15, tool)
        half = np.column_stack([vertical, horizontal, vertical, horizontal]).ravel() / 2
        around = np.tile([0.0, 90.0, 180.0, 270.0], of_row.size)
        samples = hb.Caliper(np.repeat(of_row, 4), around, half, arm=np.tile([0, 1, 0, 1], of_row.size))
        show(
            f"F-15, {name}",
            hb.reconstruct(samples, bit_diameter=8.5 * INCH, sectors=32, pitch=STEP, estimator="inverse-distance"),
        )


if __name__ == "__main__":
    main()
