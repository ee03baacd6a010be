"""Readings: what each sensor of a tool measured in each row of a log, in metres, degrees and seconds.

    row   depth    toolface   radius of sensor 1   radius of sensor 2
    0     1000.0       12.5               0.1081               0.1079

``helibore.channels.channel_readings`` makes readings from the channels of a file, and the preparation uses them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from helibore import _core
from helibore.base.arrays import Floats, Integers, Mask
from helibore.preparation.sensors import Sensor
from helibore.settings.preparation_settings import Echo

IMAGE_ROW = 8
"""If sensors look in this many directions or more, one row of readings shows the hole all around."""


def _row_place(row: int) -> str:
    return f"row {row}"


@dataclass(frozen=True)
class HoleDirection:
    """The direction of the hole at the n rows of a log, as its own sensors measured it."""

    inclination: Floats  # degrees, (n,); NaN where missing
    azimuth: Floats  # degrees, (n,); NaN where missing
    north: str = ""  # the north of the azimuths: true, magnetic or grid; "": not stated


@dataclass(frozen=True)
class Readings:
    """The readings of a tool's p sensors in the n rows of a log, in order; columns are (n,), NaN where missing."""

    name: str  # name of the file that the readings come from, for errors
    depth: Floats  # metres
    toolface: Floats  # degrees; 0 where the log has none
    sensors: tuple[Sensor, ...]
    radii: tuple[Floats, ...]  # metres, a column for each sensor
    arm: Integers  # index into ``channels`` for each sensor, (p,)
    channels: tuple[str, ...]  # names of the wall channels
    across: tuple[bool, ...]  # whether the radius of a sensor is half a diameter, which hides the tool's offset, (p,)
    time: Floats | None = None  # seconds
    pass_number: Integers | None = None  # -1 where a row has no number; None where the log numbers no passes
    reference: str = ""  # what toolfaces count from: north, horizontal-north, high-side, automatic; "": as the wall's
    high_side: Mask | None = None  # whether a row's toolface counts from the high side; None: no tags
    turning: bool = True  # whether the log has a toolface
    missing: dict[str, int] = field(default_factory=dict)  # channel name to the number of its missing values
    notes: tuple[str, ...] = ()  # a sentence for each channel used: its role, unit and reason
    north: str = ""  # the north of toolfaces from north: true, magnetic or grid; "": not stated
    hole: HoleDirection | None = None  # the direction of the hole at each row, if the log has it
    place: Callable[[int], str] = _row_place  # where a row stands in the file, for errors: "line 12" or "row 7"
    echo: Echo | None = None  # how the travel times of every sensor became radii; None: not all sensors have times

    def __repr__(self) -> str:
        return f"Readings({self.name}, {self.rows} rows of {', '.join(self.channels)})"

    @property
    def is_image(self) -> bool:
        """Whether a row shows the hole all around: sensors at one place on the string look in eight directions or more.

        Two calipers, each of which looks in four directions from its own place, are no imaging tool.
        """
        return _core.is_image(self.places)

    @property
    def places(self) -> list[tuple[float, float, int]]:
        """Offset, mounting and column of readings of each sensor; the two ends of a diameter share a column."""
        places: list[tuple[float, float, int]] = []
        for at, sensor in enumerate(self.sensors):
            shared = at > 0 and self.across[at] and self.arm[at] == self.arm[at - 1]
            column = places[-1][2] + (not shared) if places else 0
            places.append((sensor.offset, sensor.mounting, column))
        return places

    @property
    def rows(self) -> int:
        return int(self.depth.size)
