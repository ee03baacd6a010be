"""The probability of each kind of a zone: its sections are compared with a library of sections.

    d = radius - bit/2, mean in each of 32 parts of the turn; a part without a sample says nothing
    chi^2 of a section s = min over the tool's offset (x, y) of sum w (d - s - x cos - y sin)^2 + (x^2 + y^2) / (7 mm)^2
    evidence of a kind = mean over its sections of sum over scales f of p(f) f^-n exp(-chi^2 / 2 f^2)

The library has round, oval and lobed sections of many sizes, widths and directions, and slots of pipes. The criteria
say of which kind each of them is, as of a turn (`helibore.logs.zone_criteria`). The factor f lets holes differ from the
library more than `ROUGH`, so that other shapes do not make it too sure. A zone that no gauge section explains is not
gauge, however little it resembles the other kinds; if no section at all explains it, its kind is not sure. Lengths are
those of a hole of 8.5 in, scaled to the bit. ``python -m bench.accuracy.hazards`` measures how often the probabilities
are right. The core draws the library and compares (``kinds.hpp``).
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers, Mask, runs_of
from helibore.settings.zone_settings import Criteria

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
LIKENESS = (ROUGH, OFFSET, EFFECTIVE, list(SCALES.items()))
"""How sections are compared, as the core takes it."""


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
    library = _library(bit_diameter, criteria, even)
    kinds, sound = _core.likely_kind(sections.ravel(), library, PRIOR, (EXPLAINED, RESEMBLES), LIKENESS)
    return np.array(kinds), sound


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
            chained = _chained(gathered[low:high], turns * height, library, threads)
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


def _chained(windows: Floats, step: float, library: _core.Library, threads: int) -> Floats:
    """Return what is known in windows of the length ``step``, metres, (windows, 7).

    It is the probability of each kind, then the means of the squared radius and of its square.
    """
    sections, counts, size, weight = library
    middle = float(size.mean())  # the core has floats: those near 0 are finer
    stays = STAYS**step
    chain = (stays, (1 - stays) * CHANGES, TEMPER)
    centred = (sections, counts, size - middle, weight)
    kinds, mean, square = _core.likely_along(windows.ravel(), centred, ALONG_PRIOR, chain, LIKENESS, threads)
    off = [middle + mean, square + 2 * middle * mean + middle**2]
    return np.column_stack([kinds.reshape(len(windows), len(PRIOR)), *off])


@lru_cache(maxsize=4)
def _library(bit_diameter: float, criteria: Criteria, even: bool) -> _core.Library:
    """Return sections, how many are of each kind, their mean squared radii, and how many directions each stands for."""
    limits = (criteria.elongation, criteria.washout, criteria.key_seat, criteria.undergauge, criteria.symmetry)
    return _core.section_library(bit_diameter, limits, even)
