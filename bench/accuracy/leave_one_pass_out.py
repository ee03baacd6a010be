"""Measure how well passes of a real caliper predict each other: ``python -m bench.accuracy.leave_one_pass_out [FILE]``.

Volve F-12, 2010: an X-Y caliper that went ten times over 3080 to 3240 m of cased hole at 53 deg. One pass is left out,
the wall is built from the others, and the wall predicts each sample of the pass at its depth and toolface. The
benchmark prints the median, then the mean, of |predicted - measured| over the samples of the pass, in mm of radius, for

    others        a constant known beforehand: the mean of the other passes
    own, best     constants that know the answer: the pass's own median, and the constant with the least median error
    raw           the wall from the samples as they are in the file
    shift         the wall after depth shifts, found by correlation
    bias          also without the bias of each pass and each arm, found where passes overlap
    sides         as bias, but the bias of each arm depends on the side of the hole on which the arm lies (arms sag)

In nine of the ten passes the toolface of the tool stays in a narrow range (-22 to 67 deg), so that the sag of an arm
and the shape of the hole cannot be told apart. Only in pass 26 does the tool turn all around. For the larger part of
this turn, the wall of the other passes contains a sag that differs by up to 1 mm, and one wall cannot be right for both
arms. Without a bias by side, the median error of pass 26 is larger than that of the constant "others", which lies on
one of the file's steps. The mean error is not larger than that of "others", and the median error is not larger than
that of "own". Only a bias by side removes the sag from the wall.

Shifts and biases of the left-out pass come from every second block of 10 m, and its errors are computed in the other
blocks; then the blocks change roles. So no sample predicts itself. One step of the file, 0.03 in of diameter, is
0.38 mm of radius. The exit code is 1 if ``sides`` loses to any constant on any pass, or exceeds 0.108 mm on average.
"""

from __future__ import annotations

import csv
import gzip
import sys
from pathlib import Path

import numpy as np

import helibore as hb
from helibore.preparation.biases import arm_sides, find_bias
from helibore.preparation.sensors import Sensor, observe_by_depth
from helibore.preparation.shifts import find_shifts
from helibore.wall.points import evaluate

FILE = Path(__file__).parents[3] / "shared/data/calipers/volve_F-12_2010_pfcs_xy_caliper.csv.gz"
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
    """Return the radii, metres, that the wall of the samples ``train`` has at the samples ``test``."""
    caliper = hb.Caliper(depth[train], toolface[train], radius[train])
    wall = hb.reconstruct(
        caliper, bit_diameter=2 * float(np.median(radius)), sectors=32, pitch=0.1, estimator="inverse-distance"
    )
    return evaluate(wall, depth[test], toolface[test])


def level_of(bias, passes, classes):
    """Return the bias of every sample.

    Where ``bias`` does not know a sample's class (its arm, or its arm on this side of the hole), only the bias of its
    pass counts.
    """
    known = np.isin(classes, bias.arms)
    level = np.nan_to_num(bias.by_pass)[np.searchsorted(bias.passes, passes)]
    level[known] = bias.at(passes[known], classes[known])
    return level


def score(depth, toolface, radius, passes, classes, left_out):
    """Return the errors of the predictions of one pass, mm, (2 + len(classes), n) for its n samples.

    The rows are raw, shift, and one for each of ``classes``. An error is NaN where the wall has no radius.
    """
    mine = passes == left_out
    errors = np.full((2 + len(classes), depth.size), np.nan)
    errors[0, mine] = predict(depth, toolface, radius, ~mine, mine) - radius[mine]
    odd = np.floor(depth / BLOCK) % 2 == 1
    for block in (odd, ~odd):
        known, scored = ~mine | ~block, mine & block
        moved = depth + find_shifts(depth[known], toolface[known], radius[known], passes[known]).at(passes, depth)
        errors[1, scored] = predict(moved, toolface, radius, ~mine, scored) - radius[scored]
        for row, arms in enumerate(classes, start=2):
            known_columns = (column[known] for column in (moved, toolface, radius, passes, arms))
            bias = find_bias(*known_columns, sides=1 if row == 2 else 8)
            level = level_of(bias, passes, arms)
            wall = predict(moved, toolface, radius - level, ~mine, scored)
            errors[row, scored] = wall + level[scored] - radius[scored]
    return 1e3 * errors[:, mine]


def constants(radius, mine):
    """Return the errors of the constants others, own and best at the samples of a pass, mm, (3, n).

    The best constant is searched in steps of 0.02 mm.
    """
    own = radius[mine]
    tried = np.arange(own.min(), own.max(), 2e-5)
    best = tried[np.argmin([np.median(np.abs(own - one)) for one in tried])]
    return 1e3 * np.array([constant - own for constant in (np.mean(radius[~mine]), np.median(own), best)])


def main() -> int:
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    if not path.exists():
        print(f"{path}: there is no such file; give its path", file=sys.stderr)
        return 2
    depth, toolface, radius, passes, arm, side = read(path)
    shifts = find_shifts(depth, toolface, radius, passes)
    bias = find_bias(depth + shifts.at(passes, depth), toolface, radius, passes, arm)
    names = ("others", "own", "best", "raw", "shift", "bias", "sides")
    print("pass  samples  shift m  bias mm |" + "".join(f"{name:>8s}" for name in names) + "   mm, median")
    medians, means, unseen = [], [], 0
    for row, number in enumerate(shifts.passes):
        mine = passes == number
        predicted = score(depth, toolface, radius, passes, (arm, side), number)
        errors = np.abs(np.vstack([constants(radius, mine), predicted]))
        unseen += np.count_nonzero(np.isnan(errors))
        medians.append(np.nanmedian(errors, axis=1))
        means.append(np.nanmean(errors, axis=1))
        line = f"{number:4d} {mine.sum():8d} {shifts.shift[row]:8.3f} {1e3 * bias.by_pass[row]:8.3f} |"
        print(line + columns(medians[-1]))
    print(f"mean{'':27s} |" + columns(np.mean(medians, axis=0)))
    print(f"\n{'the same by the mean of |error|, pass':>31s}")
    for number, one in zip(shifts.passes, means, strict=True):
        print(f"{number:4d}{'':27s} |" + columns(one))
    print(f"bias of x and y: {np.round(1e3 * bias.by_arm, 3)} mm; samples without a prediction: {unseen}")
    for at in range(3, len(names)):
        rows = ((row, k) for row, one in enumerate(medians) for k in range(3) if one[at] >= one[k])
        lost = [f"{shifts.passes[row]} ({names[k]})" for row, k in rows]
        print(f"{names[at]:5s} loses by the median to a constant on passes: {', '.join(lost) or 'none'}")
    mean = np.mean(medians, axis=0)[-1]
    print(f"mean of the medians of sides {mean:.3f} mm, bar 0.108 mm")
    return int(any(one[-1] >= one[:3].min() for one in medians) or mean > 0.108)


def columns(values) -> str:
    return "".join(f"{value:8.3f}" for value in values)


if __name__ == "__main__":
    sys.exit(main())
