"""Compare the kinds of zones with those that an ideal observer says of the same samples.

    python -m bench.accuracy.ideal_observer [HOLES] [FIRST]     holes for each tool and kind (4), first seed (0)

The holes are those of ``bench.accuracy.hazards``, family "plain", with a breakout or a key seat. The observer knows how
these holes are made: where the hazard is, the families of its shapes with the range of each number, and the noise; of
the tool's centre, that it turns by 0 or 10 degrees a metre to either side. For each kind he fits all numbers to the
samples, and takes the kind with the most evidence (Laplace). No software knows as much of a real hole: what he cannot
say, the samples do not show.

    X-Y: the observer parts slots from breakouts by the shapes of both. Of a hole with two opposite slots of half the
    height, each diameter is the same; such holes are not among his.
"""

from __future__ import annotations

import sys
from collections import Counter

import numpy as np
from scipy.optimize import least_squares

import helibore as hb
from bench.accuracy.hazards import BIT, LOBED, Hole, _circle, away_from, judged, slot, walls
from helibore.base.arrays import Floats
from helibore.base.units import INCH

TOOLS = ("X-Y", "four arms", "six arms", "telemetry")
CENTRE = ((-0.010, 0.010), (-0.010, 0.010))
SIZE = (BIT / 2 - 0.0003, BIT / 2 + 0.0015)
SHAPES = {
    "gauge": (),
    "breakout": ((0, 360), (35, 80), (0.016, 0.035), (0.6, 1.0), (156, 204)),
    "key seat": ((0, 360), (3.5 * INCH, 6.5 * INCH), (0.010, 0.040)),
}
PRIOR = {"gauge": 5 / 9, "breakout": 1 / 9, "key seat": 1 / 9}
ROUGH = 0.0004  # metres; a typical rms of the rock
INSIDE = 0.35  # metres at each end of the hazard, where it grows
MOST = 300  # samples
TRIED, FITTED = 600, 6


def height(kind: str, shape: Floats, size: float, toolface: Floats) -> Floats:
    if kind == "key seat":
        axis, pipe, deep = shape
        return slot(size, pipe, deep, away_from(toolface, axis))
    if kind == "gauge":
        return np.zeros(toolface.size)
    axis, wide, high, other, apart = shape
    one, two = (
        np.cos(np.radians(np.clip(90 * away_from(toolface, at) / wide, -90, 90))) ** 2 for at in (axis, axis + apart)
    )
    return np.asarray(high * (one + other * two))


def evidence(kind: str, read: hb.Caliper, rows: Floats, noise: float, turn: float, even: bool) -> float:
    depth, toolface, radius = (np.asarray(of)[rows] for of in (read.depth, read.toolface, read.radius))
    low, high = np.array([*(() if even else CENTRE), SIZE, *SHAPES[kind]], dtype=float).T
    first = 0 if even else 2  # the place of the size

    def off(share: Floats) -> Floats:
        numbers = low + share * (high - low)
        size, shape = numbers[first], numbers[first + 1 :]
        if even:
            both = height(kind, shape, size, toolface) + height(kind, shape, size, toolface + 180)
            return np.asarray((size + both / 2 - radius) / noise)
        along = (numbers[0] + 1j * numbers[1]) * np.exp(1j * np.radians(turn * depth))
        return np.asarray((_circle(along, size, toolface) + height(kind, shape, size, toolface) - radius) / noise)

    ends = np.zeros(low.size), np.ones(low.size)
    if kind != "gauge":
        ends[0][first + 1], ends[1][first + 1] = -1, 2  # an axis may pass 0
    starts = np.random.default_rng(1).uniform(0.02, 0.98, (TRIED if kind != "gauge" else 1, low.size))
    starts = starts[np.argsort([np.sum(off(start) ** 2) for start in starts])[:FITTED]]
    best = min((least_squares(off, start, bounds=ends, max_nfev=60) for start in starts), key=lambda fit: fit.cost)
    prior = 12.0  # 1 / variance of a share
    curved = best.jac.T @ best.jac + prior * np.eye(low.size)
    return float(-best.cost + 0.5 * low.size * np.log(prior) - 0.5 * np.linalg.slogdet(curved)[1])


def observed(tool: str, of: Hole, read: hb.Caliper) -> str:
    rows = np.flatnonzero((read.depth > of.top + INSIDE) & (read.depth < of.bottom - INSIDE))
    rows = rows[:: max(1, rows.size // MOST)]
    even, noise = tool == "X-Y", float(np.hypot(of.noise, ROUGH))
    turns = (0.0,) if even else (-10.0, 0.0, 10.0)

    def likely(kind: str) -> float:
        of_turns = [evidence(kind, read, rows, noise, turn, even) for turn in turns]
        return float(np.log(PRIOR[kind])) + max(of_turns)

    return max(SHAPES, key=likely)


def main(seeds: range) -> None:
    for tool in TOOLS:
        found = [
            (of.kind, observed(tool, of, read), judged(of, wall.zones().zones)[0])
            for of, wall, read in walls(tool, LOBED, seeds, "plain")
        ]
        for kind in LOBED:
            ideal = [says == kind for true, says, _ in found if true == kind]
            own = [said == kind for true, _, said in found if true == kind]
            silent = Counter(said or "no zone" for true, says, said in found if true == says == kind != said)
            text = f"ideal observer {sum(ideal)}, helibore {sum(own)} of {len(own)}"
            print(f"{tool:10s} {kind:9s} {text}; only the observer: {dict(silent) or 'none'}", flush=True)


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:]]
    first = numbers[1] if numbers[1:] else 0
    main(range(first, first + (numbers[0] if numbers else 4)))
