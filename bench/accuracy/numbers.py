"""Measure how exact the numbers of a log are, on known holes that no test uses: ``python -m bench.accuracy.numbers``.

    ellipse     four arms, one turn in 30 m, every 5 cm: largest error of a diameter and of C1 - C2, mm; coverage
    X-Y         how many of twenty logs of a breakout or a washout, 20 mm deep, are classified rightly
    drift       an arm that drifts by 0.3 in over eight passes: largest error of a corrected diameter, in
    spikes      ten holes: spikes that are found, and samples of the true shape that are dropped, %
    F-12        pass 26: mean out-of-roundness of the log over that of the arms (only with the shared data)

The holes are those of the tests, with other seeds. The exit code is 1 if a figure misses its bar.
"""

from __future__ import annotations

import csv
import gzip
import sys
from contextlib import suppress
from pathlib import Path

import numpy as np

import helibore as hb
from helibore.preparation.biases import find_bias
from helibore.preparation.conditioning import spikes

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "python"))
sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "python" / "logs"))
sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "python" / "preparation"))
from test_arms import BIT, F12, ellipse, four_arms, test_an_x_y_log_knows_a_breakout_from_a_washout
from test_conditioning import hole_with_spikes
from test_passes import INCH, drifting

SEEDS = range(9100, 9110)
missed = []


def report(name: str, text: str, met: bool) -> None:
    print(f"{name:10s} {text}{'' if met else '   MISSED'}", flush=True)
    missed.extend([] if met else [name])


def four_arms_in_an_ellipse() -> None:
    logs = hb.reconstruct(four_arms(ellipse), bit_diameter=BIT, estimator="inverse-distance").logs()
    true = [2 * ellipse(logs.depth, 12 * logs.depth + 90 * arm) for arm in (0, 1)]
    off = 1e3 * max(np.abs(logs.arm_diameter[arm] - true[arm]).max() for arm in (0, 1))
    apart = 1e3 * np.abs(logs.c1 - logs.c2 - np.abs(true[0] - true[1])).max()
    covered = logs.coverage.mean() / (12 / 90)  # five degrees on either side of each arm, and a metre of depth
    report("ellipse", f"diameter {off:.3f} mm, C1 - C2 {apart:.3f} mm, coverage {covered:.3f} of what four arms see",
           off <= 0.1 and apart <= 0.2 and abs(covered - 1) < 0.08)  # fmt: skip


def x_y() -> None:
    right = 0
    for kind in ("breakout", "washout"):
        for seed in SEEDS:
            with suppress(AssertionError):
                test_an_x_y_log_knows_a_breakout_from_a_washout(kind, seed)
                right += 1
    report("X-Y", f"{right} of 20", right == 20)


def drift() -> None:
    worst = 0.0
    for seed in SEEDS:
        columns = drifting(seed)
        bias = find_bias(*columns)
        truth = np.stack([0.15 * INCH * np.arange(8) / 7, np.zeros(8)], axis=1)
        off = np.abs(bias.table - truth)
        worst = max(worst, float(np.max(np.where(np.isfinite(off), off, np.inf))))
    report("drift", f"{2 * worst / INCH:.4f} in", 2 * worst / INCH <= 0.02)


def spiked() -> None:
    found = spiked = lost = shaped = 0
    for seed in SEEDS:
        toolface, radius, turn, depth, spike, shape = hole_with_spikes(seed)
        dropped = spikes(toolface, radius, turn, depth).dropped
        found, spiked = found + np.count_nonzero(dropped & spike), spiked + np.count_nonzero(spike)
        lost, shaped = lost + np.count_nonzero(dropped & shape & ~spike), shaped + np.count_nonzero(shape & ~spike)
    shares = 100 * found / spiked, 100 * lost / shaped
    report(
        "spikes", f"{shares[0]:.2f} % found, {shares[1]:.2f} % of the shape dropped", shares[0] >= 95 >= 95 * shares[1]
    )


def f12() -> None:
    with gzip.open(F12, "rt") as file:
        rows = [row for row in csv.DictReader(file) if row["pass"] == "26" and 3080 <= float(row["md_m"]) <= 3240]
    names = ("md_m", "rb_deg", "pfc1_x_in", "pfc2_y_in")
    depth, bearing, x, y = (np.array([float(row[name]) for row in rows]) for name in names)
    toolface = np.concatenate([bearing, bearing + 180, bearing + 90, bearing + 270])
    radius = np.concatenate([x, x, y, y]) * 0.0127
    caliper = hb.Caliper(np.tile(depth, 4), toolface, radius, arm=np.repeat([0, 0, 1, 1], depth.size))
    logs = hb.reconstruct(caliper, bit_diameter=6.2 * 0.0254, estimator="inverse-distance").logs()
    kept = logs.out_of_roundness.mean() / np.abs(x - y).mean() / 0.0254
    means = [float(of.mean() / 0.0254) for of in logs.arm_diameter]
    text = f"out-of-roundness {kept:.4f} of the arms'; mean diameters {means[0]:.4f} and {means[1]:.4f} in, "
    text += f"of the file {x.mean():.4f} and {y.mean():.4f} in"
    report("F-12", text, abs(kept - 1) <= 0.01)


if __name__ == "__main__":
    four_arms_in_an_ellipse()
    x_y()
    drift()
    spiked()
    if F12.exists():
        f12()
    sys.exit(bool(missed))
