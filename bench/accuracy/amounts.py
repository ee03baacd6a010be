"""Compare the uncertainty of mean diameters and of volumes with their true errors on simulated holes.

    python -m bench.accuracy.amounts [SEEDS] [FIRST]     seeds for each kind of hole (2), and the first seed (1000)

The holes are those of ``bench.accuracy.passage``. A row is one kind of hole, samples a turn with their noise, and
estimator; a "step" is 3 m of hole:

    ratio    mean uncertainty of the mean diameter over its true rms error, of turns and of steps
    covered  true mean diameters within 1.96 times the uncertainty, %, of turns and of steps
"""

from __future__ import annotations

import sys

import numpy as np

import helibore as hb
from bench.accuracy.passage import BIT, KINDS, LENGTH, PITCH, SECTORS, hole
from helibore.base.arrays import Floats

TOOLS = ((200, 0.0005), (64, 0.0005), (64, 0.002), (24, 0.0005), (12, 0.0005))
STEP = 3.0


def compared(kind: str, seed: int, per_turn: int, noise: float, estimator: str) -> tuple[Floats, Floats]:
    """Return error and uncertainty of the mean diameter, (2, rows), of turns and of steps."""
    rng = np.random.default_rng(seed)
    shape = hole(kind, rng)
    count = int(LENGTH / PITCH * per_turn)
    depth, toolface = np.sort(rng.uniform(0, LENGTH, count)), rng.uniform(0, 360, count)
    samples = hb.Caliper(depth, toolface, shape(depth, toolface) + rng.normal(0, noise, count))
    wall = hb.reconstruct(samples, bit_diameter=BIT, estimator=estimator, start_depth=1.0, stop_depth=LENGTH - 1.0)
    logs = wall.logs(sigma=True)
    square = (shape(wall.depth, wall.toolface)[: len(logs) * SECTORS] ** 2).reshape(-1, SECTORS).mean(axis=1)
    steps = logs.by_step(STEP)
    of_steps = [np.mean(square[abs(logs.depth - middle) <= STEP / 2]) for middle in steps.depth]
    return (
        np.array([logs.equivalent_diameter - 2 * np.sqrt(square), logs.diameter_sigma]),
        np.array([steps.equivalent_diameter - 2 * np.sqrt(of_steps), steps.diameter_sigma]),
    )


def main(seeds: range) -> None:
    for kind in KINDS:
        for per_turn, noise in TOOLS:
            for estimator in ("inverse-distance", "automatic"):
                found = [compared(kind, seed, per_turn, noise, estimator) for seed in seeds]
                text = ""
                for name, parts in zip(("turns", "steps"), zip(*found, strict=True), strict=True):
                    error, sigma = np.concatenate(parts, axis=1)
                    known = np.isfinite(sigma)
                    error, sigma = error[known], sigma[known]
                    ratio = sigma.mean() / np.sqrt(np.mean(error**2)) if known.any() else np.nan
                    covered = 100 * np.mean(abs(error) <= 1.96 * sigma) if known.any() else np.nan
                    text += f"  {name}: ratio {ratio:.2f}, covered {covered:5.1f} % of {known.sum()}"
                print(f"{kind:7s} {per_turn:3d} a turn, {1e3 * noise:.1f} mm, {estimator:16s}{text}", flush=True)


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:]]
    first = numbers[1] if len(numbers) > 1 else 1000
    main(range(first, first + (numbers[0] if numbers else 2)))
