"""The criteria of washout, breakout, key seat and undergauge hole.

C1 is the largest diameter, C2 is the diameter at right angles to it. The kind of a turn is the first in this list
whose rule fits:

    undergauge   least diameter  < bit - 0.25 in
    washout      C2 - bit       >= 0.5 in                                     enlarged all around
    breakout     C1 - C2        >= 1 in, and both lobes are high              two lobes, opposite
    key seat     one lobe        is >= 0.25 in high and at most 150 degrees wide, and no other is high
    gauge        all other turns

Lobes and their heights are those over the unworn circle (`Logs.lobe1_height`). Two lobes are opposite if the angle
between them is 140 degrees or more. Both are high if twice the height of the lower one is at least `Criteria.symmetry`
times the sum of both heights. A lobe counts if the wall is about as high (0.65 of it in the mean) at its toolface over
the least length of a zone: an open fracture crosses the hole, so it is no zone. For a tool with few arms C1 and C2 are
diameters of arms, the heights are those of the two ends of C1 over the circle of C2, and its centre is that of the tool
(``arms``).

These are the usual four-arm criteria (JewelSuite's defaults; the undergauge limit is helibore's), applied to the whole
section instead of four pads. The core (``zones.hpp``) applies them.
"""

from __future__ import annotations

import numpy as np

from helibore.base.arrays import Floats
from helibore.settings.zone_settings import CRITERIA_BIT, Criteria

__all__ = ["CRITERIA_BIT", "MEASURES", "Criteria", "median_enlargement"]

MEASURES = {
    "washout": "C2 - bit", "breakout": "C1 - C2", "key seat": "height", "undergauge": "least diameter - bit",
}  # fmt: skip
"""The length by which the criteria decide each kind: they compare it with the kind's limit."""


def median_enlargement(radius: Floats, sectors: int, bit_diameter: float) -> Floats:
    """Return the median diameter of each whole turn less the bit diameter, metres; NaN where a radius is missing.

    Alarms compare it with their limits, because one bad sample hardly moves it.
    """
    turns = radius[: len(radius) // sectors * sectors].reshape(-1, sectors)
    median: Floats = np.median(turns + np.roll(turns, sectors // 2, axis=1), axis=1)
    return median - bit_diameter
