"""Small simulated files in place of the public ones that README.md and docs name, with the same channels and units."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import numpy as np

from helibore.simulation.tool import Hole

INCH = 0.0254


def write_stand_ins(folder: Path) -> None:
    """Write every file that the blocks of the pages read and do not make."""
    (folder / "tops.csv").write_text("name,md_m\nUpper sand,2000\nLower sand,2005\n")
    wireline_caliper(folder / "volve_F-12_2010_pfcs_xy_caliper.csv.gz")
    density_and_gamma(folder / "P11-A-02.las")
    four_images(folder / "15_9-F-15_D.json")
    amplitude = 100 + np.random.default_rng(3).normal(size=(200, 144))
    amplitude[60:140, 36:44] = amplitude[60:140, 108:116] = 30  # a breakout: dark, 90 and 270 degrees
    np.savez(folder / "atv_amplitude.npz", depth=np.arange(200) * 0.01 + 107, amplitude=amplitude)


def wireline_caliper(path: Path) -> None:
    """Eight passes of two pairs of arms."""
    hole = Hole.example(3080.0, 3090.0, bit_diameter=6.2 * INCH)
    rows = ["pass,direction,etim_s,tdep_0.1in,md_m,rb_deg,pfc1_x_in,pfc2_y_in,devi_pgms_deg"]
    rng = np.random.default_rng(2)
    for number in (26, 27, 28, 29, 30, 38, 40, 41):
        depth = np.arange(3090.0, 3080.0, -0.0762)
        bearing = (360 * rng.random() + 30 * (3090 - depth)) % 360
        x, y = ((hole.radius(depth, bearing + at) + hole.radius(depth, bearing + at + 180)) / INCH for at in (0, 90))
        for k, (md, rb, one, two) in enumerate(zip(depth, bearing, x, y, strict=True)):
            rows.append(f"{number},up,{k},{md / INCH * 10:.0f},{md:.4f},{rb:.2f},{one:.5f},{two:.5f},55")
    path.write_bytes(gzip.compress("\n".join(rows).encode()))


def density_and_gamma(path: Path) -> None:
    """A LAS file with sixteen sectors of density and eight of gamma, and no caliper."""
    depth = np.arange(1950.0, 1956.0, 0.1)
    names = [f"ABDC{i}M .g/cc" for i in range(1, 17)] + [f"GRAS{i}M .API" for i in range(8)]
    head = ["~Version", "VERS. 2.0 :", "WRAP. NO :", "~Well", "STRT.m 1950 :", "STOP.m 1956 :", "STEP.m 0.1 :"]
    head += ["NULL. -999.25 :", "~Curve", "DEPTH.m :", *(f"{name} : {name[:5]} Sector" for name in names), "~Ascii"]
    values = np.column_stack([depth, 2.4 + 0.1 * np.sin(depth[:, None] + np.arange(16)), 60 + np.ones((60, 8))])
    path.write_text("\n".join([*head, *(" ".join(f"{value:.4f}" for value in row) for row in values)]) + "\n")


def four_images(path: Path) -> None:
    """A JSON Well Log with four images and an acoustic caliper in inches."""
    sectors = {"ABDC": (16, "g/cm3"), "GRCS": (8, "gAPI"), "APRA": (16, "ohm.m"), "NBGRCS": (8, "gAPI")}
    curves = [("TDEP", "m", 1), ("CALCM", "in", 1), *((name, unit, n) for name, (n, unit) in sectors.items())]
    depth = np.round(np.arange(4309.6, 4330.0, 0.1), 1)
    log = {
        "header": {"name": "a simulated run", "startIndex": depth[0], "endIndex": depth[-1], "step": 0.1},
        "curves": [
            {"name": name, "description": name, "quantity": None, "unit": unit, "valueType": "float", "dimensions": n}
            for name, unit, n in curves
        ],
        "data": [[z, 8.6, *([2.0 + np.sin(z + i) / 9 for i in range(n)] for n, _ in sectors.values())] for z in depth],
    }
    path.write_text(json.dumps([log]))
