"""The settings of the preparation: the steps that turn readings into samples, and how travel times become radii."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from helibore.base.errors import InputError
from helibore.settings.declared import (
    DEGREES,
    DEPTH,
    METRES,
    MILLIMETRES,
    NOT_NEGATIVE,
    POSITIVE,
    SECONDS,
    Declared,
    Option,
    Rule,
    at_least,
)
from helibore.settings.role_settings import ToolfaceReference

if TYPE_CHECKING:
    from helibore.base.arrays import Floats

NORTH_ANGLE = Rule("must lie within -180 and 180 degrees", lambda value: -180.0 <= value <= 180.0)


@dataclass(frozen=True, kw_only=True)
class Preparation(Declared, group="preparation"):
    """The steps that turn readings into samples. Units are metres, degrees and seconds."""

    shallowest: Annotated[float | None, METRES, Option(), "Drop shallower samples."] = None
    deepest: Annotated[float | None, METRES, Option(), "Drop deeper samples."] = None
    saturated: Annotated[bool, Option(),
        "Drop the readings of arms that cannot open farther. A run of 5 readings or more, over 0.5 m or more, in which "
        "an arm is as wide open as it can be, shows this limit.",
    ] = True  # fmt: skip
    drop_closed: Annotated[bool, Option(),
        "Drop the rows in which all arms stay closed, inside the bit. They stay at a radius 10 mm or more below the "
        "bit; the rows in which they close before and open after are dropped, too. This needs the bit size. If False, "
        "or without a bit size, such rows are only reported. Not used if ``closed`` is given.",
    ] = True  # fmt: skip
    closed: Annotated[float | None, METRES, POSITIVE, Option(metavar="RADIUS"),
        "Drop rows in which no arm reads 2 mm more than this radius, the reading of a closed tool.",
    ] = None  # fmt: skip
    stuck: Annotated[int | None, at_least(2, "rows"), Option(metavar="ROWS"),
        "Drop an arm that does not move for this many rows while others move. An arm without a value counts as one "
        "that does not move.",
    ] = None  # fmt: skip
    least_radius: Annotated[float | None, METRES, Option(), "Drop smaller radii."] = None
    greatest_radius: Annotated[float | None, METRES, Option(),
        "Drop larger radii. An impossible radius that is left is an error.",
    ] = None  # fmt: skip
    repeated: Annotated[bool, Option(),
        "Drop samples equal to an earlier sample. They are equal in depth, toolface, radius and, if there are times, "
        "time.",
    ] = False  # fmt: skip
    spikes: Annotated[float | None, POSITIVE, Option(metavar="DEVIATIONS"),
        "Drop readings, bursts and rows of a tool with few arms that differ from the wall around them by this many "
        "robust deviations; 6 is usual. Between its rows such a tool may miss what would confirm them. None: spikes "
        "are reported.",
    ] = None  # fmt: skip
    turn_spikes: Annotated[float | None, POSITIVE, Option("none: they stay", metavar="DEVIATIONS"),
        "Drop samples that differ from the turns beside theirs by this many robust deviations, and that no other turn "
        "confirms, if the tool turns within a metre or shows the hole all around.",
    ] = 6.0  # fmt: skip
    turn_height: Annotated[float | None, METRES, POSITIVE, Option("a turn is a rotation, or a row of an image"),
        "Height of a turn, for a tool that does not turn. None: a turn is a rotation, or a row of an image "
        "(`is_image`).",
    ] = None  # fmt: skip
    sensor_offset: Annotated[float, METRES, Option(),
        "How far every sensor lies above the point whose depth is recorded; added to the offset in a map.",
    ] = 0.0  # fmt: skip
    latency: Annotated[float, SECONDS, Option(),
        "Time from measurement to time stamp, for every sensor; added to the latency in a map.",
    ] = 0.0  # fmt: skip
    toolface_from: Annotated[ToolfaceReference | None, Option("as the map states, or else as for the wall"),
        "What the samples' toolface counts from; automatic: by inclination. In \"horizontal-north\" it is an angle in "
        "the horizontal plane, as the azimuth of a pad. None: as the file's map states.",
    ] = None  # fmt: skip
    declination: Annotated[float | None, DEGREES, NORTH_ANGLE, Option(),
        "Azimuth of magnetic north from true north, positive to the east. Needed if toolfaces count from magnetic "
        "north and azimuths from another, or the reverse.",
    ] = None  # fmt: skip
    convergence: Annotated[float | None, DEGREES, NORTH_ANGLE, Option(),
        "Azimuth of grid north from true north, positive to the east. Needed likewise for grid north.",
    ] = None  # fmt: skip
    steep: Annotated[float, DEGREES, Option(),
        "Automatic toolfaces count from the high side until the inclination falls to this.",
    ] = 4.0  # fmt: skip
    level: Annotated[float, DEGREES, Option(),
        "Automatic toolfaces count from north until the inclination rises to this.",
    ] = 6.0  # fmt: skip
    recentre: Annotated[bool, Option(),
        "Correct radii for the tool's offset from the axis of the bit. Where the tool rests is found by the unworn "
        "rock, which needs the bit size; without one, only its motion is corrected.",
    ] = False  # fmt: skip
    reversal: Annotated[float | None, METRES, POSITIVE, Option(),
        "Start a new pass where the tool moves back by more than this. None: each file has the passes that it numbers, "
        "or is one pass if it numbers no pass.",
    ] = None  # fmt: skip
    passes: Annotated[tuple[int, ...] | None, Option("all", metavar="NUMBERS"),
        "Passes to use, such as 2,3. The earliest is first; None: all, by number. The wall is made from the passes "
        "that are not in ``earlier``.",
    ] = None  # fmt: skip
    latest: Annotated[bool, Option(), "In each 0.5 m, use the last pass that measured there."] = False
    shifts: Annotated[tuple[tuple[int, float], ...], METRES, Option(metavar="PASS=LENGTH"),
        "Add a length to a pass's depths, such as 3=-0.2m. In Python (pass, metres) pairs.",
    ] = ()  # fmt: skip
    find_shifts: Annotated[bool, Option(),
        "Find each pass's depth shift from the overlap, as a function of depth: a constant, stretch, steps. A "
        "shift that ``shifts`` sets is not found. Without given shifts, the mean of the shifts that are found is 0. "
        "Where the toolfaces of a pass lie apart from those of the others, the report says by how much.",
    ] = False  # fmt: skip
    toolface_shifts: Annotated[tuple[tuple[int, float], ...], DEGREES,
        "Add an angle to a pass's toolfaces, such as 3=-15deg. In Python (pass, degrees) pairs.",
    ] = ()  # fmt: skip
    bias: Annotated[Literal["none", "arm", "side"], Option(),
        "Subtract the bias of each pass and arm; with side, a separate bias for each side of the hole. Biases are "
        "found where passes and arms measured the same wall.",
    ] = "none"  # fmt: skip
    earlier: Annotated[tuple[int, ...], Option(metavar="NUMBERS"),
        "Passes used only for the earlier wall, with which the wall is compared.",
    ] = ()  # fmt: skip

    def _check(self) -> None:
        self._ordered(("least_radius", "greatest_radius"), ("shallowest", "deepest"), ("steep", "level"))
        shifted, turned = (tuple(number for number, _ in of) for of in (self.shifts, self.toolface_shifts))
        for name, numbers in (
            ("shifts", shifted), ("toolface_shifts", turned), ("passes", self.passes or ()), ("earlier", self.earlier),
        ):  # fmt: skip
            twice = [number for number in numbers if numbers.count(number) > 1]
            if twice:
                raise InputError(name, f"pass {twice[0]} is given twice")

    @property
    def by_pass(self) -> bool:
        """Whether a step needs pass numbers."""
        return bool(
            self.passes
            or self.latest
            or self.shifts
            or self.toolface_shifts
            or self.find_shifts
            or self.bias != "none"
            or self.earlier
        )


@dataclass(frozen=True)
class EchoCasing(Declared, group="echo.casing"):
    """An interval of casing in which the velocity of sound in the mud is measured."""

    top: Annotated[float, METRES, DEPTH, "Top."]
    bottom: Annotated[float, METRES, DEPTH, "Bottom."]
    inner_diameter: Annotated[float, METRES, POSITIVE, "Inner diameter."]

    def _check(self) -> None:
        if not self.top < self.bottom:
            raise InputError("top", f"must be above the bottom, {self.bottom:g} m", f"{self.top:g}")


@dataclass(frozen=True)
class Echo(Declared, group="echo"):
    """The conversion of a travel time to a radius: tool_radius + velocity * (travel_time - window) / 2."""

    velocity: Annotated[float, POSITIVE, Option(),
        "Speed of sound in the mud, m/s; about 1500 in water. Where ``casing`` is stated, it measures the velocity by "
        "depth, and must not contradict this.",
    ]  # fmt: skip
    tool_radius: Annotated[
        float, METRES, NOT_NEGATIVE, Option(), "Distance from the tool's axis to the face of its transducer."
    ]
    window: Annotated[float, SECONDS, NOT_NEGATIVE, Option(),
        "Two-way time of the echo inside the tool, behind the transducer's window.",
    ] = 0.0  # fmt: skip
    velocity_sigma: Annotated[float | None, NOT_NEGATIVE, Option("not counted; a casing may differ by 6 %"),
        "Standard uncertainty of the velocity, m/s. It reaches diameters and volumes. A casing may differ from the "
        "velocity by three times as much. None: not counted without casing, and a casing may differ by 6 %.",
    ] = None  # fmt: skip
    casing: Annotated[tuple[EchoCasing, ...], METRES, Option(metavar="TOP,BOTTOM,DIAMETER"),
        "Interval of casing of known inner diameter, such as 0m,300m,8.681in, which measures the velocity. Between "
        "intervals the velocity follows their velocities, and beyond them its uncertainty grows; it reaches diameters "
        "and volumes.",
    ] = ()  # fmt: skip
    casing_sigma: Annotated[float, MILLIMETRES, NOT_NEGATIVE, Option(),
        "Standard uncertainty of the inner diameter of each casing.",
    ] = 0.0005  # fmt: skip

    def radius(self, travel_time: Floats) -> Floats:
        """Return the radii, metres, of travel times of any shape; NaN for a time shorter than the window (no echo)."""
        import numpy as np

        late = np.where(travel_time >= self.window, travel_time, np.nan)
        return self.tool_radius + 0.5 * self.velocity * (late - self.window)
