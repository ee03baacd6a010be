"""The probability of each kind of a zone: its sections are compared with a library of sections.

    d = radius - bit/2, mean in each of 32 parts of the turn; a part without a sample says nothing
    chi^2 of a section s = min over the tool's offset (x, y) of sum w (d - s - x cos - y sin)^2 + (x^2 + y^2) / (7 mm)^2
    evidence of a kind = mean over its sections of sum over scales f of p(f) f^-n exp(-chi^2 / 2 f^2)

The library has round, oval and lobed sections of many sizes, widths and directions, and slots of pipes. The criteria
say of which kind each of them is, as of a turn (`helibore.logs.zone_criteria`). The factor f lets holes differ from the
library more than `ROUGH`, so that other shapes do not make it too sure. A zone that no gauge section explains is not
gauge, however little it resembles the other kinds; if no section at all explains it, its kind is not sure. Lengths are
those of a hole of 8.5 in, scaled to the bit. ``python -m bench.accuracy.hazards`` measures how often the probabilities
are right.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers, Mask, runs_of
from helibore.base.units import INCH
from helibore.settings.zone_settings import CRITERIA_BIT, Criteria

PARTS = 32
"""Parts of a turn in a section."""
ROUGH = 1.6e-3
"""Metres; standard deviation of a part of the wall from a section of the library."""
OFFSET = 7e-3
"""Metres; standard deviation of the tool's distance from the hole's centre, in each of two directions."""
EFFECTIVE = 24.0
"""Most parts of a turn that count as independent."""
SCALES = {1.0: 0.5, 1.6: 0.3, 2.6: 0.15, 4.2: 0.05}
"""Prior of the factor by which a hole differs more from the library than `ROUGH`."""
INDEPENDENT = 1.0
"""Sections of a zone that count as independent: all differ from the library alike."""
EXPLAINED = 2.6
"""A zone may be gauge if a gauge section lies within so many times `ROUGH` of its own, rms."""
RESEMBLES = 0.35
"""Nor is a kind sure if the nearest section differs by more than this share of the zone's own rms, and not in small."""
PRIOR = (0.4, 0.15, 0.15, 0.15, 0.15)
"""Prior of gauge, washout, breakout, key seat and undergauge hole, where turns meet a criterion."""
WINDOWS = (0.1, 0.3, 0.5)
"""Lengths of the windows that a chain along the hole takes turns together in, metres."""
SEEN = 14
"""Mean number of parts that a window must see; else it is longer, up to the last of `WINDOWS`."""
STAYS, CHANGES = 0.8, 0.1
"""Probability that the section stays the same over a metre, and that it keeps its kind if it changes."""
TEMPER = 0.7
"""Power of the evidence of a window, since windows differ from the library alike."""
ALONG_PRIOR = (0.68, 0.1, 0.1, 0.06, 0.06)
"""Prior of the kinds along the hole; `PRIOR` is that of turns which meet a criterion."""
_BLOCK, _BESIDE = 400, 20  # windows at once, and how many beside them count
_FINE = 6 * PARTS  # toolfaces at which a section of the library is drawn


class Along(NamedTuple):
    """What the chain finds along a hole.

    ``kinds``: (turns, 5) probability of each kind. ``seen``: (turns,) parts that samples see around a turn.
    ``square``, ``square_sigma``: (turns,) mean squared radius, m2, and its standard deviation among likely sections.
    """

    kinds: Floats
    seen: Integers
    square: Floats
    square_sigma: Floats


def kind_probabilities(sections: Floats, bit_diameter: float, criteria: Criteria, even: bool) -> tuple[Floats, bool]:
    """Return the probability of gauge, washout, breakout, key seat and undergauge hole, (5,), and whether it is sound.

    It is not sound if no section of the library resembles the zone: then it only says which one is the least unlike.

    Parameters
    ----------
    sections
        (n, PARTS) radius less half the bit diameter, metres; part p is around the toolface p 360 / PARTS. NaN: no
        sample.
    bit_diameter
        Metres.
    criteria
        They say of which kind each section of the library is.
    even
        Whether the tool measures diameters, whose two ends have equal radii.
    """
    shapes, kind, _ = _library(bit_diameter, criteria, even)
    square, count = _compared(sections, shapes)
    best = square.min(axis=1, keepdims=True)
    terms = [np.log(prior) - count * np.log(scale) - best[:, 0] / (2 * scale**2) for scale, prior in SCALES.items()]
    highest = np.max(terms, axis=0)
    likelihood = np.zeros_like(square)
    for term, scale in zip(terms, SCALES, strict=True):
        likelihood += np.exp(term - highest)[:, None] * np.exp((best - square) / (2 * scale**2))
    evidence = np.full((len(sections), len(PRIOR)), -700.0)
    for code in range(len(PRIOR)):
        if (kind == code).any():
            evidence[:, code] = np.log(np.maximum(likelihood[:, kind == code].mean(axis=1), 1e-300))
    total = np.log(PRIOR) + INDEPENDENT * evidence.mean(axis=0)
    misfit = square / np.maximum(count, 1)[:, None]
    if misfit[:, kind == 0].min(axis=1).mean() > EXPLAINED**2:
        total[0] = -np.inf
    own = np.nansum(sections**2) / max(np.isfinite(sections).sum(), 1) / ROUGH**2
    explained = misfit.min(axis=1).mean() <= max(EXPLAINED**2, RESEMBLES**2 * own)
    odds = np.exp(total - total.max())
    return odds / odds.sum(), bool(explained)


def kinds_along(
    sections: Floats,
    height: float,
    bit_diameter: float,
    criteria: Criteria,
    even: bool,
    wanted: Mask,
    threads: int,
) -> Along:
    """Return the probability of each kind and the likely size along a hole.

    It is for tools that have few samples a turn. Turns are taken together in windows. A chain carries the section of
    the library along the hole: from one window to the next it stays, changes within its kind, or becomes any section
    (`STAYS`, `CHANGES`), so that windows which see other parts of one shape add up. Parameters as of
    `kind_probabilities`; ``height`` is that of a turn, metres. Only the turns ``wanted``, (turns,), have values, which
    windows beside them decide as well; the others are NaN.
    """
    turns, gathered = _windows(sections, height)
    steps = len(gathered)
    likely = np.full((steps, len(PRIOR) + 2), np.nan)
    library = _library(bit_diameter, criteria, even)
    needed = np.pad(wanted, (0, steps * turns - len(wanted))).reshape(steps, turns).any(axis=1)
    for first, last in runs_of(np.convolve(needed, np.ones(2 * _BESIDE + 1), "same") > 0):
        for start in range(first, last, _BLOCK):
            stop = min(start + _BLOCK, last)
            low, high = max(start - _BESIDE, 0), min(stop + _BESIDE, steps)
            chained = _chained(gathered[low:high], turns * height, *library, threads)
            likely[start:stop] = chained[start - low : stop - low]
    likely[~needed] = np.nan
    seen = np.isfinite(gathered).sum(axis=1)
    every = np.repeat(likely, turns, axis=0)[: len(sections)]
    kinds, square, variance = every[:, :-2], every[:, -2], every[:, -1] - every[:, -2] ** 2
    return Along(kinds, np.repeat(seen, turns)[: len(sections)], square, np.sqrt(np.maximum(variance, 0)))


def _windows(sections: Floats, height: float) -> tuple[int, Floats]:
    """Return the turns of a window and the mean section of each: the shortest windows that see `SEEN` parts or more."""
    known = np.isfinite(sections)
    for length in WINDOWS:
        turns = max(1, round(length / height))
        steps = -(-len(sections) // turns)
        more = ((0, steps * turns - len(sections)), (0, 0))
        count = np.pad(known, more).reshape(steps, turns, PARTS).sum(axis=1)
        if (count > 0).sum(axis=1).mean() >= SEEN:
            break
    total = np.pad(np.where(known, sections, 0.0), more).reshape(steps, turns, PARTS).sum(axis=1)
    return turns, np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0)


def _chained(windows: Floats, step: float, shapes: Floats, kind: Integers, size: Floats, threads: int) -> Floats:
    """Return what is known in windows of the length ``step``, metres, (windows, 7).

    It is the probability of each kind, then the means of the squared radius and of its square.
    """
    order = np.argsort(kind, kind="stable")
    a, b, c, d, e = np.bincount(kind, minlength=len(PRIOR)).tolist()
    stays = STAYS**step
    middle = float(size.mean())  # the core has floats: those near 0 are finer
    kinds, mean, square = _core.likely_along(
        windows.ravel(), shapes[order].ravel(), (a, b, c, d, e), size[order] - middle,
        ALONG_PRIOR, (stays, (1 - stays) * CHANGES, ROUGH, OFFSET, EFFECTIVE, TEMPER), list(SCALES.items()), threads,
    )  # fmt: skip
    off = [middle + mean, square + 2 * middle * mean + middle**2]
    return np.column_stack([kinds.reshape(len(windows), len(PRIOR)), *off])


def _compared(sections: Floats, shapes: Floats) -> tuple[Floats, Floats]:
    """Return chi^2 of each section with each shape, and how many independent parts each section has."""
    known = np.isfinite(sections)
    used = known.sum(axis=1)
    weight = known * (np.minimum(1.0, EFFECTIVE / np.maximum(used, 1)) / ROUGH**2)[:, None]
    return _squares(np.where(known, sections, 0.0), weight, shapes), np.minimum(used, EFFECTIVE)


def _squares(section: Floats, weight: Floats, shapes: Floats) -> Floats:
    """Return chi^2 of each section with each shape, (n, shapes), least over the tool's offset."""
    angle = np.arange(PARTS) * 2 * np.pi / PARTS
    around = (np.cos(angle), np.sin(angle))
    weighted = weight * section
    square = (weighted * section).sum(axis=1)[:, None] - 2 * weighted @ shapes.T + weight @ (shapes * shapes).T
    x, y = ((weighted * of).sum(axis=1)[:, None] - (weight * of) @ shapes.T for of in around)
    xx, yy = ((weight * of**2).sum(axis=1)[:, None] + OFFSET**-2 for of in around)
    xy = (weight * around[0] * around[1]).sum(axis=1)[:, None]
    least: Floats = square - (yy * x**2 - 2 * xy * x * y + xx * y**2) / (xx * yy - xy**2)
    return least


@lru_cache(maxsize=4)
def _library(bit_diameter: float, criteria: Criteria, even: bool) -> tuple[Floats, Integers, Floats]:
    """Return sections, (m, PARTS), radius less half the bit diameter in metres, their kinds and mean squared radii."""
    fine, lower, higher = _drawn(bit_diameter)
    diameter = bit_diameter + fine[:, : _FINE // 2] + fine[:, _FINE // 2 :]
    row, largest = np.arange(len(fine)), diameter.argmax(axis=1)
    c1, c2 = diameter[row, largest], diameter[row, (largest + _FINE // 4) % (_FINE // 2)]
    both = (lower > 0) & (2 * lower >= criteria.symmetry * (lower + higher))
    kind = np.zeros(len(fine), dtype=np.int64)
    kind[both & (c1 - c2 >= criteria.elongation)] = 2
    kind[~both & (higher >= criteria.key_seat)] = 3
    kind[c2 - bit_diameter >= criteria.washout] = 1
    kind[diameter.min(axis=1) < bit_diameter - criteria.undergauge] = 4
    first = (
        len(kind) % PARTS
    )  # after the round ones, each section comes in all directions: the kind of all is the first's
    kind[first:] = np.repeat(kind[first::PARTS], PARTS)
    part = (np.arange(_FINE) * PARTS + _FINE // 2) // _FINE % PARTS
    into = (part[:, None] == np.arange(PARTS)).astype(np.float64)
    shapes = fine @ (into / into.sum(axis=0))
    size = np.mean((bit_diameter / 2 + fine) ** 2, axis=1)
    return (shapes + np.roll(shapes, PARTS // 2, axis=1)) / 2 if even else shapes, kind, size


def _drawn(bit_diameter: float) -> tuple[Floats, Floats, Floats]:
    """Return radii less half the bit diameter, (m, _FINE), and the heights of the lower and the higher lobe, metres."""
    mm = 1e-3 * bit_diameter / CRITERIA_BIT
    degrees = np.arange(_FINE) * 360 / _FINE
    angle = np.radians(degrees)
    away = np.abs((degrees + 180) % 360 - 180)
    rounded = [(np.full(_FINE, size), 0.0, 0.0) for size in
               (-11, -8, -6, -4.5, -2.5, -1.2, 0, 1.2, 2.5, 4, 8, 11, 15, 20, 27, 36, 48)]  # fmt: skip
    turned = [(size + half * np.cos(2 * angle), 0.0, 0.0) for size in (0, 2) for half in (1.5, 3, 4.5)]
    turned += [(size + 2 * np.cos(2 * angle), 0.0, 0.0) for size in (-8, -5)]
    turned += [
        (size * (1 + share * np.cos(waves * angle)), 0.0, 0.0)
        for size in (9, 14, 21, 30) for waves in (2, 3) for share in (0.15, 0.3)
    ]  # fmt: skip
    for wide in (30, 45, 65):
        smooth = np.cos(np.radians(np.minimum(90 * away / wide, 90))) ** 2
        for lobe in (smooth, np.clip(2.2 * (1 - away / wide), 0, 1)):
            for base in (0, 1.5):
                for high in (5, 9, 14, 19, 26, 35):
                    turned += [
                        (base + high * (lobe + share * np.roll(lobe, _FINE // 2)), share * high, high)
                        for share in (0.65, 1)
                    ]
                turned += [(base + high * lobe, 0.0, high) for high in (3.5, 5, 8, 12, 18, 26, 36)]
    bit = 500 * CRITERIA_BIT
    for pipe in (1750 * INCH, 2500 * INCH, 3250 * INCH):  # radius, mm
        for deep in (5, 9, 14, 20, 28, 38):
            centre = bit + deep - pipe
            left = np.maximum(pipe**2 - (centre * np.sin(angle)) ** 2, 0)
            reach = np.where((left > 0) & (np.cos(angle) > 0), centre * np.cos(angle) + np.sqrt(left), 0)
            turned.append((np.maximum(reach - bit, 0), 0.0, deep))
    turns = (np.arange(_FINE) - np.arange(0, _FINE, _FINE // PARTS)[:, None]) % _FINE
    shapes, lower, higher = (np.array(column) for column in zip(*rounded, *turned, strict=True))
    every = np.concatenate([shapes[: len(rounded)], shapes[len(rounded) :, turns].reshape(-1, _FINE)])
    times = np.repeat([1, len(turns)], [len(rounded), len(turned)])
    return mm * every, mm * np.repeat(lower, times), mm * np.repeat(higher, times)
