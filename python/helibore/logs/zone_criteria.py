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
times the sum of both heights. For a tool with few arms C1 and C2 are diameters of arms, the heights are those of the
two ends of C1 over the circle of C2, and its centre is that of the tool (``arms``).

These are the usual four-arm criteria (JewelSuite's defaults; the undergauge limit is helibore's), applied to the whole
section instead of four pads. `helibore.logs.zones` applies them.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

from helibore.base.arrays import Floats, Mask
from helibore.base.errors import InputError, check_not_negative
from helibore.base.units import INCH

CRITERIA_BIT = 8.5 * INCH
"""Bit size at which `Criteria.scaled` gives the defaults; the trade states no bit size with its criteria."""
MEASURES = {
    "washout": "C2 - bit", "breakout": "C1 - C2", "key seat": "height", "undergauge": "least diameter - bit",
}  # fmt: skip
"""The length by which the criteria decide each kind: they compare it with the kind's limit."""


@dataclass(frozen=True, kw_only=True)
class Criteria:
    """The criteria that decide the kind of a turn or a zone. Lengths are metres.

    Attributes
    ----------
    elongation
        Least C1 - C2 of a breakout.
    washout
        Least C2 - bit of a washout.
    key_seat
        Least height of a key seat over the unworn circle.
    undergauge
        How much less than the bit the least diameter must be.
    symmetry
        Share of the height of both lobes that must be symmetric about the unworn circle's centre in a breakout, 0 to
        1; if the share is less, the turn is one-sided. 0.5 is usual for six-arm tools.
    opening_level
        Share of a lobe's height at which its opening is measured, in (0, 1).
    least_length
        Least length of a zone, metres of hole.
    join
        Two zones of a kind become one if they are at most this many metres apart and the hole between them is neither
        of another kind nor missing.
    """

    elongation: float = 1.0 * INCH
    washout: float = 0.5 * INCH
    key_seat: float = 0.25 * INCH
    undergauge: float = 0.25 * INCH
    symmetry: float = 0.5
    opening_level: float = 0.25
    least_length: float = 0.3
    join: float = 1.0

    def __post_init__(self) -> None:
        check_not_negative(vars(self))
        if self.symmetry > 1:
            raise InputError("symmetry", "must be in [0, 1]", str(self.symmetry))
        if not 0 < self.opening_level < 1:
            raise InputError("opening_level", "must be in (0, 1)", str(self.opening_level))

    @classmethod
    def scaled(cls, bit_diameter: float, **others: float) -> Criteria:
        """Return the default criteria, which are for a bit of `CRITERIA_BIT` (8.5 in), scaled to another bit.

        Elongation, washout, key seat and undergauge scale with the bit. Service companies state their limits in inches
        for holes of any size; but in a hole of 4 in, lobes of a fifth of its diameter do not reach an elongation of 1
        in.

        Parameters
        ----------
        bit_diameter
            Metres.
        **others
            Values of attributes, which replace their scaled or default values.

        Examples
        --------
        >>> round(Criteria.scaled(0.104).elongation * 1000, 1)
        12.2
        """
        if not (math.isfinite(bit_diameter) and bit_diameter > 0):
            raise InputError("bit_diameter", "must be finite and above 0", str(bit_diameter))
        share = bit_diameter / CRITERIA_BIT
        scaled = {name: getattr(cls, name) * share for name in ("elongation", "washout", "key_seat", "undergauge")}
        return cls(**{**scaled, **others})

    def limits(self) -> dict[str, float]:
        """Return the limits of the lengths in `MEASURES`, metres, by kind; the limit of undergauge hole is below 0."""
        return {
            "washout": self.washout,
            "breakout": self.elongation,
            "key seat": self.key_seat,
            "undergauge": -self.undergauge,
        }

    def facts(self) -> dict[str, str]:
        """Return the criteria as texts; every output states them."""
        shares = ("symmetry", "opening_level")
        return {
            f"criterion {name.replace('_', ' ')}": f"{value:.6g}" if name in shares else f"{value:.6g} m"
            for name, value in asdict(self).items()
        }


def washed_out(c2: Floats, bit_diameter: float, criteria: Criteria | None = None) -> Mask:
    """Return which turns are enlarged all around, C2 - bit >= `Criteria.washout`; False where C2 is NaN.

    No other code decides what is washed out; a zone of washout is a long enough run of such turns (`classify`).
    """
    criteria = Criteria() if criteria is None else criteria
    washed: Mask = c2 - bit_diameter >= criteria.washout
    return washed
