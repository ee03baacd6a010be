"""Measure how often the 95 % interval of a drift holds the drift of the true hole, and how long a drift takes.

    python -m bench.accuracy.passage [SEEDS] [FIRST]     seeds for each kind of hole (3), and the first seed (1000)
    python -m bench.accuracy.passage forms [CASES] [FIRST]   cases of each closed form (20), and the first seed (1000)
    python -m bench.accuracy.passage times

Each hole is 30 m of 8.5 in hole with a spiral, bumps, and one of none, breakouts or washouts. "smooth" is no rougher
than the tool's samples are dense; "rough" adds waves of 26 to 72 degrees and 0.3 to 2 m with 0.2 to 1 mm rms; "ledges"
has steps of up to 4 mm every 2 to 6 m. The tools send samples at random toolfaces with noise. A row of the table is one
kind of hole, tool and length:

    covered  turns whose true drift lies within the interval, %; turns half a length apart
    bias     mean of the wall's drift less the true one, mm
    width    mean width of the interval, mm

The last rows are those of all classes, each class counted alike.

"forms": greatest difference of a drift from the one that is known, mm. A disc fits a round section if its centre lies
within R - rho of the section's, so a spiral loses 2 min over axes of max over depth of the distance between axis and
centre line: a convex problem, solved here by cutting planes. A bend costs the arc's height, a ledge its step; an
ellipse has its short axis, a slotted circle the bit. A wall has a ledge somewhere between turns, over g = 1.5 pitches
at opposite toolfaces, in which a body of length L may lean: the drift lies up to 2 step g / (L + g) above bit - step.

"times": processor seconds for 1,000 m of hole at a pitch of 0.1 m, on one thread: drifts, and zones with their kinds.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
from scipy.optimize import linprog

import helibore as hb
from helibore.base.arrays import Floats
from helibore.base.units import INCH
from helibore.logs.passage import drift_of
from helibore.settings.wall_settings import Settings

BIT, LENGTH, PITCH, SECTORS = 8.5 * INCH, 30.0, 0.1, 64
DRIFTS = (0.3, 1.5, 9.0)
KINDS = ("smooth", "rough", "ledges")
TOOLS = {
    "64 a turn, 0.5 mm, automatic": (64, 0.0005, "automatic"),
    "64 a turn, 0.5 mm": (64, 0.0005, "inverse-distance"),
    "32 a turn, 1 mm, automatic": (32, 0.001, "automatic"),
}
Shape = Callable[[Floats, Floats], Floats]


def offset_circle(x: Floats, y: Floats, radius: float, toolface: Floats) -> Floats:
    ray, centre = np.exp(1j * np.radians(toolface)), x + 1j * y
    out: Floats = (ray.conj() * centre).real + np.sqrt(radius**2 - (ray.conj() * centre).imag ** 2)
    return out


def hole(kind: str, rng: np.random.Generator) -> Shape:
    """Return the radius of a hole as a function of depth and toolface."""
    offset, period = rng.uniform(0, 0.006), rng.uniform(0.8, 5)
    bumps = [
        (rng.uniform(0, LENGTH), rng.uniform(0, 360), rng.uniform(-0.0015, 0.004), rng.uniform(0.15, 1.5),
         rng.uniform(15, 60))
        for _ in range(40)
    ]  # fmt: skip
    breakout, washout = rng.choice([(0.0, 0.0), (0.01, 0.0), (0.0, 0.008)])
    axis = rng.uniform(0, 180)
    waves = [(rng.integers(5, 14), rng.uniform(3, 20), rng.uniform(0, 2 * np.pi)) for _ in range(12)]
    height = rng.uniform(0.2, 1.0) * 0.001 / np.sqrt(6) if kind == "rough" else 0.0
    steps = np.cumsum(rng.uniform(2, 6, 15))
    shifts = np.vstack([np.zeros(2), rng.uniform(-0.002, 0.002, (15, 2))]) * (kind == "ledges")

    def radius(depth: Floats, toolface: Floats) -> Floats:
        phase, bed = 2 * np.pi * depth / period, np.searchsorted(steps, depth)
        x, y = offset * np.cos(phase) + shifts[bed, 0], offset * np.sin(phase) + shifts[bed, 1]
        out = offset_circle(x, y, BIT / 2 + 0.001, toolface)
        for at, towards, high, long, wide in bumps:
            away = (toolface - towards + 180) % 360 - 180
            out = out + high * np.exp(-0.5 * ((depth - at) / long) ** 2 - 0.5 * (away / wide) ** 2)
        away = (toolface - axis + 90) % 180 - 90
        out = out + breakout * np.exp(-0.5 * (away / 20) ** 2) * (0.5 + 0.5 * np.sin(depth / 3))
        out = out + washout * (np.sin(depth / 2) > 0.3)
        for around, along, start in waves:
            out = out + height * np.cos(around * np.radians(toolface) + along * depth + start)
        return out

    return radius


def coverage(seeds: range) -> None:
    every: dict[float, list[float]] = {length: [] for length in DRIFTS}
    for kind in KINDS:
        for tool, (per_turn, noise, estimator) in TOOLS.items():
            found: dict[float, list[Floats]] = {length: [] for length in DRIFTS}
            for seed in seeds:
                rng = np.random.default_rng(seed)
                shape = hole(kind, rng)
                count = int(LENGTH / PITCH * per_turn)
                depth, toolface = np.sort(rng.uniform(0, LENGTH, count)), rng.uniform(0, 360, count)
                samples = hb.Caliper(depth, toolface, shape(depth, toolface) + rng.normal(0, noise, count))
                wall = hb.reconstruct(samples, bit_diameter=BIT, estimator=estimator)
                true = SimpleNamespace(
                    settings=wall.settings, start_depth=wall.start_depth, radius=shape(wall.depth, wall.toolface)
                )
                for length in DRIFTS:
                    drift, truth = wall.drift(length, sigma=True), drift_of(true, length).diameter
                    rows = np.flatnonzero(np.isfinite(drift.low))[:: max(1, round(length / PITCH / 2))]
                    found[length].append(np.array([of[rows] for of in (truth, drift.diameter, drift.low, drift.high)]))
            for length, parts in found.items():
                truth, own, low, high = np.concatenate(parts, axis=1)
                covered = 100 * np.mean((truth >= low) & (truth <= high))
                every[length] += [covered] if truth.size else []
                bias, width = 1e3 * np.mean(own - truth), 1e3 * np.mean(high - low)
                text = f"covered {covered:5.1f} %, bias {bias:+.2f} mm, width {width:.2f} mm, {truth.size} turns"
                print(f"{kind:7s} {tool:29s} {length:4.1f} m: {text}", flush=True)
    for length, shares in every.items():
        print(
            f"all {length:4.1f} m: covered {np.mean(shares):5.1f} %, by class {min(shares):.1f} to {max(shares):.1f} %"
        )


def least_distance(x: Floats, y: Floats, along: Floats) -> float:
    """Return the least greatest distance between points of a line and any straight axis."""
    cuts: list[list[float]] = []
    axis, least = np.zeros(4), 0.0
    for _ in range(300):
        off = (x - axis[0] - along * axis[1]) + 1j * (y - axis[2] - along * axis[3])
        far = int(np.argmax(abs(off)))
        if abs(off[far]) - least < 1e-8:
            break
        new = {far, *np.flatnonzero(abs(off) > 0.9 * abs(off[far]))[:: max(1, off.size // 20)]}
        for at in sorted(new):
            u = off[at] / abs(off[at])
            cuts.append([u.real, u.imag, x[at] * u.real + y[at] * u.imag, along[at]])
        of = np.array(cuts)
        left = -np.column_stack([of[:, 0], of[:, 0] * of[:, 3], of[:, 1], of[:, 1] * of[:, 3], np.ones(len(of))])
        found = linprog([0, 0, 0, 0, 1], A_ub=left, b_ub=-of[:, 2], bounds=[(-0.1, 0.1)] * 4 + [(0, 1)])
        axis, least = found.x[:4], found.x[4]
    return float(abs(off[far]))


def form(name: str, rng: np.random.Generator) -> float:
    """Return how far a drift by the core is from the known one, metres."""
    length, sectors, pitch, path, lean = float(rng.uniform(0.4, 3.0)), 64, 0.02, None, 0.0
    turns = int(length / pitch) + 40
    depth, toolface = (np.arange(turns * sectors) * of / sectors for of in (pitch, 360.0))
    toolface = toolface % 360
    if name == "spiral":
        offset, period = rng.uniform(0.002, 0.01), rng.uniform(0.6, 5.0)
        phase = 2 * np.pi * depth / period
        radius = offset_circle(offset * np.cos(phase), offset * np.sin(phase), BIT / 2, toolface)
        z = np.linspace(-0.5, 0.5, 2001)
        around = 2 * np.pi * z * length / period
        known = BIT - 2 * least_distance(offset * np.cos(around), offset * np.sin(around), z)
    elif name == "dogleg":
        build, length, sectors, pitch = rng.uniform(1, 15), float(rng.uniform(1, 9)), 256, 0.1
        path = hb.Survey([-10, 60], [20, 20 + build * 70 / 30], [40, 40]).path()
        radius = np.full(int(length / pitch + 20) * sectors, BIT / 2)
        bend = 30 / np.radians(build)
        known = np.sqrt((bend + BIT / 2) ** 2 - length**2 / 4) - (bend - BIT / 2)
    elif name == "ledge":
        step, towards = rng.uniform(0.002, 0.012), np.exp(1j * rng.uniform(0, 6.28)) * (depth > depth[-1] / 2)
        radius = offset_circle(step * towards.real, step * towards.imag, BIT / 2, toolface)
        known, lean = BIT - step, 3 * step * pitch / (length + 1.5 * pitch)
    elif name == "ellipse":
        axes, angle = (BIT / 2 + rng.uniform(0, 0.03), BIT / 2), np.radians(toolface)
        radius = 1 / np.hypot(np.cos(angle) / axes[0], np.sin(angle) / axes[1])
        known = BIT
    else:
        away = abs((toolface - rng.uniform(0, 360) + 180) % 360 - 180)
        radius = BIT / 2 + np.where(away < rng.uniform(10, 60), rng.uniform(0.01, 0.04), 0.0)
        known = BIT
    settings = Settings(bit_diameter=BIT, sectors=sectors, pitch=pitch)
    drift = drift_of(SimpleNamespace(settings=settings, start_depth=0.0, radius=radius, path=path, threads=1), length)
    return float(max(known - drift.least, drift.least - known - lean, 0.0))


def forms(cases: range) -> None:
    for number, name in enumerate(("spiral", "dogleg", "ledge", "ellipse", "slot")):
        found = [form(name, np.random.default_rng([seed, number])) for seed in cases]
        print(f"{name:8s} off by at most {1e3 * max(found):.4f} mm in {len(found)} cases", flush=True)


def times() -> None:
    rng = np.random.default_rng(0)
    k = np.arange(10_000 * SECTORS)
    radius = hole("rough", rng)(k * PITCH / SECTORS % LENGTH, k * 360 / SECTORS % 360)
    wall = SimpleNamespace(settings=Settings(bit_diameter=BIT), start_depth=0.0, radius=radius, threads=1)
    for length in (*DRIFTS, 12.0):
        for name, sigma in (("", None), (" with its interval", np.full(k.size, 3e-4))):
            start = time.process_time()
            drift_of(wall, length, sigma)
            print(f"{length:4.1f} m{name}: {time.process_time() - start:.2f} s", flush=True)
    for tool, (per_turn, arms) in {"64 a turn": (64, 0), "4 arms, 5 cm": (8, 4)}.items():
        k = np.arange(10_000 * per_turn)
        depth, toolface = k * PITCH / per_turn, k * 360 / per_turn % 360
        if arms:
            depth, toolface = np.floor(k / arms) * PITCH * arms / per_turn, (k % arms * 90 + 7 * depth) % 360
        samples = hb.Caliper(
            depth, toolface, hole("rough", rng)(depth % LENGTH, toolface), arm=k % arms if arms else None
        )
        made = hb.reconstruct(samples, bit_diameter=BIT, threads=1, estimator="inverse-distance")
        start = time.process_time()
        zones = made.zones().zones
        print(f"kinds, {tool}: {time.process_time() - start:.2f} s, {len(zones)} zones", flush=True)


if __name__ == "__main__":
    if sys.argv[1:] == ["times"]:
        times()
    elif sys.argv[1:2] == ["forms"]:
        numbers = [int(text) for text in sys.argv[2:]]
        first = numbers[1] if len(numbers) > 1 else 1000
        forms(range(first, first + (numbers[0] if numbers else 20)))
    else:
        numbers = [int(text) for text in sys.argv[1:]]
        first = numbers[1] if len(numbers) > 1 else 1000
        coverage(range(first, first + (numbers[0] if numbers else 3)))
