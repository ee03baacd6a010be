"""Measure what a live wall with ``estimator="automatic"`` loses: it is fitted to its first 2, 5, 10, 20 and 40 m.

    python -m bench.accuracy.live_fits [--class NAME ...] [--every N] [SEED]

The cases are every Nth of those of `bench.accuracy.automatic`, in holes of 50 m. Samples come pass by pass, all arms
together, without arm numbers. For each length the whole hole is drawn with the settings found by the samples up to
there: its rms error over that of inverse distance, over that of a fit of all of them, and over that of the batch, which
has arm numbers, too. And what is seen meanwhile: the hole drawn from the samples up to the next fit, over inverse
distance. Then the processor time on one thread, of a fit and of drawing again what was drilled up to then, by estimator
found.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import TypeVar

import numpy as np

import helibore as hb
from bench.accuracy import automatic, known_holes
from helibore.live.model.fits import LENGTHS, LayerFits
from helibore.wall.automatic import choose

WHOLE = 50.0
AUTOMATIC = hb.Settings(bit_diameter=known_holes.BIT, estimator="automatic")
SIMPLE = hb.Settings(bit_diameter=known_holes.BIT, estimator="inverse-distance")
Made = TypeVar("Made")


def timed(make: Callable[[], Made]) -> tuple[Made, float]:
    """Return what ``make`` returns, and its processor time in seconds."""
    start = time.process_time()
    made = make()
    return made, time.process_time() - start


def as_they_come(caliper: hb.Caliper) -> hb.Caliper:
    """Return the samples pass by pass, each in order of depth; the cases have them arm by arm."""
    if caliper.arm is None:
        return caliper
    number = np.cumsum((np.diff(caliper.arm, prepend=-1) != 0) & (caliper.arm == 0))
    order = np.lexsort((caliper.arm, caliper.depth, number))
    columns = (column[order] for column in (caliper.depth, caliper.toolface, caliper.radius))
    return hb.Caliper(*columns, arm=np.asarray(caliper.arm)[order])


def drawn(caliper: hb.Caliper, settings: hb.Settings) -> hb.Wall:
    """Return the wall of samples without arm numbers."""
    wall = hb.Wall(threads=1, **vars(settings))
    wall.append(caliper.depth, caliper.toolface, caliper.radius)
    return wall


def measured(case: automatic.Case) -> tuple[list[list[float]], list[list[float]], list[str]]:
    """Return for each length the ratios of errors, the seconds and the estimator."""
    of = as_they_come(case.caliper)

    def error(wall: hb.Wall) -> float:
        inside = (wall.depth > automatic.EDGE) & (wall.depth < wall.depth[-1] - automatic.EDGE)
        off = wall.radius - case.truth(wall.depth, wall.toolface)
        return float(np.sqrt(np.nanmean(off[inside] ** 2)))

    simple = error(drawn(of, SIMPLE))
    batch = error(hb.reconstruct(of, threads=1, **vars(choose(of, AUTOMATIC).settings)))
    of_all = error(drawn(of, choose(hb.Caliper(of.depth, of.toolface, of.radius), AUTOMATIC).settings))
    fits, ratios, seconds, names = LayerFits(AUTOMATIC), [], [], []
    ends: dict[float, int] = {}
    for start in range(of.depth.size):  # one sample at a time, as they come
        depth = of.depth[start : start + 1]
        length, _ = fits.reached(depth)
        fits.count(depth)
        if length:
            ends[length] = start + 1

    def up_to(row: int | None) -> hb.Caliper:
        return hb.Caliper(*(column[:row] for column in (of.depth, of.toolface, of.radius)))

    for length, after in zip(LENGTHS, (*LENGTHS[1:], None), strict=True):
        first, meanwhile = up_to(ends[length]), up_to(ends[after] if after else None)
        choice, fitting = timed(lambda first=first: choose(first, AUTOMATIC))  # type: ignore[misc]
        _, drawing = timed(lambda first=first, choice=choice: drawn(first, choice.settings))  # type: ignore[misc]
        live = error(drawn(of, choice.settings))
        seen = error(drawn(meanwhile, choice.settings)) / error(drawn(meanwhile, SIMPLE))
        ratios.append([live / simple, live / of_all, live / batch, seen])
        seconds.append([fitting, drawing])
        names.append(choice.settings.estimator)
    return ratios, seconds, names


def main() -> None:
    """Print a line for each case, and tables of the classes and of the times."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--class", dest="classes", action="append", choices=automatic.CLASSES)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("seed", type=int, nargs="?", default=701)
    given = parser.parse_args()
    known_holes.LENGTH = automatic.LENGTH = WHOLE
    rows, times = [], []
    for name in given.classes or ("rotating", "arms", "telemetry"):
        found = []
        for case in list(automatic.CLASSES[name][0](given.seed))[given.every // 2 :: given.every]:
            ratios, seconds, names = measured(case)
            found.append(ratios)
            times += [(*of, *row) for of, row in zip(zip(names, LENGTHS, strict=True), seconds, strict=True)]
            print(
                f"{name}, {case.name}:", np.round(ratios, 3).tolist(), np.round(seconds, 2).tolist(), names, flush=True
            )
        means, worst = np.exp(np.log(found).mean(axis=0)), np.max(found, axis=0)
        for i, length in enumerate(LENGTHS):
            cells = [f"{means[i, k]:.2f} (worst {worst[i, k]:.2f})" for k in range(4)]
            rows.append(f"| {name} | {len(found)} | {length:g} m | {' | '.join(cells)} |")
    print(
        "\n| class | cases | fitted to | over inverse distance | over a fit of all | over the batch | until the next |"
    )
    print("| --- | --- | --- | --- | --- | --- | --- |")
    print("\n".join(rows))
    print("\n| estimator | fitted to | cases | fit, s | drawn again, s |\n| --- | --- | --- | --- | --- |")
    for estimator in sorted({of[0] for of in times}):
        for length in LENGTHS:
            if those := [of[2:] for of in times if of[:2] == (estimator, length)]:
                fit, draw = np.median(those, axis=0)
                print(f"| {estimator} | {length:g} m | {len(those)} | {fit:.1f} | {draw:.2f} |")


if __name__ == "__main__":
    main()
