"""The settings of the path of a hole, from its survey."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from helibore.settings.declared import FINITE, METRES, NOT_NEGATIVE, Declared, Option, Rule

Method = Literal["minimum-curvature", "radius-of-curvature"]
Reference = Literal["high-side", "north", "parallel-transport"]
North = Literal["true", "magnetic", "grid"]
"""Which north azimuths count from."""
ALL_FINITE = Rule("must be finite", lambda values: all(FINITE.test(value) for value in values))


@dataclass(frozen=True, kw_only=True)
class PathSettings(Declared, group="path"):
    """Settings of a path; see `helibore.Survey.path`."""

    method: Annotated[Method, Option(), "Curve between stations."] = "minimum-curvature"
    reference: Annotated[Reference | None, Option("high-side with a survey, else not known"),
        "Direction of toolface 0 of the wall. Without a survey it states this direction. None: the high side if there "
        "is a path, else not known.",
    ] = None  # fmt: skip
    north: Annotated[North | None, Option("as the survey states"),
        "Which north the azimuths of the survey count from, if the survey does not state it.",
    ] = None  # fmt: skip
    head: Annotated[tuple[float, float, float], METRES, ALL_FINITE, Option("0,0,0", metavar="NORTH,EAST,DOWN"),
        "North, east and down of the first station.",
    ] = (0.0, 0.0, 0.0)  # fmt: skip
    extend: Annotated[float, METRES, NOT_NEGATIVE, Option(),
        "Length by which the path goes on straight below the last station.",
    ] = 0.0  # fmt: skip
