"""Measure the steps from readings to samples: ``python -m bench.accuracy.preparation [ROW ...] [--seeds=1:5]``.

Two passes over simulated holes of known truth, 100 m each. Tools: "dense" turns with 32 samples in 2 cm; "X-Y" has two
diameters in 0.1 m, "four arms" four radii in 0.15 m, and both turn slowly. Rows:

    depth      depth functions in ordinary holes: constant to 1 m, linear by 0.3 m, a step of 0.5 m
    motion     yo-yo of 0.15 m in 3 to 8 m, heave of 0.2 m in 1.5 to 3 m
    periodic   spirals with one to three lobes, rings and ledges that repeat every 0.5 to 2.5 m
    toolface   offsets of 15, 40, 100 and 180 degrees, and of none in ordinary and periodic holes

    rms        of the shift, cm, in rows that are known
    inside     rows whose true shift lies within 1.96 sigma, %
    answered   passes that are shifted, %
    known      rows of these passes whose shift is known, %
    wrong      known rows whose shift is wrong by more than 0.2 m, %
    said       passes whose offset is reported, %; its rms error, degrees (for X-Y modulo 180), and error over sigma
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable

import numpy as np

from helibore.base.arrays import Floats
from helibore.preparation.shifts import DepthFunction, find_shifts

TOOLS = ("dense", "X-Y", "four arms")
LENGTH = 100.0
PERIODIC = ("spiral", "lobed spiral", "rings", "ledges")
Radius = Callable[[Floats, Floats], Floats]


def ordinary(seed: int) -> Radius:
    """Return the radius (m), by depth and toolface, of a rough hole with washouts, breakouts and a varying oval."""
    rng = np.random.default_rng([seed, 11])
    along = np.arange(-10.0, LENGTH + 10.0, 0.05)

    def smooth(scale: float, size: float) -> Floats:
        kernel = np.exp(-0.5 * np.square(np.arange(-60, 61) * 0.05 / scale))
        return size * np.convolve(rng.normal(0, 1, along.size), kernel / np.sqrt(np.square(kernel).sum()), "same")

    level = np.abs(smooth(0.6, 0.004)) + smooth(0.15, 0.0008)
    at = np.cumsum(rng.uniform(2, 9, 200))
    for top in at[at < LENGTH + 10]:
        deep, high = rng.uniform(0.002, 0.02), rng.uniform(0.4, 2.0)
        level += 0.5 * deep * (np.tanh((along - top) / 0.12) - np.tanh((along - top - high) / 0.12))
    breakout, toolface = np.clip(smooth(1.5, 0.006), 0, None), rng.uniform(0, 360)
    waves = (smooth(1.0, 0.001), smooth(1.0, 0.001), smooth(0.4, 0.0006))

    def radius(depth: Floats, angle: Floats) -> Floats:
        cosine, sine, third = (np.interp(depth, along, wave) for wave in waves)
        lobe = np.maximum(1 - np.square(((angle - toolface + 90) % 180 - 90) / 35), 0)
        turned = np.radians(angle)
        shape = cosine * np.cos(2 * turned) + sine * np.sin(2 * turned) + third * np.cos(3 * turned)
        return np.asarray(0.109 + np.interp(depth, along, level) + np.interp(depth, along, breakout) * lobe + shape)

    return radius


def periodic(kind: str, seed: int) -> Radius:
    rng = np.random.default_rng([seed, 12])
    pitch, size, begin, waves = (
        rng.uniform(0.5, 2.5),
        rng.uniform(0.001, 0.005),
        rng.uniform(0, 6.28),
        rng.integers(2, 4),
    )
    if kind == "rings":
        return lambda depth, angle: 0.109 + size * np.cos(2 * np.pi * depth / pitch) + 0 * angle
    if kind == "ledges":
        return lambda depth, angle: 0.109 + size * (depth % pitch < 0.4 * pitch) + 0 * angle
    of = 1 if kind == "spiral" else waves
    return lambda depth, angle: 0.109 + size * np.cos(of * (np.radians(angle) - 2 * np.pi * depth / pitch) - begin)


def shift_of(kind: str, seed: int) -> Callable[[Floats], Floats]:
    rng = np.random.default_rng([seed, 13])
    start, sign, place = rng.uniform(-0.3, 0.3), rng.choice([-1, 1]), rng.uniform(0.3, 0.7) * LENGTH
    size, wave = (0.15, rng.uniform(3, 8)) if kind == "yo-yo" else (0.2, rng.uniform(1.5, 3))
    return {
        "constant": lambda depth: start / 0.3 + 0 * depth,
        "linear": lambda depth: start + sign * 0.3 * (2 * depth / LENGTH - 1),
        "step": lambda depth: start + 0.5 * sign * (depth > place),
    }.get(kind, lambda depth: start + size * np.sin(2 * np.pi * depth / wave))


def log(radius: Radius, tool: str, rng: np.random.Generator, shift: Callable[[Floats], Floats]) -> tuple[Floats, ...]:
    """Return depth, toolface and radius of the samples that a tool takes."""
    if tool == "dense":
        depth = np.arange(0, LENGTH, 0.02 / 32) + rng.uniform(0, 0.02)
        toolface = (np.arange(depth.size) * 360 / 32 + rng.uniform(-3, 3, depth.size)) % 360
        return depth, toolface, radius(depth + shift(depth), toolface) + rng.normal(0, 5e-4, depth.size)
    every = 0.1 if tool == "X-Y" else 0.15
    row = np.arange(0, LENGTH, every) + rng.uniform(0, every)
    turned = (
        rng.uniform(0, 360) + rng.choice([-1, 1]) * rng.uniform(5, 25) * row + np.cumsum(rng.normal(0, 2, row.size))
    )
    depth, toolface = np.repeat(row, 4), (np.repeat(turned, 4) + np.tile([0, 90, 180, 270], row.size)) % 360
    seen = radius(depth + shift(depth), toolface)
    if tool == "X-Y":
        both = 0.5 * (seen + radius(depth + shift(depth), toolface + 180)).reshape(-1, 4)
        return depth, toolface, (both + rng.normal(0, 5e-4, (row.size, 2))[:, [0, 1, 0, 1]]).ravel()
    return depth, toolface, seen + rng.normal(0, 5e-4, seen.size)


def found(
    radius: Radius, tool: str, shift: Callable[[Floats], Floats], seed: int, offset: float = 0.0
) -> DepthFunction:
    """Return the depth function of a second pass, whose toolfaces are ``offset`` degrees too low."""
    first = log(radius, tool, np.random.default_rng([seed, 14]), lambda depth: 0 * depth)
    second = log(radius, tool, np.random.default_rng([seed, 15]), shift)
    second = (second[0], (second[1] - offset) % 360, second[2])
    number = np.repeat([0, 1], [first[0].size, second[0].size])
    depth, toolface, distance = (np.concatenate(pair) for pair in zip(first, second, strict=True))
    return find_shifts(depth, toolface, distance, number, held=[0]).functions[1]


def score(name: str, cases: list[tuple[DepthFunction, Callable[[Floats], Floats]]]) -> None:
    shifted = [(each, each.shift - shift(each.depth)) for each, shift in cases if each.found]
    line = f"{name:34s} {100 * len(shifted) / len(cases):8.1f}"
    if shifted:
        off = np.concatenate([error for _, error in shifted])
        sigma, known = (np.concatenate([getattr(each, of) for each, _ in shifted]) for of in ("sigma", "known"))
        rms = np.mean([np.sqrt(np.mean(np.square(error[each.known]))) for each, error in shifted])
        line += f" {100 * known.mean():7.1f} {100 * rms:6.2f} {100 * np.mean(np.abs(off) < 1.96 * sigma):7.1f}"
        line += f" {100 * np.mean(np.abs(off[known]) > 0.2):6.2f}"
    print(line, flush=True)


def depth(seeds: range, kinds: tuple[str, ...] = ("constant", "linear", "step")) -> None:
    print(f"{'depth':34s} answered   known    rms  inside  wrong")
    for tool in TOOLS:
        for kind in kinds:
            shifts = [shift_of(kind, seed) for seed in seeds]
            cases = [(found(ordinary(seed), tool, of, seed), of) for seed, of in zip(seeds, shifts, strict=True)]
            score(f"{tool}, {kind}", cases)


def motion(seeds: range) -> None:
    depth(seeds, ("yo-yo", "heave"))


def repeated(seeds: range) -> None:
    print(f"{'periodic':34s} answered   known    rms  inside  wrong")
    for tool in TOOLS:
        for kind in PERIODIC:
            shifts = [shift_of("constant", seed) for seed in seeds]
            score(f"{tool}, {kind}", [
                (found(periodic(kind, seed), tool, of, seed), of) for seed, of in zip(seeds, shifts, strict=True)
            ])  # fmt: skip


def toolface(seeds: range) -> None:
    print(f"{'toolface':34s} answered    said    rms  over sigma")
    for tool in TOOLS:
        for offset in (15.0, 40.0, 100.0, 180.0):
            report(f"{tool}, {offset:g} degrees", offset, [
                found(ordinary(seed), tool, shift_of("constant", seed), seed, offset) for seed in seeds
            ])  # fmt: skip
        for kind in ("ordinary", *PERIODIC):
            holes = [ordinary(seed) if kind == "ordinary" else periodic(kind, seed) for seed in seeds]
            report(f"{tool}, {kind}, none", 0.0, [
                found(hole, tool, shift_of("constant", seed), seed) for hole, seed in zip(holes, seeds, strict=True)
            ])  # fmt: skip


def report(name: str, offset: float, cases: list[DepthFunction]) -> None:
    of = [each.toolface for each in cases if each.found and each.toolface is not None]
    off = [(match, match.angle - offset) for match in of if match.clear]
    error = np.array([(by + 90) % 180 - 90 if match.by_half else (by + 180) % 360 - 180 for match, by in off])
    line = (
        f"{name:34s} {100 * len(of) / len(cases):8.1f} {100 * sum(match.is_offset for match in of) / len(cases):7.1f}"
    )
    if off:
        over = error / [match.sigma for match, _ in off]
        line += f" {np.sqrt(np.mean(error**2)):6.2f} {np.sqrt(np.mean(over**2)):11.2f}"
    print(line, flush=True)


ROWS = {"toolface": toolface, "depth": depth, "motion": motion, "periodic": repeated}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("row", nargs="*", help=", ".join(ROWS))
    parser.add_argument("--seeds", default="1:5", help="first seed, and the one after the last")
    given = parser.parse_args()
    seeds = range(*map(int, given.seeds.split(":")))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for row in given.row or ROWS:
            ROWS[row](seeds)
