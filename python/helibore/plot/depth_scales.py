"""Choose the numbers that people read off a picture: the depth scale, and the steps of the depth lines.

1:200     5 mm a metre     a line each metre, a number each 5 m
1:500     2 mm a metre     a line each 2 m, a number each 10 m
1:240     1.27 mm a foot   a line each 5 ft, a number each 20 ft
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from helibore.base.units import FOOT

FINE_SCALES = (20, 40, 200)
COARSEST = 500
LONGEST = 1000.0
"""Greatest length on paper, millimetres, that an interval may have at one of the fine scales."""


def usual_depth_scale(length: float) -> int:
    """Return the finest of 1:20, 1:40 and 1:200 at which ``length`` metres of hole fit a metre of paper, else 1:500.

    >>> usual_depth_scale(3.0), usual_depth_scale(160.0), usual_depth_scale(736.0)
    (20, 200, 500)
    """
    return next((scale for scale in FINE_SCALES if length * 1000.0 / scale <= LONGEST), COARSEST)


@dataclass(frozen=True)
class DepthUnit:
    """The unit of depths on paper: its name, and its length in metres."""

    name: str
    metres: float

    def text(self, depth: float, decimals: int = 2) -> str:
        """Return a depth, given in metres, as a number in this unit: ``6,561.68``."""
        return f"{depth / self.metres:,.{decimals}f}"

    def ends(self, top: float, bottom: float) -> str:
        """Return the ends of an interval, given in metres, as text: ``2,000.00 to 2,022.00 m MD``."""
        return f"{self.text(top)} to {self.text(bottom)} {self.name} MD"


METRES, FEET = DepthUnit("m", 1.0), DepthUnit("ft", FOOT)


@dataclass(frozen=True)
class Lines:
    """Depth lines: a thin line every ``fine`` metres, and a thick line with its number every ``coarse`` metres.

    Both distances are metres. `Lines.of` makes each of them 1, 2 or 5 times a power of ten of ``unit``.
    """

    fine: float
    coarse: float
    unit: DepthUnit = METRES

    @classmethod
    def of(cls, scale: int, unit: DepthUnit = METRES) -> Lines:
        """Return lines at least 4 mm apart, and numbered lines at least 20 mm apart, on paper of scale 1:``scale``."""
        steps = [mantissa * 10.0**power for power in range(-3, 6) for mantissa in (1, 2, 5)]
        paper = unit.metres * 1000.0 / scale
        coarse = next(step for step in steps if step * paper >= 20.0)
        fine = next(step for step in steps if step * paper >= 4.0 and abs(coarse / step - round(coarse / step)) < 1e-6)
        return cls(fine * unit.metres, coarse * unit.metres, unit)

    def major(self, top: float, bottom: float) -> Sequence[float]:
        """Return the depths of the thick lines from ``top`` to ``bottom``, metres."""
        return multiples(self.coarse, top, bottom)

    def minor(self, top: float, bottom: float) -> Sequence[float]:
        """Return the depths of the thin lines from ``top`` to ``bottom``, metres, without those of thick lines."""
        every = round(self.coarse / self.fine)
        return [depth for depth in multiples(self.fine, top, bottom) if round(depth / self.fine) % every]

    def label(self, depth: float) -> str:
        """Return the number at a thick line, in ``unit``; ``depth`` is in metres."""
        digits = max(0, -math.floor(math.log10(self.coarse / self.unit.metres) + 1e-9))
        return f"{depth / self.unit.metres:.{digits}f}"


def multiples(step: float, top: float, bottom: float) -> list[float]:
    """Return the multiples of ``step`` from ``top`` to ``bottom``, both included."""
    first, last = math.ceil(top / step - 1e-9), math.floor(bottom / step + 1e-9)
    return [round(at * step, 9) for at in range(first, last + 1)]


def length_text(length: float, unit: str) -> str:
    """Return a length with its unit, inches or millimetres, as text: ``8.5 in``, ``215.9 mm``."""
    return f"{length:.3f}".rstrip("0").rstrip(".") + " in" if unit == "in" else f"{length:.1f} mm"
