"""How well passes of a real caliper predict each other: ``python bench/leave_one_pass_out.py [FILE]``.

Volve F-12, 2010: an X-Y caliper that went ten times over 3080 to 3240 m of cased hole at 53 deg. One pass is left out,
the wall is built from the others, and each sample of the pass is predicted by the wall at its depth and toolface. Side
by side, the median of |predicted - measured| in mm of radius over the samples of the pass:

    own, others   constants: the median of the pass itself, knowing the answer, and the mean of the other passes
    raw           the wall, samples as they are in the file
    shift         depth shifts found by correlation
    bias          and the bias of each pass and each arm, found from the overlap
    sides         the same with each arm's bias by the side of the hole it lies on (the arms sag)

Nine of the ten passes ride in the hole with nearly one bearing (0 to 40 deg), where the sag of an arm and the shape of
the hole are one and the same. Pass 26 alone turned all around: the wall of the others, which holds their sag, predicts
it worse than their plain mean does, with or without a bias an arm. Only a bias by side takes the sag out of the wall.

Shifts and biases of the pass left out come from blocks of 10 m of it; it is scored in the blocks between, and the other
way round: no sample predicts itself. One step of the file, 0.03 in of diameter, is 0.38 mm of radius. Exit code 1 if
``sides`` loses to a constant on any pass or exceeds 0.3 mm on average.
"""

from __future__ import annotations

import csv
import gzip
import sys
from pathlib import Path

import numpy as np

import helibore as hb
from helibore.passes import arm_sides, evaluate, find_bias, find_shifts
from helibore.sensors import Sensor, observe_by_depth

FILE = Path(__file__).parents[2] / "shared/data/calipers/volve_F-12_2010_pfcs_xy_caliper.csv.gz"
TOP, BOTTOM = 3080.0, 3240.0
BLOCK = 10.0
INCH = 0.0254


def read(path: Path):
    with gzip.open(path, "rt", newline="") as text:
        rows = [row for row in csv.DictReader(text) if TOP <= float(row["md_m"]) <= BOTTOM]
    depth, turned, x, y = (
        np.array([float(row[name]) for row in rows]) for name in ("md_m", "rb_deg", "pfc1_x_in", "pfc2_y_in")
    )
    arms = [Sensor("x", mounting=m) for m in (0, 180)] + [Sensor("y", mounting=m) for m in (90, 270)]
    half = 0.5 * INCH
    seen = observe_by_depth(arms, depth, turned, [half * x, half * x, half * y, half * y])
    passes = np.array([int(row["pass"]) for row in rows])[seen.row]
    arm = seen.sensor // 2
    return seen.depth, seen.toolface, seen.radius, passes, arm, arm_sides(arm, turned[seen.row])


def predict(depth, toolface, radius, train, test):
    """The wall of the training samples at the test samples."""
    caliper = hb.Caliper(depth[train], toolface[train], radius[train])
    wall = hb.reconstruct(caliper, bit_diameter=2 * float(np.median(radius)), sectors=32, pitch=0.1)
    return evaluate(wall, depth[test], toolface[test])


def level_of(bias, passes, classes):
    """Bias of every sample; a side on which no other sample of its arm lies, anywhere, has none of its own."""
    known = np.isin(classes, bias.arms)
    level = bias.by_pass[np.searchsorted(bias.passes, passes)]
    level[known] = bias.at(passes[known], classes[known])
    return level


def score(depth, toolface, radius, passes, classes, left_out):
    """Errors of the predictions of one pass, mm, (2 + len(classes), n)."""
    mine = passes == left_out
    errors = np.full((2 + len(classes), depth.size), np.nan)
    errors[0, mine] = predict(depth, toolface, radius, ~mine, mine) - radius[mine]
    odd = np.floor(depth / BLOCK) % 2 == 1
    for block in (odd, ~odd):
        known, scored = ~mine | ~block, mine & block
        moved = depth + find_shifts(depth[known], radius[known], passes[known]).at(passes)
        errors[1, scored] = predict(moved, toolface, radius, ~mine, scored) - radius[scored]
        for row, arms in enumerate(classes, start=2):
            bias = find_bias(moved[known], toolface[known], radius[known], passes[known], arms[known])
            level = level_of(bias, passes, arms)
            wall = predict(moved, toolface, radius - level, ~mine, scored)
            errors[row, scored] = wall + level[scored] - radius[scored]
    return 1e3 * errors[:, mine]


def main() -> int:
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    if not path.exists():
        print(f"{path}: not there; give the file's path", file=sys.stderr)
        return 2
    depth, toolface, radius, passes, arm, side = read(path)
    shifts = find_shifts(depth, radius, passes)
    bias = find_bias(depth + shifts.at(passes), toolface, radius, passes, arm)
    print("pass  samples  shift m  bias mm |      own   others |      raw    shift     bias    sides")
    table, unseen = [], 0
    for row, number in enumerate(shifts.passes):
        mine = passes == number
        errors = np.abs(score(depth, toolface, radius, passes, (arm, side), number))
        unseen += np.count_nonzero(np.isnan(errors))
        constants = [np.median(np.abs(radius[mine] - c)) for c in (np.median(radius[mine]), np.mean(radius[~mine]))]
        table.append([*(1e3 * np.array(constants)), *np.nanmedian(errors, axis=1)])
        print(f"{number:4d} {mine.sum():8d} {shifts.shift[row]:8.3f} {1e3 * bias.by_pass[row]:8.3f} |"
              + columns(table[-1]))  # fmt: skip
    mean = np.mean(table, axis=0)
    print(f"mean{'':27s} |" + columns(mean))
    print(f"bias of x and y: {np.round(1e3 * bias.by_arm, 3)} mm; samples without a prediction: {unseen}")
    lost = [int(shifts.passes[i]) for i, row in enumerate(table) if row[-1] >= min(row[:2])]
    print(f"sides loses to a constant on passes: {lost or 'none'}; mean of its medians {mean[-1]:.3f} mm, bar 0.3 mm")
    return int(bool(lost) or mean[-1] > 0.3)


def columns(values) -> str:
    text = [f"{value:9.3f}" for value in values]
    return "".join(text[:2]) + " |" + "".join(text[2:])


if __name__ == "__main__":
    sys.exit(main())
