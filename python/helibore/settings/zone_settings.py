"""The criteria of zones: washout, breakout, key seat and undergauge hole, and breakouts in an image.

`helibore.logs.zone_criteria` explains how the criteria decide the kind of a zone.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Annotated

from helibore.base.errors import InputError
from helibore.base.units import INCH
from helibore.settings.declared import DEGREES, INCHES, METRES, NOT_NEGATIVE, Declared, Option, Rule, at_least

CRITERIA_BIT = 8.5 * INCH
"""Bit size at which `Criteria.scaled` gives the defaults; the trade states no bit size with its criteria."""

SHARE = Rule("must be in [0, 1]", lambda value: 0 <= value <= 1)
INNER_SHARE = Rule("must be in (0, 1)", lambda value: 0 < value < 1)
QUARTER = Rule("must be at most 90", lambda value: value <= 90)


@dataclass(frozen=True, kw_only=True)
class ZoneLimits(Declared, group="zones"):
    """The criteria that decide the kind of a turn or a zone, as settings."""

    elongation: Annotated[float, INCHES, NOT_NEGATIVE, Option(), "Least C1 - C2 of a breakout."] = 1.0 * INCH
    washout: Annotated[float, INCHES, NOT_NEGATIVE, Option(), "Least C2 - bit of a washout."] = 0.5 * INCH
    key_seat: Annotated[float, INCHES, NOT_NEGATIVE, Option(),
        "Least height of a key seat over the unworn circle.",
    ] = 0.25 * INCH  # fmt: skip
    undergauge: Annotated[float, INCHES, NOT_NEGATIVE, Option(),
        "How much less than the bit the least diameter must be.",
    ] = 0.25 * INCH  # fmt: skip
    symmetry: Annotated[float, NOT_NEGATIVE, SHARE, Option(),
        "Share of the height of both lobes of a breakout that must be symmetric. It is symmetric about the unworn "
        "circle's centre; if the share is less, the turn is one-sided. 0.5 is usual for six-arm tools.",
    ] = 0.5  # fmt: skip
    opening_level: Annotated[float, NOT_NEGATIVE, INNER_SHARE, Option(),
        "Share of a lobe's height at which its opening is measured.",
    ] = 0.25  # fmt: skip
    least_length: Annotated[float, METRES, NOT_NEGATIVE, Option(), "Least length of a zone along the hole."] = 0.3
    join: Annotated[float, METRES, NOT_NEGATIVE, Option(),
        "Two zones of a kind become one if they are at most this far apart. The hole between them must be neither of "
        "another kind nor missing.",
    ] = 1.0  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Criteria(ZoneLimits):
    """The criteria that decide the kind of a turn or a zone. Lengths are metres."""

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


@dataclass(frozen=True, kw_only=True)
class ZoneSettings(ZoneLimits):
    """The criteria that decide the kind of a turn or a zone, and whether those that are not stated follow the bit."""

    scaled: Annotated[bool,
        "Scale the default criteria, which are for a bit of 8.5 in, to the bit size.",
    ] = False  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class ImageCriteria(Declared, group="image_zones"):
    """The criteria that rows of an image must meet to be a breakout."""

    dark: Annotated[float, NOT_NEGATIVE, INNER_SHARE,
        "A sector is dark below this share of the median of its row.",
    ] = 0.6  # fmt: skip
    least_opening: Annotated[float, DEGREES, NOT_NEGATIVE, "A narrower dark arc is ignored."] = 10.0
    most_opening: Annotated[float, DEGREES, NOT_NEGATIVE, "A wider dark arc is ignored."] = 100.0
    opposite: Annotated[float, DEGREES, NOT_NEGATIVE, QUARTER,
        "The angle between two arcs may differ from 180 degrees by at most this much.",
    ] = 30.0  # fmt: skip
    least_length: Annotated[float, METRES, NOT_NEGATIVE, "A shorter stretch of hole is no breakout."] = 0.05
    least_rows: Annotated[int, at_least(1), "Number of rows with two opposite dark arcs that make a breakout."] = 2
    join: Annotated[float, METRES, NOT_NEGATIVE,
        "A gap up to this does not split a breakout, if the axes agree within ``opposite``.",
    ] = 0.02  # fmt: skip

    def _check(self) -> None:
        if not self.least_opening < self.most_opening <= 180:
            place = f"least_opening = {self.least_opening}, most_opening"
            rule = "the first must be less than the second, and the second at most 180"
            raise InputError(place, rule, str(self.most_opening))

    def facts(self) -> dict[str, str]:
        """Return the criteria as texts; every output states them."""
        units = {"dark": "of the row's median", "least_length": "m", "least_rows": "rows", "join": "m"}
        return {
            f"criterion {name.replace('_', ' ')}": f"{value:.6g} {units.get(name, 'deg')}"
            for name, value in asdict(self).items()
        }
