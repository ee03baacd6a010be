"""Measure what zones say of open fractures, which are no key seats, of key seats that wander, and of noisy hole.

    python -m bench.accuracy.fractures [HOLES] [FIRST]    holes for each tool and noise (1), first seed (0)

Each hole is 8 m of 8.5 in hole that a rotating tool, up to 10 mm off centre, logs with 16, 32 or 64 samples a turn of
20 or 100 mm, and a noise of 0.5, 1 or 2 mm.

    fracture      a plane with an aperture of 5 to 30 mm, in which readings are 8 to 40 mm longer; "two": a second one
                  of another direction 0.2 to 1 m below it
    key seat      a slot of 8 to 40 mm that a pipe wore over up to 1.3 times the stated length; its toolface turns
    gauge         hole without a hazard, with more noise: 24 samples in 0.1 m, 16.3 a turn

Each line counts the holes in which zones of a kind lie, and those with filled ones (confidence of 0.8 or more) in
brackets.
"""

from __future__ import annotations

import itertools
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator

import numpy as np

import helibore as hb
from bench.accuracy.hazards import BIT, FILLED, HAZARDS, away_from, slot
from helibore.base.arrays import Floats
from helibore.base.units import INCH

LENGTH, MIDDLE = 8.0, 4.0
TOOLS = tuple(itertools.product((16, 32, 64), (0.02, 0.1), (0.0005, 0.001, 0.002)))
Grown = Callable[[Floats, Floats], Floats]


def fracture(dip: float, middle: float, rng: np.random.Generator) -> Grown:
    """Return by how much readings at depths and toolfaces are longer in a fracture."""
    aperture, towards = rng.uniform(0.005, 0.030), rng.uniform(0, 360)
    deep, edge = rng.uniform(0.008, 0.040), rng.uniform(0.001, 0.004)  # the tool's beam rounds the edge
    cosine, sine = np.cos(np.radians(dip)), np.sin(np.radians(dip))

    def grown(depth: Floats, toolface: Floats) -> Floats:
        away = (depth - middle) * cosine - BIT / 2 * sine * np.cos(np.radians(toolface - towards))
        return np.asarray(deep * np.clip((aperture / 2 - np.abs(away)) / edge + 0.5, 0, 1))

    return grown


def two_fractures(dip: float, rng: np.random.Generator) -> Grown:
    both = fracture(dip, MIDDLE, rng), fracture(dip, MIDDLE + rng.uniform(0.2, 1.0), rng)
    return lambda depth, toolface: np.maximum(both[0](depth, toolface), both[1](depth, toolface))


def key_seat(length: float, turn: float, rng: np.random.Generator) -> Grown:
    """``turn``: degrees a metre."""
    length, axis = length * rng.uniform(1.0, 1.3), rng.uniform(0, 360)
    pipe, deep = rng.uniform(3.5, 6.5) * INCH, rng.uniform(0.008, 0.040)
    ends = min(0.1, length / 4)

    def grown(depth: Floats, toolface: Floats) -> Floats:
        along = depth - MIDDLE
        worn = np.clip((length / 2 - np.abs(along)) / ends, 0, 1)
        return np.asarray(worn * slot(BIT / 2, pipe, deep, away_from(toolface, axis + turn * along)))

    return grown


def logged(grown: Grown, per_turn: float, pitch: float, noise: float, rng: np.random.Generator) -> hb.Caliper:
    turns = np.arange(int(LENGTH / pitch * per_turn)) / per_turn
    toolface = turns * 360 + rng.uniform(-2, 2, turns.size)
    offset, away = rng.uniform(0, 0.010), np.radians(toolface - rng.uniform(0, 360))
    radius = offset * np.cos(away) + np.sqrt((BIT / 2) ** 2 - (offset * np.sin(away)) ** 2)
    radius = radius + grown(turns * pitch, toolface) + rng.normal(0, noise, turns.size)
    return hb.Caliper(turns * pitch, toolface, radius)


def say(name: str, read: Iterable[hb.Caliper]) -> None:
    holes, found, filled = 0, Counter[str](), Counter[str]()
    for of in read:
        zones = hb.reconstruct(of, bit_diameter=BIT, estimator="inverse-distance").zones().zones
        holes += 1
        found.update({zone.kind for zone in zones} or {"none"})
        filled.update({zone.kind for zone in zones if zone.confidence >= FILLED})
    kinds = ", ".join(f"{kind} {found[kind]}({filled[kind]})" for kind in HAZARDS if found[kind])
    print(f"{name:34s} {holes} holes: {kinds or 'no zone'}, without {found['none']}", flush=True)


def main(count: int, first: int) -> None:
    def read(make: Callable[[np.random.Generator], Grown], *of: int) -> Iterator[hb.Caliper]:
        for seed, (number, tool) in itertools.product(range(first, first + count), enumerate(TOOLS)):
            rng = np.random.default_rng([seed, number, *of])
            yield logged(make(rng), *tool, rng)

    def noisy(noise: float) -> Iterator[hb.Caliper]:
        for seed in range(10 * first, 10 * (first + count)):
            yield logged(lambda depth, _: 0 * depth, 16.3, 0.068, noise, np.random.default_rng([seed, 3]))

    for dip in (30, 45, 55, 65, 73, 80):
        say(f"fracture, dip {dip}", read(lambda rng, dip=dip: fracture(dip, MIDDLE, rng), 0, dip))  # type: ignore[misc]
        say(f"two fractures, dip {dip}", read(lambda rng, dip=dip: two_fractures(dip, rng), 1, dip))  # type: ignore[misc]
    for length, turn in itertools.product((0.4, 0.6, 1.0, 2.0, 6.0), (0, 6)):
        name = f"key seat, {length} m, {turn} degrees a metre"
        say(name, read(lambda rng, of=(length, turn): key_seat(*of, rng), 2, round(10 * length)))  # type: ignore[misc]
    for noise in (0.004, 0.006):
        say(f"gauge, noise of {1e3 * noise:.0f} mm", noisy(noise))


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:]]
    main(numbers[0] if numbers else 1, numbers[1] if numbers[1:] else 0)
