"""Measure diameters from travel times with a velocity that drifts: ``python -m bench.accuracy.mud_velocity [SEED]``.

Wells of 1,200 m with 12 m of casing (8.681 in) every 300 m, 32 samples in each turn of 0.1 m. The velocity drifts by
3 % along the well: evenly, bent, as half a wave, as a wave of 1,200 m, at random. The tool, of 90 mm, rests up to 5 mm
off the axis or whirls; readings have a noise of 0.3 mm, and 1 % have no echo of the wall. "exact": casings have the
stated diameter. "nominal": they differ from it by 0.5 mm (standard deviation), which the setting states. "string": one
casing of nominal diameter from 0 to 600 m, and no other.

    error      rms error of the diameters, %, at the casings' depths and between them
    before     the same with the velocity at the top
    inside     depths (every 10 m) where the true diameter lies within 1.96 standard deviations, %
    sigma      median deviation of the diameter, %
"""

from __future__ import annotations

import argparse

import numpy as np

from helibore.base.arrays import Floats
from helibore.preparation.mud_velocity import find_velocity
from helibore.settings.preparation_settings import Echo, EchoCasing

LENGTH, STEP, HIGH = 1200.0, 300.0, 12.0
INNER, HOLE, TOOL = 0.2205, 0.216, 0.045
DRIFTS = ("even", "bent", "half wave", "wave", "random")


def drift(kind: str, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return depths and the velocity there, as a share of that at the top."""
    depth = np.linspace(0.0, LENGTH + HIGH, 1201)
    along = depth / depth[-1]
    if kind == "random":
        kernel = np.exp(-0.5 * np.square(np.arange(-400, 401) * depth[1] / rng.uniform(250, 600)))
        rough = np.convolve(rng.normal(size=depth.size + 800), kernel, "valid")
        return depth, 1.0 + 0.03 * (rough - rough[0]) / np.ptp(rough)
    shape = {
        "even": along, "bent": np.sqrt(along), "half wave": np.sin(np.pi * along),
        "wave": 0.5 * np.sin(2 * np.pi * along + rng.uniform(0, 6.28)),
    }[kind]  # fmt: skip
    return depth, 1.0 + 0.03 * rng.choice([-1, 1]) * (shape - shape[0])


def measure(kind: str, what: str, seed: int) -> tuple[float, float, float, float]:
    """Return error and error before (%), share inside, and sigma (%) of one well."""
    rng = np.random.default_rng([seed, 77, DRIFTS.index(kind)])
    depth, share = drift(kind, rng)
    velocity = 1500.0
    casings, columns = [], []
    first = 0
    string = INNER + rng.normal(0, 0.0005)
    tops = np.arange(0.0, 600.0, 15.0) if what == "string" else np.arange(0.0, LENGTH + 1, STEP)
    for top in tops:
        casings.append(EchoCasing(float(top), float(top + HIGH), INNER))
        true = string if what == "string" else INNER + (0.0 if what == "exact" else rng.normal(0, 0.0005))
        turns = np.arange(20 if what == "string" else int(HIGH / 0.1))
        at = (top + 0.1 * (turns[:, None] + (np.arange(32) + 0.5) / 32)).ravel()
        toolface = (np.tile(np.arange(32) * 11.25, turns.size) + 0.5 * at) % 360
        away, rate = rng.uniform(0, 0.005), rng.choice([0.0, 0.0, 0.23, 0.83])
        centre = rng.uniform(0, 360) + rate * 360 * np.repeat(turns, 32)
        across = np.radians(toolface - centre)
        radius = np.sqrt((0.5 * true) ** 2 - (away * np.sin(across)) ** 2) - away * np.cos(across)
        if rng.uniform() < 0.5:
            radius = np.where((at - top) % 9.6 < 0.15, radius + 0.008, radius)  # a collar
        radius = radius + rng.normal(0, 0.0003, radius.size)
        lost = rng.uniform(size=radius.size) < 0.01
        radius[lost] += rng.uniform(-0.03, 0.05, lost.sum())
        standoff = (radius - TOOL) / np.interp(at, depth, share)  # with the velocity at the top
        columns.append((at, toolface, TOOL + standoff, np.repeat(turns, 32) + first))
        first += turns.size + 10
    every = [np.concatenate([column[n] for column in columns]) for n in range(4)]
    casings = [EchoCasing(0.0, 600.0, INNER)] if what == "string" else casings
    found = find_velocity(Echo(velocity, TOOL, casing=tuple(casings)), every[0], every[1], every[2], every[3])
    at = np.arange(5.0, LENGTH, 10.0)
    true_velocity = velocity * np.interp(at, depth, share)
    here, sigma = found.at(at)
    part = (HOLE / 2 - TOOL) / (HOLE / 2)
    off, before = part * (here / true_velocity - 1), part * (velocity / true_velocity - 1)
    inside = np.abs(here - true_velocity) <= 1.96 * sigma
    return (100 * float(np.sqrt(np.mean(off**2))), 100 * float(np.sqrt(np.mean(before**2))), 100 * float(inside.mean()),
            100 * part * float(np.median(sigma / here)))  # fmt: skip


def main(seed: int) -> None:
    """Print a row for each drift."""
    print(f"{'drift':12}{'casing':10}{'error':>8}{'worst':>8}{'before':>8}{'inside':>8}{'sigma':>8}")
    for what in ("exact", "nominal", "string"):
        rows = []
        for kind in DRIFTS:
            of = np.array([measure(kind, what, 100 * seed + number) for number in range(20)])
            rows.append(of)
            _print(kind, what, of)
        _print("all", what, np.concatenate(rows))


def _print(kind: str, what: str, of: Floats) -> None:
    error, before = np.sqrt(np.square(of[:, :2]).mean(axis=0))
    print(f"{kind:12}{what:10}{error:8.3f}{of[:, 0].max():8.3f}{before:8.2f}"
          f"{of[:, 2].mean():8.1f}{np.median(of[:, 3]):8.3f}")  # fmt: skip


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seed", type=int, nargs="?", default=1)
    main(parser.parse_args().seed)
