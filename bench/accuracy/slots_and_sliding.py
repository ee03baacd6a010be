"""Measure what zones say of slots that pipes wore, and of holes in which the tool stops turning.

    python -m bench.accuracy.slots_and_sliding slots [FIRST]           240 slots, first seed (0)
    python -m bench.accuracy.slots_and_sliding sliding [HOLES] [FIRST]

slots: 2 m of 8.5 in hole with a slot of 10 to 40 mm that a pipe of 3.5 to 6.5 in wore; a rotating tool, up to 10 mm off
centre, takes 64 samples of 0.5 mm noise in 0.1 m, or, "dense", 128 in 0.02 m.

    right  the one zone of the wall is a key seat
    pipe   difference of its pipe diameter from the true one, mm: mean, greatest; the rows "few" have 24 and 12 samples
           a turn, which show some slots only: the others' pipes are unknown

sliding: holes as of ``bench.accuracy.hazards``. A tool turns at first; from the middle of the hazard, of quiet holes
from the middle on, it stands at one toolface or at four, give or take 3 degrees, with 2,000 samples a metre.

    filled, wrong  zones with a confidence of 0.8 or more of another kind than the hole has, or beside its hazard
    within         turns up to 2.5 m below the place whose true equal-area diameter lies within the likely range, or
                   where this is none within 2 sigma of the stated diameter, %; those without either are left out
"""

from __future__ import annotations

import itertools
import sys

import numpy as np

import helibore as hb
from bench.accuracy.hazards import BIT, FILLED, HAZARDS, LENGTH, QUIET, Hole, hole, judged
from helibore.base.arrays import Floats
from helibore.base.units import INCH

NOISE = 0.0005


def slots(first: int) -> None:
    pipes, depths = np.linspace(3.5, 6.5, 6) * INCH, np.linspace(0.010, 0.040, 5)
    tools = (("64 a turn", 64, 0.1), ("dense", 128, 0.02), ("few, 24", 24, 0.1), ("few, 12", 12, 0.1))
    for name, per_turn, pitch in tools:
        right, apart = [], []
        for number, (pipe, deep, _) in enumerate(itertools.product(pipes, depths, range(8))):
            rng = np.random.default_rng([first, number])
            turns = np.arange(round(2 / pitch * per_turn)) / per_turn
            toolface = turns * 360 + rng.uniform(-2, 2, turns.size)
            axis, towards, off = rng.uniform(0, 360), rng.uniform(0, 360), rng.uniform(0, 0.010)
            radius = _seen_from(off * np.exp(1j * np.radians(towards)), BIT / 2, pipe, deep, axis, toolface)
            samples = hb.Caliper(turns * pitch, toolface, radius + rng.normal(0, NOISE, turns.size))
            zones = hb.reconstruct(samples, bit_diameter=BIT, estimator="inverse-distance").zones().zones
            right.append([zone.kind for zone in zones] == ["key seat"])
            apart += [1e3 * abs(zone.pipe_diameter - pipe) for zone in zones if zone.kind == "key seat"]
        known = np.array(apart)[np.isfinite(apart)]
        sizes = f"{np.mean(known):.1f}, {np.max(known, initial=0):.1f} mm of {known.size} known"
        print(f"{name}: right {sum(right)} of {len(right)}; pipe {sizes} of {len(apart)}", flush=True)


def _seen_from(tool: complex, size: float, pipe: float, deep: float, axis: float, toolface: Floats) -> Floats:
    """Return the distances of a slotted wall from a tool off centre: the far end of both circles along each ray."""
    slotted = (size + deep - pipe / 2) * np.exp(1j * np.radians(axis))
    far = []
    for centre, radius in ((0.0, size), (slotted, pipe / 2)):
        across = np.exp(-1j * np.radians(toolface)) * (centre - tool)
        left = radius**2 - across.imag**2
        far.append(np.where(left > 0, across.real + np.sqrt(np.maximum(left, 0)), 0.0))
    return np.asarray(np.maximum(*far))


def sliding(holes: range) -> None:
    for stands in (1, 4):
        false, within, ranged, rows = [], [], 0, 0
        for seed in holes:
            for number, kind in enumerate((*HAZARDS, *QUIET)):
                rng = np.random.default_rng([seed, number, stands])
                of = hole(kind, "plain", rng, False)
                stop = (of.top + of.bottom) / 2 if kind in HAZARDS else LENGTH / 2
                wall = _stopped(of, stop, stands, rng)
                filled = tuple(zone for zone in wall.zones().zones if zone.confidence >= FILLED)
                false += [f"{zone.kind} in {of.kind}" for zone, is_right in judged(of, filled)[1] if not is_right]
                logs = wall.logs(sigma=True)
                low, high = logs.diameter_range
                around = np.arange(0, 360, 1.0)
                true = np.array([_diameter(of.radius(np.full(360, at), around)) for at in logs.depth])
                sure = (low >= high) & np.isfinite(logs.diameter_sigma)
                low = np.where(sure, low - 2 * logs.diameter_sigma, low)
                high = np.where(sure, high + 2 * logs.diameter_sigma, high)
                below = (logs.depth > stop) & (logs.depth < stop + 2.5)
                stated = below & (low < high)
                within += list((low <= true)[stated] & (true <= high)[stated])
                rows += int(below.sum())
                ranged += int(stated.sum())
        named = ", ".join(f"{false.count(name)} {name}" for name in sorted(set(false))) or "none"
        text = f"filled, wrong: {named}; within {100 * np.mean(within):.1f} % of {ranged} turns of {rows}"
        print(f"stands at {stands} of {len(holes) * len((*HAZARDS, *QUIET))} holes: {text}", flush=True)


def _diameter(radius: Floats) -> float:
    return float(2 * np.sqrt(np.mean(radius**2)))


def _stopped(of: Hole, stop: float, stands: int, rng: np.random.Generator) -> hb.Wall:
    turning = np.sort(rng.uniform(0, stop, int(2000 * stop)))
    standing = np.sort(rng.uniform(stop, LENGTH, int(2000 * (LENGTH - stop))))
    at = rng.uniform(0, 360) + 360 / stands * rng.integers(stands, size=standing.size)
    depth = np.append(turning, standing)
    toolface = np.append(rng.uniform(0, 360, turning.size), at + rng.uniform(-3, 3, standing.size)) % 360
    radius = of.radius(depth, toolface) + rng.normal(0, of.noise, depth.size)
    return hb.reconstruct(hb.Caliper(depth, toolface, radius), bit_diameter=BIT, estimator="inverse-distance")


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[2:]]
    if sys.argv[1:2] == ["slots"]:
        slots(numbers[0] if numbers else 0)
    else:
        first = numbers[1] if numbers[1:] else 0
        sliding(range(first, first + (numbers[0] if numbers else 3)))
