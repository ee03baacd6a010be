"""Measure how often the zones of holes with one known hazard are right, and what a measured vertex is worth.

    python -m bench.accuracy.hazards [HOLES] [FIRST] [FAMILY]          holes for each tool and kind (3), first seed (0)
    python -m bench.accuracy.hazards quiet [HOLES] [FIRST] [FAMILY]    quiet holes only: 28 for each are 10,080 m
    python -m bench.accuracy.hazards vertices [HOLES] [FIRST] [FAMILY] errors of vertices that count as measured

Each hole is 12 m of 8.5 in hole with one hazard of 1.5 to 5 m, or a quiet hole: gauge, oval, with a ledge, a spiral, or
noise of 1.5 mm. Tools are up to 10 mm off centre. The shapes of the family "plain" are smooth; those of "odd" have
corners, flat bottoms, uneven sides and more rough rock: they are for verification.

    right          a hole with a hazard: zones of its kind cover most of it; a quiet hole: no zone; for all zones,
                   and for the filled ones (confidence of 0.8 or more) in brackets
    filled, wrong  filled zones of another kind than the hole has, or beside its hazard
    touched        holes with a breakout or key seat in which a reading lies at least 6.35 mm outside the wall as it was
                   before it wore (X-Y: half of a diameter's growth). In the others no reading shows a lobe
    without        hazards without key seats of X-Y tools: a slot has the diameters of two lobes of half its height
    said, true     mean confidence of the zones in five classes of it, and the share that is right; the calibration
                   error is their mean difference, weighted by the number of zones
"""

from __future__ import annotations

import itertools
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

import helibore as hb
from helibore.base.arrays import Floats, Integers
from helibore.base.units import INCH

BIT, LENGTH = 8.5 * INCH, 12.0
TOOLS = ("rotating", "transducers", "X-Y", "four arms", "six arms", "telemetry")
HAZARDS = ("breakout", "key seat", "washout", "undergauge")
QUIET = ("gauge", "oval", "ledge", "spiral", "noise")
FAMILIES = ("plain", "odd")
LOBED = ("breakout", "key seat")
FILLED = 0.8
TOUCHED = 0.25 * INCH
Shape = Callable[[Floats, Floats], Floats]


@dataclass(frozen=True)
class Hole:
    """A hole with the radius ``radius`` (depth, toolface), and a hazard of ``kind`` between ``top`` and ``bottom``.

    ``unworn`` is its radius without the hazard.
    """

    kind: str
    top: float
    bottom: float
    noise: float
    radius: Shape
    unworn: Shape


def away_from(toolface: Floats, towards: float) -> Floats:
    return np.asarray((toolface - towards + 180) % 360 - 180)


def slot(radius: float, pipe: float, deep: float, away: Floats) -> Floats:
    """Return the height, over a circle of ``radius``, of a slot that a pipe of a diameter wore."""
    centre = radius + deep - pipe / 2
    angle = np.radians(away)
    left = np.maximum((pipe / 2) ** 2 - (centre * np.sin(angle)) ** 2, 0)
    reach = np.where((left > 0) & (np.cos(angle) > 0), centre * np.cos(angle) + np.sqrt(left), 0)
    return np.maximum(reach - radius, 0)


def hole(kind: str, family: str, rng: np.random.Generator, centred: bool) -> Hole:
    odd = family == "odd"
    radius = BIT / 2 + rng.uniform(-0.0003, 0.0015)
    offset = 0.0 if centred else rng.uniform(0, 0.010)
    towards, turn = rng.uniform(0, 360), rng.uniform(-15, 15)
    top = rng.uniform(2.5, 4.5)
    bottom = top + rng.uniform(1.5, 5.0)
    ends = rng.uniform(0.05, 0.3)
    axis, wide = rng.uniform(0, 360), rng.uniform(35, 80)
    high = rng.uniform(0.016, 0.035)
    other, apart = rng.uniform(0.6, 1.0), 180 + rng.normal(0, 8)
    pipe, deep = rng.uniform(3.5, 6.5) * INCH, rng.uniform(0.010, 0.040)
    growth, under = rng.uniform(0.010, 0.035), rng.uniform(0.0055, 0.009)
    uneven = [(rng.integers(1, 5), rng.uniform(-3, 3), rng.uniform(0, 6.3)) for _ in range(4)]
    share = rng.uniform(0, 0.35 if odd else 0.2)
    period, swing = rng.uniform(0.6, 3.0), rng.uniform(0.003, 0.008)
    step, step_to = rng.uniform(0.004, 0.008), rng.uniform(0, 360)
    ovality = rng.uniform(0.001, 0.0025)
    rough = rng.uniform(0.0004, 0.0015) if odd else rng.uniform(0, 0.0006)
    waves = [(rng.integers(2, 12), rng.uniform(2, 25), rng.uniform(0, 6.3)) for _ in range(16)]
    sharp, lean, corner = rng.uniform(0.6, 3.0), rng.uniform(-0.5, 0.5), rng.integers(3)

    def lobe(away: Floats, width: float) -> Floats:
        if not odd:
            return np.cos(np.radians(np.clip(90 * away / width, -90, 90))) ** 2
        place = np.abs(away) / (width * np.where(away > 0, 1 + lean, 1 - lean))
        if corner == 0:
            return np.maximum(1 - place, 0)
        if corner == 1:
            return np.asarray(np.clip(2.5 * (1 - place), 0, 1))
        return np.maximum(1 - place**2, 0) ** sharp

    def of(depth: Floats, toolface: Floats, hazard: float = 1.0) -> Floats:
        worn = hazard * np.clip((depth - top) / ends, 0, 1) * np.clip((bottom - depth) / ends, 0, 1)
        along = offset * np.exp(1j * np.radians(towards + turn * depth))
        if kind == "spiral":
            along = along + swing * np.exp(2j * np.pi * depth / period)
        if kind == "ledge":
            along = along + step * np.exp(1j * np.radians(step_to)) * (depth > top)
        size = radius - (under * worn if kind == "undergauge" else 0.0)
        out = _circle(along, size, toolface)
        if kind == "breakout":
            out = out + worn * high * lobe(away_from(toolface, axis), wide)
            out = out + worn * high * other * lobe(away_from(toolface, axis + apart), wide)
        elif kind == "key seat":
            ideal = slot(radius, pipe, deep, away_from(toolface, axis))
            worn_in = 0.85 * ideal + 0.15 * deep * lobe(away_from(toolface, axis), wide * 0.7) if odd else ideal
            out = out + worn * worn_in
        elif kind == "washout":
            shape = sum(np.cos(m * np.radians(toolface) + k * depth + p) for m, k, p in uneven) / 2
            out = out + worn * growth * (1 + share * shape)
        elif kind == "oval":
            out = out + ovality * np.cos(2 * np.radians(toolface - axis))
        for m, k, p in waves:
            out = out + rough / np.sqrt(8) * np.cos(m * np.radians(toolface) + k * depth + p)
        return out

    ends_of_it = (top, bottom) if kind in HAZARDS else (np.inf, np.inf)
    noise = 0.0015 if kind == "noise" else 0.0005
    return Hole(kind, *ends_of_it, noise, of, lambda depth, toolface: of(depth, toolface, 0.0))


def _circle(centre: Floats, radius: Floats | float, toolface: Floats) -> Floats:
    ray = np.exp(1j * np.radians(toolface)).conj() * centre
    return np.asarray(ray.real + np.sqrt(radius**2 - ray.imag**2))


def samples(tool: str, of: Hole, rng: np.random.Generator) -> hb.Caliper:
    """Return what a tool measures of a hole."""
    arm: Integers | None = None
    if tool == "rotating":
        count = int(LENGTH / 0.1 * 64)
        depth = np.arange(count) * 0.1 / 64
        toolface = np.arange(count) * 360.0 / 64 + rng.uniform(-2, 2, count)
    elif tool == "telemetry":
        depth = np.sort(rng.uniform(0, LENGTH, int(LENGTH / 0.05)))
        toolface = rng.uniform(0, 360, depth.size)
        slide = rng.uniform(0, LENGTH - 3)
        stands = (depth > slide) & (depth < slide + 3) & (rng.uniform() < 0.5)
        toolface = np.where(stands, rng.uniform(0, 360) + rng.uniform(-5, 5, depth.size), toolface)
    else:
        arms = {"transducers": 4, "X-Y": 4, "four arms": 4, "six arms": 6}[tool]
        rows = np.arange(int(LENGTH / 0.05)) * 0.05
        if tool == "transducers":
            turned = rng.uniform(0, 360, rows.size)
        else:
            turned = rng.uniform(0, 360) + rng.uniform(-25, 25) * rows + np.cumsum(rng.normal(0, 0.5, rows.size))
            arm = np.tile(np.arange(arms), rows.size)
        depth = np.repeat(rows, arms)
        toolface = np.repeat(turned, arms) + np.tile(np.arange(arms) * 360 / arms, rows.size)
    radius = of.radius(depth, toolface)
    if tool == "X-Y":
        radius = (radius + of.radius(depth, toolface + 180)) / 2
    noise = rng.normal(0, of.noise, depth.size)
    if tool == "X-Y":
        noise = noise.reshape(-1, 4)[:, [0, 1, 0, 1]].ravel()
        radius = radius.reshape(-1, 4)[:, [0, 1, 0, 1]].ravel()
    return hb.Caliper(depth, toolface, radius + noise, arm=arm)


def is_touched(tool: str, of: Hole, read: hb.Caliper) -> bool:
    """Return whether a reading of ``tool`` shows the hazard, if the wall before it wore is known."""
    depth, toolface = np.asarray(read.depth), np.asarray(read.toolface)
    grown = of.radius(depth, toolface) - of.unworn(depth, toolface)
    if tool == "X-Y":
        grown = (grown + of.radius(depth, toolface + 180) - of.unworn(depth, toolface + 180)) / 2
    return bool(np.any(grown >= TOUCHED))


def walls(tool: str, kinds: tuple[str, ...], seeds: range, family: str) -> Iterator[tuple[Hole, hb.Wall, hb.Caliper]]:
    for seed in seeds:
        for number, kind in enumerate(kinds):
            rng = np.random.default_rng([seed, number, TOOLS.index(tool), FAMILIES.index(family)])
            of = hole(kind, family, rng, tool == "X-Y")
            read = samples(tool, of, rng)
            yield of, hb.reconstruct(read, bit_diameter=BIT), read


def vertices(seeds: range, family: str) -> None:
    every = []
    for tool in (*TOOLS, "all"):
        parts = every if tool == "all" else []
        for of, wall, _ in walls(tool, (*HAZARDS, *QUIET), seeds, family) if tool != "all" else ():
            depth, toolface = wall.depth, wall.toolface
            true = of.radius(depth, toolface)
            if tool == "X-Y":  # it measures diameters, and the radii of its samples are their halves
                true = (true + of.radius(depth, toolface + 180)) / 2
            error = np.abs(wall.radius - true)
            parts.append(np.array([error, wall.measured]))
        every += parts if tool != "all" else []
        error, counted = np.concatenate(parts, axis=1)
        is_counted = counted > 0
        large = error > 0.003
        text = f"measured {100 * counted.mean():5.1f} %"
        if is_counted.any():
            text += f", 95 % of their errors below {1e3 * np.quantile(error[is_counted], 0.95):.2f} mm"
        if large.any():
            text += f"; flagged of the {100 * large.mean():.1f} % above 3 mm: {100 * np.mean(~is_counted[large]):.0f} %"
        print(f"{tool:12s} {text}", flush=True)


def confidence(zone: hb.Zone) -> float:
    return float(getattr(zone, "confidence", 1.0))


def judged(of: Hole, zones: tuple[hb.Zone, ...]) -> tuple[str, list[tuple[hb.Zone, bool]]]:
    """Return the kind that the zones say of the hole ("" for none), and whether each zone is right."""
    over = dict.fromkeys(HAZARDS, 0.0)
    verdicts = []
    for zone in zones:
        inside = min(zone.stop, of.bottom) - max(zone.start, of.top)
        over[zone.kind] += max(inside, 0.0)
        verdicts.append((zone, zone.kind == of.kind and inside >= 0.5 * zone.length))
    said = max(over, key=lambda kind: over[kind])
    return said if over[said] > 0 else "", verdicts


def share(right: list[bool]) -> str:
    return f"{100 * np.mean(right):.1f} % of {len(right)}" if right else "none of 0"


def kinds(seeds: range, family: str, of_kinds: tuple[str, ...]) -> None:
    every: list[tuple[float, bool]] = []
    every_hazard: list[bool] = []
    every_touched: list[bool] = []
    every_distinct: list[bool] = []
    wrong = total = quiet = false = 0
    for tool in TOOLS:
        right: dict[str, list[bool]] = defaultdict(list)
        filled_right: dict[str, list[bool]] = defaultdict(list)
        confused: dict[str, int] = defaultdict(int)
        hazards: list[bool] = []
        touched: list[bool] = []
        lobed = 0
        for of, wall, read in walls(tool, of_kinds, seeds, family):
            zones = wall.zones().zones
            filled = tuple(zone for zone in zones if confidence(zone) >= FILLED)
            said, verdicts = judged(of, zones)
            sure = judged(of, filled)[0]
            is_hazard = of.kind in HAZARDS
            right[of.kind].append(said == of.kind if is_hazard else not zones)
            filled_right[of.kind].append(sure == of.kind if is_hazard else not filled)
            every += [(confidence(zone), is_right) for zone, is_right in verdicts]
            if is_hazard:
                hazards.append(said == of.kind)
                if (tool, of.kind) != ("X-Y", "key seat"):
                    every_distinct.append(said == of.kind)
                lobed += of.kind in LOBED
                if of.kind not in LOBED or is_touched(tool, of, read):
                    touched.append(said == of.kind)
            else:
                quiet += 1
                false += len(filled)
            faults = [zone for zone, is_right in verdicts if not is_right and zone in filled]
            wrong += bool(faults)
            total += 1
            for zone in faults:
                confused[f"{zone.kind} in {of.kind}"] += 1
        line = "  ".join(f"{kind} {sum(of)}({sum(filled_right[kind])})/{len(of)}" for kind, of in right.items())
        print(f"{tool:12s} {line}")
        faulty = ", ".join(f"{number} {name}" for name, number in confused.items()) or "none"
        print(f"{'':12s} filled and wrong: {faulty}")
        if hazards:
            untouched = f"{len(hazards) - len(touched)} of {lobed} lobed holes are not touched"
            print(f"{'':12s} right: {share(hazards)}; {untouched}, right of the others: {share(touched)}", flush=True)
        every_hazard += hazards
        every_touched += touched
    print(f"{total} holes, {wrong} with a filled and wrong zone ({100 * wrong / max(total, 1):.1f} %)")
    if every_hazard:
        print(f"hazards of the right kind: {share(every_hazard)}; where touched: {share(every_touched)}")
        print(f"without key seats of X-Y tools, which read as breakouts do: {share(every_distinct)}")
    if quiet:
        metres = quiet * LENGTH
        print(f"{false} filled zones in {metres:,.0f} m of quiet hole: {1000 * false / metres:.2f} in 1,000 m")
    said, true = np.array(every, dtype=float).T if every else np.empty((2, 0))
    apart = 0.0
    edges = np.array([0, 0.6, 0.7, 0.8, 0.9, 1.01])
    for low, high in itertools.pairwise(edges):
        inside = (said >= low) & (said < high)
        if inside.any():
            apart += inside.sum() * abs(said[inside].mean() - true[inside].mean())
            print(f"confidence {said[inside].mean():.2f}: {true[inside].mean():.2f} right of {inside.sum()} zones")
    if said.size:
        print(f"calibration error {apart / said.size:.3f}")


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:] if text.isdigit()]
    count, first = numbers[0] if numbers else 3, numbers[1] if numbers[1:] else 0
    families = [text for text in sys.argv[1:] if text in FAMILIES] or ["plain"]
    if "vertices" in sys.argv:
        vertices(range(first, first + count), families[0])
    else:
        kinds(range(first, first + count), families[0], QUIET if "quiet" in sys.argv else (*HAZARDS, *QUIET))
