"""Compare the automatic and the tuned wall with the least errors that the classes telemetry and noisy allow.

    python -m bench.accuracy.least_error [--family] [SEED ...]

Linear: kriging of all samples of a case by the true noise and the mean and covariance of all holes that the generator
of its kind draws (`known_holes`; from its formulas, averaged over depth): no linear estimate that knows no more than
the kind of hole has less error in the mean. An estimate that knows more, for example that the waves of a rough hole
are 14, may have less. Family (slow): kriging with near and far neighbours, by the covariance of our family that makes
the error least in this very case: no way to find its parameters does better. A ratio is an rms error over that of the
tuned wall.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from scipy.optimize import minimize

import helibore as hb
from bench.accuracy.automatic import EDGE, NOISE, Case, noisy, telemetry
from bench.accuracy.known_holes import BIT, HOLES, LENGTH
from helibore.base.arrays import Floats
from helibore.settings.wall_settings import Settings
from helibore.wall.automatic import near_and_far
from helibore.wall.covariance import covariance_of, fit_covariance
from helibore.wall.estimates import in_depth_order

CLASSES = "telemetry", "noisy"
GAUGE = 0.109
WAVES = (6, 0.3, 3.0), (20, 0.05, 0.5)  # of known_holes: most around, shortest and longest along (m)
STEP, NEAREST, FARTHEST = 0.015, 0.3, 1.5  # metres: greatest step of ledges, and their distances
PERIOD = 30.0  # metres, of the waves by which the noisy class is kriged
LONG = 200.0  # metres, longer than the hole
_STARTS = (1e-6, 0.05, 0.5, 2e-5, 0.1, 30.0, 3e-7), (2e-5, 4.0, 0.4, 1e-6, 0.06, 0.5, 1e-6)
_TRIALS = 250


@cache
def _tables(which: int) -> tuple[Floats, Floats, Floats, Floats]:
    around, least, most = WAVES[which]
    numbers, lengths = np.arange(-around, around + 1), np.exp(np.linspace(np.log(least), np.log(most), 1001))
    degrees, metres = np.linspace(0.0, 360.0, 1441), np.linspace(0.0, LENGTH, 4001)
    by_turn: Floats = np.cos(np.radians(degrees)[:, None] * numbers).mean(axis=1)
    by_depth: Floats = np.cos(2 * np.pi * metres[:, None] / lengths).mean(axis=1)
    return degrees, by_turn, metres, by_depth


def _of_waves(which: int, turn: Floats, along: Floats) -> Floats:
    """Return the correlation of two places of a rough hole; ``turn`` in degrees, ``along`` in metres."""
    degrees, by_turn, metres, by_depth = _tables(which)
    found: Floats = np.interp(turn % 360.0, degrees, by_turn) * np.interp(np.abs(along), metres, by_depth)
    return found


def _of_shape(shape: Floats, turn: Floats) -> Floats:
    """Return the mean product of a shape, at each half degree, with itself turned."""
    product = np.fft.ifft(np.abs(np.fft.fft(shape)) ** 2).real / shape.size
    found: Floats = np.interp(turn % 360.0, np.arange(shape.size + 1) / 2.0, np.append(product, product[0]))
    return found


def moments(kind: str, turn: Floats, along: Floats) -> tuple[float, Floats]:
    """Return the mean radius of all holes of a kind (m), and the covariance of two radii (m^2) by their differences."""
    toolface = np.arange(0.0, 360.0, 0.5)
    away = np.maximum(1.0 - (((toolface + 90.0) % 180.0 - 90.0) / 35.0) ** 2, 0.0) ** 2
    seat = np.exp(-((((toolface + 180.0) % 360.0 - 180.0) / 20.0) ** 2))
    gap = np.clip(np.abs(along), 0.0, FARTHEST)  # the same ledge: none in between
    inner = np.maximum(NEAREST - gap, 0.0) + (FARTHEST - np.maximum(gap, NEAREST)) ** 2 / (2 * (FARTHEST - NEAREST))
    ledges = STEP**2 / 12.0 * inner / (0.5 * (NEAREST + FARTHEST))
    if kind == "breakout":
        product = 0.018**2 * _of_shape(away, turn) * (0.49 + 0.045 * np.cos(along / 3))
        mean, rest = 0.018 * 0.7 * away.mean(), 9e-8 * _of_waves(0, turn, along)
    elif kind == "key seat":
        product, mean, rest = 0.03**2 * _of_shape(seat, turn), 0.03 * seat.mean(), 4e-8 * _of_waves(0, turn, along)
    elif kind == "ledges":
        product, mean, rest = STEP**2 / 4 + 0.0 * turn, STEP / 2, ledges + 9e-8 * _of_waves(0, turn, along)
    elif kind == "rough":
        product, mean, rest = 0.0 * turn, 0.0, 2.25e-6 * _of_waves(0, turn, along)
    else:
        there = 0.5 * (1.0 - np.abs((2 * along / np.pi + 1.0) % 2.0 - 1.0))  # both within a stretch of breakouts
        on, steps = 0.012 * away.mean(), STEP / 4
        product = 0.012**2 * _of_shape(away, turn) * there + on * steps + steps**2
        mean, rest = 0.5 * on + steps, 0.25 * ledges + 1e-6 * _of_waves(0, turn, along)
        rest = rest + 6.4e-7 * _of_waves(1, turn, along)
    return GAUGE + mean, product - mean**2 + rest


def linear(kind: str, of: hb.Caliper, noise: float, depth: Floats, toolface: Floats) -> Floats:
    """Return the radii (m) at places by simple kriging of all samples."""
    mean, among = moments(kind, of.toolface[:, None] - of.toolface, of.depth[:, None] - of.depth)
    weights = np.linalg.solve(among + noise**2 * np.eye(of.depth.size), of.radius - mean)
    found = [
        moments(kind, toolface[rows, None] - of.toolface, depth[rows, None] - of.depth)[1] @ weights
        for rows in np.array_split(np.arange(depth.size), 1 + depth.size // 1000)
    ]
    return mean + np.concatenate(found)


def linear_of_waves(of: hb.Caliper, noise: float, depth: Floats, toolface: Floats) -> Floats:
    """Return what `linear` would for a rough hole, whose samples may be many: by the amplitudes of its waves."""
    around, least, most = WAVES[0]
    along = 2 * np.pi / PERIOD * np.arange(1, int(PERIOD / least) + 2)
    ends = np.clip(np.append(along, along[-1] + along[0]) - along[0] / 2, 2 * np.pi / most, 2 * np.pi / least)
    share = np.diff(np.log(ends)) / np.log(most / least)
    along, share = along[share > 0], share[share > 0]
    variance = 2.25e-6 * np.repeat(share, 2 * (2 * around + 1)) / (2 * around + 1)

    def waves(depth: Floats, toolface: Floats) -> Floats:
        by_turn = np.radians(toolface)[:, None] * np.arange(-around, around + 1)
        phase = (depth[:, None, None] * along[:, None] + by_turn[:, None]).reshape(depth.size, -1)
        return np.stack([np.cos(phase), np.sin(phase)], axis=-1).reshape(depth.size, -1)

    matrix, side = np.diag(noise**2 / variance), np.zeros(variance.size)
    for rows in np.array_split(np.arange(of.depth.size), 1 + of.depth.size // 4000):
        part = waves(of.depth[rows], of.toolface[rows])
        matrix += part.T @ part
        side += part.T @ (of.radius[rows] - GAUGE)
    return GAUGE + waves(depth, toolface) @ np.linalg.solve(matrix, side)


def _least_of_family(caliper: hb.Caliper, error: Callable[[hb.Wall], float]) -> float:
    """Return the least error (m) of a wall with near and far neighbours, whatever its covariance."""
    fitted = fit_covariance(in_depth_order(caliper))
    assert fitted is not None
    limits = np.log([(1e-12, 1e-2), (0.004, 40 * fitted.radius), (0.004, LONG)] * 2 + [(1e-12, 1e-2)]).T

    def by_family(logs: Floats) -> float:
        *terms, variance = np.exp(np.clip(logs, *limits)).tolist()
        chosen = near_and_far(covariance_of((fitted.radius, variance, *terms)), Settings(bit_diameter=BIT))
        wall = hb.reconstruct(caliper, threads=1, **vars(replace(chosen, neighbors=21)))
        return 1e3 * error(wall)

    first = np.array([*(value for term in fitted.terms[:2] for value in term), fitted.noise])
    found = [
        minimize(by_family, np.log(start), method="Nelder-Mead", options={"maxfev": _TRIALS, "xatol": 0.05}).fun
        for start in (first, *_STARTS)
    ]
    return 1e-3 * float(min(found))


def errors(case: Case, kind: str, noise: float, family: bool) -> dict[str, float]:
    """Return the rms errors (m) of the walls of a case, and the two bounds."""
    usual: dict[str, Any] = {"bit_diameter": BIT, "threads": 1}
    tuned = hb.reconstruct(case.caliper, threads=1, **vars(hb.tune(case.caliper, **usual).settings))
    inside = (tuned.depth > EDGE) & (tuned.depth < LENGTH - EDGE)
    depth, toolface = tuned.depth[inside], tuned.toolface[inside]
    truth = case.truth(depth, toolface)

    def rms(radius: Floats) -> float:
        return float(np.sqrt(np.nanmean((radius - truth) ** 2)))

    bound = linear_of_waves if kind == "rough" else lambda *given: linear(kind, *given)
    return {
        "tuned": rms(tuned.radius[inside]),
        "automatic": rms(hb.reconstruct(case.caliper, estimator="automatic", **usual).radius[inside]),
        "linear": rms(bound(case.caliper, noise, depth, toolface)),
        **({"family": _least_of_family(case.caliper, lambda wall: rms(wall.radius[inside]))} if family else {}),
    }


def ratios(name: str, seed: int, family: bool = False) -> Iterator[tuple[str, dict[str, float]]]:
    """Yield for each case of a class its name, and the errors over that of the tuned wall."""
    cases = zip(HOLES, telemetry(seed), strict=True) if name == "telemetry" else (("rough", of) for of in noisy(seed))
    for kind, case in cases:
        found = errors(case, kind, NOISE if name == "telemetry" else 3e-3, family)
        yield case.name, {key: value / found["tuned"] for key, value in found.items() if key != "tuned"}


def means(found: list[dict[str, float]]) -> dict[str, float]:
    """Return the geometric means of ratios."""
    return {key: float(np.exp(np.mean([np.log(each[key]) for each in found]))) for key in found[0]}


def _text(of: dict[str, float]) -> str:
    return ", ".join(f"{key} {value:.3f}" for key, value in of.items())


def main(seeds: list[int], family: bool) -> None:
    """Print the ratios of each case, and their means."""
    for name in CLASSES:
        for seed in seeds:
            found = []
            for case, of in ratios(name, seed, family):
                found.append(of)
                print(f"{name} {seed}, {case}: {_text(of)}", flush=True)
            print(f"{name} {seed}, mean: {_text(means(found))}")


if __name__ == "__main__":
    given = [each for each in sys.argv[1:] if each != "--family"]
    main([int(seed) for seed in given] or [301], "--family" in sys.argv)
