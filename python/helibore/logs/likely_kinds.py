"""The probability of each kind of a zone: its sections are compared with a library of sections.

    d = radius - bit/2, mean in each of 32 parts of the turn; a part without a sample says nothing
    chi^2 of a section s = min over the tool's offset (x, y) of sum w (d - s - x cos - y sin)^2 + (x^2 + y^2) / (7 mm)^2
    evidence of a kind = mean over its sections of sum over scales f of p(f) f^-n exp(-chi^2 / 2 f^2)

The library has round, oval and lobed sections of many sizes, widths and directions, and slots of pipes. The criteria
say of which kind each of them is, as of a turn (`helibore.logs.zone_criteria`): by diameters none is a key seat, since
these do not show on which side a hole is wide, and a breakout that they show is less sure by what a key seat is likely.
Along the hole, one that is gauge by them is thought lobed in one of fifteen cases. The factor f lets holes differ from
the library more than 1.6 mm, so that other shapes do not make it too sure. A zone that no gauge section explains is not
gauge, however little it resembles the other kinds; if no section at all explains it, its kind is not sure. Lengths are
those of a hole of 8.5 in, scaled to the bit. ``python -m bench.accuracy.hazards`` measures how often the probabilities
are right. The core draws the library and compares; ``kinds.hpp`` has the numbers.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from helibore import _core
from helibore.base.arrays import Floats, Integers, Mask
from helibore.settings.zone_settings import Criteria

PARTS = 32
"""Parts of a turn in a section."""


class Along(NamedTuple):
    """What the chain finds along a hole.

    ``kinds``: (turns, 5) probability of each kind. ``seen``: (turns,) parts that samples see around a turn, and those
    beside them. ``square``, ``square_sigma``: (turns,) mean squared radius, m2, and its deviation among likely
    sections; NaN where the samples lie beyond all sections of the library: from 11 mm inside a bit of 8.5 in to 48 mm
    outside.
    """

    kinds: Floats
    seen: Integers
    square: Floats
    square_sigma: Floats


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
    the library along the hole: from one window to the next it stays, changes within its kind, or becomes any section,
    so that windows which see other parts of one shape add up. It carries the tool's offset as well: one reading that is
    short or long all along the hole is an offset, but a change of it on one side is not. Parameters as of
    `kind_probabilities`; ``height`` is that of a turn, metres. Only the turns ``wanted``, (turns,), have values, which
    windows beside them decide as well; the others are NaN.
    """
    many, libraries = wanted.astype(np.float64), section_libraries(bit_diameter, criteria)
    kinds, seen, square, sigma = libraries.kinds_along(sections.ravel(), height, many, even, threads)
    return Along(kinds.reshape(len(wanted), -1), seen, square, sigma)


@lru_cache(maxsize=4)
def section_libraries(bit_diameter: float, criteria: Criteria) -> _core.SectionLibraries:
    """Return the libraries of sections for a bit and criteria; the core draws them when it needs them."""
    limits = (criteria.elongation, criteria.washout, criteria.key_seat, criteria.undergauge, criteria.symmetry)
    return _core.SectionLibraries(bit_diameter, limits)
