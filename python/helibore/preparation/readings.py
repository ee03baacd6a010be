"""Readings: what each sensor of a tool measured in each row of a log, in metres, degrees and seconds.

    row   depth    toolface   radius of sensor 1   radius of sensor 2
    0     1000.0       12.5               0.1081               0.1079

The preparation takes them; ``helibore.channels.readings`` makes them from the channels of a file.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from helibore.base.arrays import Floats, Integers
from helibore.preparation.sensors import Sensor


def _row_place(row: int) -> str:
    return f"row {row}"


@dataclass(frozen=True)
class Readings:
    """The readings of a tool's sensors, in the order of the log's rows.

    Attributes
    ----------
    name
        The name of the file they come from, for errors.
    depth, toolface
        Of each row, (n,) m and degrees; NaN where missing. Toolfaces are 0 where the log has none.
    sensors, radii
        p sensors, and the radius that each measured in each row, (n,) m, NaN where missing.
    arm
        Index into ``channels`` for each sensor, (p,) int64.
    channels
        Names of the wall channels.
    across
        Whether a sensor's radius is half a measured diameter, (p,): such a radius does not show where the tool's
        centre was.
    time
        Seconds, (n,), or None.
    pass_number
        Pass of each row, (n,) int64, or None where the log numbers no passes; -1 where a row has no number.
    reference
        What toolfaces count from: "north", "high-side", "automatic", or "" for the wall's own reference.
    high_side
        Whether each row's toolface counts from the high side, (n,) bool; None where the log does not say it by row.
    turning
        Whether the log has a toolface.
    missing
        Channel name to the number of its missing values.
    notes
        One sentence for each channel used: its role, unit and reason.
    place
        Returns where a row stands in the file, for errors: ``"line 12"`` or ``"row 7"``.
    """

    name: str
    depth: Floats
    toolface: Floats
    sensors: tuple[Sensor, ...]
    radii: tuple[Floats, ...]
    arm: Integers
    channels: tuple[str, ...]
    across: tuple[bool, ...]
    time: Floats | None = None
    pass_number: Integers | None = None
    reference: str = ""
    high_side: npt.NDArray[np.bool_] | None = None
    turning: bool = True
    missing: dict[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    place: Callable[[int], str] = _row_place

    def __repr__(self) -> str:
        return f"Readings({self.name}, {self.rows} rows of {', '.join(self.channels)})"

    @property
    def rows(self) -> int:
        """The number of rows."""
        return int(self.depth.size)
