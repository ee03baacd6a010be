"""Measure ``estimator="automatic"`` against inverse distance and `hb.tune`; print a table for one seed.

    python -m bench.accuracy.automatic [--class NAME ...] [SEED]

Classes of cases: rotating tools; tools with 2 to 12 arms, one to eight passes, that turn or not; telemetry; heavy
tails; noise twice the shape; holes that change character; radii in steps of 0.1 inch; passes of arms doubled, with the
ratios of the errors. A ratio is the rms error of the automatic wall over that of inverse distance or of the tuned one,
within the hole but for half a metre at its ends; means are geometric. Expected: the errors that the choice states for
the automatic wall over its errors where they can be known: the median, and the share within a factor of 2. Intervals:
the share of vertices with a sigma at which 1.96 sigma holds the truth; and the same of C1 - C2 and of the volume of
turns, whose truth is measured at every degree (that of the volume along the helix, as its vertices). Windows: the ratio
of the errors over inverse distance in each metre of hole, or in as many metres as hold 200 samples, without the
vertices within 5 cm of ledges of more than 2 mm: geometric mean, worst, and the share above 1.10; those of telemetry
are longer than the hole. The last line has costs, in processor time on one thread: of the fit and choice, and of a
vertex with near and far neighbours over one by inverse distance.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

import helibore as hb
from bench.accuracy.known_holes import BIT, HOLES, LENGTH, ROTATING, Hole, positions
from helibore.base.arrays import Floats
from helibore.wall.automatic import choose

EDGE = 0.5
NOISE = 5e-4
STEP = 0.00254  # 0.1 inch
IN_WINDOW, WINDOW = 200, 1.0  # samples, metres: the least of a window
LEDGE = 0.002

Radius = Callable[[Floats, Floats], Floats]


class Case(NamedTuple):
    """One hole and the samples of one tool."""

    name: str
    truth: Radius
    caliper: hb.Caliper


def _sampled(name: str, truth: Radius, at: tuple[Floats, Floats], off: Floats) -> Case:
    return Case(name, truth, hb.Caliper(*at, truth(*at) + off))


def _hole(kind: str, tool: str, seed: int, scale: float = NOISE) -> Case:
    at = positions(tool, seed)
    off = np.random.default_rng([seed, 3]).normal(0, scale, at[0].size)
    return _sampled(f"{kind}, {tool}", Hole(kind, seed).radius, at, off)


def rotating(seed: int) -> Iterator[Case]:
    """Yield five kinds of hole, measured by three rotating tools."""
    yield from (_hole(kind, tool, seed) for kind in HOLES for tool in ROTATING)


def telemetry(seed: int) -> Iterator[Case]:
    """Yield five kinds of hole, measured by few samples."""
    yield from (_hole(kind, "telemetry", seed) for kind in HOLES)


def tails(seed: int) -> Iterator[Case]:
    """Yield five kinds of hole; 3 % of the samples are off by some 3 mm more."""
    for kind in HOLES:
        at = positions("32 a turn", seed)
        rng = np.random.default_rng([seed, 3])
        off = rng.normal(0, NOISE, at[0].size)
        off += (
            (rng.random(off.size) < 0.03) * np.maximum(rng.standard_t(2, off.size), -30.0) * 3e-3
        )  # radii stay above 0
        yield _sampled(kind, Hole(kind, seed).radius, at, off)


def noisy(seed: int) -> Iterator[Case]:
    """Yield a rough hole, whose shape has 1.5 mm rms, with twice as much noise."""
    yield from (_hole("rough", tool, seed, 3e-3) for tool in (*ROTATING, "stick-slip"))


def changing(seed: int) -> Iterator[Case]:
    """Yield a hole that is quiet, then has ledges, then breakouts, measured by five tools."""
    ledges, breakouts = (Hole(kind, seed).radius for kind in ("ledges", "breakout"))

    def truth(depth: Floats, toolface: Floats) -> Floats:
        part = np.digitize(depth, (LENGTH / 3, 2 * LENGTH / 3))
        return np.choose(part, (np.full(depth.shape, 0.109), ledges(depth, toolface), breakouts(depth, toolface)))

    for tool in (*ROTATING, "four arms", "telemetry"):
        at = positions(tool, seed)
        yield _sampled(tool, truth, at, np.random.default_rng([seed, 3]).normal(0, NOISE, at[0].size))


def quantised(seed: int) -> Iterator[Case]:
    """Yield five kinds of hole; radii have steps of 0.1 inch."""
    for kind in HOLES:
        case = _hole(kind, "32 a turn", seed)
        of = case.caliper
        yield case._replace(caliper=hb.Caliper(of.depth, of.toolface, np.round(of.radius / STEP) * STEP))


def _by_arms(rng: np.random.Generator, count: int, name: str, passes: int | None) -> Case:
    """Return a hole measured by biased arms that turn or not; ``passes`` None: some number of them, drawn."""

    def oval(depth: Floats, toolface: Floats) -> Floats:
        return np.asarray(0.112 + 0.005 * np.cos(2 * np.radians(toolface - start)) + 0 * depth)

    def breakout(depth: Floats, toolface: Floats) -> Floats:
        away = (toolface - start - turn * depth + 90.0) % 180.0 - 90.0
        return np.asarray(0.109 + 0.016 * np.exp(-((away / 22.0) ** 2)) * (0.8 + 0.2 * np.sin(depth / 2)))

    start, turn = rng.uniform(0, 360), 8.0 if name == "turning breakout" else 0.0
    passes, rate = passes or int(rng.choice([1, 2, 4, 8])), float(rng.choice([0.0, 3.0, 12.0]))
    depth = np.arange(0, LENGTH, 0.05)
    first = rng.uniform(0, 360, passes)
    at = np.tile(depth, passes * count)
    toolface = np.concatenate([
        first[number] + rate * depth + arm * 360 / count for number in range(passes) for arm in range(count)
    ])  # fmt: skip
    bias = np.repeat(rng.normal(0, 3e-4, count), depth.size)
    off = np.tile(bias, passes) + rng.normal(0, NOISE, at.size)
    shape = oval if name == "oval" else breakout
    case = _sampled(f"{count} arms, {passes} passes, {rate:g} deg/m, {name}", shape, (at, toolface % 360), off)
    of, arm = case.caliper, np.tile(np.repeat(np.arange(count), depth.size), passes)
    return case._replace(caliper=hb.Caliper(of.depth, of.toolface, of.radius, arm=arm))


ARMS, SHAPES, PASSES = (2, 3, 4, 6, 8, 12), ("oval", "breakout", "turning breakout"), (1, 2, 4, 8)


def arms(seed: int) -> Iterator[Case]:
    """Yield tools with 2 to 12 arms in three holes, with some number of passes, turning or not; arms are biased."""
    rng = np.random.default_rng([seed, 4])
    yield from (_by_arms(rng, count, name, None) for count in ARMS for name in SHAPES)


def doubled(seed: int) -> Iterator[Case]:
    """Yield the cases of arms with 1, 2, 4 and 8 passes; more passes contain the samples of fewer."""
    rng = np.random.default_rng([seed, 9])
    for count in ARMS:
        for name in SHAPES:
            case = _by_arms(rng, count, name, PASSES[-1])
            for passes in PASSES:
                of, rows = case.caliper, slice(0, case.caliper.depth.size * passes // PASSES[-1])
                part = hb.Caliper(of.depth[rows], of.toolface[rows], of.radius[rows], arm=np.asarray(of.arm)[rows])
                yield Case(f"the first {passes} of {case.name}", case.truth, part)


CLASSES: dict[str, tuple[Callable[[int], Iterator[Case]], bool]] = {
    "rotating": (rotating, True), "arms": (arms, False), "telemetry": (telemetry, True), "tails": (tails, True),
    "noisy": (noisy, True), "changing": (changing, False), "quantised": (quantised, False),
    "doubled": (doubled, False),
}  # fmt: skip
"""Makers of the cases of each class, and whether the tuned wall is measured too."""


class Measured(NamedTuple):
    """Ratios of the automatic wall's error, and its intervals."""

    name: str
    error: float  # rms, mm
    over_inverse: float
    over_tuned: float
    expected: float  # stated error over the error where a sigma is known
    holds: float  # share of the vertices with a sigma
    stated: float  # share of the vertices that have a sigma
    shape_holds: float  # share of the turns with an uncertainty of C1 - C2
    volume_holds: float
    estimator: str
    windows: tuple[float, ...]  # error over inverse distance, of each


def window_ratios(case: Case, at: tuple[Floats, Floats], errors: tuple[Floats, Floats]) -> tuple[float, ...]:
    """Return the ratio of the rms errors of two walls at vertices, in each window of the hole."""
    ends = [EDGE]
    measured = np.sort(case.caliper.depth)
    while ends[-1] < LENGTH - EDGE:
        last = np.searchsorted(measured, ends[-1]) + IN_WINDOW - 1
        ends.append(max(ends[-1] + WINDOW, measured[last] if last < measured.size else np.inf))
    change = case.truth(at[0] + 0.05, at[1]) - case.truth(at[0] - 0.05, at[1])
    away, window = np.abs(change) <= LEDGE, np.digitize(at[0], ends)
    found = []
    for number in range(1, len(ends) - (ends[-1] > LENGTH - EDGE)):
        of, other = (each[away & (window == number)] for each in errors)
        if np.isfinite(of).any():
            found.append(float(np.sqrt(np.nanmean(of**2) / np.nanmean(other**2))))
    return tuple(found)


def turns_hold(case: Case, logs: hb.Logs) -> tuple[float, float]:
    """Return the shares of the turns whose C1 - C2 and volume are within 1.96 times their uncertainty.

    The truth of C1 - C2 lies at one depth, that of the volume along the helix, as the vertices of the turn do.
    """
    inside = np.flatnonzero((logs.depth > EDGE) & (logs.depth < LENGTH - EDGE))
    toolface = np.arange(360.0)
    at = np.repeat(logs.depth[inside], toolface.size), np.tile(toolface, inside.size)
    radius = case.truth(*at).reshape(-1, toolface.size)
    across, turn = radius + np.roll(radius, -180, axis=1), np.arange(inside.size)
    greatest = np.argmax(across, axis=1)
    shape = across[turn, greatest] - across[turn, (greatest + 90) % 360]
    along = case.truth(at[0] + (at[1] / 360.0 - 0.5) * logs.pitch, at[1]).reshape(radius.shape)
    volume = np.pi * np.mean(along**2, axis=1) * logs.pitch
    found = []
    for real, value, sigma in (
        (shape, logs.c1 - logs.c2, logs.c1_c2_sigma),
        (volume, logs.volume, logs.volume_sigma),
    ):
        known = np.isfinite(sigma[inside])
        held = np.abs(value[inside] - real)[known] <= 1.96 * sigma[inside][known]
        found.append(float(np.mean(held)) if known.any() else np.nan)
    return found[0], found[1]


def measure(case: Case, tuned: bool) -> Measured:
    """Build the walls of a case, and compare them with the truth."""
    choice = choose(case.caliper, hb.Settings(bit_diameter=BIT, estimator="automatic"))
    found = hb.reconstruct(case.caliper, threads=1, **vars(choice.settings))
    inside = (found.depth > EDGE) & (found.depth < LENGTH - EDGE)
    truth = case.truth(found.depth, found.toolface)

    def rms(wall: hb.Wall) -> float:
        return float(np.sqrt(np.nanmean((wall.radius - truth)[inside] ** 2)))

    error, over_tuned = rms(found), np.nan
    simple = hb.reconstruct(case.caliper, bit_diameter=BIT, threads=1, estimator="inverse-distance")
    over_inverse = error / rms(simple)
    windows = window_ratios(case, (found.depth, found.toolface), (found.radius - truth, simple.radius - truth))
    if tuned:
        best = hb.tune(case.caliper, bit_diameter=BIT, threads=1).settings
        over_tuned = error / rms(hb.reconstruct(case.caliper, threads=1, **vars(best)))
    sigma = found.sigma
    known = inside & np.isfinite(sigma)
    holds = np.mean((np.abs(found.radius - truth) <= 1.96 * sigma)[known]) if known.any() else np.nan
    stated = float(known.sum() / inside.sum())
    real = np.sqrt(np.mean((found.radius - truth)[known] ** 2)) if known.any() else np.nan
    expected = choice.errors.get(found.settings.estimator, np.nan) / real
    ratios, intervals = (over_inverse, over_tuned, float(expected)), (float(holds), stated)
    of_turns = turns_hold(case, found.logs(sigma=True))
    return Measured(case.name, 1e3 * error, *ratios, *intervals, *of_turns, found.settings.estimator, windows)


def _pairs(errors: list[float]) -> str:
    """Return the ratios of the errors with twice as many passes; ``errors`` are those of `doubled`."""
    of = np.array(errors).reshape(-1, len(PASSES))
    ratios = (of[:, 1:] / of[:, :-1]).ravel()
    return f"passes doubled: {_ratio(ratios.tolist())}; {np.sum(ratios > 1.08)} of {ratios.size} above 1.08"


def _ratio(of: list[float]) -> str:
    known = np.array([each for each in of if np.isfinite(each)])
    return f"{np.exp(np.log(known).mean()):.3f}, {known.max():.3f}" if known.size else "-"


def _windows(of: list[float]) -> str:
    return f"{_ratio(of)}, {100 * np.mean(np.array(of) > 1.1):.1f} % of {len(of)}" if of else "-"


def _expected(of: list[float]) -> str:
    known = np.log2(of)[np.isfinite(of)]
    return f"{2 ** np.median(known):.2f}, {100 * np.mean(np.abs(known) <= 1):.0f} %" if known.size else "-"


def _shares(of: list[float]) -> str:
    known = 100 * np.array([each for each in of if np.isfinite(each)])
    return f"{known.mean():.1f}, {known.min():.0f}" if known.size else "-"


def costs(seed: int) -> str:
    """Return as text the cost of the fit and choice, and of a vertex with near and far neighbours."""
    case = _hole("breakout", "64 a turn", seed)

    def seconds(work: Callable[[], object]) -> float:
        start = time.process_time()
        work()
        return time.process_time() - start

    def wall(**estimator: Any) -> hb.Wall:
        return hb.reconstruct(case.caliper, bit_diameter=BIT, threads=1, pitch=0.02, **estimator)

    covariance = (0.11, 2.3e-7, 1.1e-7, 0.059, 0.11, 3.5e-5, 0.074, 19.0)
    fit = seconds(lambda: choose(case.caliper, hb.Settings(bit_diameter=BIT, estimator="automatic")))
    both = ({"estimator": "inverse-distance"}, {"estimator": "near-and-far", "covariance": covariance})
    pairs = [[seconds(lambda of=of: wall(**of)) for of in both] for _ in range(5)]
    simple, far = np.min(pairs, axis=0)
    return f"fit and choice {fit:.1f} s; vertex with near and far neighbours {far / simple:.1f} x inverse distance"


def main() -> None:
    """Measure the classes, and print a line for each case and each class."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--class", dest="classes", action="append", choices=CLASSES)
    parser.add_argument("seed", type=int, nargs="?", default=601)
    given = parser.parse_args()
    rows = []
    for name in given.classes or CLASSES:
        make, tuned = CLASSES[name]
        found = []
        for case in make(given.seed):
            found.append(measure(case, tuned))
            *shown, windows = found[-1]
            text = ", ".join(f"{of:.3f}" if isinstance(of, float) else str(of) for of in shown)
            print(f"{name}: {text}; windows {_windows(list(windows))}", flush=True)
        shares = [[of.holds for of in found], [of.shape_holds for of in found], [of.volume_holds for of in found]]
        interval = " | ".join(_shares(of) for of in shares)
        over = _ratio([of.over_inverse for of in found]), _ratio([of.over_tuned for of in found])
        stated = _expected([of.expected for of in found])
        if name == "doubled":
            print(_pairs([of.error for of in found]))
        by_window = _windows([each for of in found for each in of.windows])
        rows.append(f"| {name} | {len(found)} | {over[0]} | {over[1]} | {stated} | {interval} | {by_window} |")
    print(
        "\n| class | cases | over inverse distance: mean, worst | over tuned | expected | intervals, %: mean, worst "
        "| C1-C2 | volume | windows |"
    )
    print("\n".join(["| --- | --- | --- | --- | --- | --- | --- | --- | --- |", *rows]))
    print(costs(given.seed))


if __name__ == "__main__":
    main()
