"""Measure the correction of tools off centre: ``python -m bench.accuracy.centres [SEED]``.

Holes of 200 turns of 32 samples, 0.5 mm noise, whose shape changes slowly along the hole. A tool rests 0 to 15 mm off
the axis, or whirls around it at one of `RATES`. The truth is the axis of the bit, in a hole of the bit's size.

The samples of a "crescent" are those of a "round" hole: a circle, which here contains that of the bit and touches it.
Its centre is as far off the bit's axis as its radius is larger than the bit's, and no sample shows it. So a rule that
holds the truth in three deviations in both holes states at least a third of that: "least" is this over the error.

    answered   turns whose centre is known, %
    in 3 s     known centres within three standard deviations on both axes, %
    sigma      median of sigma over the rms error of the known centres
    error      rms error of the known centres, mm
    before     rms error of the samples about the axis of the bit, mm
    after      the same of the recentred samples
    worse      holes in which "after" is more than 1 % larger than "before"
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable

import numpy as np

from bench.accuracy.known_holes import BIT
from helibore.base.arrays import Floats
from helibore.preparation.centre_paths import find_centre_path

TURNS, SAMPLES = 200, 32
RATES = (0.0, 30.0, 84.0, 300.0, -150.0)
OFFSETS = (0.0, 0.003, 0.008, 0.015)
Wall = Callable[[Floats, Floats], Floats]


def _lobe(phi: Floats, at: Floats | float, width: float) -> Floats:
    away = np.abs((phi - at + np.pi) % (2 * np.pi) - np.pi) / np.radians(width / 2)
    return np.maximum(1 - np.square(away), 0)


def oversize(seed: int) -> float:
    """Return how much larger than the bit's the radius of the unworn hole is, metres."""
    return float(np.random.default_rng([seed, 33]).uniform(0, 0.001))


def walls(seed: int) -> dict[str, Wall]:
    """Return the radius of each hole, by turn and direction (radians)."""
    rng = np.random.default_rng([seed, 31])
    at, other = rng.uniform(0, 2 * np.pi, 2)
    wave, deep, over = rng.uniform(100, 200), rng.uniform(0.006, 0.02), oversize(seed)

    def size(turn: Floats) -> Floats:
        return 0.6 + 0.4 * np.sin(2 * np.pi * turn / wave + other)

    def base(turn: Floats, phi: Floats) -> Floats:
        return 0.5 * BIT + over + 0.0003 * np.cos(2 * (phi - other)) + 0.0001 * np.sin(3 * phi + turn / 40)

    return {
        "round": base,
        "crescent": lambda t, p: _crescent(base, over, at, t, p),
        "shallow": lambda t, p: base(t, p) - over + 0.003 * size(t) * _lobe(p, at, 150),
        "breakout": lambda t, p: base(t, p) + deep * size(t) * (_lobe(p, at, 60) + _lobe(p, at + np.pi, 60)),
        "uneven": lambda t, p: base(t, p) + deep * size(t) * (_lobe(p, at, 70) + 0.4 * _lobe(p, at + 3.3, 45)),
        "key seat": lambda t, p: base(t, p) + deep * size(t) * _lobe(p, at, 60),
        "oval": lambda t, p: base(t, p) + 0.3 * deep * size(t) * (1 + np.cos(2 * (p - at))),
        "washout": lambda t, p: base(t, p) + deep * size(t) * _lobe(p, at, 250),
        "all around": lambda t, p: base(t, p) + deep * size(t),
    }


def _crescent(circle: Wall, away: float, at: float, turn: Floats, phi: Floats) -> Floats:
    """Return the radius about the bit's axis of a hole whose own axis lies ``away`` off it towards ``at``."""
    across = away * np.sin(phi - at)
    of = circle(turn, phi + np.arcsin(across / (0.5 * BIT)))
    return np.asarray(away * np.cos(phi - at) + np.sqrt(np.square(of) - np.square(across)))


def measured(wall: Wall, far: float, rate: float, seed: int) -> tuple[Floats, ...]:
    """Return position along the turns, toolface and radius of the samples, their true radius and the true centre."""
    rng = np.random.default_rng([seed, 32])
    position = (np.arange(TURNS * SAMPLES) + 0.6 * rng.random(TURNS * SAMPLES)) / SAMPLES
    angle = 2 * np.pi * position
    begin, slow = rng.uniform(0, 2 * np.pi, 2)
    drift = far * (1 + 0.2 * np.sin(2 * np.pi * position / 150 + slow)) / 1.2
    centre = drift * np.exp(1j * (np.radians(rate) * position + begin + 0.3 * np.sin(position / 60)))
    inner, outer = np.full(angle.size, 0.02), np.full(angle.size, 0.3)
    for _ in range(40):
        middle = 0.5 * (inner + outer)
        point = centre + middle * np.exp(1j * angle)
        inside = np.abs(point) < wall(position, np.angle(point))
        inner, outer = np.where(inside, middle, inner), np.where(inside, outer, middle)
    return position, np.degrees(angle) % 360, inner + rng.normal(0, 5e-4, angle.size), centre


def _row(wall: Wall, far: float, rate: float, seed: int, bit: float | None) -> tuple[float, ...]:
    position, toolface, radius, centre = measured(wall, far, rate, seed)
    path = find_centre_path(toolface, radius, position, bit)
    assert path is not None
    turn = np.arange(TURNS)
    found = path.centres(turn, np.full(TURNS, SAMPLES))
    away = path.at(position)[0]
    truth = np.interp(turn + 0.5, position, centre.real) + 1j * np.interp(turn + 0.5, position, centre.imag)
    known = np.isfinite(found.x)
    x, y = found.x[known] - truth.real[known], found.y[known] - truth.imag[known]
    held = np.maximum(np.abs(x) / found.sigma_x[known], np.abs(y) / found.sigma_y[known]) <= 3
    sigma, error = np.median(np.hypot(found.sigma_x, found.sigma_y)[known]), np.sqrt(np.mean(x**2 + y**2))
    place = away + radius * np.exp(1j * np.radians(toolface))
    pairs = ((radius, np.radians(toolface)), (np.abs(place), np.angle(place)))
    before, after = (1e3 * np.sqrt(np.mean(np.square(r - wall(position, a)))) for r, a in pairs)
    return 100 * known.mean(), 100 * held.mean(), sigma / error, 1e3 * error, before, after, after > 1.01 * before


def main(seed: int, bit: float | None = BIT) -> None:
    print(f"{'bit known' if bit else 'no bit size':24s} answered  in 3 s   sigma   error  before   after   worse")
    for name, wall in walls(seed).items():
        for rates in ((0.0,), RATES[1:]):
            rows = [
                _row(wall, far, rate, seed + number, bit)
                for rate in rates for number, far in enumerate(OFFSETS) if far > 0 or rate == 0
            ]  # fmt: skip
            mean = np.nanmean(np.array(rows), axis=0)
            numbers = f"{mean[0]:8.1f} {mean[1]:7.2f} {mean[2]:7.2f} {mean[3]:7.3f} {mean[4]:7.3f} {mean[5]:7.3f}"
            worse = f"{sum(row[6] for row in rows):.0f} of {len(rows)}"
            print(f"{name + (', still' if len(rates) == 1 else ', whirl'):24s} {numbers} {worse:>9s}", flush=True)
            if bit and name == "round":
                print(f"{'least':24s} {'':16s} {1e3 * np.sqrt(2) * oversize(seed) / 3 / mean[3]:7.2f}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seed", type=int, nargs="?", default=1)
    given = parser.parse_args().seed
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Mean of empty slice|invalid value")
        main(given)
        main(given, None)
