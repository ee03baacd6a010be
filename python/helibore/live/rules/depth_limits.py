"""The table ``[depth]``: the range of depths, and how far a depth may lie from the depth before it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from helibore.base.arrays import Floats, Mask
from helibore.settings.declared import FINITE, METRES, NOT_NEGATIVE, Declared, Rule, at_least

ORDERED = Rule("must be [least, most], least below most", lambda limits: limits[0] < limits[1])


@dataclass(frozen=True, kw_only=True)
class DepthLimits(Declared):
    """Limits of depths, ``[depth]``: a depth beyond them is counted, gives an event, and is not used."""

    depth_range: Annotated[tuple[float, float], METRES, ORDERED,
        "Least and most depth of samples, images, stations, bit and hole.",
    ] = (0.0, 15_000.0)  # fmt: skip
    jump: Annotated[float, METRES, FINITE, at_least(0.1, "m"),
        "A depth farther from the depth before it is used only if the next one confirms it.",
    ] = 100.0  # fmt: skip
    beyond_hole: Annotated[float, METRES, NOT_NEGATIVE,
        "A depth that lies more than this below the hole depth is wrong.",
    ] = 10.0  # fmt: skip

    def outside(self, depth: Floats) -> Mask:
        """Return which depths are outside the range; NaN counts as inside."""
        wrong: Mask = (depth < self.depth_range[0]) | (depth > self.depth_range[1])
        return wrong

    def rule(self) -> str:
        """Return the text of the rule for the range."""
        return f"must be in depth_range [{self.depth_range[0]:g}, {self.depth_range[1]:g}]"
