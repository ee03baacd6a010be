"""The table ``[depth]``: the range of depths, and how far a depth may lie from the depth before it."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator

from helibore.base.arrays import Floats, Mask
from helibore.live.rules.checks import Table, within


def _ordered(limits: list[float]) -> list[float]:
    if len(limits) != 2 or not limits[0] < limits[1]:
        raise ValueError("must be [least, most] in metres, least < most")
    return limits


class DepthLimits(Table):
    """The range of depths, the longest step between two depths, and how far below the hole a depth may be; metres."""

    depth_range: Annotated[list[float], AfterValidator(_ordered)] = [0.0, 15_000.0]
    jump: Annotated[float, within(0.1)] = 100.0
    beyond_hole: Annotated[float, within(0)] = 10.0

    def outside(self, depth: Floats) -> Mask:
        """Return which depths are outside the range; NaN counts as inside."""
        wrong: Mask = (depth < self.depth_range[0]) | (depth > self.depth_range[1])
        return wrong

    def rule(self) -> str:
        """Return the text of the rule for the range."""
        return f"must be in depth_range [{self.depth_range[0]:g}, {self.depth_range[1]:g}]"
