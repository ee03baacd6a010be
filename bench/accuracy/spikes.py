"""Measure which spikes the preparation drops, and what it costs: ``python -m bench.accuracy.spikes [ROW ...] SEED``.

Six kinds of hole (`known_holes`, and one with washouts, breakouts and a varying oval). Rows:

    dense    32 samples a turn in 2 cm; 0.5 % single spikes, and bursts of two to five samples
    arms     six arms in 0.1 m, four arms in 0.1 and 0.15 m, slowly turning; also rows in which all arms jump
    tails    walls from noise after Student's t (2 degrees of freedom, 0.5 mm) with spikes dropped, over those without
    clean    the same for normal noise without spikes

Spikes are off by 8 to 60 mm (logarithmic), to both sides; radii stay above 30 mm.

    single, burst, row   spikes that are dropped, %
    lost                 samples where the hole is worn by more than 3 mm, and no spike, that are dropped, %
    mean, worst          ratio of the rms errors of the walls, of all holes
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator

import numpy as np

import helibore as hb
from bench.accuracy.known_holes import HOLES, Hole
from bench.accuracy.preparation import ordinary
from helibore.base.arrays import Floats
from helibore.preparation.prepare import Preparation
from helibore.preparation.readings import Readings
from helibore.preparation.sensors import Sensor

Radius = Callable[[Floats, Floats], Floats]

ROUND = 0.109
WORN = 0.003
NOISE = 5e-4
ARMS = (("six arms, 0.1 m", 6, 0.1), ("four arms, 0.1 m", 4, 0.1), ("four arms, 0.15 m", 4, 0.15))
HEIGHT, PER_TURN = 0.02, 32


def holes(seed: int) -> Iterator[tuple[str, Radius]]:
    yield from ((kind, Hole(kind, seed).radius) for kind in HOLES)
    yield "ordinary", ordinary(seed)


def dense_at(rng: np.random.Generator, length: float) -> tuple[Floats, Floats]:
    """Return depth and toolface, (turns, samples), of a tool that turns unevenly."""
    number = np.arange(int(length / HEIGHT) * PER_TURN)
    toolface = (number + rng.uniform(-0.25, 0.25, number.size)) * 360.0 / PER_TURN % 360.0
    return (number * HEIGHT / PER_TURN).reshape(-1, PER_TURN), toolface.reshape(-1, PER_TURN)


def arms_at(rng: np.random.Generator, count: int, step: float, length: float) -> tuple[Floats, Floats]:
    """Return depth and toolface, (rows, arms), of a tool that turns slowly."""
    rows = np.arange(int(length / step))
    turned = rng.uniform(0, 360) + np.cumsum(rng.normal(rng.uniform(5, 20) * step, 6 * step, rows.size))
    depth = np.broadcast_to(rows[:, None] * step, (rows.size, count))
    return depth, (turned[:, None] + 360.0 / count * np.arange(count)) % 360.0


def spiked(radius: Floats, rng: np.random.Generator, rows: bool) -> tuple[Floats, Floats]:
    """Return radii with spikes, and the kind of each: 0 none, 1 single, 2 burst, 3 row."""
    size = np.exp(rng.uniform(np.log(0.008), np.log(0.06), radius.shape)) * rng.choice([-1, 1], radius.shape)
    kind = np.where(rng.random(radius.shape) < 0.005, 1, 0)
    along = kind if rows else kind.T  # a burst runs along an arm, or around a turn
    sizes = size if rows else size.T
    for _ in range(radius.size // 700):
        first, column = rng.integers(0, along.shape[0] - 5), rng.integers(along.shape[1])
        stop = first + rng.integers(2, 6)
        along[first:stop, column] = 2
        sizes[first:stop, column] = sizes[first, column]
    if rows:
        for row in rng.choice(len(radius), len(radius) // 150, replace=False):
            kind[row], size[row] = 3, size[row, 0]
    return np.where(kind > 0, np.maximum(radius + size, 0.03), radius), kind


def readings_of(depth: Floats, toolface: Floats, radius: Floats) -> Readings:
    """Return the readings of a tool: rows of arms, or one sample in each row of a dense tool."""
    if depth.shape[1] == PER_TURN:
        depth, toolface, radius = (each.reshape(-1, 1) for each in (depth, toolface, radius))
    names = tuple(f"R{number}" for number in range(1, radius.shape[1] + 1))
    sensors = tuple(Sensor(name, mounting=360.0 / len(names) * number) for number, name in enumerate(names))
    return Readings(
        "simulated", depth[:, 0].copy(), toolface[:, 0].copy(), sensors, tuple(radius.T.copy()),
        np.arange(len(names)), names, (False,) * len(names)
    )  # fmt: skip


def kept(depth: Floats, toolface: Floats, radius: Floats) -> tuple[hb.Caliper, np.ndarray]:
    """Return the samples that the preparation keeps, and which samples, of all in the order of rows, these are."""
    made = hb.prepare(readings_of(depth, toolface, radius), Preparation(spikes=6.0)).caliper
    numbers = {key: at for at, key in enumerate(zip(depth.ravel(), np.round(toolface.ravel() % 360, 6), strict=True))}
    mask = np.zeros(depth.size, dtype=bool)
    mask[[numbers[key] for key in zip(made.depth, np.round(made.toolface % 360, 6), strict=True)]] = True
    return made, mask.reshape(depth.shape)


def found(seed: int, tool: str, at: Callable[[np.random.Generator], tuple[Floats, Floats]], rows: bool) -> None:
    total = np.zeros((5, 2))
    for number, (name, truth) in enumerate(holes(seed)):
        rng = np.random.default_rng([seed, 21, number])
        depth, toolface = at(rng)
        shape = truth(depth, toolface)
        measured, kind = spiked(shape + rng.normal(0, NOISE, shape.shape), rng, rows)
        dropped = ~kept(depth, toolface, measured)[1]
        worn = (np.abs(shape - ROUND) > WORN) & (kind == 0)
        line = np.array([
            *([np.count_nonzero(dropped & (kind == one)), np.count_nonzero(kind == one)] for one in (1, 2, 3)),
            [np.count_nonzero(dropped & worn), np.count_nonzero(worn)],
            [np.count_nonzero(dropped & (kind == 0)), np.count_nonzero(kind == 0)],
        ])  # fmt: skip
        total += line
        _show(f"  {tool}, {name}", line)
    _show(tool, total)


def _show(name: str, counts: Floats) -> None:
    print(f"{name:34s}" + "".join(f" {100 * part / max(of, 1):7.2f}" for part, of in counts), flush=True)


def dense(seed: int) -> None:
    print(f"{'dense':34s}  single   burst     row    lost   of all")
    found(seed, "dense", lambda rng: dense_at(rng, 20.0), rows=False)


def arms(seed: int) -> None:
    print(f"{'arms':34s}  single   burst     row    lost   of all")
    for tool, count, step in ARMS:
        found(seed, tool, lambda rng, count=count, step=step: arms_at(rng, count, step, 100.0), rows=True)


def _walls(seed: int, off: Callable[[np.random.Generator, tuple[int, ...]], Floats]) -> None:
    print(f"{'wall with spikes dropped / without':34s}    mean   worst   in")
    tools = [("dense", lambda rng: dense_at(rng, 10.0))]
    tools += [(tool, lambda rng, of=(count, step): arms_at(rng, *of, 60.0)) for tool, count, step in ARMS]
    for tool, at in tools:
        ratios = {}
        for number, (name, truth) in enumerate(holes(seed)):
            rng = np.random.default_rng([seed, 22, number])
            depth, toolface = at(rng)
            radius = np.maximum(truth(depth, toolface) + off(rng, depth.shape), 0.03)
            every = hb.Caliper(depth.ravel(), toolface.ravel(), radius.ravel())
            settings = hb.tune(every, bit_diameter=0.216, threads=1).settings
            errors = []
            for caliper in (every, kept(depth, toolface, radius)[0]):
                wall = hb.reconstruct(caliper, threads=1, **vars(settings))
                inside = (wall.depth > 0.5) & (wall.depth < depth.max() - 0.5)
                errors.append(np.sqrt(np.nanmean(np.square(wall.radius - truth(wall.depth, wall.toolface))[inside])))
            ratios[name] = errors[1] / errors[0]
        worst = max(ratios, key=ratios.__getitem__)
        mean = np.exp(np.mean(np.log(list(ratios.values()))))
        print(f"{tool:34s} {mean:7.3f} {ratios[worst]:7.3f}   {worst}", flush=True)


def tails(seed: int) -> None:
    _walls(seed, lambda rng, shape: NOISE * rng.standard_t(2, shape))


def clean(seed: int) -> None:
    _walls(seed, lambda rng, shape: rng.normal(0, NOISE, shape))


ROWS = {"dense": dense, "arms": arms, "tails": tails, "clean": clean}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("row", nargs="*", help=", ".join(ROWS))
    parser.add_argument("seed", type=int)
    given = parser.parse_args()
    for row in given.row or ROWS:
        ROWS[row](given.seed)
